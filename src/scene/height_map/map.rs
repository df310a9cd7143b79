use super::Geographic;
use crate::scene::Error;
use glam::DVec2;

/// A regular grid of heights in metres.
///
/// Column 0 is the west edge (u = 0), row 0 the north edge (v = 0). Samples are nodes, row by row: a map of w x h
/// samples has (w - 1) x (h - 1) cells between them.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    width: u32,
    height: u32,
    samples: Samples,
    range_m: (f32, f32),
    spacing_m: DVec2,
    geographic: Option<Geographic>,
    voids_filled: u64,
}

/// The heights of a map, row by row.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 16-bit steps, as integral sources hold them: height = `origin_m` + `step_m` * value.
    Steps { values: Vec<u16>, origin_m: f32, step_m: f32 },
    /// Metres.
    Float(Vec<f32>),
}

impl HeightMap {
    /// Fewest and most samples a side.
    pub const SIDE: std::ops::RangeInclusive<u32> = 2..=16_384;

    /// A map of `width` x `height` samples, 1 m apart.
    ///
    /// # Errors
    /// A side outside [`Self::SIDE`], a number of samples other than `width` times `height`, a height that is not
    /// finite, or steps that are not finite and positive.
    pub fn new(width: u32, height: u32, samples: Samples) -> Result<Self, Error> {
        check_size(width.into(), height.into()).map_err(unusable)?;
        let (count, expected) = (samples.len(), width as usize * height as usize);
        if count != expected {
            return Err(unusable(format!("{count} samples for {width} x {height}, which needs {expected}")));
        }
        let range_m = samples.range_m().map_err(|fault| match fault {
            RangeFault::Steps => unusable("its 16-bit steps need a finite origin and a finite, positive step"),
            RangeFault::NotFinite(index) => {
                let (row, column) = (index / width as usize, index % width as usize);
                unusable(format!("row {row}, column {column}: the height is not a finite number"))
            }
        })?;
        Ok(Self { width, height, samples, range_m, spacing_m: DVec2::ONE, geographic: None, voids_filled: 0 })
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The height of one sample, metres. Columns and rows beyond the border take the border's.
    pub fn height_m(&self, column: u32, row: u32) -> f32 {
        let index = row.min(self.height - 1) as usize * self.width as usize + column.min(self.width - 1) as usize;
        match &self.samples {
            Samples::Steps { values, origin_m, step_m } => origin_m + step_m * f32::from(values[index]),
            Samples::Float(heights) => heights[index],
        }
    }

    /// Lowest and highest sample, metres.
    pub fn range_m(&self) -> (f32, f32) {
        self.range_m
    }

    /// Metres between neighbouring columns (x) and rows (y), both positive.
    pub fn spacing_m(&self) -> DVec2 {
        self.spacing_m
    }

    /// Where the map lies on the Earth, if its source says so in degrees.
    pub fn geographic(&self) -> Option<Geographic> {
        self.geographic
    }

    /// How many samples the source left void, which were filled from their neighbours.
    pub fn voids_filled(&self) -> u64 {
        self.voids_filled
    }

    /// The map with another distance between columns (x) and rows (y), metres. It keeps its place on the Earth.
    ///
    /// # Errors
    /// A distance that is not finite and positive.
    pub fn with_spacing_m(self, spacing_m: DVec2) -> Result<Self, Error> {
        if !(spacing_m.is_finite() && spacing_m.min_element() > 0.0) {
            let reason = format!("its spacing is {} x {} m; give finite, positive numbers", spacing_m.x, spacing_m.y);
            return Err(unusable(reason));
        }
        Ok(Self { spacing_m, ..self })
    }

    /// The map with all heights multiplied by `factor`.
    ///
    /// # Errors
    /// A factor that is not finite and positive, or one that makes a height infinite.
    pub fn with_exaggeration(self, factor: f32) -> Result<Self, Error> {
        if !(factor.is_finite() && factor > 0.0) {
            return Err(unusable(format!("its exaggeration is {factor}; give a finite, positive number")));
        }
        let samples = match self.samples {
            Samples::Steps { values, origin_m, step_m } => {
                Samples::Steps { values, origin_m: origin_m * factor, step_m: step_m * factor }
            }
            Samples::Float(mut heights) => {
                heights.iter_mut().for_each(|height| *height *= factor);
                Samples::Float(heights)
            }
        };
        let range_m = samples
            .range_m()
            .map_err(|_| unusable(format!("an exaggeration of {factor} takes its heights out of range")))?;
        Ok(Self { samples, range_m, ..self })
    }

    pub(super) fn with_geographic(self, geographic: Geographic) -> Self {
        Self { geographic: Some(geographic), ..self }
    }

    pub(super) fn with_voids_filled(self, voids_filled: u64) -> Self {
        Self { voids_filled, ..self }
    }
}

impl Samples {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Steps { values, .. } => values.len(),
            Self::Float(heights) => heights.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Lowest and highest height of at least one sample.
    fn range_m(&self) -> Result<(f32, f32), RangeFault> {
        match self {
            Self::Steps { values, origin_m, step_m } => {
                let (low, high) =
                    values.iter().fold((u16::MAX, 0), |(low, high), &value| (low.min(value), high.max(value)));
                let [low_m, high_m] = [low, high].map(|value| origin_m + step_m * f32::from(value));
                let valid = *step_m > 0.0 && [*origin_m, *step_m, low_m, high_m].iter().all(|part| part.is_finite());
                if valid { Ok((low_m, high_m)) } else { Err(RangeFault::Steps) }
            }
            Self::Float(heights) => {
                if let Some(index) = heights.iter().position(|height| !height.is_finite()) {
                    return Err(RangeFault::NotFinite(index));
                }
                Ok(heights.iter().fold((f32::MAX, f32::MIN), |(low, high), &h| (low.min(h), high.max(h))))
            }
        }
    }
}

enum RangeFault {
    Steps,
    NotFinite(usize),
}

/// Whether a map may have this many columns and rows; readers ask before they allocate.
pub(super) fn check_size(width: u64, height: u64) -> Result<(), String> {
    let (fewest, most) = (u64::from(*HeightMap::SIDE.start()), u64::from(*HeightMap::SIDE.end()));
    if [width, height].iter().all(|side| (fewest..=most).contains(side)) {
        return Ok(());
    }
    Err(format!("it has {width} x {height} samples; a map has {fewest} to {most} a side"))
}

fn unusable(reason: impl Into<String>) -> Error {
    Error::HeightMap { reason: reason.into() }
}

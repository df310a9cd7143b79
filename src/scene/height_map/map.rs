mod record;

use super::slope::SlopeMeter;
use super::void_samples::{Suspect, VoidSamples, Voids};
use super::{Coordinates, Geographic};
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
    coordinates: Option<Coordinates>,
    voids: Option<VoidSamples>,
    /// The height of the nodes in its holes, metres, if it has any.
    hole_m: Option<f32>,
    suspect: Option<Suspect>,
    /// Of a map whose samples lie elsewhere.
    slope: Option<f64>,
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
    pub const SIDE: std::ops::RangeInclusive<u32> = 2..=65_536;
    /// Least and most metres between samples that a file or a user may state: what is far beyond has no picture.
    pub const SPACING_M: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
    /// As the upper end of [`Self::SPACING_M`], of a map in degrees: two samples may lie around the Earth.
    pub const MOST_SPACING_ON_EARTH_M: f64 = 1e8;
    /// Most metres above and below 0 that a height of a file and the level of a base or of voids may lie.
    pub const MOST_HEIGHT_M: f64 = 1e6;

    /// A map of `width` x `height` samples, 1 m apart.
    ///
    /// # Errors
    /// A side outside [`Self::SIDE`], a number of samples other than `width` times `height`, a height that is not
    /// finite, or steps that are not finite and positive.
    pub fn new(width: u32, height: u32, samples: Samples) -> Result<Self, Error> {
        let map = Self::promised(width, height, samples.kind())?;
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
        Ok(Self { samples, range_m, ..map })
    }

    /// A map without its samples, which lie elsewhere, so that its range and its slope are not known; `kind` has no sample.
    ///
    /// # Errors
    /// A side outside [`Self::SIDE`].
    pub(super) fn promised(width: u32, height: u32, kind: Samples) -> Result<Self, Error> {
        check_size(width.into(), height.into()).map_err(unusable)?;
        Ok(Self {
            width,
            height,
            samples: kind,
            range_m: (0.0, 0.0),
            spacing_m: DVec2::ONE,
            geographic: None,
            coordinates: None,
            voids: None,
            hole_m: None,
            suspect: None,
            slope: None,
        })
    }

    /// The map without its samples, which lie elsewhere; all else that it says of itself stays.
    ///
    /// # Errors
    /// Heights that are not finite.
    pub(super) fn without_samples(self, range_m: (f32, f32), slope: f64) -> Result<Self, Error> {
        if !(range_m.0.is_finite() && range_m.1.is_finite()) {
            return Err(unusable("its heights are out of range"));
        }
        let voids = self.voids.as_ref().map(VoidSamples::counted);
        Ok(Self { samples: self.samples.kind(), range_m, slope: Some(slope), voids, ..self })
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
        self.samples.height_m(index)
    }

    /// Lowest and highest sample, metres; a hole is none.
    pub fn range_m(&self) -> (f32, f32) {
        self.range_m
    }

    /// The lowest node that interpolation reads, metres: a sample, or one in a hole.
    pub fn lowest_node_m(&self) -> f32 {
        self.hole_m.map_or(self.range_m.0, |hole_m| hole_m.min(self.range_m.0))
    }

    /// Root of the mean square of the land's slope, metres for a metre; of at most 512 columns and rows.
    pub fn slope(&self) -> f64 {
        self.slope.unwrap_or_else(|| {
            let mut meter = SlopeMeter::new((self.width, self.height), self.spacing_m);
            for row in (0..self.height).filter(|row| meter.takes(*row)).collect::<Vec<_>>() {
                meter.take(&|column| self.height_m(column, row), &|column| self.height_m(column, row + 1));
            }
            meter.slope()
        })
    }

    /// Metres between neighbouring columns (x) and rows (y), both positive.
    pub fn spacing_m(&self) -> DVec2 {
        self.spacing_m
    }

    /// Placement of the map on the Earth, if its source says so in degrees.
    pub fn geographic(&self) -> Option<Geographic> {
        self.geographic
    }

    /// Map coordinates of the samples, if the source has any.
    pub fn coordinates(&self) -> Option<Coordinates> {
        self.coordinates
    }

    /// All heights, metres, row by row; no number where the source left a sample void.
    pub(super) fn known_heights(&self) -> Vec<f32> {
        let mut heights = match &self.samples {
            Samples::Steps { values, origin_m, step_m } => {
                values.iter().map(|value| origin_m + step_m * f32::from(*value)).collect()
            }
            Samples::Float(heights) => heights.clone(),
        };
        let voids = self.voids.iter().flat_map(VoidSamples::places);
        voids.for_each(|place| heights[place] = f32::NAN);
        heights
    }

    /// Number of samples that the source left void.
    pub fn voids(&self) -> u64 {
        self.voids.as_ref().map_or(0, VoidSamples::count)
    }

    /// Fraction of the samples that the source left void.
    pub fn void_fraction(&self) -> f64 {
        self.voids() as f64 / (f64::from(self.width) * f64::from(self.height))
    }

    /// Heights that look like voids which the source does not declare.
    pub fn suspect(&self) -> Option<Suspect> {
        self.suspect
    }

    /// The map with its voids, which readers fill from their neighbours, as asked for; a hole lies below `base_m`.
    ///
    /// # Errors
    /// A level that is not finite.
    pub fn with_voids(self, treatment: Voids, base_m: f32) -> Result<Self, Error> {
        let Some(voids) = self.voids.clone() else { return Ok(self) };
        let voids = voids.treated(treatment);
        let samples = match treatment {
            Voids::Fill => return Ok(Self { voids: Some(voids), ..self }),
            Voids::Level(level_m) if !level_m.is_finite() => {
                return Err(unusable("the level of its voids is not finite"));
            }
            Voids::Level(level_m) => voids.at(self.samples, level_m),
            Voids::Hole => voids.below(self.samples, base_m, self.range_m.1 - self.range_m.0),
        };
        let range_m = match treatment {
            Voids::Hole => self.range_m,
            _ => samples.range_m().map_err(|_| unusable("the level of its voids is out of range"))?,
        };
        let hole = voids.places().next().filter(|_| treatment == Voids::Hole);
        let hole_m = hole.map(|place| samples.height_m(place));
        Ok(Self { samples, range_m, voids: Some(voids), hole_m, ..self })
    }

    /// A line on the samples that the source left void; none where it has them all.
    pub fn void_note(&self) -> Option<String> {
        let voids = self.voids.as_ref()?;
        let percent = 100.0 * self.void_fraction();
        Some(format!("{} samples, {percent:.1} %, are void: {}", voids.count(), voids.note()))
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
        let hole_m = self.hole_m.map(|hole_m| hole_m * factor);
        Ok(Self { samples, range_m, hole_m, ..self })
    }

    /// The map of a whole turn, whose first column follows its last: two columns more on each side, which repeat those
    /// of the other. It lies in the same place; what it says of its place on the Earth is left out.
    pub fn closed(&self) -> Self {
        let width = self.width as usize;
        let columns = || (width - 2..width).chain(0..width).chain(0..2);
        let wider = |row: usize| columns().map(move |column| row * width + column);
        let places = || (0..self.height as usize).flat_map(wider);
        let samples = match &self.samples {
            Samples::Steps { values, origin_m, step_m } => Samples::Steps {
                values: places().map(|place| values[place]).collect(),
                origin_m: *origin_m,
                step_m: *step_m,
            },
            Samples::Float(heights) => Samples::Float(places().map(|place| heights[place]).collect()),
        };
        let voids = self.voids.as_ref().map(VoidSamples::counted);
        Self { width: self.width + 4, samples, geographic: None, coordinates: None, voids, ..*self }
    }

    pub(super) fn with_geographic(self, geographic: Geographic) -> Self {
        let Geographic { west_deg, north_deg, step_deg } = geographic;
        let coordinates = Coordinates { north_west: DVec2::new(west_deg, north_deg), step: step_deg };
        Self { geographic: Some(geographic), ..self.with_coordinates(Some(coordinates)) }
    }

    pub(super) fn with_coordinates(self, coordinates: Option<Coordinates>) -> Self {
        Self { coordinates, ..self }
    }

    pub(super) fn with_void_samples(self, places: &[u32]) -> Self {
        let voids = (!places.is_empty()).then(|| VoidSamples::new(self.samples.len(), places));
        Self { voids, ..self }
    }

    pub(super) fn with_suspect(self, suspect: Option<Suspect>) -> Self {
        Self { suspect, ..self }
    }
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Steps { values, .. } => values.len(),
            Self::Float(heights) => heights.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The height of one sample, metres.
    fn height_m(&self, index: usize) -> f32 {
        match self {
            Self::Steps { values, origin_m, step_m } => origin_m + step_m * f32::from(values[index]),
            Self::Float(heights) => heights[index],
        }
    }

    /// The same kind without a sample.
    fn kind(&self) -> Self {
        match *self {
            Self::Steps { origin_m, step_m, .. } => Self::Steps { values: Vec::new(), origin_m, step_m },
            Self::Float(_) => Self::Float(Vec::new()),
        }
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

/// Passes for a number of columns and rows that a map may have; readers ask before they allocate.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(values: &[u16], origin_m: f32, step_m: f32) -> Samples {
        Samples::Steps { values: values.to_vec(), origin_m, step_m }
    }

    #[test]
    fn heights_are_read_row_by_row_and_clamped_at_the_border() {
        let map = HeightMap::new(3, 2, steps(&[0, 1, 2, 10, 11, 12], -5.0, 0.5)).unwrap();
        assert_eq!((map.width(), map.height(), map.range_m()), (3, 2, (-5.0, 1.0)));
        assert_eq!((map.height_m(2, 0), map.height_m(0, 1)), (-4.0, 0.0));
        assert_eq!((map.height_m(9, 0), map.height_m(u32::MAX, u32::MAX)), (-4.0, 1.0));
        assert_eq!((map.spacing_m(), map.geographic(), map.voids()), (DVec2::ONE, None, 0));
    }

    #[test]
    fn spacing_and_exaggeration_change_only_themselves() {
        let float = HeightMap::new(2, 2, Samples::Float(vec![-1.0, 0.0, 1.0, 8.0])).unwrap();
        for map in [float, HeightMap::new(2, 2, steps(&[0, 1, 2, 9], -1.0, 1.0)).unwrap()] {
            let wide = map.clone().with_spacing_m(DVec2::new(3.0, 4.0)).unwrap();
            assert_eq!((wide.spacing_m(), wide.samples()), (DVec2::new(3.0, 4.0), map.samples()));
            let high = wide.with_exaggeration(2.0).unwrap();
            assert_eq!((high.range_m(), high.spacing_m()), ((-2.0, 16.0), DVec2::new(3.0, 4.0)));
            assert_eq!([(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| high.height_m(c, r)), [-2.0, 0.0, 2.0, 16.0]);
        }
    }

    #[test]
    fn a_closed_map_repeats_two_columns_on_each_side() {
        let heights = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        for map in [
            HeightMap::new(3, 2, steps(&[0, 1, 2, 3, 4, 5], 0.0, 1.0)).unwrap(),
            HeightMap::new(3, 2, Samples::Float(heights.to_vec())).unwrap(),
        ] {
            let closed = map.closed();
            assert_eq!((closed.width(), closed.height(), closed.range_m()), (7, 2, (0.0, 5.0)));
            let row = |row| (0..7).map(|column| closed.height_m(column, row)).collect::<Vec<_>>();
            assert_eq!(row(0), [1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0]);
            assert_eq!(row(1), [4.0, 5.0, 3.0, 4.0, 5.0, 3.0, 4.0]);
        }
    }

    #[test]
    fn impossible_maps_are_refused_with_the_reason() {
        let message = |result: Result<HeightMap, Error>| result.unwrap_err().to_string();
        for (width, height, samples, expected) in [
            (0, 5, steps(&[], 0.0, 1.0), "it has 0 x 5 samples; a map has 2 to 65536 a side"),
            (1, 2, steps(&[1, 2], 0.0, 1.0), "it has 1 x 2 samples"),
            (65_537, 2, steps(&[1], 0.0, 1.0), "it has 65537 x 2 samples"),
            (2, 2, steps(&[1, 2, 3], 0.0, 1.0), "3 samples for 2 x 2, which needs 4"),
            (2, 2, steps(&[0; 4], f32::NAN, 1.0), "16-bit steps need a finite origin"),
            (2, 2, steps(&[0; 4], 0.0, 0.0), "16-bit steps need a finite origin and a finite, positive step"),
            (2, 2, steps(&[9; 4], 0.0, f32::MAX), "16-bit steps need"),
            (
                2,
                2,
                Samples::Float(vec![0.0, 0.0, 0.0, f32::INFINITY]),
                "row 1, column 1: the height is not a finite number",
            ),
            (2, 2, Samples::Float(vec![0.0, f32::NAN, 0.0, 0.0]), "row 0, column 1"),
        ] {
            let message = message(HeightMap::new(width, height, samples));
            assert!(message.starts_with("cannot use the height map: ") && message.contains(expected), "{message}");
        }
        let map = || HeightMap::new(2, 2, Samples::Float(vec![0.0, 1.0, 1e38, 0.0])).unwrap();
        for spacing_m in [DVec2::ZERO, DVec2::new(1.0, -1.0), DVec2::new(f64::NAN, 1.0), DVec2::INFINITY] {
            assert!(message(map().with_spacing_m(spacing_m)).contains("give finite, positive numbers"));
        }
        for factor in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(message(map().with_exaggeration(factor)).contains("give a finite, positive number"));
        }
        assert!(message(map().with_exaggeration(10.0)).contains("takes its heights out of range"));
    }
}

//! Maps whose rows come one after another, so that none is held whole.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use glam::DVec2;

use super::formats::GeoTiffRows;
use super::slope::SlopeMeter;
use super::volcano::VolcanoRows;
use super::{HeightMap, MapOptions, Samples};
use crate::scene::Error;
use crate::scene::loading::Conditions;

/// Rows that are read at once.
const TOGETHER: usize = 128;

/// Whole rows of a map, from the north on.
#[derive(Debug, Clone, Copy)]
pub enum Rows<'a> {
    /// 16-bit steps, as the map has them.
    Steps(&'a [u16]),
    /// Metres.
    Float(&'a [f32]),
}

/// A map without its samples, and what tells them row by row.
pub struct RowSource {
    /// All but range and slope, which follow from the samples.
    map: HeightMap,
    /// Factor of heights in metres; steps have it in their own.
    factor: f32,
    source: Source,
}

enum Source {
    Map(Box<HeightMap>),
    Volcano(VolcanoRows),
    GeoTiff(GeoTiffRows),
}

impl RowSource {
    /// A map that is held.
    ///
    /// # Errors
    /// None that a map has.
    pub fn of(map: HeightMap) -> Result<Self, Error> {
        let bare = map.clone().without_samples(map.range_m(), map.slope())?;
        Ok(RowSource { map: bare, factor: 1.0, source: Source::Map(Box::new(map)) })
    }

    /// [`volcano()`](super::volcano()), of which a few rows are held.
    ///
    /// # Errors
    /// A side outside [`HeightMap::SIDE`]; [`Error::Interrupted`].
    pub fn volcano(side: u32, seed: u64) -> Result<Self, Error> {
        super::map::check_size(side.into(), side.into()).map_err(|reason| Error::HeightMap { reason })?;
        let rows = VolcanoRows::new(side, seed)?;
        Ok(RowSource { map: rows.map()?, factor: 1.0, source: Source::Volcano(rows) })
    }

    /// A GeoTIFF, or its overview of a number from 1 on, of which a row of tiles or a strip is held; none of another file, and of one
    /// with voids, which are filled from all their neighbours.
    ///
    /// # Errors
    /// As [`HeightMapSource::load_with`](super::HeightMapSource::load_with).
    pub fn geotiff(path: &Path, options: impl Into<MapOptions>) -> Result<Option<Self>, Error> {
        let Some(rows) = GeoTiffRows::survey(path, options.into())? else { return Ok(None) };
        Ok(Some(RowSource { map: rows.map()?, factor: 1.0, source: Source::GeoTiff(rows) }))
    }

    /// As [`HeightMap::with_spacing_m`], before the rows are read.
    ///
    /// # Errors
    /// A distance that is not finite and positive.
    pub fn with_spacing_m(self, spacing_m: DVec2) -> Result<Self, Error> {
        Ok(RowSource { map: self.map.with_spacing_m(spacing_m)?, ..self })
    }

    /// As [`HeightMap::with_exaggeration`], before the rows are read; not of a map that is held.
    ///
    /// # Errors
    /// A factor that is not finite and positive, or one that makes a height infinite.
    pub fn with_exaggeration(self, factor: f32) -> Result<Self, Error> {
        Ok(RowSource { map: self.map.with_exaggeration(factor)?, factor: self.factor * factor, ..self })
    }

    /// The map; its range and slope are not known yet.
    pub fn map(&self) -> &HeightMap {
        &self.map
    }

    /// Hands all rows to `take`, some at a time, while that says true, and gives the map without its samples; none where `take`
    /// said false. `name` is for whoever waits.
    ///
    /// # Errors
    /// [`Error::Interrupted`], and heights that are not finite.
    pub fn read(self, name: &Path, take: &mut dyn FnMut(Rows<'_>) -> bool) -> Result<Option<HeightMap>, Error> {
        let watch = Conditions::current().watch;
        let (width, height) = (self.map.width() as usize, self.map.height() as usize);
        let sample_bytes = if matches!(self.map.samples(), Samples::Float(_)) { 4 } else { 2 };
        let size_bytes = (width * height * sample_bytes) as u64;
        let mut meter = Meter::new(&self.map);
        let mut done_bytes = 0;
        let mut see = |rows: Rows<'_>| {
            meter.see(rows);
            let samples = match rows {
                Rows::Steps(values) => values.len(),
                Rows::Float(values) => values.len(),
            };
            done_bytes += (samples * sample_bytes) as u64;
            (watch.progress)(done_bytes, size_bytes);
            if watch.interrupted.load(Ordering::Relaxed) {
                return Err(Error::Interrupted { path: PathBuf::from(name) });
            }
            Ok(take(rows))
        };
        let goes_on = match &self.source {
            Source::Map(map) => match map.samples() {
                Samples::Steps { values, .. } => each(values, width, &mut |rows| see(Rows::Steps(rows)))?,
                Samples::Float(values) => each(values, width, &mut |rows| see(Rows::Float(rows)))?,
            },
            Source::Volcano(volcano) => {
                let mut block = vec![0_u16; TOGETHER * width];
                let mut goes_on = true;
                let mut first_row = 0;
                while goes_on && first_row < height {
                    let rows = &mut block[..TOGETHER.min(height - first_row) * width];
                    volcano.fill(first_row as u32, rows)?;
                    goes_on = see(Rows::Steps(rows))?;
                    first_row += TOGETHER;
                }
                goes_on
            }
            Source::GeoTiff(picture) => picture.read(self.factor, &mut see)?,
        };
        if !goes_on {
            return Ok(None);
        }
        match self.source {
            // Its range leaves out holes.
            Source::Map(_) => Ok(Some(self.map)),
            Source::Volcano(_) | Source::GeoTiff(_) => {
                self.map.without_samples(meter.range_m(), meter.slope.slope()).map(Some)
            }
        }
    }
}

/// Some rows at a time, while `take` says true.
fn each<T>(values: &[T], width: usize, take: &mut dyn FnMut(&[T]) -> Result<bool, Error>) -> Result<bool, Error> {
    for rows in values.chunks(TOGETHER * width) {
        if !take(rows)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Range and slope of rows so far.
struct Meter {
    width: usize,
    /// Height of the value 0 and of a step, metres.
    origin_m: f32,
    step_m: f32,
    lowest: f32,
    highest: f32,
    slope: SlopeMeter,
    next_row: u32,
    /// Heights of the last row, where it counts and its next is not there yet.
    last: Vec<f32>,
}

impl Meter {
    fn new(map: &HeightMap) -> Self {
        let (origin_m, step_m) = match map.samples() {
            Samples::Steps { origin_m, step_m, .. } => (*origin_m, *step_m),
            Samples::Float(_) => (0.0, 1.0),
        };
        Meter {
            width: map.width() as usize,
            origin_m,
            step_m,
            lowest: f32::INFINITY,
            highest: f32::NEG_INFINITY,
            slope: SlopeMeter::new((map.width(), map.height()), map.spacing_m()),
            next_row: 0,
            last: Vec::new(),
        }
    }

    fn see(&mut self, rows: Rows<'_>) {
        match rows {
            Rows::Steps(values) => self.see_values(values),
            Rows::Float(values) => self.see_values(values),
        }
    }

    fn see_values<T: Copy + Into<f32>>(&mut self, values: &[T]) {
        let (origin_m, step_m) = (self.origin_m, self.step_m);
        let height_m = |value: T| {
            let value: f32 = value.into();
            origin_m + step_m * value
        };
        for row in values.chunks_exact(self.width) {
            for &value in row {
                let value: f32 = value.into();
                (self.lowest, self.highest) = (self.lowest.min(value), self.highest.max(value));
            }
            if !self.last.is_empty() {
                let last = std::mem::take(&mut self.last);
                self.slope.take(&|column| last[column as usize], &|column| height_m(row[column as usize]));
            }
            if self.slope.takes(self.next_row) {
                self.last = row.iter().map(|&value| height_m(value)).collect();
            }
            self.next_row += 1;
        }
    }

    fn range_m(&self) -> (f32, f32) {
        (self.origin_m + self.step_m * self.lowest, self.origin_m + self.step_m * self.highest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::height_map::volcano;

    /// All samples, and what is known when the last has come.
    fn read(source: RowSource) -> (Vec<f32>, HeightMap) {
        let mut values = Vec::new();
        let map = source.read(Path::new("map"), &mut |rows| {
            match rows {
                Rows::Steps(steps) => values.extend(steps.iter().map(|&step| f32::from(step))),
                Rows::Float(heights) => values.extend_from_slice(heights),
            }
            true
        });
        (values, map.unwrap().unwrap())
    }

    #[test]
    fn rows_of_the_volcano_are_those_of_the_whole_one() {
        for side in [2, 128, 300, 1_025] {
            let whole = volcano(side, 3).unwrap().with_spacing_m(DVec2::new(7.0, 11.0)).unwrap();
            let (values, map) = read(RowSource::volcano(side, 3).unwrap().with_spacing_m(whole.spacing_m()).unwrap());
            let Samples::Steps { values: expected, .. } = whole.samples() else { panic!("steps") };
            assert!(values.iter().zip(expected).all(|(value, step)| *value == f32::from(*step)), "{side}");
            assert_eq!(values.len(), expected.len());
            assert_eq!(map, whole.clone().without_samples(whole.range_m(), whole.slope()).unwrap());
        }
        assert!(RowSource::volcano(1, 3).is_err());
    }

    #[test]
    fn a_map_that_is_held_is_read_whole_or_as_far_as_wanted() {
        let heights: Vec<f32> = (0..300 * 3).map(|index| (index % 17) as f32).collect();
        let map = HeightMap::new(3, 300, Samples::Float(heights.clone())).unwrap();
        let (values, bare) = read(RowSource::of(map.clone()).unwrap());
        assert_eq!((values, bare.range_m(), bare.slope()), (heights, (0.0, 16.0), map.slope()));
        let mut blocks = 0;
        let ended = RowSource::of(map).unwrap().read(Path::new("map"), &mut |_| {
            blocks += 1;
            blocks < 2
        });
        assert_eq!((ended.unwrap(), blocks), (None, 2));
    }
}

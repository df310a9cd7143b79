use super::map::check_size;
use super::void_samples::Watch;
use super::{Coordinates, Geographic, HeightMap, Samples, voids};
use crate::scene::Error;
use crate::scene::error::{Fault, Place};
use glam::DVec2;

/// Output of a reader: the samples as the source holds them, row by row from the north-west.
pub(super) struct Grid<T> {
    /// Samples in a row.
    pub(super) width: u32,
    /// Number of rows.
    pub(super) height: u32,
    /// Heights as the source holds them, in its own unit; rows from north to south.
    pub(super) values: Vec<T>,
    /// True when all values that are not void are whole numbers.
    pub(super) integral: bool,
    /// The value of a sample without a height.
    pub(super) no_data: Option<f64>,
    /// Spacing and coordinates, as far as the source has them.
    pub(super) placement: Placement,
}

/// Spacing of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Placement {
    /// The source does not say: 1 m.
    Unknown,
    /// Metres between columns and rows, and the coordinates that the source has.
    Metres(DVec2, Option<Coordinates>),
    Degrees(Geographic),
}

/// The widest range that whole metres in 16 bits have.
const STEPS: f64 = u16::MAX as f64;
/// Whole numbers up to here are exact in 32-bit floating point.
const EXACT: f64 = 16_777_216.0;

impl<T: Copy + Into<f64>> Grid<T> {
    /// The map, with its voids filled. Whole numbers that 16-bit steps can hold stay exact.
    pub(super) fn into_map(self) -> Result<HeightMap, Fault> {
        let whole = |reason: String| Fault::new(Place::Whole, reason);
        check_size(self.width.into(), self.height.into()).map_err(whole)?;
        let (width, height) = (self.width as usize, self.height as usize);
        if self.values.len() != width * height {
            return Err(whole(format!("{} samples for {width} x {height}", self.values.len())));
        }
        let no_data = self.no_data;
        let mut void_count = 0_usize;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        let mut watch = Watch::new(no_data);
        for (index, value) in self.values.iter().enumerate() {
            let value = (*value).into();
            if is_void(value, no_data) {
                void_count += 1;
            } else if (value as f32).is_finite() {
                (low, high) = (low.min(value), high.max(value));
                watch.see(value);
            } else {
                return Err(not_finite(index / width, index % width, value));
            }
        }
        if void_count == self.values.len() {
            return Err(whole("all its samples are void; a map needs at least one height".to_owned()));
        }
        let mut void_places = Vec::with_capacity(void_count);
        // A map has at most 2^32 samples.
        let indices = self.values.iter().enumerate().filter(|(_, value)| is_void((**value).into(), no_data));
        void_places.extend(indices.map(|(index, _)| index as u32));
        let samples = if self.integral && fits_steps(low, high) {
            // The void's own value may lie anywhere; the conversion saturates.
            let values = self.values.into_iter().map(|value| (value.into() - low) as u16).collect();
            Samples::Steps { values: voids::fill_steps(values, width, &void_places), origin_m: low as f32, step_m: 1.0 }
        } else {
            let heights = self.values.into_iter().map(|value| value.into() as f32).collect();
            Samples::Float(voids::fill(heights, width, &void_places))
        };
        let map = HeightMap::new(self.width, self.height, samples).and_then(|map| self.placement.place(map));
        let map = map.map_err(|error| Fault::foreign(Place::Whole, &error))?;
        Ok(map.with_void_samples(&void_places).with_suspect(watch.suspect()))
    }
}

impl Placement {
    /// The map at its place.
    pub(super) fn place(self, map: HeightMap) -> Result<HeightMap, Error> {
        match self {
            Placement::Unknown => Ok(map),
            Placement::Metres(spacing_m, coordinates) => map.with_coordinates(coordinates).with_spacing_m(spacing_m),
            Placement::Degrees(place) => {
                let spacing_m = place.spacing_m(map.height());
                map.with_geographic(place).with_spacing_m(spacing_m)
            }
        }
    }
}

/// True where whole numbers between these are 16-bit steps of 1 m.
pub(super) fn fits_steps(low: f64, high: f64) -> bool {
    high - low <= STEPS && low.abs() <= EXACT && high.abs() <= EXACT
}

/// The fault of a sample that is neither void nor a height.
pub(super) fn not_finite(row: usize, column: usize, value: f64) -> Fault {
    let place = format!("row {row}, column {column}");
    Fault::new(Place::Part(place), format!("its height is {value}, not a finite number"))
}

/// True when a value is the one that stands for no height.
///
/// Headers often round the lowest 32-bit number (-3.4e38), so huge values need to agree roughly only.
pub(super) fn is_void(value: f64, no_data: Option<f64>) -> bool {
    let Some(no_data) = no_data else { return false };
    let huge = no_data.abs() > 1e30;
    value == no_data
        || value == f64::from(no_data as f32)
        || (value.is_nan() && no_data.is_nan())
        || (huge && (value / no_data - 1.0).abs() < 2e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map<T: Copy + Into<f64>>(values: &[T], integral: bool, no_data: Option<f64>) -> Result<HeightMap, Fault> {
        let values = values.to_vec();
        Grid { width: 2, height: 2, values, integral, no_data, placement: Placement::Unknown }.into_map()
    }

    #[test]
    fn all_of_16_bits_is_exact() {
        let signed = [i16::MIN, i16::MAX, 0, -1];
        let map_signed = map(&signed, true, None).unwrap();
        assert!(matches!(map_signed.samples(), Samples::Steps { .. }));
        let unsigned = [0, u16::MAX, 1, 32_768];
        let map_unsigned = map(&unsigned, true, None).unwrap();
        for (index, (column, row)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            assert_eq!(map_signed.height_m(column, row), f32::from(signed[index]));
            assert_eq!(map_unsigned.height_m(column, row), f32::from(unsigned[index]));
        }
    }

    #[test]
    fn whole_numbers_too_wide_or_too_far_for_steps_are_float() {
        for values in [[0, 65_536, 1, 2], [1 << 24, (1 << 24) + 1, 1 << 24, 1 << 24]] {
            assert!(matches!(map::<i32>(&values, true, None).unwrap().samples(), Samples::Float(_)), "{values:?}");
        }
        let far = map::<i32>(&[-9_000, 56_535, 0, 0], true, None).unwrap();
        assert!(matches!(far.samples(), Samples::Steps { origin_m: -9_000.0, .. }));
    }

    #[test]
    fn the_no_data_value_may_be_rounded_or_nan() {
        let lowest = f32::MIN;
        for (void, no_data) in [
            (lowest, f64::from(f32::MIN)),
            (lowest, -3.402_823e38),
            (lowest, -3.4e38),
            (0.1, 0.1),
            (f32::NAN, f64::NAN),
            (f32::NEG_INFINITY, f64::NEG_INFINITY),
        ] {
            let result = map(&[1.0, void, 1.0, 1.0], false, Some(no_data));
            assert_eq!(result.map(|map| (map.voids(), map.range_m())), Ok((1, (1.0, 1.0))), "{void} {no_data}");
        }
        assert_eq!(map(&[1.0, -9_998.999, 1.0, 1.0], false, Some(-9_999.0)).unwrap().voids(), 0);
    }

    #[test]
    fn heights_that_are_no_number_and_maps_without_heights_are_refused() {
        for (value, shown) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-1e300, "-1")] {
            let fault = map(&[0.0, 1.0, value, 3.0], false, Some(-9_999.0)).unwrap_err().to_string();
            assert!(fault.starts_with(&format!("row 1, column 0: its height is {shown}")), "{fault}");
        }
        assert!(map(&[-1_i16; 4], true, Some(-1.0)).unwrap_err().to_string().contains("all its samples are void"));
    }
}

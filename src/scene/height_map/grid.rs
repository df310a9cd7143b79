use super::map::check_size;
use super::void_samples::Watch;
use super::{Coordinates, Geographic, HeightMap, Samples, shown, voids};
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
            } else if is_height(value) {
                (low, high) = (low.min(value), high.max(value));
                watch.see(value);
            } else {
                return Err(no_height(index / width, index % width, value));
            }
        }
        if void_count == self.values.len() {
            return Err(all_void());
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
    /// Passes where samples of a map of so many rows lie neither too near nor too far apart; `field` of the file says it.
    pub(super) fn check(&self, rows: u32, field: &str) -> Result<(), Fault> {
        let Some(spacing_m) = self.spacing_m(rows) else { return Ok(()) };
        let (least_m, most_m) = HeightMap::SPACING_M.into_inner();
        let most_m = if matches!(self, Placement::Degrees(_)) { HeightMap::MOST_SPACING_ON_EARTH_M } else { most_m };
        if spacing_m.to_array().iter().all(|metres| (least_m..=most_m).contains(metres)) {
            return Ok(());
        }
        let [across, along] = spacing_m.to_array().map(shown);
        let reason =
            format!("it makes samples lie {across} x {along} m apart; they have to lie {least_m} to {most_m} m apart");
        Err(Fault::new(Place::Part(field.to_owned()), reason))
    }

    /// Metres between columns and rows of a map of so many rows; none where the source does not say.
    pub(super) fn spacing_m(&self, rows: u32) -> Option<DVec2> {
        match self {
            Placement::Unknown => None,
            Placement::Metres(spacing_m, _) => Some(*spacing_m),
            Placement::Degrees(place) => Some(place.spacing_m(rows)),
        }
    }

    /// The map at its place.
    pub(super) fn place(self, map: HeightMap) -> Result<HeightMap, Error> {
        let Some(spacing_m) = self.spacing_m(map.height()) else { return Ok(map) };
        let placed = match self {
            Placement::Unknown => map,
            Placement::Metres(_, coordinates) => map.with_coordinates(coordinates),
            Placement::Degrees(place) => map.with_geographic(place),
        };
        placed.with_spacing_m(spacing_m)
    }
}

/// True where whole heights between these are 16-bit steps of 1 m; all of them are exact in 32-bit floating point.
pub(super) fn fits_steps(low: f64, high: f64) -> bool {
    high - low <= STEPS
}

/// True for a number that can be a height in metres.
pub(super) fn is_height(value: f64) -> bool {
    value.abs() <= HeightMap::MOST_HEIGHT_M
}

/// The fault of a sample that is neither void nor a height.
pub(super) fn no_height(row: usize, column: usize, value: f64) -> Fault {
    let place = Place::Part(format!("row {row}, column {column}"));
    let number = shown(value);
    if !value.is_finite() {
        return Fault::new(place, format!("its height is {number}, not a finite number"));
    }
    let most_m = HeightMap::MOST_HEIGHT_M;
    let reason = format!(
        "its height is {number} m, and heights are -{most_m} to {most_m} m; if it stands for none, declare it, as by \
         gdal_translate -a_nodata {number}"
    );
    Fault::new(place, reason)
}

/// The fault of samples of which none is a height.
pub(super) fn all_void() -> Fault {
    Fault::new(Place::Whole, "all its samples are void; a map needs at least one height")
}

/// True for a height of a file that is `void` as the file, or as 32 bits, have it.
pub(super) fn is_same(height: f64, void: f64) -> bool {
    height == void || height as f32 == void as f32
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
    fn whole_numbers_too_wide_for_steps_are_float() {
        assert!(matches!(map::<i32>(&[0, 65_536, 1, 2], true, None).unwrap().samples(), Samples::Float(_)));
        for low in [-9_000, -1_000_000, 934_465] {
            let far = map::<i32>(&[low, low + 65_535, low + 1, low], true, None).unwrap();
            assert!(matches!(far.samples(), Samples::Steps { origin_m, .. } if *origin_m == low as f32));
            assert_eq!(far.range_m(), (low as f32, (low + 65_535) as f32));
        }
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
        for (value, shown) in [
            (f64::NAN, "NaN, not a finite number"),
            (f64::INFINITY, "inf, not a finite number"),
            (-1e300, "-1e300 m, and heights are -1000000 to 1000000 m; if"),
            (1_000_000.5, "1000000.5 m, and heights are"),
        ] {
            let fault = map(&[0.0, 1.0, value, 3.0], false, Some(-9_999.0)).unwrap_err().to_string();
            assert!(fault.starts_with(&format!("row 1, column 0: its height is {shown}")), "{fault}");
            assert!(fault.len() < 200, "{fault}");
        }
        let farthest = map(&[-1e6, 1e6, 0.5, 3.0], false, None).unwrap();
        assert_eq!(farthest.range_m(), (-1e6, 1e6));
        assert!(map(&[-1_i16; 4], true, Some(-1.0)).unwrap_err().to_string().contains("all its samples are void"));
    }
}

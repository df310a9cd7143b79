//! A height map as the shape of the water, in place of waves.

use std::sync::Arc;

use glam::DVec2;

use crate::scene::HeightMap;

/// A still surface. Its middle lies over the middle of the receivers, its columns run along +X and its rows along +Z,
/// at the map's own spacing; heights are metres about the water's level.
///
/// It is the bicubic spline through the samples. A caustic's brightness follows the curvature of the water: this
/// surface has a continuous one, while Catmull-Rom's jumps from cell to cell, and would show the map's cells in the
/// light. Beyond the border it levels off within two samples.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterMap {
    name: String,
    heights: Arc<HeightMap>,
    /// Of the B-spline, metres, row by row. The surface lies between the lowest and the highest near a place, and is no
    /// steeper than the steps between them.
    coefficients: Arc<[f32]>,
}

impl WaterMap {
    /// `name` is what the record calls it.
    pub fn new(name: impl Into<String>, heights: Arc<HeightMap>) -> Self {
        let mut values = samples(&heights);
        let (width, count) = (heights.width() as usize, values.len());
        let mut line = Vec::new();
        for row in 0..heights.height() as usize {
            interpolate(&mut values, row * width..(row + 1) * width, &mut line);
        }
        for column in 0..width {
            interpolate(&mut values, (column..count).step_by(width), &mut line);
        }
        WaterMap { name: name.into(), heights, coefficients: values.into() }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn heights(&self) -> &HeightMap {
        &self.heights
    }

    /// Extent along x and z, metres.
    pub fn extent_m(&self) -> DVec2 {
        let cells = DVec2::new(f64::from(self.heights.width() - 1), f64::from(self.heights.height() - 1));
        self.heights.spacing_m() * cells
    }

    /// Metres, row by row: what the surface is the cubic B-spline of.
    pub(super) fn coefficients(&self) -> &[f32] {
        &self.coefficients
    }

    /// Bounds of the surface about the water's level, metres.
    pub fn range_m(&self) -> (f32, f32) {
        self.coefficients.iter().fold((f32::MAX, f32::MIN), |(low, high), &c| (low.min(c), high.max(c)))
    }

    /// Root of the mean square of the slopes between neighbouring coefficients.
    pub fn mean_slope(&self) -> f64 {
        let width = self.heights.width() as usize;
        let mean_square = |pairs: &mut dyn Iterator<Item = (&f32, &f32)>| {
            let (sum, count) =
                pairs.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + f64::from(a - b).powi(2), count + 1.0));
            sum / f64::max(count, 1.0)
        };
        let rows = self.coefficients.chunks_exact(width);
        let along_x = mean_square(&mut rows.flat_map(|row| row.iter().zip(&row[1..])));
        let along_z = mean_square(&mut self.coefficients.iter().zip(&self.coefficients[width..]));
        (DVec2::new(along_x, along_z) / self.heights.spacing_m().powf(2.0)).element_sum().sqrt()
    }

    /// Root of the mean square of the Laplacian at the samples, per metre, along each axis where they have neighbours on both sides:
    /// how the surface levels off at the border does not count.
    pub fn mean_curvature(&self) -> f64 {
        let heights = &self.heights;
        let (width, height) = (heights.width(), heights.height());
        let at = |column: u32, row: u32| f64::from(heights.height_m(column, row));
        let squares = heights.spacing_m().powf(2.0);
        let laplacian = |column: u32, row: u32| {
            let here = 2.0 * at(column, row);
            let is_between = |place: u32, count: u32| place > 0 && place + 1 < count;
            let along_x = match is_between(column, width) {
                true => at(column - 1, row) - here + at(column + 1, row),
                false => 0.0,
            };
            let along_z = match is_between(row, height) {
                true => at(column, row - 1) - here + at(column, row + 1),
                false => 0.0,
            };
            (DVec2::new(along_x, along_z) / squares).element_sum()
        };
        let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let sum: f64 = places.map(|(column, row)| laplacian(column, row).powi(2)).sum();
        (sum / (f64::from(width) * f64::from(height))).sqrt()
    }

    /// No slope is steeper.
    pub fn steepest_slope(&self) -> f32 {
        let width = self.heights.width() as usize;
        let steepest = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let along_x = self.coefficients.chunks_exact(width).map(|row| steepest(row, &row[1..])).fold(0.0, f32::max);
        let along_z = steepest(&self.coefficients, &self.coefficients[width..]);
        (DVec2::new(f64::from(along_x), f64::from(along_z)) / self.heights.spacing_m()).length() as f32
    }
}

/// Row by row, metres.
fn samples(map: &HeightMap) -> Vec<f32> {
    let places = (0..map.height()).flat_map(|row| (0..map.width()).map(move |column| (column, row)));
    places.map(|(column, row)| map.height_m(column, row)).collect()
}

/// Replaces the samples at `places` by the coefficients c of the B-spline through them: (c[i-1] + 4 c[i] + c[i+1]) / 6
/// is the sample i, and c goes on beyond both ends as at the ends. Gauss's elimination of a system with three
/// diagonals.
fn interpolate(values: &mut [f32], places: impl Iterator<Item = usize> + Clone, line: &mut Vec<(usize, f64, f64)>) {
    let last = places.clone().last();
    line.clear();
    let (mut factor, mut value) = (0.0, 0.0);
    for (i, place) in places.enumerate() {
        let ends = f64::from(u8::from(i == 0) + u8::from(Some(place) == last));
        let pivot = 4.0 + ends - factor;
        value = (6.0 * f64::from(values[place]) - value) / pivot;
        factor = 1.0 / pivot;
        line.push((place, factor, value));
    }
    let mut next = 0.0;
    for &(place, factor, value) in line.iter().rev() {
        // Nothing follows the last one, whose neighbour is itself.
        next = if Some(place) == last { value } else { value - factor * next };
        values[place] = next as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::HeightField;
    use crate::scene::Samples;
    use crate::scene::random::Random;

    const SPACING_M: DVec2 = DVec2::new(0.5, 0.25);

    /// Uncorrelated samples, 9 x 7: nothing swings more between them.
    fn noise() -> (WaterMap, HeightField) {
        let mut random = Random::new(3);
        let heights: Vec<f32> = (0..9 * 7).map(|_| random.unit() - 0.5).collect();
        let exact: Vec<f64> = heights.iter().copied().map(f64::from).collect();
        let map = HeightMap::new(9, 7, Samples::Float(heights)).unwrap().with_spacing_m(SPACING_M).unwrap();
        (WaterMap::new("noise", Arc::new(map)), HeightField::through(&exact, 9, SPACING_M, DVec2::ZERO))
    }

    #[test]
    fn the_coefficients_are_those_of_the_surface_through_the_samples() {
        let (water, field) = noise();
        for (found, expected) in water.coefficients().iter().zip(&field.coefficients) {
            assert!((f64::from(*found) - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn the_surface_stays_within_its_bounds() {
        let (water, field) = noise();
        assert_eq!(water.extent_m(), DVec2::new(4.0, 1.5));
        let (low, high) = water.range_m();
        let (mut highest, mut steepest) = (f64::MIN, 0.0f64);
        for (i, j) in (0..160).flat_map(|i| (0..120).map(move |j| (i, j))) {
            let vertex = field.vertex(0.0, f64::from(i - 80) * 0.03, f64::from(j - 60) * 0.015);
            highest = highest.max(vertex.position.y);
            assert!(vertex.position.y >= f64::from(low) && vertex.position.y <= f64::from(high));
            steepest = steepest.max(vertex.normal.x.hypot(vertex.normal.z) / vertex.normal.y);
        }
        // The bounds are met to a factor, not idle; the surface swings beyond its samples.
        assert!(highest > f64::from(water.heights().range_m().1), "{highest}");
        let bound = f64::from(water.steepest_slope());
        assert!(steepest <= bound && steepest > 0.3 * bound, "{steepest} of {bound}");
    }

    #[test]
    fn a_ramp_is_as_steep_as_it_is() {
        let rising = || (0..25 * 2).map(|i| 0.1 * (i % 25) as f32).collect::<Vec<f32>>();
        let map = HeightMap::new(25, 2, Samples::Float(rising())).unwrap();
        let slope = WaterMap::new("ramp", Arc::new(map)).steepest_slope();
        // A little more where the surface levels off at the border.
        assert!((0.1..0.13).contains(&slope), "{slope}");
        let mean =
            WaterMap::new("ramp", Arc::new(HeightMap::new(25, 2, Samples::Float(rising())).unwrap())).mean_slope();
        assert!((mean - 0.1).abs() < 0.005, "{mean}");
    }
}

//! Values between the samples of a grid, in double precision: the sum of all samples around a point, each times its
//! weights along the three axes.

use glam::{DMat3, DVec3};

use crate::papers::gas::grid::{Filter, Grid};

/// Beyond the outermost samples the grid goes on so far, in samples: half a cell, and what the shaders add for rounding.
const BORDER: f64 = 0.501;

/// The value at a point, metres from the grid's middle; 0 outside. Samples beyond the outermost ones are like them.
pub fn value(grid: &Grid, filter: Filter, from_middle: DVec3) -> f64 {
    mean(grid, filter, from_middle, |sample| f64::from(grid.samples[sample]))
}

/// The light of the temperatures at a point, likewise, linearly.
pub fn glow(grid: &Grid, from_middle: DVec3) -> DVec3 {
    let channel = |channel: usize| {
        let of_sample = |sample: usize| grid.glow.get(sample).map_or(0.0, |light| f64::from(light[channel]));
        mean(grid, Filter::Trilinear, from_middle, of_sample)
    };
    DVec3::new(channel(0), channel(1), channel(2))
}

/// The mean of what is known of each sample.
fn mean(grid: &Grid, filter: Filter, from_middle: DVec3, of_sample: impl Fn(usize) -> f64) -> f64 {
    // Cramer's rule: the point as a sum of steps.
    let [x, y, z] = grid.steps_m;
    let whole = DMat3::from_cols(x, y, z).determinant();
    let part = |columns: [DVec3; 3]| DMat3::from_cols(columns[0], columns[1], columns[2]).determinant() / whole;
    let steps = [part([from_middle, y, z]), part([x, from_middle, z]), part([x, y, from_middle])];
    let last = grid.size.map(|count| f64::from(count) - 1.0);
    let at: [f64; 3] = std::array::from_fn(|axis| last[axis] / 2.0 + steps[axis]);
    if (0..3).any(|axis| at[axis] < -BORDER || at[axis] > last[axis] + BORDER) {
        return 0.0;
    }
    // Indices of samples, real or beyond the border, with weights.
    let along = |axis: usize| {
        let middle = at[axis].floor() as i64;
        let reach = (middle - 2)..=(middle + 3);
        reach.map(move |index| (index.clamp(0, last[axis] as i64) as usize, weight(filter, at[axis] - index as f64)))
    };
    let [columns, rows, _] = grid.size.map(|count| count as usize);
    let mut sum = 0.0;
    for (layer, of_layer) in along(2) {
        for (row, of_row) in along(1) {
            for (column, of_column) in along(0) {
                sum += of_sample((layer * rows + row) * columns + column) * of_layer * of_row * of_column;
            }
        }
    }
    sum
}

/// The weight of a sample at that distance, in samples.
fn weight(filter: Filter, distance: f64) -> f64 {
    let d = distance.abs();
    match filter {
        Filter::Trilinear => (1.0 - d).max(0.0),
        // R. Keys's convolution with a = -1/2 (1981), which is the cubic of Catmull and Rom.
        Filter::Tricubic if d < 1.0 => 1.5 * d.powi(3) - 2.5 * d.powi(2) + 1.0,
        Filter::Tricubic if d < 2.0 => -0.5 * d.powi(3) + 2.5 * d.powi(2) - 4.0 * d + 2.0,
        Filter::Tricubic => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A skewed grid of a function of its indices.
    fn grid(of: impl Fn(DVec3) -> f64) -> Grid {
        let size = [7, 6, 5];
        let index = |i: u32| DVec3::new(f64::from(i % 7), f64::from(i / 7 % 6), f64::from(i / 42));
        let samples = (0..7 * 6 * 5).map(|i| of(index(i)) as f32).collect();
        let steps_m = [DVec3::new(0.1, 0.02, 0.0), DVec3::new(0.0, -0.2, 0.01), DVec3::new(0.03, 0.0, 0.3)];
        Grid { size, steps_m, samples, glow: Vec::new() }
    }

    fn point(grid: &Grid, index: DVec3) -> DVec3 {
        let from_middle = index - DVec3::new(3.0, 2.5, 2.0);
        (0..3).map(|axis| grid.steps_m[axis] * from_middle[axis]).sum()
    }

    #[test]
    fn samples_and_polynomials_are_kept() {
        let linear = |p: DVec3| 0.5 * p.x - 0.25 * p.y + p.z + 2.0;
        let square = |p: DVec3| linear(p) + 0.25 * p.x * p.x - 0.5 * p.y * p.z;
        let inside = [DVec3::new(2.25, 2.5, 1.75), DVec3::new(3.0, 1.0, 2.0), DVec3::new(4.75, 3.5, 2.0)];
        for at in inside {
            let grid = grid(linear);
            assert!((value(&grid, Filter::Trilinear, point(&grid, at)) - linear(at)).abs() < 1e-6);
        }
        for at in inside {
            let grid = grid(square);
            assert!((value(&grid, Filter::Tricubic, point(&grid, at)) - square(at)).abs() < 1e-6);
        }
        let grid = grid(square);
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            for at in [DVec3::ZERO, DVec3::new(6.0, 5.0, 4.0), DVec3::new(3.0, 0.0, 4.0)] {
                assert!((value(&grid, filter, point(&grid, at)) - square(at)).abs() < 1e-6);
            }
            // The cell of a corner's sample, and what is beyond it.
            let corner = point(&grid, DVec3::splat(-0.5));
            assert!(value(&grid, filter, corner) != 0.0 && value(&grid, filter, corner * 1.01) == 0.0);
        }
        assert!((value(&grid, Filter::Trilinear, point(&grid, DVec3::splat(-0.5))) - square(DVec3::ZERO)).abs() < 1e-6);
    }
}

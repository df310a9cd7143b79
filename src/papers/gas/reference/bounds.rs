//! Extinctions that paths are drawn by: greater than the gas's own nearly everywhere.

use glam::DVec3;
use rayon::prelude::*;

use crate::papers::gas::model::Volume;

/// Cells along each axis of the box around all volumes.
const CELLS: u32 = 16;
/// Samples along each axis of a cell, the first and the last on its faces.
const SAMPLES: u32 = 4;
/// A bound over the greatest sample.
const ABOVE: f64 = 1.3;
/// A bound over the greatest of all, at least: gas may lie between samples.
const LEAST: f64 = 0.02;
/// Least path into the next cell, of the box's longest side.
const NUDGE: f64 = 1e-9;

/// Bounds of the extinction in the cells of a box.
#[derive(Default)]
pub(super) struct Bounds {
    low: DVec3,
    high: DVec3,
    /// x fastest, per metre.
    cells: Vec<f64>,
}

impl Bounds {
    /// By an extinction at points of the world, which is 0 outside of all volumes.
    pub fn new(volumes: &[Volume], extinction: impl Fn(DVec3) -> f64 + Sync) -> Self {
        let of_volume = |volume: &Volume| {
            let (center, half) = (volume.center.as_dvec3(), volume.half_extent_m.as_dvec3());
            (center - half, center + half)
        };
        let around = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let Some((low, high)) = volumes.iter().map(of_volume).reduce(around) else { return Bounds::default() };
        let greatest = |cell: u32| {
            let corner = index_of(cell, CELLS);
            let sample = |sample: u32| {
                let at = corner + index_of(sample, SAMPLES) / f64::from(SAMPLES - 1);
                extinction(low + (high - low) * at / f64::from(CELLS))
            };
            (0..SAMPLES.pow(3)).map(sample).fold(0.0, f64::max)
        };
        let greatest: Vec<f64> = (0..CELLS.pow(3)).into_par_iter().map(greatest).collect();
        let least = LEAST * greatest.iter().copied().fold(0.0, f64::max);
        let cells = greatest.into_iter().map(|found| (ABOVE * found).max(least)).collect();
        Bounds { low, high, cells }
    }

    /// The path from a point through the box, as far as `distance_m`.
    pub fn path(&self, from: DVec3, direction: DVec3, distance_m: f64) -> FreePath<'_> {
        let (a, b) = ((self.low - from) / direction, (self.high - from) / direction);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        FreePath { bounds: self, from, direction, at: enter.max(0.0), end: leave.min(distance_m) }
    }

    /// The bound in the cell of a point, and the path until a ray leaves it.
    fn cell(&self, point: DVec3, direction: DVec3) -> (f64, f64) {
        let size = (self.high - self.low) / f64::from(CELLS);
        let at = (point - self.low) / size;
        let cell = at.floor().clamp(DVec3::ZERO, DVec3::splat(f64::from(CELLS - 1)));
        let leave = |axis: usize| {
            let border = if direction[axis] > 0.0 { cell[axis] + 1.0 } else { cell[axis] };
            let is_across = direction[axis] == 0.0;
            if is_across { f64::INFINITY } else { (border - at[axis]) * size[axis] / direction[axis] }
        };
        let leave = (0..3).map(leave).fold(f64::INFINITY, f64::min);
        let [x, y, z] = cell.to_array().map(|index| index as usize);
        let index = (z * CELLS as usize + y) * CELLS as usize + x;
        (self.cells[index], leave.max(NUDGE * (self.high - self.low).max_element()))
    }
}

/// A cell or sample of a cube with `count` along each axis.
fn index_of(number: u32, count: u32) -> DVec3 {
    let along = |number: u32| f64::from(number % count);
    DVec3::new(along(number), along(number / count), along(number / count / count))
}

/// A path that is filled with particles up to the bounds.
pub(super) struct FreePath<'a> {
    bounds: &'a Bounds,
    from: DVec3,
    direction: DVec3,
    at: f64,
    end: f64,
}

impl FreePath<'_> {
    /// The next particle, real or not: its distance and the bound there; nothing where the path ends.
    pub fn particle(&mut self, mut unit: impl FnMut() -> f64) -> Option<(f64, f64)> {
        while self.at < self.end {
            let (bound, leave) = self.bounds.cell(self.from + self.direction * self.at, self.direction);
            let leave = (self.at + leave).min(self.end);
            let free = -(-unit()).ln_1p();
            if free < bound * (leave - self.at) {
                self.at += free / bound;
                return Some((self.at, bound));
            }
            self.at = leave;
        }
        None
    }
}

//! Pass `accumulate-depths` (section 6.3) on the device: each grid point gathers eq. 6.3 over the columns around it.

use std::sync::Arc;

use super::super::accumulate_depths::radius_m;
use super::super::parameters::{Parameters, SurfaceKind};
use super::super::targets::Context;
use super::tiles::{Tile, tiles};
use crate::gpu::{Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct AccumulateConstants {
        spacing_m: [f32; 2],
        columns: [i32; 2],
        first: [i32; 2],
        radius_m: f32,
        each: f32,
        reach: i32,
        first_row: i32,
        last_row: i32,
    }
}

/// Most iterations of a dispatch: lavapipe ends all loops of a shader after 65,535.
const MOST_TAPS: i64 = 60_000;

/// The pass.
pub struct AccumulateDepths {
    pass: Pass,
    grid: [u32; 3],
    bands: Vec<AccumulateConstants>,
}

impl AccumulateDepths {
    /// Adds to `sums` the heights of `columns`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, columns: &Arc<ImageView>, sums: &Arc<ImageView>) -> Result<Self, Error> {
        let pass = Pass::compute("accumulate-depths", "6.3", "lava/accumulate-depths.comp")
            .constants::<AccumulateConstants>()
            .with("columns", columns)
            .with("sums", sums)
            .build(context.shaders)?;
        Ok(AccumulateDepths { pass, grid: context.parameters.density, bands: bands(context.parameters) })
    }

    /// Sums up eq. 6.3 over the columns; `most_work` is that of one submission.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, most_work: f64) -> Result<(), Error> {
        let [columns, _, rows] = self.grid;
        for band in &self.bands {
            let each = band.taps();
            for tile in tiles([columns, rows, 1], each, most_work) {
                frame.reserve_work(&self.pass, tile.work(each), most_work)?;
                frame.compute(&self.pass, |dispatch| {
                    let Tile { first: [x, y, _], count } = tile;
                    let constants = AccumulateConstants { first: [x as i32, y as i32], ..*band };
                    dispatch.constants(&constants).threads(count[0], count[1], 1);
                })?;
            }
        }
        Ok(())
    }
}

impl AccumulateConstants {
    /// Columns that a grid point looks at.
    fn taps(&self) -> f64 {
        f64::from(self.last_row - self.first_row + 1) * f64::from(2 * self.reach + 1)
    }
}

/// The rows around a grid point that the radius of eq. 6.3 reaches, as many at a time as a dispatch may take.
fn bands(parameters: &Parameters) -> Vec<AccumulateConstants> {
    let [columns, _, rows] = parameters.density;
    let spacing_m = [parameters.space_m.x / columns as f32, parameters.space_m.z / rows as f32];
    let radius_m = radius_m(parameters);
    // A little more than the radius, which rounding may pass.
    let reach = |spacing_m: f32, count: u32| ((1.001 * radius_m / spacing_m) as i64).min(i64::from(count) - 1);
    let (across, along) = (reach(spacing_m[0], columns), reach(spacing_m[1], rows));
    let each = (MOST_TAPS / (2 * across + 3)).max(1);
    let band = |first: i64| AccumulateConstants {
        spacing_m,
        columns: [columns as i32, rows as i32],
        first: [0; 2],
        radius_m,
        each: f32::from(u8::from(parameters.surface == SurfaceKind::Mean)),
        reach: across as i32,
        first_row: first as i32,
        last_row: (first + each - 1).min(along) as i32,
    };
    (-along..=along).step_by(each as usize).map(band).collect()
}

/// Dispatches of `accumulate-depths` in a frame.
pub fn dispatches(parameters: &Parameters) -> u64 {
    bands(parameters).len() as u64
}

/// Columns that a grid point looks at.
pub fn taps(parameters: &Parameters) -> f64 {
    bands(parameters).iter().map(AccumulateConstants::taps).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_every_row_once() {
        let default = Parameters::default();
        let wide = Parameters { density: [8192, 1, 8192], radius_m: 1.0, ..default.clone() };
        let crossing = Parameters { surface: SurfaceKind::Crossing, ..default.clone() };
        for (parameters, rows, count) in [(default, 3, 1), (wide, 16_383, 1171), (crossing, 1, 1)] {
            let bands = bands(&parameters);
            assert_eq!(bands.len(), count, "{rows}");
            let mut next = bands[0].first_row;
            for band in &bands {
                assert_eq!(band.first_row, next);
                assert!(i64::from(band.last_row - band.first_row + 1) * i64::from(2 * band.reach + 3) < 65_535);
                next = band.last_row + 1;
            }
            assert_eq!((bands[0].first_row, next - 1), (-(rows - 1) / 2, (rows - 1) / 2));
        }
    }
}

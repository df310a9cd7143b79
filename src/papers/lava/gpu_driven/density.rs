//! Pass `density` (section 6.1), gathered: each column of four grid planes sums eq. 6.2 over the sorted particles around it.

use std::sync::Arc;

use super::super::density::peak;
use super::super::targets::Context;
use super::cells::Cells;
use super::sort::Sort;
use super::tiles::{Tile, tiles};
use crate::gpu::{Error, Frame, Image, ImageView, Pass};
use crate::host_block;

host_block! {
    struct GatherConstants {
        space_m: [f32; 3],
        per_radius: f32,
        grid: [u32; 3],
        piece: u32,
        cells: [u32; 3],
        radius_m: f32,
        first: [u32; 3],
        peak: f32,
    }
}

/// Particles of a stretch in one dispatch: as in `lava/density.comp`.
const PIECE: u32 = 28_672;

/// Dispatches that hold every particle, were they all in one stretch of cells.
pub fn pieces(particles: u32) -> u32 {
    particles.div_ceil(PIECE)
}

/// The pass.
pub struct GatheredDensity {
    pass: Pass,
    constants: GatherConstants,
    clusters: u32,
    pieces: u32,
    /// Particles that an invocation looks at, all pieces together.
    seen: f64,
    /// A layer for each four grid planes, a component for each of them.
    pub density: Arc<ImageView>,
}

impl GatheredDensity {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for a grid beyond the device's.
    pub fn new(context: Context<'_>, cells: &Cells, sort: &Sort) -> Result<Self, Error> {
        let parameters = context.parameters;
        let clusters = parameters.clusters();
        let density = Image::new(context.device(), context.stored_desc("density").layers(clusters))?.view()?;
        let pass = Pass::compute("density", "6.1", "lava/density.comp")
            .constants::<GatherConstants>()
            .with("starts", &sort.starts)
            .with("places_by_cells", &sort.places)
            .with("reached", &sort.reached)
            .with("density", &density)
            .build(context.shaders)?;
        let constants = GatherConstants {
            space_m: parameters.space_m.to_array(),
            // Finite: no place is so near that more would tell them apart.
            per_radius: (1.0 / parameters.radius_m).min(1e18),
            grid: parameters.density,
            piece: 0,
            cells: cells.counts,
            radius_m: parameters.radius_m,
            first: [0; 3],
            peak: peak(parameters.radius_m),
        };
        let (pieces, seen) = (pieces(cells.particles), cells.seen(parameters));
        Ok(GatheredDensity { pass, constants, clusters, pieces, seen, density })
    }

    /// Gathers the densities of the sorted particles; `most_work` is that of one submission.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, most_work: f64) -> Result<(), Error> {
        let [columns, _, rows] = self.constants.grid;
        for piece in 0..self.pieces {
            let each = self.seen_in(piece);
            for tile in tiles([columns, rows, self.clusters], each, most_work) {
                frame.reserve_work(&self.pass, tile.work(each), most_work)?;
                frame.compute(&self.pass, |dispatch| {
                    let Tile { first, count: [x, y, z] } = tile;
                    dispatch.constants(&GatherConstants { piece, first, ..self.constants }).threads(x, y, z);
                })?;
            }
        }
        Ok(())
    }

    /// Particles that an invocation looks at in one piece, where they fill the space evenly.
    fn seen_in(&self, piece: u32) -> f64 {
        let [across, _, along] = self.constants.cells.map(|count| f64::from(count.min(3)));
        let stretch = self.seen / (across * along);
        (stretch - f64::from(piece) * f64::from(PIECE)).clamp(0.0, f64::from(PIECE)) * across * along
    }
}

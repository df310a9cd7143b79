//! Pass `combine-slices` (section 5.2.1): the slices put together, the nearest to the light in front.

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{Context, LIGHT, POSITION};
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct SlicesConstants {
        count: u32,
        top: f32,
        cell_height: f32,
    }
}

/// The pass.
pub struct CombineSlices {
    pass: Pass,
    /// I_c x I_d, linear RGB; alpha is 1 where there is a receiver.
    pub map: Arc<ImageView>,
    /// Heights of the slices that the map shows, metres of box space.
    pub position: Arc<ImageView>,
}

impl CombineSlices {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, illumination_map: &Arc<ImageView>) -> Result<Self, Error> {
        let map = context.map("combined-map", LIGHT)?;
        let position = context.map("position-map", POSITION)?;
        let pass = Pass::graphics("combine-slices", "5.2.1", "common/fullscreen.vert", "caustics/combine-slices.frag")
            .constants::<SlicesConstants>()
            .with("illumination_map", illumination_map)
            .with("nearest", context.nearest)
            .color(&map, Load::Discard, Blend::Replace)
            .color(&position, Load::Discard, Blend::Replace)
            .build(context.shaders)?;
        Ok(CombineSlices { pass, map, position })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        let height = lit.aligned.extent.y;
        let constants = SlicesConstants {
            count: lit.cells.len() as u32,
            top: (height / 2.0) as f32,
            cell_height: (height / lit.cells.len() as f64) as f32,
        };
        frame.graphics(&self.pass, |draw| draw.constants(&constants).vertices(3))
    }
}

//! Pass `multiply` (section 5.2.1): a sample plane's slice, multiplied by the plane's caustics map in the blend state.

use std::sync::Arc;

use super::combine::CombineConstants;
use super::illumination_volumes::IlluminationVolumes;
use super::resources::Context;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};

/// The pass.
pub struct Multiply {
    /// One for each plane.
    passes: Vec<Pass>,
    constants: CombineConstants,
}

impl Multiply {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        caustics: &Arc<ImageView>,
        slices: &[Arc<ImageView>],
    ) -> Result<Self, Error> {
        let first = Pass::graphics("multiply", "5.2.1", "common/fullscreen.vert", "caustics/multiply.frag")
            .constants::<CombineConstants>()
            .with("caustics_map", caustics)
            .with("nearest", context.nearest)
            .color(&slices[0], Load::Keep, Blend::Multiply)
            .build(context.shaders)?;
        let each = slices.iter().map(|slice| first.rebind().color(0, slice, Load::Keep).build(context.shaders));
        Ok(Multiply { passes: each.collect::<Result<_, _>>()?, constants: CombineConstants::new(volumes) })
    }

    /// Multiplies the slice of one plane.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, plane: usize) -> Result<(), Error> {
        frame.graphics(&self.passes[plane], |draw| draw.constants(&self.constants).vertices(3))
    }
}

//! Pass `normal-height` (sections 6.3 and 6.4): heights, and normals by their finite differences.

use std::sync::Arc;

use super::targets::Context;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct NormalConstants {
        space_m: [f32; 2],
        columns: [f32; 2],
        border_m: f32,
    }
}

/// The pass.
pub struct NormalHeight {
    pass: Pass,
    constants: NormalConstants,
    /// Normals in RGB, heights in metres in alpha.
    pub surface: Arc<ImageView>,
}

impl NormalHeight {
    /// A fluid's lies on its bed where there is no lava.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        accumulated_depths: &Arc<ImageView>,
        bed: Option<&Arc<ImageView>>,
    ) -> Result<Self, Error> {
        let parameters = context.parameters;
        let surface = context.grid_target("normal-height")?;
        let shader = if bed.is_some() { "lava/normal-height-sph.frag" } else { "lava/normal-height-free.frag" };
        let pass = Pass::graphics("normal-height", "6.4", "common/fullscreen.vert", shader)
            .constants::<NormalConstants>()
            .with("accumulated_depths", accumulated_depths)
            .whole(&["accumulated_depths"])
            .color(&surface, Load::Discard, Blend::Replace);
        let pass = match bed {
            None => pass,
            Some(bed) => pass.with("bed", bed),
        };
        let pass = pass.build(context.shaders)?;
        let constants = NormalConstants {
            space_m: [parameters.space_m.x, parameters.space_m.z],
            columns: [surface.width() as f32, surface.height() as f32],
            border_m: parameters.border_m,
        };
        Ok(NormalHeight { pass, constants, surface })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.constants(&self.constants).vertices(3))
    }
}

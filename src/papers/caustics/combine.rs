//! Pass `combine` (section 5.2.2): I_c x I_d of eq. 4-19.

use std::sync::Arc;

use super::illumination_volumes::IlluminationVolumes;
use super::resources::Context;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    /// The light's colour, where I_c is combined with I_d.
    pub struct CombineConstants {
        intensity: [f32; 3],
    }
}

impl CombineConstants {
    pub fn new(volumes: &IlluminationVolumes) -> Self {
        CombineConstants { intensity: volumes.intensity.to_array() }
    }
}

/// The pass.
pub struct Combine {
    pass: Pass,
    constants: CombineConstants,
    /// I_c x I_d, linear RGB; alpha is 1 where there is a receiver.
    pub map: Arc<ImageView>,
}

impl Combine {
    /// Draws to `map`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        caustics: &Arc<ImageView>,
        diffuse: &Arc<ImageView>,
        map: Arc<ImageView>,
    ) -> Result<Self, Error> {
        let pass = Pass::graphics("combine", "5.2.2", "common/fullscreen.vert", "caustics/combine.frag")
            .constants::<CombineConstants>()
            .with("caustics_map", caustics)
            .with("diffuse_map", diffuse)
            .whole(&["caustics_map", "diffuse_map"])
            .with("nearest", context.nearest)
            .color(&map, Load::Discard, Blend::Replace)
            .build(context.shaders)?;
        Ok(Combine { pass, constants: CombineConstants::new(volumes), map })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.constants(&self.constants).vertices(3))
    }
}

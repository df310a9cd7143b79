//! Pass `blending` (section 7.2): the colours of the splats near the front, weighted and added up.

use std::sync::Arc;

use super::parameters::Shading;
use super::scene::Scene;
use super::splats::Splats;
use super::targets::{Context, ZERO};
use crate::gpu::{Blend, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct ShadingConstants {
        drift_m: [f32; 2],
        mode: u32,
    }
}

/// The pass.
pub struct Blending {
    pass: Pass,
    shading: Shading,
}

impl Blending {
    /// Adds to `sums` what the depths of `visibility` do not hide.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        scene: &Scene,
        splats: &Splats,
        visibility: &Arc<ImageView>,
        sums: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let pass = scene
            .hot(|shader| splats.pass(scene, "blending", "7.2", shader), "lava/blending")
            .constants::<ShadingConstants>()
            .with("visibility", visibility)
            .with("rock", &scene.rock)
            .with("linear", &scene.linear)
            .with("emission", &scene.emission)
            .color(sums, ZERO, Blend::Add)
            .build(context.shaders)?;
        Ok(Blending { pass, shading: context.parameters.shading })
    }

    /// Draws the splats; the rock has drifted `drift_m` along x.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, splats: &Splats, drift_m: f32) -> Result<(), Error> {
        let constants = ShadingConstants { drift_m: [drift_m, 0.0], mode: self.shading.mode() };
        frame.graphics(&self.pass, |draw| {
            draw.constants(&constants);
            splats.draw(draw);
        })
    }
}

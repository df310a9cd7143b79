//! Pass `blending` (section 7.2): the colours of the splats near the front, weighted and added up.

use std::sync::Arc;

use ash::vk;

use super::parameters::Shading;
use super::rock::Rock;
use super::splats::Splats;
use super::targets::{Context, FLOATS, ZERO};
use super::visibility::Visibility;
use crate::gpu::{Blend, Error, Frame, ImageView, Pass, Sampler};
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
    /// The rock on the device.
    pub(super) rock: Arc<ImageView>,
    /// The sampler of the rock.
    pub(super) linear: Arc<Sampler>,
    /// Weighted colours, sum of weights in alpha.
    pub sums: Arc<ImageView>,
}

impl Blending {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, splats: &Splats, visibility: &Visibility, rock: &Rock) -> Result<Self, Error> {
        let parameters = context.parameters;
        let sums = context.target("accumulated-colors", FLOATS, parameters.width, parameters.height)?;
        let rock = rock.load(context)?;
        let linear = Sampler::new(context.device(), "linear", vk::Filter::LINEAR)?;
        let pass = splats
            .pass("blending", "7.2", "lava/blending.frag")
            .constants::<ShadingConstants>()
            .with("visibility", &visibility.depth)
            .with("rock", &rock)
            .with("linear", &linear)
            .color(&sums, ZERO, Blend::Add)
            .build(context.shaders)?;
        Ok(Blending { pass, shading: parameters.shading, rock, linear, sums })
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

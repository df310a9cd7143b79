//! Pass `visibility` (section 7.1): depth of the nearest splat plus epsilon, eq. 7.1, as a fraction of
//! [`depth_range_m`](super::depth_range_m).

use std::sync::Arc;

use super::scene::Scene;
use super::splats::Splats;
use super::targets::{Context, FAR};
use crate::gpu::{DepthTest, Error, Frame, ImageView, Pass};

/// The pass.
pub struct Visibility {
    pass: Pass,
}

impl Visibility {
    /// Draws into `depth`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, scene: &Scene, splats: &Splats, depth: &Arc<ImageView>) -> Result<Self, Error> {
        let pass = scene
            .bounded(|shader| splats.pass(scene, "visibility", "7.1", shader), "lava/visibility")
            .depth(depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        Ok(Visibility { pass })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, splats: &Splats) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| splats.draw(draw))
    }
}

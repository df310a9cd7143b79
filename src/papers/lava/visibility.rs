//! Pass `visibility` (section 7.1): depth of the nearest splat plus epsilon, eq. 7.1.

use std::sync::Arc;

use super::splats::Splats;
use super::targets::{Context, DEPTH, FAR};
use crate::gpu::{DepthTest, Error, Frame, ImageView, Pass};

/// The pass.
pub struct Visibility {
    pass: Pass,
    /// Eye-space depth of the nearest splat plus epsilon, as a fraction of [`depth_range_m`](super::depth_range_m).
    pub depth: Arc<ImageView>,
}

impl Visibility {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, splats: &Splats) -> Result<Self, Error> {
        let depth = context.target("visibility", DEPTH, context.parameters.width, context.parameters.height)?;
        let pass = splats
            .pass("visibility", "7.1", "lava/visibility.frag")
            .depth(&depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        Ok(Visibility { pass, depth })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, splats: &Splats) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| splats.draw(draw))
    }
}

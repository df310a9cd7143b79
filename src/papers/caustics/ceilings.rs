//! Pass `ceilings` (section 6.3): what faces away from the light above a hidden surface, where the room above that ends.

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{BACKGROUND, Context};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};

/// The lowest is kept: it is the farthest from the light.
const NEAREST: Load = Load::Clear([0.0; 4]);

/// The pass of one hidden surface.
pub struct Ceilings {
    pass: Pass,
}

impl Ceilings {
    /// Between the surfaces of two position maps, the upper one first.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        lit: &LitReceiver,
        [above, below]: [&Arc<ImageView>; 2],
        ceilings: &Arc<ImageView>,
        depth: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let pass = lit
            .map_pass("ceilings", "6.3", "caustics/ceilings.frag")
            .with("above", above)
            .with("below", below)
            .with("nearest", context.nearest)
            .color(ceilings, BACKGROUND, Blend::Replace)
            .depth(depth, NEAREST, DepthTest::GreaterWrite)
            .build(context.shaders)?;
        Ok(Ceilings { pass })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        lit.draw_into_map(frame, &self.pass, None)
    }
}

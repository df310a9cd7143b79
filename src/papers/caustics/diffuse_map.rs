//! Pass `diffuse-map`: diffuse light of the receiver in a pass of its own (section 4.2.2, figure 5-5).

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{BLACK, Context, FAR, LIGHT};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Pass};

/// The pass.
pub struct DiffuseMap {
    pass: Pass,
    /// I_d of eq. 4-19; alpha is 1 where there is a receiver.
    pub diffuse: Arc<ImageView>,
}

impl DiffuseMap {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, lit: &LitReceiver, depth: &Arc<ImageView>) -> Result<Self, Error> {
        let diffuse = context.map("diffuse-map", LIGHT)?;
        let pass = lit
            .map_pass("diffuse-map", "4.2.2", "caustics/diffuse-map.frag")
            .color(&diffuse, BLACK, Blend::Replace)
            .depth(depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        Ok(DiffuseMap { pass, diffuse })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        lit.draw_into_map(frame, &self.pass, None)
    }
}

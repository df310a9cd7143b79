//! Pass `position-diffuse-map`: position map and diffuse map in one pass with two targets (section 4.2.2, figure 5-6).

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{BACKGROUND, BLACK, Context, DEPTH, FAR, LIGHT, POSITION};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Pass};

/// The pass.
pub struct PositionDiffuseMap {
    pass: Pass,
    /// Heights of the lit surface, metres of box space.
    pub position: Arc<ImageView>,
    /// I_d of eq. 4-19; alpha is 1 where there is a receiver.
    pub diffuse: Arc<ImageView>,
}

impl PositionDiffuseMap {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, lit: &LitReceiver) -> Result<Self, Error> {
        let position = context.map("position-map", POSITION)?;
        let diffuse = context.map("diffuse-map", LIGHT)?;
        let depth = context.map("position-depth", DEPTH)?;
        let pass = lit
            .map_pass("position-diffuse-map", "4.2.2", "caustics/position-diffuse-map.frag")
            .color(&position, BACKGROUND, Blend::Replace)
            .color(&diffuse, BLACK, Blend::Replace)
            .depth(&depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        Ok(PositionDiffuseMap { pass, position, diffuse })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        lit.draw_into_map(frame, &self.pass, None)
    }
}

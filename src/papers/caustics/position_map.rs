//! Pass `position-map`: heights of the lit surface in a pass of its own (section 4.2.2, figure 5-5).

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{BACKGROUND, Context, DEPTH, FAR, POSITION};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Pass};

/// The pass.
pub struct PositionMap {
    pass: Pass,
    /// Heights of the lit surface, metres of box space.
    pub position: Arc<ImageView>,
    /// Depth of the map's camera, which `diffuse-map` clears and draws anew.
    pub depth: Arc<ImageView>,
}

impl PositionMap {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, lit: &LitReceiver) -> Result<Self, Error> {
        let position = context.map("position-map", POSITION)?;
        let depth = context.map("position-depth", DEPTH)?;
        let pass = lit
            .map_pass("position-map", "4.2.2", "caustics/position-map.frag")
            .color(&position, BACKGROUND, Blend::Replace)
            .depth(&depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        Ok(PositionMap { pass, position, depth })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        lit.draw_into_map(frame, &self.pass, None)
    }
}

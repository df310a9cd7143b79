//! The pass `object-depth` (section 1: "does support traditional objects"): what the rays or the grids found as a depth
//! buffer for polygon objects, so that terrain and objects hide each other.

use std::sync::Arc;

use super::blocks::LightBlock;
use super::geometric_transformation::SceneView;
use super::scene::block_buffer;
use super::stage::{Build, FARTHEST};
use crate::gpu::{Buffer, DepthTest, Error, Frame, ImageView, Pass};

/// The pass, and what it shares with the passes that draw the objects.
pub struct ObjectDepth {
    pass: Pass,
    /// A [`LightBlock`].
    pub light: Arc<Buffer>,
    /// The depth buffer: near / depth.
    pub tested: Arc<ImageView>,
}

impl ObjectDepth {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, depth: &Arc<ImageView>) -> Result<Self, Error> {
        let tested = build.depth_buffer("object-depth")?;
        let light = block_buffer::<LightBlock>(build.shaders.device(), &format!("{}/object-light", build.label))?;
        let pass = Pass::graphics("object-depth", "1", "common/fullscreen.vert", "terrain/object-depth.frag")
            .with("light", &light)
            .with("depth", depth)
            .depth(&tested, FARTHEST, DepthTest::GreaterWrite)
            .build(build.shaders)?;
        Ok(ObjectDepth { pass, light, tested })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, view: &SceneView) -> Result<(), Error> {
        self.light.write(0, bytemuck::bytes_of(&view.light))?;
        frame.graphics(&self.pass, |draw| draw.vertices(3))
    }
}

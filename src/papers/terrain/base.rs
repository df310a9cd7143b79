//! The pass `base` (section 2) of the variant `mesh`: the base surface under and around the triangle grids.

use std::sync::Arc;

use super::hit::NO_DEPTH;
use super::scene::DeviceScene;
use super::stage::{Build, FARTHEST, VECTOR};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};

/// The pass, and the targets that it shares with the pass `mesh`.
pub struct BasePass {
    pass: Pass,
    /// A hit of each pixel, of base and grids.
    pub target: Arc<ImageView>,
    /// The depth buffer: near / depth.
    pub tested: Arc<ImageView>,
}

impl BasePass {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, scene: &DeviceScene) -> Result<Self, Error> {
        let target = build.image("depth", VECTOR)?;
        let tested = build.depth_buffer("tested")?;
        let Some(first) = scene.maps.first() else {
            return Err(Error::Pass { pass: "mesh".into(), problem: "there is no map".into() });
        };
        let fragment = format!("terrain/mesh-base-{}.frag", build.parameters.base.kind());
        let pass = Pass::graphics("base", "2", "common/fullscreen.vert", &fragment)
            .with("terrain", &first.terrain)
            .with("levels", &first.levels.view)
            .color(&target, Load::Clear([NO_DEPTH, 0.0, 0.0, 0.0]), Blend::Replace)
            .depth(&tested, FARTHEST, DepthTest::GreaterWrite)
            .build(build.shaders)?;
        Ok(BasePass { pass, target, tested })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.vertices(3))
    }
}

//! The pass `object-hits` (section 1): where polygon objects are seen, as the pass `depth` has it of the terrain. Rays to the
//! sun start there. Once for each mesh.

use std::sync::Arc;

use super::geometric_transformation::SceneView;
use super::hit::NO_DEPTH;
use super::object_depth::ObjectDepth;
use super::objects::ObjectMesh;
use super::stage::{Build, VECTOR};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};

pub struct ObjectHits {
    passes: Vec<Pass>,
    /// A hit of each pixel that sees an object.
    pub target: Arc<ImageView>,
}

impl ObjectHits {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, meshes: &[ObjectMesh], object_depth: &ObjectDepth) -> Result<Self, Error> {
        let target = build.image("object-hits", VECTOR)?;
        let mut passes = Vec::new();
        for (number, mesh) in meshes.iter().enumerate() {
            let load = if number == 0 { Load::Clear([NO_DEPTH, 0.0, 0.0, 0.0]) } else { Load::Keep };
            let pass = mesh.pass("object-hits", "terrain/object-hit.frag").color(&target, load, Blend::Replace).depth(
                &object_depth.tested,
                Load::Keep,
                DepthTest::GreaterWrite,
            );
            passes.push(pass.build(build.shaders)?);
        }
        Ok(ObjectHits { passes, target })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, meshes: &[ObjectMesh], view: &SceneView) -> Result<(), Error> {
        self.passes.iter().zip(meshes).try_for_each(|(pass, mesh)| mesh.draw(frame, pass, view))
    }
}

//! The pass `objects` (section 1: "does support traditional objects"): polygon objects in the same picture, with mutually
//! hidden surfaces. Once for each mesh.

use std::sync::Arc;

use super::geometric_transformation::SceneView;
use super::object_depth::ObjectDepth;
use super::stage::Build;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};
use crate::host_block;
use crate::papers::device_mesh::{DeviceMesh, MeshVertex};
use crate::scene::Mesh;

host_block! {
    struct ObjectConstants {
        /// From the world; w is the depth along the view's axis in metres.
        to_clip: [f32; 16],
    }
}

pub struct Objects {
    passes: Vec<Pass>,
}

impl Objects {
    /// Draws over the picture what passes `test` against the depth buffer, in the shadow of the maps.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        build: &Build<'_>,
        meshes: &[ObjectMesh],
        (object_depth, test): (&ObjectDepth, DepthTest),
        shadow: &Arc<ImageView>,
        picture: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let pass = |mesh: &ObjectMesh| {
            mesh.pass("objects", "terrain/object.frag")
                .with("light", &object_depth.light)
                .with("shadow", shadow)
                .color(picture, Load::Keep, Blend::Replace)
                .depth(&object_depth.tested, Load::Keep, test)
                .build(build.shaders)
        };
        Ok(Objects { passes: meshes.iter().map(pass).collect::<Result<_, _>>()? })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, meshes: &[ObjectMesh], view: &SceneView) -> Result<(), Error> {
        self.passes.iter().zip(meshes).try_for_each(|(pass, mesh)| mesh.draw(frame, pass, view))
    }
}

/// A polygon object on the device.
pub struct ObjectMesh(DeviceMesh);

impl ObjectMesh {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, mesh: &Mesh) -> Result<Self, Error> {
        DeviceMesh::new(build.shaders.device(), build.label, mesh).map(ObjectMesh)
    }

    /// A pass that draws the mesh; both that do find the same depths.
    pub fn pass(&self, name: &'static str, fragment: &str) -> PassBuilder {
        Pass::graphics(name, "1", "terrain/object.vert", fragment)
            .vertices::<MeshVertex>(&self.0.vertices)
            .indices(&self.0.indices)
            .constants::<ObjectConstants>()
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn draw(&self, frame: &mut Frame<'_>, pass: &Pass, view: &SceneView) -> Result<(), Error> {
        let constants = ObjectConstants { to_clip: view.to_clip.as_mat4().to_cols_array() };
        frame.graphics(pass, |draw| draw.constants(&constants).indices(self.0.index_count))
    }
}

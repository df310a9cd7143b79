//! Pass `objects`: polygon objects in the lava's space, with mutually hidden surfaces. The thesis has none; a picture
//! without objects is the thesis's own.

use std::sync::Arc;

use ash::vk;

use super::normalisation::Normalisation;
use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::{Context, DEPTH, FAR};
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};
use crate::host_block;
use crate::papers::device_mesh::{DeviceMesh, MeshVertex};
use crate::scene::Mesh;

host_block! {
    struct ObjectConstants {
        eye_m: [f32; 3],
        exposure: f32,
        knee: f32,
    }
}

/// The pass, a call for each mesh.
pub struct Objects {
    /// Each with its number of indices.
    passes: Vec<(Pass, u32)>,
    constants: ObjectConstants,
}

impl Objects {
    /// Draws over the picture what of `meshes`, metres in the simulation space, is nearer than the lava and each other.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        meshes: &[Mesh],
        scene: &Scene,
        visibility: &Arc<ImageView>,
        normalisation: &Normalisation,
    ) -> Result<Self, Error> {
        let Context { shaders, parameters, .. } = context;
        let desc = ImageDesc::new_2d(context.name("object-depth"), DEPTH, parameters.width, parameters.height);
        let depth = Image::new(context.device(), desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT))?.view()?;
        let mut passes: Vec<(Pass, u32)> = Vec::with_capacity(meshes.len());
        for mesh in meshes {
            let DeviceMesh { vertices, indices, index_count } = DeviceMesh::new(context.device(), context.label, mesh)?;
            let pass = match passes.first() {
                None => Pass::graphics("objects", "", "lava/object.vert", "lava/object.frag")
                    .vertices::<MeshVertex>(&vertices)
                    .indices(&indices)
                    .constants::<ObjectConstants>()
                    .with("scene", &scene.block)
                    .with("visibility", visibility)
                    .color(&normalisation.picture, Load::Keep, Blend::Replace)
                    .depth(&depth, FAR, DepthTest::LessWrite)
                    .build(shaders)?,
                Some((first, _)) => {
                    first.rebind().vertices(&vertices).indices(&indices).depth(&depth, Load::Keep).build(shaders)?
                }
            };
            passes.push((pass, index_count));
        }
        Ok(Objects { passes, constants: constants(parameters) })
    }

    /// Sets the constants of the next frames.
    pub fn set_constants(&mut self, parameters: &Parameters) {
        self.constants = constants(parameters);
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|(pass, count)| {
            frame.graphics(pass, |draw| {
                draw.constants(&self.constants).indices(*count);
            })
        })
    }
}

fn constants(parameters: &Parameters) -> ObjectConstants {
    let eye_m = parameters.camera.eye.to_array();
    ObjectConstants { eye_m, exposure: parameters.exposure, knee: parameters.tone.knee() }
}

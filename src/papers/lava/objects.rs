//! Pass `objects`: polygon objects in the lava's space, with mutually hidden surfaces. The thesis has none; a picture
//! without objects is the thesis's own.

use std::sync::Arc;

use ash::vk;

use super::normalisation::Normalisation;
use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::{Context, DEPTH, FAR};
use crate::gpu::transfer::upload_each;
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};
use crate::host_block;
use crate::scene::Mesh;

host_block! {
    struct ObjectVertex {
        position: [f32; 3],
        normal: [f32; 3],
    }
}

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
            let buffer =
                |what: &str, usage, bytes: &[u8]| context.upload(&format!("{}/{what}", mesh.name), usage, bytes);
            let vertex = |at: usize| ObjectVertex {
                position: mesh.positions[at].to_array(),
                normal: mesh.normals[at].to_array(),
            };
            let name = context.name(&format!("{}/vertices", mesh.name));
            let (usage, count) = (vk::BufferUsageFlags::VERTEX_BUFFER, mesh.positions.len());
            let vertices = upload_each(context.device(), &name, usage, count, vertex)?;
            let index_usage = vk::BufferUsageFlags::INDEX_BUFFER;
            let indices = buffer("indices", index_usage, bytemuck::cast_slice(&mesh.indices))?;
            let pass = match passes.first() {
                None => Pass::graphics("objects", "", "lava/object.vert", "lava/object.frag")
                    .vertices::<ObjectVertex>(&vertices)
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
            passes.push((pass, mesh.indices.len() as u32));
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

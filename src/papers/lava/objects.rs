//! Pass `objects`: polygon objects in the lava's space, with mutually hidden surfaces. The thesis has none; a picture
//! without objects is the thesis's own. The ground under a fluid is drawn as one.

use std::sync::Arc;

use ash::vk;

use super::normalisation::Normalisation;
use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::{Context, DEPTH, FAR};
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};
use crate::host_block;
use crate::papers::device_mesh::{DeviceMesh, MeshVertex};
use crate::scene::Mesh;

host_block! {
    struct ObjectConstants {
        eye_m: [f32; 3],
        exposure: f32,
        knee: f32,
        paint: f32,
    }
}

/// Share of light that comes back of an object.
const OBJECT: f32 = 0.55;
/// Of the ground: old basalt.
const BED: f32 = 0.3;

/// The pass, a call for each mesh.
pub struct Objects {
    calls: Vec<Call>,
    constants: ObjectConstants,
}

struct Call {
    pass: Pass,
    index_count: u32,
    /// Share of light that comes back.
    paint: f32,
}

impl Objects {
    /// Draws over the picture what of `meshes` and `bed`, metres in the simulation space, is nearer than the lava and each other;
    /// `None` where there is nothing to draw.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        meshes: &[Mesh],
        bed: Option<&Mesh>,
        scene: &Scene,
        visibility: &Arc<ImageView>,
        normalisation: &Normalisation,
        lamps: Option<&Arc<Buffer>>,
    ) -> Result<Option<Self>, Error> {
        if meshes.is_empty() && bed.is_none() {
            return Ok(None);
        }
        let Context { shaders, parameters, .. } = context;
        let desc = ImageDesc::new_2d(context.name("object-depth"), DEPTH, parameters.width, parameters.height);
        let depth = Image::new(context.device(), desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT))?.view()?;
        let mut calls: Vec<Call> = Vec::new();
        let all = bed.map(|mesh| (mesh, BED)).into_iter().chain(meshes.iter().map(|mesh| (mesh, OBJECT)));
        for (mesh, paint) in all {
            let DeviceMesh { vertices, indices, index_count } = DeviceMesh::new(context.device(), context.label, mesh)?;
            let pass = match calls.first() {
                None => objects(lamps)
                    .vertices::<MeshVertex>(&vertices)
                    .indices(&indices)
                    .constants::<ObjectConstants>()
                    .with("scene", &scene.block)
                    .with("visibility", visibility)
                    .color(&normalisation.picture, Load::Keep, Blend::Replace)
                    .depth(&depth, FAR, DepthTest::LessWrite)
                    .build(shaders)?,
                Some(Call { pass: first, .. }) => {
                    first.rebind().vertices(&vertices).indices(&indices).depth(&depth, Load::Keep).build(shaders)?
                }
            };
            calls.push(Call { pass, index_count, paint });
        }
        Ok(Some(Objects { calls, constants: constants(parameters) }))
    }

    /// Sets the constants of the next frames.
    pub fn set_constants(&mut self, parameters: &Parameters) {
        self.constants = constants(parameters);
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.calls.iter().try_for_each(|Call { pass, index_count, paint }| {
            let constants = ObjectConstants { paint: *paint, ..self.constants };
            frame.graphics(pass, |draw| draw.constants(&constants).indices(*index_count))
        })
    }
}

fn constants(parameters: &Parameters) -> ObjectConstants {
    let eye_m = parameters.camera.eye.to_array();
    ObjectConstants { eye_m, exposure: parameters.exposure, knee: parameters.tone.knee(), paint: 0.0 }
}

/// Begins the pass beside a fluid that shines, or beside the thesis's lava.
fn objects(lamps: Option<&Arc<Buffer>>) -> PassBuilder {
    match lamps {
        None => Pass::graphics("objects", "", "lava/object-free.vert", "lava/object-free.frag"),
        Some(lamps) => {
            Pass::graphics("objects", "", "lava/object-sph.vert", "lava/object-sph.frag").with("lamps", lamps)
        }
    }
}

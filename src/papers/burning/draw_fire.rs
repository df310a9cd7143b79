//! `draw-fire` (3.6): the particles of fire and smoke over the mesh, or in a layer of their own that `tone` lays over it.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::{Draw, LIGHT};
use super::flames::Flames;
use super::parameters::Parameters;
use crate::gpu::{Blend, Buffer, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary, Topology};

/// The pass.
pub struct DrawFire {
    pass: Pass,
    particle_count: u32,
    /// The picture, or the layer: linear light, and what it leaves of the light behind it.
    pub target: Arc<ImageView>,
}

impl DrawFire {
    /// `fire_lights` are those of a picture of linear light.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        buffers: &Buffers,
        (draw, flames): (&Draw, &Flames),
        fire_lights: Option<&Arc<Buffer>>,
    ) -> Result<Self, Error> {
        let pass = |light: &str| {
            let shader = |stage: &str| format!("burning/draw-fire-{light}.{stage}");
            Pass::graphics("draw-fire", "3.6", &shader("vert"), &shader("frag"))
        };
        let (pass, target, load) = match fire_lights {
            None => (pass("sun"), draw.picture.clone(), Load::Keep),
            Some(fire_lights) => {
                let [width, height] = layer_size(parameters);
                let desc = ImageDesc::new_2d(format!("{label}/fire-layer"), LIGHT, width, height)
                    .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED);
                let layer = Image::new(shaders.device(), desc)?.view()?;
                (pass("flames").with("FireLights", fire_lights), layer, Load::Clear([0.0; 4]))
            }
        };
        let pass = pass
            .with("constants", &buffers.constants)
            .with("view", &draw.view)
            .with("billboards", &flames.billboards)
            .with("Particles", &flames.particles)
            .with("mesh_depth", &draw.depth)
            .color(&target, load, Blend::Premultiplied)
            .topology(Topology::TriangleStrip)
            .build(shaders)?;
        Ok(DrawFire { pass, particle_count: flames.particle_count, target })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            draw.instances(4, self.particle_count);
        })
    }
}

/// Pixels of the layer along x and y.
pub(super) fn layer_size(parameters: &Parameters) -> [u32; 2] {
    [parameters.width, parameters.height].map(|pixels| pixels.div_ceil(parameters.fire_scale))
}

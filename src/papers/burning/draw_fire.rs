//! `draw-fire` (3.6): the particles of fire and smoke, in a layer of their own that goes over the picture once, or in the
//! picture itself.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::{Draw, LIGHT};
use super::flames::Flames;
use super::parameters::Parameters;
use super::smoke_volume::SmokeVolume;
use crate::gpu::{Blend, Buffer, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary, Topology};

/// The pass.
pub struct DrawFire {
    /// The smoke's density, where it is drawn as a volume.
    pub(super) volume: Option<SmokeVolume>,
    /// Smoke, then fire, with their vertices and instances: what of the smoke hides fire is in front mostly, and fire
    /// shines through. A shader each, for devices that run both sides of a branch would pay for both everywhere.
    steps: [(Pass, [u32; 2]); 2],
    /// Lays the layer over a picture that `tone` does not make.
    over: Option<Pass>,
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
        let light = if fire_lights.is_some() { "flames" } else { "sun" };
        let (target, load) = if parameters.has_fire_layer() {
            let [width, height] = layer_size(parameters);
            let desc = ImageDesc::new_2d(format!("{label}/fire-layer"), LIGHT, width, height)
                .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED);
            (Image::new(shaders.device(), desc)?.view()?, Load::Clear([0.0; 4]))
        } else {
            (draw.picture.clone(), Load::Keep)
        };
        let step = |vertex: &str, fragment: &str, load| {
            let [vertex, fragment] = [vertex, fragment].map(|shader| format!("burning/{shader}"));
            Pass::graphics("draw-fire", "3.6", &vertex, &fragment)
                .with("view", &draw.view)
                .with("billboards", &flames.billboards)
                .with("Particles", &flames.particles)
                .with("mesh_depth", &draw.depth)
                .color(&target, load, Blend::Premultiplied)
                .topology(Topology::TriangleStrip)
        };
        let volume = fire_lights
            .filter(|_| parameters.has_smoke_volume())
            .map(|lights| SmokeVolume::new(shaders, label, parameters.smoke, buffers, flames, lights))
            .transpose()?;
        let (smoke, drawn) = match &volume {
            None => {
                let smoke = step(&format!("draw-smoke-{light}.vert"), &format!("draw-smoke-{light}.frag"), load);
                let smoke = smoke.with("constants", &buffers.constants);
                let lit = fire_lights.into_iter().fold(smoke, |smoke, lights| smoke.with("FireLights", lights));
                (lit, [4, parameters.smoke])
            }
            Some(volume) => {
                let (vertex, fragment) = ("common/fullscreen.vert", "burning/draw-smoke-volume.frag");
                let smoke = Pass::graphics("draw-fire", "3.6", vertex, fragment)
                    .with("view", &draw.view)
                    .with("billboards", &flames.billboards)
                    .with("mesh_depth", &draw.depth)
                    .with("SmokeGrid", &volume.grid)
                    .with("SmokeCells", &volume.cells)
                    .color(&target, load, Blend::Premultiplied);
                (smoke, [3, 1])
            }
        };
        let fire = step("draw-fire.vert", "draw-fire.frag", Load::Keep);
        let [smoke, fire] = [smoke.build(shaders)?, fire.build(shaders)?];
        let (smoke, fire, over) = if parameters.has_fire_layer() && fire_lights.is_none() {
            let over = Pass::graphics("draw-fire", "3.6", "common/fullscreen.vert", "burning/draw-fire-over.frag")
                .with("billboards", &flames.billboards)
                .with("mesh_depth", &draw.depth)
                .with("fire_layer", &target)
                .color(&draw.picture, Load::Keep, Blend::Premultiplied)
                .build(shaders)?;
            let [smoke, fire, over] = Pass::steps([smoke, fire, over]);
            (smoke, fire, Some(over))
        } else {
            let [smoke, fire] = Pass::steps([smoke, fire]);
            (smoke, fire, None)
        };
        Ok(DrawFire { volume, steps: [(smoke, drawn), (fire, [4, parameters.fire])], over, target })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        if let Some(volume) = &self.volume {
            volume.record(frame)?;
        }
        self.steps.iter().try_for_each(|&(ref step, [vertices, instances])| {
            frame.graphics(step, |draw| draw.instances(vertices, instances))
        })?;
        self.over.iter().try_for_each(|over| frame.graphics(over, |draw| draw.vertices(3)))
    }
}

/// Pixels of the layer along x and y.
pub(super) fn layer_size(parameters: &Parameters) -> [u32; 2] {
    [parameters.width, parameters.height].map(|pixels| pixels.div_ceil(parameters.fire_scale))
}

//! `draw-fire` (3.6): the particles of fire and smoke, in a layer of their own that goes over the picture once, where it
//! shows them, or in the picture itself.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::{Draw, LIGHT};
use super::flames::Flames;
use super::parameters::Parameters;
use super::smoke_volume::SmokeVolume;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/fire-tiles.glsl`.
    struct Laying {
        /// Number of the pictures so far.
        picture: u32,
    }
}

/// Tiles of the picture along x, and along y.
const TILES: u32 = 32;
/// Vertices of a square of two triangles.
const OF_SQUARE: u32 = 6;
const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// Lays the layer over the picture, tile by tile: a blend of pixels without fire would cost as much as one of those with.
struct Over {
    /// Marks the tiles that particles reach, and draws the layer there.
    steps: [Pass; 2],
    particle_count: u32,
    laying: Laying,
}

/// The pass.
pub struct DrawFire {
    /// The smoke's density, where it is drawn as a volume.
    pub(super) volume: Option<SmokeVolume>,
    /// Smoke, then fire, with their vertices and instances: what of the smoke hides fire is in front mostly, and fire
    /// shines through. A shader each, for devices that run both sides of a branch would pay for both everywhere.
    steps: [(Pass, u32); 2],
    /// Lays the layer over a picture that `tone` does not make.
    over: Option<Over>,
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
                (lit, OF_SQUARE * parameters.smoke)
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
                (smoke, 3)
            }
        };
        let fire = step("draw-fire.vert", "draw-fire.frag", Load::Keep);
        let [smoke, fire] = [smoke.build(shaders)?, fire.build(shaders)?];
        let (smoke, fire, over) = if parameters.has_fire_layer() && fire_lights.is_none() {
            let none = vec![0; 4 * (TILES * TILES) as usize];
            let tiles = upload(shaders.device(), &format!("{label}/fire-tiles"), STORAGE, &none)?;
            let mark = Pass::compute("draw-fire", "3.6", "burning/draw-fire-tiles.comp")
                .constants::<Laying>()
                .with("constants", &buffers.constants)
                .with("view", &draw.view)
                .with("billboards", &flames.billboards)
                .with("Particles", &flames.particles)
                .with("Tiles", &tiles)
                .build(shaders)?;
            let (vertex, fragment) = ("burning/draw-fire-over.vert", "burning/draw-fire-over.frag");
            let lay = Pass::graphics("draw-fire", "3.6", vertex, fragment)
                .constants::<Laying>()
                .with("Tiles", &tiles)
                .with("billboards", &flames.billboards)
                .with("mesh_depth", &draw.depth)
                .with("fire_layer", &target)
                .color(&draw.picture, Load::Keep, Blend::Premultiplied)
                .build(shaders)?;
            let [smoke, fire, mark, lay] = Pass::steps([smoke, fire, mark, lay]);
            let particle_count = parameters.fire + parameters.smoke;
            (smoke, fire, Some(Over { steps: [mark, lay], particle_count, laying: Laying { picture: 0 } }))
        } else {
            let [smoke, fire] = Pass::steps([smoke, fire]);
            (smoke, fire, None)
        };
        Ok(DrawFire { volume, steps: [(smoke, drawn), (fire, OF_SQUARE * parameters.fire)], over, target })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        if let Some(volume) = &self.volume {
            volume.record(frame)?;
        }
        self.steps.iter().try_for_each(|&(ref step, vertices)| frame.graphics(step, |draw| draw.vertices(vertices)))?;
        self.over.iter_mut().try_for_each(|over| over.record(frame))
    }
}

impl Over {
    fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.laying.picture = self.laying.picture.wrapping_add(1).max(1);
        let Over { steps: [mark, lay], particle_count, laying } = self;
        frame.compute(mark, |dispatch| dispatch.constants(laying).elements(*particle_count))?;
        frame.graphics(lay, |draw| draw.constants(laying).vertices(OF_SQUARE * TILES * TILES))
    }
}

/// Pixels of the layer along x and y.
pub(super) fn layer_size(parameters: &Parameters) -> [u32; 2] {
    [parameters.width, parameters.height].map(|pixels| pixels.div_ceil(parameters.fire_scale))
}

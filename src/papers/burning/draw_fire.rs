//! `draw-fire` (3.6): the particles of fire and smoke, in a layer of their own that goes over the picture once, where it
//! shows them, or in the picture itself.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::Draw;
use super::fire_layer::{self, FireLayer};
use super::flames::Flames;
use super::parameters::Parameters;
use super::smoke_volume::SmokeVolume;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, Error, Frame, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/draw-fire-over.vert`.
    struct Laying {
        /// Number of the pictures so far.
        picture: u32,
    }
}

/// Tiles of the picture along x, and along y.
const TILES: u32 = 32;
/// Vertices of a square of two triangles.
const OF_SQUARE: u32 = 6;

/// The pass.
pub struct DrawFire {
    /// The smoke's density, where it is drawn as a volume.
    pub(super) volume: Option<SmokeVolume>,
    steps: Steps,
    /// The picture, or the layer: linear light, and what it leaves of the light behind it.
    pub target: Arc<ImageView>,
    /// Of the layer what the picture asks of each pixel (`burning/over-layer.glsl`).
    pub(super) texels: Option<Arc<ImageView>>,
}

enum Steps {
    /// Squares into the picture: smoke, then fire, with their vertices: what of the smoke hides fire is in front mostly,
    /// and fire shines through. A shader each, for devices that run both sides of a branch would pay for both everywhere.
    Squares([(Pass, u32); 2]),
    Layer(Box<Layer>),
}

struct Layer {
    /// The march through smoke that is a volume, which begins the layer.
    march: Option<Pass>,
    layer: FireLayer,
    /// Lays it over a picture that `tone` does not make, tile by tile: a blend of pixels without fire would cost as much as
    /// one of those with.
    over: Option<Pass>,
    laying: Laying,
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
        if !parameters.has_fire_layer() {
            let steps = squares(shaders, parameters, buffers, (draw, flames))?;
            let target = draw.picture.clone();
            return Ok(DrawFire { volume: None, steps: Steps::Squares(steps), target, texels: None });
        }
        let target = fire_layer::layer(shaders, label, parameters)?;
        let volume = fire_lights
            .filter(|_| parameters.has_smoke_volume())
            .map(|lights| SmokeVolume::new(shaders, label, parameters.smoke, buffers, flames, lights))
            .transpose()?;
        let march = volume.as_ref().map(|volume| {
            Pass::graphics("draw-fire", "3.6", "common/fullscreen.vert", "burning/draw-smoke-volume.frag")
                .with("view", &draw.view)
                .with("billboards", &flames.billboards)
                .with("mesh_depth", &draw.depth)
                .with("SmokeGrid", &volume.grid)
                .with("SmokeCells", &volume.cells)
                .color(&target, Load::Clear([0.0; 4]), Blend::Premultiplied)
                .build(shaders)
        });
        let march = march.transpose()?;
        let none = vec![0; 4 * (TILES * TILES) as usize];
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let tiles = upload(shaders.device(), &format!("{label}/fire-tiles"), usage, &none)?;
        let drawn = (&target, &tiles, volume.is_none());
        let layer = FireLayer::new(shaders, (label, parameters), buffers, (draw, flames), fire_lights, drawn)?;
        let over = fire_lights.is_none().then(|| {
            let (vertex, fragment) = ("burning/draw-fire-over.vert", "burning/draw-fire-over.frag");
            Pass::graphics("draw-fire", "3.6", vertex, fragment)
                .constants::<Laying>()
                .with("Tiles", &tiles)
                .with("billboards", &flames.billboards)
                .with("mesh_depth", &draw.depth)
                .with("fire_texels", &layer.texels)
                .color(&draw.picture, Load::Keep, Blend::Premultiplied)
                .build(shaders)
        });
        let layer = Layer { march, layer, over: over.transpose()?, laying: Laying { picture: 0 } };
        let texels = Some(layer.layer.texels.clone());
        Ok(DrawFire { volume, steps: Steps::Layer(Box::new(layer.in_one())), target, texels })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        if let Some(volume) = &self.volume {
            volume.record(frame)?;
        }
        match &mut self.steps {
            Steps::Squares(steps) => {
                steps.iter().try_for_each(|&(ref step, vertices)| frame.graphics(step, |draw| draw.vertices(vertices)))
            }
            Steps::Layer(layer) => layer.record(frame),
        }
    }
}

impl Layer {
    /// All steps as one pass.
    fn in_one(self) -> Self {
        let Layer { march, layer, over, laying } = self;
        let [clear, lines, first, next] = layer.steps();
        match (march, over) {
            (None, None) => {
                let steps = Pass::steps([clear, lines, first, next]);
                Layer { march: None, layer: layer.with_steps(steps), over: None, laying }
            }
            (Some(march), over) => {
                let [march, steps @ ..] = Pass::steps([march, clear, lines, first, next]);
                Layer { march: Some(march), layer: layer.with_steps(steps), over, laying }
            }
            (None, Some(over)) => {
                let [clear, lines, first, next, over] = Pass::steps([clear, lines, first, next, over]);
                let layer = layer.with_steps([clear, lines, first, next]);
                Layer { march: None, layer, over: Some(over), laying }
            }
        }
    }

    fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let Layer { march, layer, over, laying } = self;
        laying.picture = laying.picture.wrapping_add(1).max(1);
        if let Some(march) = march {
            frame.graphics(march, |draw| draw.vertices(3))?;
        }
        layer.record(frame, laying.picture)?;
        match over {
            None => Ok(()),
            Some(over) => frame.graphics(over, |draw| draw.constants(laying).vertices(OF_SQUARE * TILES * TILES)),
        }
    }
}

/// Draws each particle into the picture.
fn squares(
    shaders: &ShaderLibrary,
    parameters: &Parameters,
    buffers: &Buffers,
    (draw, flames): (&Draw, &Flames),
) -> Result<[(Pass, u32); 2], Error> {
    let step = |name: &str| {
        Pass::graphics("draw-fire", "3.6", &format!("burning/{name}.vert"), &format!("burning/{name}.frag"))
            .with("view", &draw.view)
            .with("billboards", &flames.billboards)
            .with("Particles", &flames.particles)
            .with("mesh_depth", &draw.depth)
            .color(&draw.picture, Load::Keep, Blend::Premultiplied)
    };
    let smoke = step("draw-smoke").with("constants", &buffers.constants).build(shaders)?;
    let fire = step("draw-fire").build(shaders)?;
    let [smoke, fire] = Pass::steps([smoke, fire]);
    Ok([(smoke, OF_SQUARE * parameters.smoke), (fire, OF_SQUARE * parameters.fire)])
}

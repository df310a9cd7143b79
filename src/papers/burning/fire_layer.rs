//! The layer of fire and smoke: its tiles add up the particles that reach them.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::{Draw, LIGHT};
use super::flames::Flames;
use super::parameters::Parameters;
use crate::gpu::{Buffer, Error, Frame, Image, ImageDesc, ImageView, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/fire-layer.glsl`.
    struct Chunk {
        /// Its first slot among those of all particles.
        first: u32,
        /// The first slot of fire.
        fire_from: u32,
        /// Number of the pictures so far.
        picture: u32,
    }
}

/// Particles of a chunk, pixels along a side of a tile, and words of a line's mask (`burning/fire-layer.glsl`).
const CHUNK: u32 = 8192;
const TILE: u32 = 8;
const WORDS: u32 = CHUNK / 32 + CHUNK / 1024;
/// Slots of a bit of a summary: smoke has a whole number of them.
const SUMMARY: u32 = 1024;
/// Texels of the particles' records along x, and below each other.
const ROW: u32 = 1024;
const RECORD: u32 = 3;
const STORAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::STORAGE;
const SAMPLED: vk::ImageUsageFlags = vk::ImageUsageFlags::SAMPLED;

/// The steps that draw the layer.
#[derive(Clone)]
pub(super) struct FireLayer {
    /// Clears the masks of the lines.
    clear: Pass,
    /// Fills them.
    lines: Pass,
    /// Draws a chunk into a cleared layer, and over what is there.
    tiles: [Pass; 2],
    /// Something is in the layer before.
    is_begun: bool,
    /// Of the layer in tiles.
    size: [u32; 2],
    /// Slots of smoke and of all particles.
    slots: [u32; 2],
    /// Of each pixel what the picture asks: colour and opacity in halves of 16 bits, and the mesh's distance.
    pub(super) texels: Arc<ImageView>,
}

/// The layer of a picture: linear light, and what it leaves of the light behind it.
///
/// # Errors
/// Those of the Vulkan layer.
pub(super) fn layer(shaders: &ShaderLibrary, label: &str, parameters: &Parameters) -> Result<Arc<ImageView>, Error> {
    let [width, height] = size(parameters);
    let desc = ImageDesc::new_2d(format!("{label}/fire-layer"), LIGHT, width, height);
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | SAMPLED | STORAGE;
    Image::new(shaders.device(), desc.usage(usage))?.view()
}

/// Pixels of the layer along x and y.
pub(super) fn size(parameters: &Parameters) -> [u32; 2] {
    [parameters.width, parameters.height].map(|pixels| pixels.div_ceil(parameters.fire_scale))
}

/// Bytes of the layer, and of what the steps leave for each other.
pub(super) fn bytes(parameters: &Parameters) -> f64 {
    let [width, height] = size(parameters).map(f64::from);
    let lines = ((width + height) / f64::from(TILE) + 2.0) * f64::from(WORDS);
    (8.0 + 16.0) * width * height + 4.0 * lines + 16.0 * f64::from(RECORD * CHUNK)
}

impl FireLayer {
    /// `drawn` is what the layer's particles are: smoke, where it is not drawn already, and fire. `picture_tiles` are
    /// those of `burning/fire-tiles.glsl`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        (label, parameters): (&str, &Parameters),
        buffers: &Buffers,
        (draw, flames): (&Draw, &Flames),
        fire_lights: Option<&Arc<Buffer>>,
        (layer, picture_tiles, has_smoke): (&Arc<ImageView>, &Arc<Buffer>, bool),
    ) -> Result<Self, Error> {
        let image = |name: &str, format, width, height| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, width, height);
            Image::new(shaders.device(), desc.usage(STORAGE | SAMPLED))?.view()
        };
        let [width, height] = size(parameters);
        let texels = image("fire-texels", vk::Format::R32G32B32A32_UINT, width, height)?;
        let [columns, rows] = [width, height].map(|pixels| pixels.div_ceil(TILE));
        let masks = image("line-masks", vk::Format::R32_UINT, WORDS, columns + rows)?;
        let records = image("fire-records", vk::Format::R32G32B32A32_SFLOAT, ROW, RECORD * CHUNK.div_ceil(ROW))?;
        let step = |shader: &str| {
            Pass::compute("draw-fire", "3.6", &format!("burning/draw-fire-{shader}.comp"))
                .constants::<Chunk>()
                .with("billboards", &flames.billboards)
        };
        let clear = Pass::compute("draw-fire", "3.6", "burning/draw-fire-clear.comp").with("line_masks", &masks);
        let lines = match fire_lights {
            None => step("lines-sun"),
            Some(lights) => step("lines-flames").with("FireLights", lights),
        };
        let lines = lines
            .with("constants", &buffers.constants)
            .with("view", &draw.view)
            .with("Particles", &flames.particles)
            .with("line_masks", &masks)
            .with("fire_records", &records);
        let tiles = |shader: &str| {
            step(shader)
                .with("mesh_depth", &draw.depth)
                .with("masks", &masks)
                .with("records", &records)
                .with("fire_layer", layer)
                .with("fire_texels", &texels)
                .with("Tiles", picture_tiles)
                .build(shaders)
        };
        let smoke = if has_smoke { parameters.smoke.next_multiple_of(SUMMARY) } else { 0 };
        Ok(FireLayer {
            clear: clear.build(shaders)?,
            lines: lines.build(shaders)?,
            tiles: [tiles("layer-clear")?, tiles("layer-keep")?],
            is_begun: !has_smoke,
            size: [columns, rows],
            slots: [smoke, smoke + parameters.fire],
            texels,
        })
    }

    /// The steps, to be one pass with others.
    pub fn steps(&self) -> [Pass; 4] {
        let [clear, keep] = self.tiles.clone();
        [self.clear.clone(), self.lines.clone(), clear, keep]
    }

    /// As part of a pass that is made of its steps and others.
    pub fn with_steps(self, [clear, lines, first, next]: [Pass; 4]) -> Self {
        FireLayer { clear, lines, tiles: [first, next], ..self }
    }

    /// Draws the layer of the picture of this number.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, picture: u32) -> Result<(), Error> {
        let [fire_from, end] = self.slots;
        let [columns, rows] = self.size;
        for first in (0..end.max(1)).step_by(CHUNK as usize) {
            let chunk = Chunk { first, fire_from, picture };
            let tiles = &self.tiles[usize::from(self.is_begun || first > 0)];
            frame.compute(&self.clear, |dispatch| dispatch.threads(WORDS, columns + rows, 1))?;
            frame.compute(&self.lines, |dispatch| dispatch.constants(&chunk).elements(CHUNK.min(end - first)))?;
            frame.compute(tiles, |dispatch| dispatch.constants(&chunk).threads(TILE * columns, rows, 1))?;
        }
        Ok(())
    }
}

//! A map on the device: its data and its pyramid in the layers of one image, or in tiles of which it holds some.
//!
//! Texels are unsigned integers: R16_UINT for 16-bit steps, R32_UINT with the bits of floats. Vulkan promises sampling and
//! rendering for both; for R16_UNORM it promises neither.

use std::sync::Arc;

use ash::vk;

use super::packed::Packed;
use super::parameters::Interpolation;
use super::pyramid::{Bound, Cover, Shape};
use super::tile_file::TileFile;
use super::tiles::Tiles;
use crate::gpu::bindings::Resource;
use crate::gpu::transfer::{copy_rectangle, upload_rows};
use crate::gpu::{Blend, Device, Error, Image, ImageDesc, ImageView, Load, Mode, Pass, Recorder, ShaderLibrary};
use crate::host_block;
use crate::scene::{HeightMap, Samples};

host_block! {
    struct Level {
        origin: [i32; 2],
        last: [i32; 2],
        is_float: i32,
        is_lowest: i32,
        before: i32,
        after: i32,
    }
}

/// Layers of the image: the data, the highest values, the lowest.
const DATA: u32 = 0;

/// A map's levels on the device.
pub struct Levels {
    /// All layers.
    pub view: Arc<ImageView>,
    /// Sizes of the levels.
    pub shape: Shape,
    /// Texels are the bits of floats, not 16-bit steps.
    pub is_float: bool,
    /// The tiles, where the device does not hold all.
    pub tiles: Option<Tiles>,
    /// Images that rays read in place of the layers, where they were made.
    pub packed: Option<Packed>,
}

impl Levels {
    /// Uploads the data in strips and builds the coarser levels of each of `bounds`, which take the layers from 1 on; `cover` is
    /// what their texels answer for.
    ///
    /// # Errors
    /// [`Error::Limit`] for a map larger than the device's images, [`Error::OutOfMemory`], errors of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        map: &HeightMap,
        bounds: &[Bound],
        cover: Cover,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let shape = Shape::new(map.width(), map.height());
        let is_float = matches!(map.samples(), Samples::Float(_));
        let format = if is_float { vk::Format::R32_UINT } else { vk::Format::R16_UINT };
        let (width, height) = shape.extent();
        let usage = vk::ImageUsageFlags::SAMPLED;
        let desc = ImageDesc::new_2d(format!("{label}/levels"), format, width, height)
            .layers(1 + bounds.len() as u32)
            .usage(usage);
        let image = Image::new(device, desc)?;
        let stride = shape.width as usize;
        let data = image.layer(DATA)?;
        upload_rows(device, &data, (shape.width, shape.height), |first_row, rows| {
            let first = first_row as usize * stride;
            match map.samples() {
                Samples::Steps { values, .. } => copy_samples(&values[first..], rows),
                Samples::Float(values) => copy_samples(&values[first..], rows),
            }
        })?;
        let levels = Levels { view: image.view()?, shape, is_float, tiles: None, packed: None };
        for (layer, &bound) in (1..).zip(bounds) {
            levels.build(shaders, &image, layer, (bound, cover))?;
        }
        Ok(levels)
    }

    /// Those of which the device holds tiles that rays asked for, in at most so many bytes; `file` has all of a map that is not held.
    ///
    /// # Errors
    /// As [`Tiles::new`].
    pub fn in_tiles(
        device: &Arc<Device>,
        label: &str,
        map: &Arc<HeightMap>,
        pool: (Interpolation, u64),
        file: Option<&Arc<TileFile>>,
    ) -> Result<Self, Error> {
        let tiles = Tiles::new(device, label, map, pool, file)?;
        let is_float = matches!(map.samples(), Samples::Float(_));
        let shape = Shape::new(map.width(), map.height());
        Ok(Levels { view: tiles.view.clone(), shape, is_float, tiles: Some(tiles), packed: None })
    }

    /// Makes the images that rays read in place of the layers.
    ///
    /// # Errors
    /// As [`Packed::new`].
    pub fn pack(mut self, shaders: &ShaderLibrary, label: &str) -> Result<Self, Error> {
        self.packed = Some(Packed::new(shaders, label, &self)?);
        Ok(self)
    }

    /// All that rays read of them, by the shaders' names.
    pub fn ray_resources(&self) -> Vec<(&'static str, Resource)> {
        match &self.packed {
            None => self.resources(),
            Some(packed) => vec![("corners", (&packed.corners).into()), ("coarser", (&packed.coarser).into())],
        }
    }

    /// All that the other passes read of them, by the shaders' names.
    pub fn resources(&self) -> Vec<(&'static str, Resource)> {
        match &self.tiles {
            None => vec![("levels", (&self.view).into())],
            Some(tiles) => tiles.resources().into(),
        }
    }

    /// One pass a level: drawn from the level below it, then copied to its place.
    fn build(
        &self,
        shaders: &ShaderLibrary,
        image: &Arc<Image>,
        layer: u32,
        (bound, cover): (Bound, Cover),
    ) -> Result<(), Error> {
        let device = shaders.device();
        let target = image.layer(layer)?;
        let mut recorder = Recorder::new(device)?;
        for shift in 1..=self.shape.top {
            let (from, source) = if shift == 1 { (DATA, (0, 0)) } else { (layer, self.shape.origin(shift - 1)) };
            let (columns, rows) = self.shape.level(shift - 1);
            let finer = image.layer_array(from)?;
            let (width, height) = self.shape.level(shift);
            let desc = ImageDesc::new_2d(target.image().name(), target.image().desc().format, width, height);
            let level = Image::new(device, desc.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT))?.view()?;
            let pass = Pass::graphics("pyramid", "3", "common/fullscreen.vert", "terrain/pyramid.frag")
                .with("finer", &finer)
                .constants::<Level>()
                .color(&level, Load::Discard, Blend::Replace)
                .build(shaders)?;
            let [before, after] = if shift == 1 { cover.more().map(|nodes| nodes as i32) } else { [0, 0] };
            let constants = Level {
                origin: [source.0 as i32, source.1 as i32],
                last: [columns as i32 - 1, rows as i32 - 1],
                is_float: self.is_float.into(),
                is_lowest: (bound == Bound::Lowest).into(),
                before,
                after,
            };
            recorder.run(Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.constants(&constants).vertices(3)))?;
            copy_rectangle(device, &level, &target, self.shape.origin(shift), (width, height))?;
        }
        Ok(())
    }
}

fn copy_samples<T: bytemuck::Pod>(samples: &[T], rows: &mut [u8]) {
    let bytes: &[u8] = bytemuck::cast_slice(samples);
    rows.copy_from_slice(&bytes[..rows.len()]);
}

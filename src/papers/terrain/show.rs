//! The pass `show`: the processor's picture and depth in images, for whoever reads pictures from the device.

use std::sync::Arc;

use ash::vk;
use glam::Vec4;

use super::hit::Hit;
use super::stage::{Build, VECTOR};
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, ImageView, Load, Location, Pass};
use crate::host_block;
use crate::measure::Target;

host_block! {
    struct Size {
        /// Pixels of a row.
        columns: u32,
    }
}

/// The pass, and copies of the processor's targets that the device can read.
pub struct Show {
    depths: Arc<Buffer>,
    normals: Arc<Buffer>,
    colors: Arc<Buffer>,
    /// 8-bit sRGB.
    pub picture: Arc<ImageView>,
    /// A [`Hit`] of each pixel.
    pub depth: Arc<ImageView>,
    pass: Pass,
    size: Size,
}

impl Show {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>) -> Result<Self, Error> {
        let Build { shaders, label, parameters, .. } = *build;
        let buffer = |name: &str, pixel_bytes: usize| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let desc = BufferDesc::new(format!("{label}/{name}"), (parameters.pixels() * pixel_bytes) as u64);
            Buffer::new(shaders.device(), desc.usage(usage).location(Location::Upload))
        };
        let colors = buffer("colors", 4)?;
        let picture = build.image("picture", vk::Format::R8G8B8A8_UNORM)?;
        let depth = build.image("depth", VECTOR)?;
        let depths = buffer("depth", 16)?;
        let pass = Pass::graphics("show", "4", "common/fullscreen.vert", "terrain/show.frag")
            .with("colors", &colors)
            .with("depths", &depths)
            .constants::<Size>()
            .color(&picture, Load::Discard, Blend::Replace)
            .color(&depth, Load::Discard, Blend::Replace)
            .build(shaders)?;
        let normals = buffer("normal", 16)?;
        let size = Size { columns: parameters.width };
        Ok(Show { depths, normals, colors, picture, depth, pass, size })
    }

    /// Puts the targets where the device can read them, and draws picture and depth into images.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &self,
        frame: &mut Frame<'_>,
        (hits, normals, colors): (&[Hit], &[Vec4], &[[u8; 4]]),
    ) -> Result<(), Error> {
        let depths: Vec<[f32; 4]> = hits.iter().map(|hit| hit.to_texel()).collect();
        self.depths.write(0, bytemuck::cast_slice(&depths))?;
        self.normals.write(0, bytemuck::cast_slice(normals))?;
        self.colors.write(0, bytemuck::cast_slice(colors))?;
        frame.graphics(&self.pass, |draw| draw.constants(&self.size).vertices(3))
    }

    /// The processor's depth and normal.
    pub fn targets(&self) -> Vec<Target> {
        vec![
            Target::table("depth", &self.depths, 4)
                .of("depth along the view in metres, place on the map in two coordinates, code of the surface"),
            Target::table("normal", &self.normals, 4).of("x, y, z of the unit normal"),
        ]
    }
}

//! A picture on the object, by the texture coordinates of its corners: the dissertation's objects have textures that it does not name.

use std::sync::Arc;

use ash::vk;

use crate::gpu::transfer::{upload, upload_rows};
use crate::gpu::{Buffer, Error, Image, ImageDesc, ImageView, ShaderLibrary};
use crate::host_block;

/// A picture with its smaller versions, each half as large as the one before it, down to one texel.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The picture itself first; at least one.
    pub levels: Vec<Level>,
}

/// One size of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    pub width: u32,
    pub height: u32,
    /// 8-bit sRGB and an alpha that is not looked at, the top row first.
    pub texels: Vec<u8>,
}

host_block! {
    /// A level of the texture in the image that holds all of them (`burning/draw-textured.frag`), texels.
    pub(super) struct TextureLevel {
        width: u32,
        height: u32,
        first_row: u32,
        level_count: u32,
    }
}

/// The buffers and the image of a texture.
pub struct Surface {
    /// All levels below one another, 8-bit sRGB: the shader filters by itself, so that every device draws the same.
    pub texels: Arc<ImageView>,
    /// [`TextureLevel`] of each.
    pub levels: Arc<Buffer>,
    /// vec2\[C\] for C draw vertices: they stay apart where the simulated vertices are welded.
    pub coordinates: Arc<Buffer>,
}

impl Surface {
    /// Uploads `texture` and the coordinates of the draw vertices.
    ///
    /// # Errors
    /// [`Error::Limit`] for a picture that is too large for the device; what Vulkan answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        texture: &Texture,
        coordinates: &[[f32; 2]],
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let level_count = texture.levels.len() as u32;
        let mut first_row = 0;
        let mut levels: Vec<TextureLevel> = Vec::new();
        for &Level { width, height, .. } in &texture.levels {
            levels.push(TextureLevel { width, height, first_row, level_count });
            first_row += height;
        }
        let width = texture.levels[0].width;
        let desc = ImageDesc::new_2d(format!("{label}/texture"), vk::Format::R8G8B8A8_SRGB, width, first_row);
        let texels = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        let row_bytes = 4 * width as usize;
        upload_rows(device, &texels, (width, first_row), |first_row, bytes| {
            for (row, bytes) in (first_row..).zip(bytes.chunks_exact_mut(row_bytes)) {
                let at = levels.partition_point(|level| level.first_row <= row) - 1;
                let from = &texture.levels[at].texels;
                let own_bytes = 4 * texture.levels[at].width as usize;
                let first = (row - levels[at].first_row) as usize * own_bytes;
                // Nothing to the right of a smaller level is read.
                bytes.fill(0);
                bytes[..own_bytes].copy_from_slice(&from[first..first + own_bytes]);
            }
        })?;
        Ok(Surface {
            texels,
            levels: upload(device, &format!("{label}/texture-levels"), storage, bytemuck::cast_slice(&levels))?,
            coordinates: upload(
                device,
                &format!("{label}/texture-coordinates"),
                storage,
                bytemuck::cast_slice(coordinates),
            )?,
        })
    }
}

//! A picture on the object, by the texture coordinates of its corners: the dissertation's objects have textures that it does not name.

use std::sync::Arc;

use ash::vk;

use crate::gpu::transfer::{upload, upload_rows};
use crate::gpu::{Buffer, Error, Image, ImageDesc, ImageView, ShaderLibrary};

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

/// What the shaders read of a texture.
pub struct Surface {
    /// All levels below one another, 8-bit sRGB: the shader filters by itself, so that every device draws the same.
    pub texels: Arc<ImageView>,
    /// uvec4 of each level: width, height, first row in the image, number of levels.
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
        let mut height = 0;
        let mut levels: Vec<[u32; 4]> = Vec::new();
        for level in &texture.levels {
            levels.push([level.width, level.height, height, level_count]);
            height += level.height;
        }
        let width = texture.levels[0].width;
        let desc = ImageDesc::new_2d(format!("{label}/texture"), vk::Format::R8G8B8A8_SRGB, width, height);
        let texels = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        let row_bytes = 4 * width as usize;
        upload_rows(device, &texels, (width, height), |first_row, bytes| {
            for (row, bytes) in (first_row..).zip(bytes.chunks_exact_mut(row_bytes)) {
                let at = levels.partition_point(|[_, _, first_row, _]| *first_row <= row) - 1;
                let from = &texture.levels[at].texels;
                let own_bytes = 4 * texture.levels[at].width as usize;
                let first = (row - levels[at][2]) as usize * own_bytes;
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

//! The rock texture of section 7.2: one that we make, or texels that the caller decoded from a file.

use std::sync::Arc;

use ash::vk;

use super::targets::Context;
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Error, ImageView};
use crate::image::{self, Rgba8};
use crate::measure::ParameterError;

/// Texels of a rock, rows from the top, sRGB with an alpha that is ignored. It repeats in both directions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rock {
    /// Texels a row, 2 to 4096.
    pub width: u32,
    /// Rows, 2 to 4096.
    pub height: u32,
    /// `width` x `height`.
    pub texels: Vec<[u8; 4]>,
}

impl Rock {
    /// Most texels a side.
    pub const MAX_SIDE: u32 = 4096;

    /// Checks that it is a texture.
    ///
    /// # Errors
    /// A size outside 2 to 4096 texels a side, or another number of texels.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let sides = 2..=Self::MAX_SIDE;
        let is_sized = sides.contains(&self.width) && sides.contains(&self.height);
        if is_sized && self.texels.len() as u64 == u64::from(self.width) * u64::from(self.height) {
            return Ok(());
        }
        Err(ParameterError {
            name: "rock",
            value: format!("{}x{}", self.width, self.height),
            range: "must have 2 to 4096 texels a side".to_owned(),
        })
    }

    /// The texels as an opaque picture.
    ///
    /// # Errors
    /// Another number of texels than width and height say.
    pub fn picture(&self) -> Result<Rgba8, image::Error> {
        let texels = self.texels.iter().flat_map(|&[r, g, b, _]| [r, g, b, 255]).collect();
        Rgba8::new(self.width, self.height, texels)
    }

    /// The rock on the device, with a border of one texel that repeats the opposite side, so
    /// that a filter finds its neighbours across the seam.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub(super) fn load(&self, context: Context<'_>) -> Result<Arc<ImageView>, Error> {
        let image = context.target("rock", vk::Format::R8G8B8A8_UNORM, self.width + 2, self.height + 2)?;
        let wrapped = |at: u32, count: u32| (at + count - 1) % count;
        upload_rows(context.device(), &image, (image.width(), image.height()), |first_row, bytes| {
            let rows = bytes.chunks_exact_mut(4 * image.width() as usize);
            for (row, bytes) in (first_row..).zip(rows) {
                let from = (wrapped(row, self.height) * self.width) as usize;
                for (column, texel) in (0..).zip(bytes.chunks_exact_mut(4)) {
                    let at = from + wrapped(column, self.width) as usize;
                    texel.copy_from_slice(&self.texels.get(at).copied().unwrap_or_default());
                }
            }
        })?;
        Ok(image)
    }
}

//! Textures of the particles in the order of their cells.

use std::sync::Arc;

use ash::vk;

use super::super::targets::{Context, FLOATS};
use crate::gpu::{Error, Image, ImageDesc, ImageView};
use crate::papers::texels::ROW;

/// One with a texel for each particle.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn texture(context: Context<'_>, name: &str, particles: u32) -> Result<Arc<ImageView>, Error> {
    texture_of_rows(context, name, particles.div_ceil(ROW))
}

/// One of so many rows.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn texture_of_rows(context: Context<'_>, name: &str, rows: u32) -> Result<Arc<ImageView>, Error> {
    let desc = ImageDesc::new_2d(context.name(name), FLOATS, ROW, rows);
    let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
    Image::new(context.device(), desc.usage(usage)).map_err(|error| error.set_by("particles"))?.view()
}

//! Formats and clear values that the stages share.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{Error, Image, ImageDesc, ImageView, Load, ShaderLibrary};

/// Positions, velocities, densities and sums: all of them are added up or compared at full precision.
pub const FLOATS: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

pub const ZERO: Load = Load::Clear([0.0; 4]);
pub const FAR: Load = Load::Clear([1.0, 0.0, 0.0, 0.0]);

/// What an image that is attached and fetched is made from.
pub fn desc(name: String, format: vk::Format, width: u32, height: u32) -> ImageDesc {
    let attachment = if format == DEPTH {
        vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT
    } else {
        vk::ImageUsageFlags::COLOR_ATTACHMENT
    };
    ImageDesc::new_2d(name, format, width, height).usage(attachment | vk::ImageUsageFlags::SAMPLED)
}

/// An image that is attached and fetched.
///
/// # Errors
/// [`Error::Limit`] for a size that the device does not allow.
pub fn target(
    shaders: &ShaderLibrary,
    name: String,
    format: vk::Format,
    width: u32,
    height: u32,
) -> Result<Arc<ImageView>, Error> {
    Image::new(shaders.device(), desc(name, format, width, height))?.view()
}

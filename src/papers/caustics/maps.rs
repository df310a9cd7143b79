//! Formats and clear values that the methods share, so that their times and memory differ by method alone.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use crate::gpu::{Error, Image, ImageDesc, ImageView, Load, ShaderLibrary};

/// Heights: full precision, since a cell decides by comparing them.
pub const POSITION: vk::Format = vk::Format::R32_SFLOAT;
/// I_c: added up from many triangles; a half float would lose the dim ones beside the bright.
pub const CAUSTICS: vk::Format = vk::Format::R32_SFLOAT;
/// I_d, the slices and the combined map: linear colour, above 1 where light is focused.
pub const LIGHT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// The height of a texel without a receiver: below every cell, so that no plane accepts it.
pub const BACKGROUND: Load = Load::Clear([-1.0e30, 0.0, 0.0, 0.0]);
/// Nothing there, no light.
pub const BLACK: Load = Load::Clear([0.0; 4]);
pub const FAR: Load = Load::Clear([1.0, 0.0, 0.0, 0.0]);

/// A square map, attached and fetched.
///
/// # Errors
/// [`Error::Limit`] for a size that the device does not allow.
pub fn map(
    shaders: &ShaderLibrary,
    name: String,
    format: vk::Format,
    parameters: &Parameters,
) -> Result<Arc<ImageView>, Error> {
    let image = Image::new(shaders.device(), map_desc(name, format, parameters));
    image.map_err(|error| error.set_by("--map-size"))?.view()
}

/// What a square map is made from.
pub fn map_desc(name: String, format: vk::Format, parameters: &Parameters) -> ImageDesc {
    let attachment = if format == DEPTH {
        vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT
    } else {
        vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED
    };
    ImageDesc::new_2d(name, format, parameters.map_size, parameters.map_size).usage(attachment)
}

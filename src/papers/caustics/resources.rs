//! Formats, clear values and images that the variants share, so that their times and memory differ by method alone.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Device, Error, Image, ImageDesc, ImageView, Load, Sampler, ShaderLibrary};

/// Heights: full precision, since a cell decides by comparing them.
pub const POSITION: vk::Format = vk::Format::R32_SFLOAT;
/// I_c: added up from many triangles; a half float would lose the dim ones beside the bright.
pub const CAUSTICS: vk::Format = vk::Format::R32_SFLOAT;
/// I_d, the slices and the combined map: linear colour, above 1 where light is focused.
pub const LIGHT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// Depth alone.
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
/// Depth and stencil; 32 bits of depth, since some devices lack 24.
pub const DEPTH_STENCIL: vk::Format = vk::Format::D32_SFLOAT_S8_UINT;

/// The height of a texel without a receiver: below every cell, so that no plane accepts it.
pub const BACKGROUND: Load = Load::Clear([-1.0e30, 0.0, 0.0, 0.0]);
/// Nothing there, no light.
pub const BLACK: Load = Load::Clear([0.0; 4]);
/// Depth of the far plane.
pub const FAR: Load = Load::Clear([1.0, 0.0, 0.0, 0.0]);
/// Light scattered back by deep water, linear RGB: the colour of pixels without a receiver.
pub const DEEP_WATER: Load = Load::Clear([0.004, 0.030, 0.055, 1.0]);

/// An image that is drawn to and fetched from.
pub const COLOR_MAP: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw() | vk::ImageUsageFlags::SAMPLED.as_raw(),
);

/// Everything that passes are made from.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Compiled shaders, and their device.
    pub shaders: &'a ShaderLibrary,
    /// Prefix of the resources' names.
    pub label: &'a str,
    /// The configuration.
    pub parameters: &'a Parameters,
    /// A sampler that filters nothing.
    pub nearest: &'a Arc<Sampler>,
}

impl<'a> Context<'a> {
    pub fn device(&self) -> &'a Arc<Device> {
        self.shaders.device()
    }

    /// The full name of a resource.
    pub fn name(&self, resource: &str) -> String {
        format!("{}/{resource}", self.label)
    }

    /// A buffer that holds these bytes.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn upload(&self, name: &str, usage: vk::BufferUsageFlags, bytes: &[u8]) -> Result<Arc<Buffer>, Error> {
        upload(self.device(), &self.name(name), usage, bytes)
    }

    /// An image of the picture's size.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn image(&self, name: &str, format: vk::Format, usage: vk::ImageUsageFlags) -> Result<Arc<Image>, Error> {
        let desc = ImageDesc::new_2d(self.name(name), format, self.parameters.width, self.parameters.height);
        Image::new(self.device(), desc.usage(usage)).map_err(|error| error.set_by("size"))
    }

    /// A square map, attached and fetched.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn map(&self, name: &str, format: vk::Format) -> Result<Arc<ImageView>, Error> {
        let image = Image::new(self.device(), self.map_desc(name, format));
        image.map_err(|error| error.set_by("map-size"))?.view()
    }

    /// A square map of the [coverage](Parameters::coverage)'s multiple of a map's size.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn multiple_of_map(&self, name: &str, format: vk::Format) -> Result<Arc<ImageView>, Error> {
        let texels = self.parameters.map_size.saturating_mul(self.parameters.coverage);
        let desc = ImageDesc::new_2d(self.name(name), format, texels, texels).usage(COLOR_MAP);
        Image::new(self.device(), desc).map_err(|error| error.set_by("coverage"))?.view()
    }

    /// Description of a square map.
    pub fn map_desc(&self, name: &str, format: vk::Format) -> ImageDesc {
        let usage = if format == DEPTH { vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT } else { COLOR_MAP };
        ImageDesc::new_2d(self.name(name), format, self.parameters.map_size, self.parameters.map_size).usage(usage)
    }
}

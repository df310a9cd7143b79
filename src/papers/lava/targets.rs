//! Formats, clear values and images that the passes share.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Device, Error, Image, ImageDesc, ImageView, Load, ShaderLibrary};

/// Positions, velocities, densities and sums: all of them are added up or compared at full precision.
pub const FLOATS: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
/// Depth alone.
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// Nothing added yet.
pub const ZERO: Load = Load::Clear([0.0; 4]);
/// Depth of the far plane.
pub const FAR: Load = Load::Clear([1.0, 0.0, 0.0, 0.0]);

/// The empty fragment stage of the passes in [`FLOORS`](super::FLOORS).
pub const EMPTY: &str = "common/empty.frag";

/// Everything that passes are made from.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Compiled shaders, and their device.
    pub shaders: &'a ShaderLibrary,
    /// Prefix of the resources' names.
    pub label: &'a str,
    /// The configuration.
    pub parameters: &'a Parameters,
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

    /// Description of an image that is attached and fetched.
    pub fn desc(&self, name: &str, format: vk::Format, width: u32, height: u32) -> ImageDesc {
        let attachment = if format == DEPTH {
            vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT
        } else {
            vk::ImageUsageFlags::COLOR_ATTACHMENT
        };
        let usage = attachment | vk::ImageUsageFlags::SAMPLED;
        ImageDesc::new_2d(self.name(name), format, width, height).usage(usage)
    }

    /// An image that is attached and fetched.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn target(&self, name: &str, format: vk::Format, width: u32, height: u32) -> Result<Arc<ImageView>, Error> {
        Image::new(self.device(), self.desc(name, format, width, height))?.view()
    }

    /// A target with a texel for each grid point of a plane (section 6.1).
    ///
    /// # Errors
    /// As [`Context::target`].
    pub fn grid_target(&self, name: &str) -> Result<Arc<ImageView>, Error> {
        let [columns, _, rows] = self.parameters.density;
        self.target(name, FLOATS, columns, rows)
    }
}

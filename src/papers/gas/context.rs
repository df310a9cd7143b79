//! The context in which every pass and resource of one configuration is made.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use crate::gpu::{Buffer, BufferDesc, Error, Image, ImageDesc, ImageView, ShaderLibrary};

/// Shaders, label and parameters of one configuration.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Shaders, and the device.
    pub shaders: &'a ShaderLibrary,
    /// Goes before the names of the resources.
    pub label: &'a str,
    /// Numbers of the configuration.
    pub parameters: &'a Parameters,
}

impl Context<'_> {
    /// The name of a resource.
    pub fn name(&self, name: &str) -> String {
        format!("{}/{name}", self.label)
    }

    /// A storage buffer of `count` elements of type `T`.
    ///
    /// # Errors
    /// [`Error::Limit`] for more than the device binds.
    pub fn storage<T>(&self, name: &str, count: u64) -> Result<Arc<Buffer>, Error> {
        let desc = BufferDesc::new(self.name(name), count * size_of::<T>() as u64);
        Buffer::new(self.shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
    }

    /// `count` tables of the parameters' size, of each entry its own value and that of the one after it in x.
    ///
    /// # Errors
    /// [`Error::Limit`] for more than the device binds.
    pub fn table(&self, name: &str, count: u64) -> Result<Arc<Buffer>, Error> {
        let entries = u64::from(self.parameters.table_size).pow(3);
        self.storage::<[f32; 2]>(name, entries * count).map_err(|error| error.set_by("table"))
    }

    /// An image of the picture's size.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn image(&self, name: &str, format: vk::Format, usage: vk::ImageUsageFlags) -> Result<Arc<ImageView>, Error> {
        let desc = ImageDesc::new_2d(self.name(name), format, self.parameters.width, self.parameters.height);
        Image::new(self.shaders.device(), desc.usage(usage)).map_err(|error| error.set_by("size"))?.view()
    }

    /// A three-dimensional image of the parameters' froxels, four floats each.
    ///
    /// # Errors
    /// [`Error::Limit`] for more froxels than the device holds.
    pub fn froxels(&self, name: &str) -> Result<Arc<ImageView>, Error> {
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let desc = ImageDesc::new_3d(self.name(name), format, self.parameters.froxels);
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        Image::new(self.shaders.device(), desc.usage(usage)).map_err(|error| error.set_by("froxels"))?.view()
    }
}

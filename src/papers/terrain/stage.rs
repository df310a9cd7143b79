//! A program over all pixels, by compute stages or as full-screen fragment passes.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use crate::gpu::bindings::Resource;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};

/// The stages that a device offers for one program over all pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    Compute,
    Fragment,
}

impl Stage {
    fn file(self, program: &str) -> String {
        format!("terrain/{program}.{}", if self == Stage::Compute { "comp" } else { "frag" })
    }

    fn usage(self) -> vk::ImageUsageFlags {
        // Polygons are drawn into what compute stages wrote.
        let written = match self {
            Stage::Compute => vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::COLOR_ATTACHMENT,
            Stage::Fragment => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        written | vk::ImageUsageFlags::SAMPLED
    }

    /// An image of the picture's size that this stage writes and later passes read.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn image(
        self,
        shaders: &ShaderLibrary,
        name: String,
        format: vk::Format,
        parameters: &Parameters,
    ) -> Result<Arc<ImageView>, Error> {
        let desc = ImageDesc::new_2d(name, format, parameters.width, parameters.height).usage(self.usage());
        Image::new(shaders.device(), desc)?.view()
    }

    /// Records `pass` over all pixels of `target`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(self, frame: &mut Frame<'_>, pass: &Pass, target: &ImageView) -> Result<(), Error> {
        match self {
            Stage::Compute => frame.compute(pass, |dispatch| {
                dispatch.threads(target.width(), target.height(), 1);
            }),
            Stage::Fragment => frame.graphics(pass, |draw| {
                draw.vertices(3);
            }),
        }
    }

    /// A pass for either stage: `program` over all pixels of `target`, which compute stages know by the pass's name.
    pub fn pass(
        self,
        (name, section): (&'static str, &'static str),
        program: &str,
        (target, load): (&Arc<ImageView>, Load),
        resources: &[(&'static str, Resource)],
    ) -> PassBuilder {
        let pass = match self {
            Stage::Compute => Pass::compute(name, section, &self.file(program)).with(name, target),
            Stage::Fragment => Pass::graphics(name, section, "common/fullscreen.vert", &self.file(program)).color(
                target,
                load,
                Blend::Replace,
            ),
        };
        resources.iter().fold(pass, |pass, (name, resource)| pass.with(name, resource.clone()))
    }
}

/// A depth buffer of the picture's size.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn depth_buffer(shaders: &ShaderLibrary, name: String, parameters: &Parameters) -> Result<Arc<ImageView>, Error> {
    let desc = ImageDesc::new_2d(name, vk::Format::D32_SFLOAT, parameters.width, parameters.height);
    Image::new(shaders.device(), desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT))?.view()
}

//! A program over all pixels, by compute stages or as full-screen fragment passes.

use std::sync::Arc;

use ash::vk;

use crate::gpu::bindings::Resource;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Device, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};

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

    /// An image that this stage writes and later passes read.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn image(
        self,
        device: &Arc<Device>,
        name: String,
        format: vk::Format,
        (width, height): (u32, u32),
    ) -> Result<Arc<ImageView>, Error> {
        Image::new(device, ImageDesc::new_2d(name, format, width, height).usage(self.usage()))?.view()
    }

    /// Records `pass` over all pixels of `target`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
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

    /// One sentence for both: `program` over all pixels of `target`, which compute stages know by the pass's name.
    pub fn say(
        self,
        (name, section): (&'static str, &'static str),
        program: &str,
        (target, load): (&Arc<ImageView>, Load),
        resources: &[(&'static str, Resource)],
    ) -> PassBuilder {
        let sentence = match self {
            Stage::Compute => Pass::compute(name, section, &self.file(program)).with(name, target),
            Stage::Fragment => Pass::graphics(name, section, "common/fullscreen.vert", &self.file(program)).color(
                target,
                load,
                Blend::Replace,
            ),
        };
        resources.iter().fold(sentence, |sentence, (name, resource)| sentence.with(name, resource.clone()))
    }
}

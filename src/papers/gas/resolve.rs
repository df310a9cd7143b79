//! `resolve`: the visible fragments, shaded and blended front to back (section "Combining A-buffer and volume rendering
//! techniques").

use std::sync::Arc;

use ash::vk;

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::blocks::SectionBlock;
use super::context::Context;
use super::scene_buffers::SceneBuffers;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, ImageView, Pass};

/// The pass `resolve`.
pub struct Resolve {
    /// Linear RGB, and the opacity of all fragments together.
    pub radiance: Arc<ImageView>,
    pass: Pass,
}

impl Resolve {
    /// Sections and attenuations where the variant has them.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        sections: Option<&Arc<Buffer>>,
        attenuations: Option<&Arc<Buffer>>,
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        let radiance = context.image("radiance", vk::Format::R32G32B32A32_SFLOAT, usage)?;
        // A binding needs a buffer where the variant has none; nothing reads it.
        let or_unread = |buffer: Option<&Arc<Buffer>>, name: &str| match buffer {
            Some(buffer) => Ok(buffer.clone()),
            None => upload(
                context.shaders.device(),
                &context.name(name),
                vk::BufferUsageFlags::STORAGE_BUFFER,
                &[0; size_of::<SectionBlock>()],
            ),
        };
        let has_veins = scene.has_veins();
        let shader = match (has_veins, context.parameters.lights.len()) {
            (false, 1) => "gas/resolve-none-one.comp",
            (false, _) => "gas/resolve-none-several.comp",
            (true, 1) => "gas/resolve-solid-one.comp",
            (true, _) => "gas/resolve-solid-several.comp",
        };
        let pass = Pass::compute("resolve", "A-buffer", shader);
        let pass = if has_veins { scene.solid_textures(pass) } else { pass };
        let pass = pass
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Lights", &scene.lights)
            .with("Objects", &scene.objects)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Pixels", &lists.pixels)
            .with("Sections", &or_unread(sections, "no sections")?)
            .with("Attenuations", &or_unread(attenuations, "no attenuations")?)
            .with("radiance", &radiance)
            .with("Progress", &lists.progress.states)
            .with("Unfinished", &lists.progress.unfinished)
            .constants::<BandConstants>()
            .build(context.shaders)?;
        Ok(Resolve { radiance, pass })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        band.dispatch_times(calls, frame, &self.pass)
    }
}

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
    /// The same for pixels that one dispatch does not finish.
    rest: Pass,
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
        let veins = if has_veins { "solid" } else { "none" };
        let count = if context.parameters.lights.len() == 1 { "one" } else { "several" };
        let (sections, attenuations) =
            (or_unread(sections, "no sections")?, or_unread(attenuations, "no attenuations")?);
        let pass_of = |shader: &str| {
            let pass = Pass::compute("resolve", "A-buffer", &format!("gas/{shader}-{veins}-{count}.comp"));
            let pass = if has_veins { scene.solid_textures(pass) } else { pass };
            pass.with("frame", &scene.frame)
                .with("counts", &scene.counts)
                .with("Lights", &scene.lights)
                .with("Objects", &scene.objects)
                .with("Heads", &lists.heads)
                .with("Links", &lists.links)
                .with("Surfaces", &lists.surfaces)
                .with("Colors", &lists.colors)
                .with("Pixels", &lists.pixels)
                .with("Sections", &sections)
                .with("Attenuations", &attenuations)
                .with("radiance", &radiance)
                .with("Progress", &lists.progress.states)
                .with("Unfinished", &lists.progress.unfinished)
                .constants::<BandConstants>()
                .build(context.shaders)
        };
        let [pass, rest] = Pass::steps([pass_of("resolve")?, pass_of("resolve-rest")?]);
        Ok(Resolve { radiance, pass, rest })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        band.dispatch_call(0, calls, frame, &self.pass)?;
        (1..calls).try_for_each(|call| band.dispatch_call(call, calls, frame, &self.rest))
    }
}

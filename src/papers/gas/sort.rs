//! `sort`: each pixel's list by depth, the depth at which its tracing ends, the slots of the sections to come, and the pixels
//! that have some.

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::context::Context;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Error, Frame, Pass};

/// The pass `sort`.
pub struct Sort {
    pass: Pass,
}

impl Sort {
    /// Sections are counted of the volumes that are marched, `volume_count`.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        volume_count: usize,
    ) -> Result<Self, Error> {
        let shader = if volume_count == 1 { "gas/sort-one.comp" } else { "gas/sort-several.comp" };
        let pass = Pass::compute("sort", "A-buffer", shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Counters", &lists.counters)
            .with("Pixels", &lists.pixels)
            .with("Progress", &lists.progress.states)
            .with("Unfinished", &lists.progress.unfinished)
            .with("GasPixels", &lists.gas_pixels)
            .constants::<BandConstants>()
            .build(context.shaders)?;
        Ok(Sort { pass })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        band.dispatch_times(calls, frame, &self.pass)
    }
}

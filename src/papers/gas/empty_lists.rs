//! `empty-lists`: every pixel's list is empty; the most that a band before has wanted is kept for the host.

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::context::Context;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Error, Frame, Pass};

/// The pass `empty-lists`.
pub struct EmptyLists {
    pass: Pass,
}

impl EmptyLists {
    /// # Errors
    /// Those of Vulkan.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, lists: &ABuffer) -> Result<Self, Error> {
        let pass = Pass::compute("empty-lists", "A-buffer", "gas/empty-lists.comp")
            .with("frame", &scene.frame)
            .with("Heads", &lists.heads)
            .with("Counters", &lists.counters)
            .with("GasPixels", &lists.gas_pixels)
            .constants::<BandConstants>()
            .build(context.shaders)?;
        Ok(EmptyLists { pass })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        band.dispatch(frame, &self.pass)
    }
}

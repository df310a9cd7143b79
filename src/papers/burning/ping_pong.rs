//! Compute passes about buffers that swap with every tick: what one tick writes the next one reads.

use std::sync::Arc;

use super::chunks::ChunkCount;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};

/// A binding's name with its buffer for each ping-pong index of the tick.
pub type Swapped<'a> = (&'static str, [&'a Arc<Buffer>; 2]);

/// The buffer of a pair that the tick writes, under the name of a binding.
pub fn new<'a>(name: &'static str, [even, odd]: &'a [Arc<Buffer>; 2]) -> Swapped<'a> {
    (name, [even, odd])
}

/// The buffer of a pair that the last tick wrote, under the name of a binding.
pub fn old<'a>(name: &'static str, [even, odd]: &'a [Arc<Buffer>; 2]) -> Swapped<'a> {
    (name, [odd, even])
}

/// One pass for each ping-pong index, with one pipeline.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn build(shaders: &ShaderLibrary, pass: PassBuilder, swapped: &[Swapped<'_>]) -> Result<[Pass; 2], Error> {
    let even = swapped.iter().fold(pass, |pass, &(name, [buffer, _])| pass.with(name, buffer)).build(shaders)?;
    if swapped.is_empty() {
        return Ok([even.clone(), even]);
    }
    let odd = swapped.iter().fold(even.rebind(), |pass, &(name, [_, buffer])| pass.with(name, buffer));
    Ok([even, odd.build(shaders)?])
}

/// The threads of a dispatch.
#[derive(Clone, Copy)]
pub enum Work {
    /// For so many elements.
    Elements(u32),
    /// By the pass's indirect buffer.
    Indirect,
    /// The one workgroup that lists chunks, of so many.
    Lists(ChunkCount),
}

/// The dispatches of a pass in order, for each ping-pong index of the tick.
pub struct PingPong<const STEPS: usize> {
    passes: [[Pass; STEPS]; 2],
    work: [Work; STEPS],
}

impl<const STEPS: usize> PingPong<STEPS> {
    /// One pass to the paper, of steps with their threads.
    pub fn new(steps: [([Pass; 2], Work); STEPS]) -> Self {
        let passes = [0, 1].map(|tick| Pass::steps(steps.each_ref().map(|(passes, _)| passes[tick].clone())));
        PingPong { passes, work: steps.map(|(_, work)| work) }
    }

    /// Records the steps of the tick that writes the buffers of index `tick`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: usize) -> Result<(), Error> {
        self.record_as(frame, tick, self.work)
    }

    /// As [`PingPong::record`], by these threads.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record_as(&self, frame: &mut Frame<'_>, tick: usize, work: [Work; STEPS]) -> Result<(), Error> {
        self.passes[tick].iter().zip(work).try_for_each(|(pass, work)| {
            frame.compute(pass, |dispatch| {
                match work {
                    Work::Elements(count) => dispatch.elements(count),
                    Work::Indirect => dispatch.groups_indirect(),
                    Work::Lists(count) => dispatch.constants(&count).threads(1, 1, 1),
                };
            })
        })
    }
}

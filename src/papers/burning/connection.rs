//! Connectivity (3.5.4): consumed triangles leave unless something would come off. Part of `surface-removal`; the search
//! is that of [`parts`](super::parts), without some of the consumed ones.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::model::{Model, roots_of};
use super::parts::{Progress, SEARCH_TICKS, Touches};
use super::ping_pong::{self, new};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};

/// Steps of the search and its end.
pub const STEPS: usize = 7;
/// Numbers of a vertex and of a triangle; what a restart brings back is there twice.
pub(super) const NUMBERS_OF_VERTEX: u32 = 3 * 2 + 1;
pub(super) const NUMBERS_OF_TRIANGLE: u32 = 2;

/// The search for what hangs together.
pub struct Connection {
    /// uint\[T\]: 2 where the search does without a triangle that is there, 1 where it has left.
    pub held: Arc<Buffer>,
    vertex_count: u32,
    triangle_count: u32,
}

impl Connection {
    /// Makes the steps for each ping-pong index of the tick.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        buffers: &mut Buffers,
        model: &Model,
    ) -> Result<(Self, [[Pass; STEPS]; 2]), Error> {
        let list = |name: &str, list: &[u32]| -> Result<Arc<Buffer>, Error> {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(shaders.device(), &format!("{label}/{name}"), usage, bytemuck::cast_slice(list))
        };
        let (vertex_count, triangle_count) = (model.vertex_count(), model.triangle_count());
        let roots = list("roots", &(0..vertex_count).collect::<Vec<_>>())?;
        let attached = list("attached", &vec![0; vertex_count as usize])?;
        let held = list("held", &vec![0; triangle_count as usize])?;
        let pieces = list("pieces", &vec![0; vertex_count as usize])?;
        let origins = list("origins", &roots_of(vertex_count as usize, &model.triangles))?;
        let progress = Progress { is_numbered: 1, ..Progress::default() };
        let progress = list("connection-progress", bytemuck::cast_slice(&[progress]))?;
        // What touches another part of the mesh does not hold it here: a pair is there, as a buffer may not be empty.
        let touching = list("touching", &[0, 0])?;
        for buffer in [&roots, &attached, &held, &pieces, &progress] {
            buffers.keep(shaders, buffer)?;
        }
        let step = |shader: &str| {
            Pass::compute("surface-removal", "3.5.4", &format!("burning/{shader}.comp"))
                .with("constants", &buffers.constants)
        };
        let searched = |shader: &str| step(shader).with("Searching", &progress);
        let state = new("NewState", &buffers.states);
        let reset = searched("parts-reset").with("Roots", &roots).with("Attached", &attached).build(shaders)?;
        let choice = searched("connection-choice")
            .with("Flammabilities", &buffers.flammabilities)
            .with("Triangles", &buffers.triangles)
            .with("Removed", &buffers.removed)
            .with("Clock", &buffers.clock)
            .with("Held", &held)
            .with("Pieces", &pieces);
        let choice = ping_pong::build(shaders, choice, &[state])?;
        let unite = step("parts-unite")
            .constants::<Touches>()
            .with("Triangles", &buffers.triangles)
            .with("Removed", &held)
            .with("Roots", &roots)
            .with("Touching", &touching);
        let unite = ping_pong::build(shaders, unite, &[state])?;
        let flatten = searched("parts-flatten").with("Roots", &roots).build(shaders)?;
        let check = searched("parts-check")
            .with("Triangles", &buffers.triangles)
            .with("Removed", &held)
            .with("Roots", &roots)
            .with("Attached", &attached)
            .build(shaders)?;
        let count = searched("connection-pieces")
            .with("Roots", &roots)
            .with("Attached", &attached)
            .with("Pieces", &pieces)
            .with("Origins", &origins)
            .build(shaders)?;
        let leave = searched("connection")
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("Removed", &buffers.removed)
            .with("Clock", &buffers.clock)
            .with("Roots", &roots)
            .with("Attached", &attached)
            .with("Held", &held)
            .with("Pieces", &pieces)
            .with("Origins", &origins)
            .with("Touched", &buffers.touched)
            .build(shaders)?;
        let steps = [0, 1].map(|tick| {
            let [choice, unite] = [&choice, &unite].map(|passes| passes[tick].clone());
            [reset.clone(), choice, unite, flatten.clone(), check.clone(), count.clone(), leave.clone()]
        });
        Ok((Connection { held, vertex_count, triangle_count }, steps))
    }

    /// Records the part of the search that belongs to `tick`, the ticks since the fire was lit with this one: in the last
    /// of [`SEARCH_TICKS`] what nothing needs leaves.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, steps: &[Pass], tick: u64) -> Result<(), Error> {
        let [reset, choice, unite, flatten, check, count, leave, ..] = steps else { return Ok(()) };
        let mut run = |step: &Pass, threads: u32| frame.compute(step, |dispatch| dispatch.elements(threads));
        match tick % SEARCH_TICKS {
            0 => {
                run(reset, self.vertex_count)?;
                run(choice, self.triangle_count.max(self.vertex_count))
            }
            1 => self.unite(frame, unite),
            2 => {
                self.unite(frame, unite)?;
                frame.compute(flatten, |dispatch| dispatch.elements(self.vertex_count))
            }
            _ => {
                run(check, self.triangle_count)?;
                run(count, self.vertex_count)?;
                run(leave, self.triangle_count)
            }
        }
    }

    fn unite(&self, frame: &mut Frame<'_>, unite: &Pass) -> Result<(), Error> {
        frame.compute(unite, |dispatch| {
            dispatch.constants(&Touches { count: 0 }).elements(self.triangle_count);
        })
    }
}

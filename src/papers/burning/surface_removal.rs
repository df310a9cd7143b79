//! `surface-removal` (3.5.4): consumed triangles leave the drawn stream, and the mesh is not rebuilt.

use std::sync::Arc;

use ash::vk;

use super::Burning;
use super::buffers::Buffers;
use super::connection::Connection;
use super::model::{Model, draw_order};
use super::parameters::{Parameters, Variant};
use super::parts::Parts;
use super::ping_pong::{self, new};
use super::refinement::Refinement;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/surface-removal-scan.comp`.
    struct Groups {
        /// Sums of the counting step.
        count: u32,
    }
}

host_block! {
    /// Push constants of `burning/refined-leaves.glsl`.
    struct Leaves {
        /// Finest level of the refinement pattern that is drawn.
        level_of_detail: u32,
    }
}

/// Triangles, or nodes of the refinement pattern, that one thread counts (`burning/runs.glsl`).
const RUN: u32 = 16;

/// The steps for each ping-pong index of the tick, those of the compaction's three phases last.
enum Steps {
    /// The marks of what is consumed.
    Marking([[Pass; 4]; 2]),
    /// The search for what hangs together.
    Connecting(Box<(Connection, [[Pass; 10]; 2])>),
}

/// The steps of the pass.
pub struct SurfaceRemoval {
    steps: Steps,
    /// Consumed triangles leave the stream.
    removes: bool,
    /// Threads of the compaction's first and last phase, and numbers that its second scans: one for each run.
    runs: u32,
    /// Of an object that is refined.
    leaves: Option<Leaves>,
}

impl SurfaceRemoval {
    /// `fallen` are the parts that fall, and the ash that they leave.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        (variant, parameters): (Variant, &Parameters),
        buffers: &mut Buffers,
        refinement: Option<&Refinement>,
        fallen: Option<(&Parts, &Arc<Buffer>)>,
        model: &Model,
    ) -> Result<Self, Error> {
        let is_connected = parameters.keeps_connected(variant);
        let connection = is_connected.then(|| Connection::new(shaders, label, buffers, model)).transpose()?;
        let buffers = &*buffers;
        let step =
            |shader: &str| Pass::compute("surface-removal", "3.5.4", shader).with("constants", &buffers.constants);
        let runs = refinement.map_or(model.triangle_count(), Refinement::node_count).div_ceil(RUN);
        let desc = BufferDesc::new(format!("{label}/group-sums"), 4 * u64::from(runs));
        let sums = Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))?;
        let draw_order = parameters.orders_triangles(variant, refinement.is_some()).then(|| {
            let order = draw_order(model.lattice.finest(), model.draw_vertex_count());
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(shaders.device(), &format!("{label}/draw-order"), usage, bytemuck::cast_slice(&order))
        });
        let draw_order = draw_order.transpose()?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let compacted = upload(shaders.device(), &format!("{label}/compacted"), usage, &[0; 8])?;
        let over_all = |shader: &str| {
            let step = step(shader).with("Removed", &buffers.removed).with("GroupSums", &sums);
            match refinement {
                None => {
                    let step = step.with("compacted", &compacted);
                    draw_order.iter().fold(step, |step, order| step.with("DrawOrder", order))
                }
                Some(refinement) => step
                    .constants::<Leaves>()
                    .with("Triangles", &buffers.triangles)
                    .with("Statuses", &refinement.statuses)
                    .with("Alive", &buffers.alive),
            }
        };
        let [count, write] = match (refinement, &draw_order) {
            (Some(_), _) => ["burning/refined-count.comp", "burning/refined-write.comp"],
            (None, None) => ["burning/surface-removal-count-own.comp", "burning/surface-removal-scatter-own.comp"],
            (None, Some(_)) => {
                ["burning/surface-removal-count-cached.comp", "burning/surface-removal-scatter-cached.comp"]
            }
        };
        let count = over_all(count);
        let count = if refinement.is_none() { count.with("Clock", &buffers.clock) } else { count }.build(shaders)?;
        let scan = match refinement {
            None => step("burning/surface-removal-scan-whole.comp").with("compacted", &compacted),
            Some(_) => step("burning/surface-removal-scan-refined.comp"),
        };
        let scan = scan
            .constants::<Groups>()
            .with("Clock", &buffers.clock)
            .with("Arguments", &buffers.arguments)
            .with("GroupSums", &sums)
            .build(shaders)?;
        let write = over_all(write).with("Corners", &buffers.corners).with("Stream", &buffers.stream).build(shaders)?;
        let compaction = [count, scan, write];
        let steps = match connection {
            Some((connection, steps)) => {
                let steps = steps.map(|[reset, choice, unite, flatten, check, pieces, leave]| {
                    let [count, scan, write] = compaction.clone();
                    Pass::steps([reset, choice, unite, flatten, check, pieces, leave, count, scan, write])
                });
                Steps::Connecting(Box::new((connection, steps)))
            }
            None => Steps::Marking(marks(shaders, buffers, fallen)?.map(|mark| {
                let [count, scan, write] = compaction.clone();
                Pass::steps([mark, count, scan, write])
            })),
        };
        Ok(SurfaceRemoval {
            steps,
            removes: parameters.removes(variant),
            runs,
            leaves: refinement.map(|refinement| Leaves { level_of_detail: refinement.level_of_detail }),
        })
    }

    /// Marks what has been consumed by `tick`, the ticks since the fire was lit.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn mark(&self, frame: &mut Frame<'_>, tick: u64) -> Result<(), Error> {
        if !self.removes {
            return Ok(());
        }
        let newest = (tick % 2) as usize;
        match &self.steps {
            Steps::Connecting(connecting) => {
                let (connection, steps) = &**connecting;
                connection.record(frame, &steps[newest], tick)
            }
            Steps::Marking(steps) => frame.compute(&steps[newest][0], |dispatch| dispatch.groups_indirect()),
        }
    }

    /// Makes the stream and its draw's parameters after the tick that wrote the state of index `tick`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn compact(&self, frame: &mut Frame<'_>, tick: usize) -> Result<(), Error> {
        let (count, scan, write) = match &self.steps {
            Steps::Marking(steps) => {
                let [_, count, scan, write] = &steps[tick];
                (count, scan, write)
            }
            Steps::Connecting(connecting) => {
                let [.., count, scan, write] = &connecting.1[tick];
                (count, scan, write)
            }
        };
        let over_all = |frame: &mut Frame<'_>, step: &Pass| {
            frame.compute(step, |dispatch| {
                if let Some(leaves) = &self.leaves {
                    dispatch.constants(leaves);
                }
                dispatch.elements(self.runs);
            })
        };
        over_all(frame, count)?;
        frame.compute(scan, |dispatch| {
            dispatch.constants(&Groups { count: self.runs }).threads(1, 1, 1);
        })?;
        over_all(frame, write)
    }
}

impl Burning {
    /// The search that keeps an object in one, of an object that is kept so.
    pub fn connection(&self) -> Option<&Connection> {
        match &self.surface_removal.steps {
            Steps::Connecting(connecting) => Some(&connecting.0),
            Steps::Marking(_) => None,
        }
    }
}

/// The marks of what is consumed, for each ping-pong index of the tick.
fn marks(
    shaders: &ShaderLibrary,
    buffers: &Buffers,
    fallen: Option<(&Parts, &Arc<Buffer>)>,
) -> Result<[Pass; 2], Error> {
    let step = |shader: &str| Pass::compute("surface-removal", "3.5.4", shader).with("constants", &buffers.constants);
    let mark = match fallen {
        Some((parts, ash)) => parts.posing(step("burning/surface-removal-mark-parts.comp")).with("Ash", ash),
        None => step("burning/surface-removal-mark-free.comp"),
    };
    let mark = mark
        .with("Flammabilities", &buffers.flammabilities)
        .with("Triangles", &buffers.triangles)
        .with("Removed", &buffers.removed)
        .with("Touched", &buffers.touched)
        .with("Clock", &buffers.clock);
    let mark = buffers.triangle_chunks.changing(mark);
    ping_pong::build(shaders, mark, &[new("NewState", &buffers.states)])
}

//! `surface-removal` (3.5.4): consumed triangles leave the drawn stream, and the mesh is not rebuilt.

use std::sync::Arc;

use ash::vk;

use super::model::Model;
use super::parameters::Variant;
use super::refinement::{LeavesConstants, Refinement};
use super::state::Buffers;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    struct Groups {
        count: u32,
    }
}

/// Threads of a workgroup of the scan.
const GROUP: u32 = 256;

/// The steps of the pass.
pub struct SurfaceRemoval {
    /// For either turn of the states: marking what is consumed, and the three phases of the compaction.
    turns: [[Pass; 4]; 2],
    /// Whether anything that is consumed leaves the stream.
    removes: bool,
    /// Of the compaction's first and last step.
    threads: u32,
    /// Of numbers that its middle step scans.
    sums: u32,
    leaves: Option<LeavesConstants>,
    triangles: u32,
}

impl SurfaceRemoval {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        buffers: &Buffers,
        refinement: Option<&Refinement>,
        model: &Model,
    ) -> Result<Self, Error> {
        let step =
            |shader: &str| Pass::compute("surface-removal", "3.5.4", shader).with("constants", &buffers.constants);
        let triangles = model.triangles.len() as u32;
        let (threads, sum_count) = refinement.map_or((triangles, triangles.div_ceil(GROUP)), |r| (r.runs(), r.runs()));
        let desc = BufferDesc::new(format!("{label}/group-sums"), 4 * u64::from(sum_count));
        let sums: Arc<Buffer> = Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))?;
        let [a, b] = &buffers.states;
        let mark_a = step("burning/surface-removal-mark.comp")
            .with("Triangles", &buffers.triangles)
            .with("NewState", a)
            .with("Removed", &buffers.removed)
            .with("Cells", &buffers.cells)
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .build(shaders)?;
        let mark_b = mark_a.rebind().with("NewState", b).build(shaders)?;
        let [count, scatter] = match refinement {
            None => {
                let count = step("burning/surface-removal-count.comp")
                    .with("Removed", &buffers.removed)
                    .with("GroupSums", &sums)
                    .build(shaders)?;
                let scatter = step("burning/surface-removal-scatter.comp")
                    .with("Corners", &buffers.corners)
                    .with("Removed", &buffers.removed)
                    .with("Stream", &buffers.stream)
                    .with("GroupSums", &sums)
                    .build(shaders)?;
                [count, scatter]
            }
            Some(refinement) => refinement.leaves(shaders, step, buffers, &sums)?,
        };
        let scan = step("burning/surface-removal-scan.comp")
            .constants::<Groups>()
            .with("Clock", &buffers.clock)
            .with("Arguments", &buffers.arguments)
            .with("GroupSums", &sums)
            .build(shaders)?;
        let turn = |mark| Pass::steps([mark, count.clone(), scan.clone(), scatter.clone()]);
        Ok(SurfaceRemoval {
            turns: [turn(mark_a), turn(mark_b)],
            removes: variant.removes(),
            threads,
            sums: sum_count,
            leaves: refinement.map(Refinement::leaves_constants),
            triangles,
        })
    }

    /// Marks what the tick that leaves its state in buffer `turn` has consumed.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn mark(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        if !self.removes {
            return Ok(());
        }
        let [mark, ..] = &self.turns[turn];
        frame.compute(mark, |dispatch| {
            dispatch.threads(self.triangles, 1, 1);
        })
    }

    /// Makes the stream and its draw's parameters after the tick that left its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn compact(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        let [_, count, scan, scatter] = &self.turns[turn];
        let over_all = |frame: &mut Frame<'_>, pass: &Pass| {
            frame.compute(pass, |dispatch| {
                if let Some(leaves) = &self.leaves {
                    dispatch.constants(leaves);
                }
                dispatch.threads(self.threads, 1, 1);
            })
        };
        over_all(frame, count)?;
        frame.compute(scan, |dispatch| {
            dispatch.constants(&Groups { count: self.sums }).threads(1, 1, 1);
        })?;
        over_all(frame, scatter)
    }
}

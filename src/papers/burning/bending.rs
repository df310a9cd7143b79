//! `bending`: what hangs by little bends before it breaks. Ours: the dissertation's objects keep their shape until they
//! have burnt.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::buffers::Buffers;
use super::model::{Cut, Hold, Joint, MOST_SECTIONS, Model, Section, Sections};
use super::parameters::Parameters;
use super::parts::{Bend, MEAN_WEIGHT, Parts, SEARCH_TICKS};
use super::ping_pong::{self, new};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Weight and foot of a section (`burning/sections.glsl`).
    pub struct Load {
        /// Of its vertices.
        pub weight: u32,
        /// The lowest part that it has vertices of, those that lie still first.
        pub part: u32,
        /// 1 where one of them is on the ground.
        pub is_foot: u32,
    }
}

host_block! {
    /// The turn of a section about its joint towards the ground in a tick (`burning/sections.glsl`).
    pub struct Hinge {
        /// A unit vector, horizontal.
        pub axis: Vec3,
        /// Radians.
        pub angle: f32,
        /// A place in the object.
        pub pivot: Vec3,
        /// Towards the ground, `u32::MAX` without any.
        pub joint: u32,
    }
}

host_block! {
    /// Push constants of `burning/bending.comp`.
    pub struct Sizes {
        /// Sections of the object.
        pub section_count: u32,
        /// Their joints.
        pub joint_count: u32,
        /// Cuts that the joints consist of.
        pub cut_count: u32,
        /// Of a section from the foot's side to the other, diagonals.
        pub width: f32,
        /// Of a weight of 1, square diagonals.
        pub area: f32,
        /// Curvature of a joint of length 1 that bears a moment of 1, without what it has at rest.
        pub bending: f32,
    }
}

/// Curvature of a joint as long as the diagonal under a square diagonal of surface at a diagonal's distance, by a factor
/// of 1.
const COMPLIANCE: f32 = 3.0;
/// Vertices of a workgroup (`burning/bending-vertices.comp`).
const GROUP: u32 = 64;
/// Of the buffers, beside those of a number a vertex.
pub(super) const BYTES: u32 = MOST_SECTIONS as u32 * 160 + (1 << 16);
/// Numbers of a vertex.
pub(super) const NUMBERS_OF_VERTEX: u32 = 2;

/// The pass with its buffers.
pub struct Bending {
    /// [`Load`] of each section.
    pub loads: Arc<Buffer>,
    /// uint\[J\]: what is left of each joint's length, in [`super::model::LENGTH_UNIT`]s of 256 parts.
    pub strengths: Arc<Buffer>,
    /// [`Bend`] of each section.
    pub sections: Arc<Buffer>,
    /// float\[J\]: radians that each joint has turned by.
    pub angles: Arc<Buffer>,
    /// [`Hinge`] of each section in the last tick.
    pub hinges: Arc<Buffer>,
    sum: [[Pass; 2]; 2],
    bend: [Pass; 3],
    vertex_count: u32,
    /// Push constants.
    pub sizes: Sizes,
}

impl Bending {
    /// `None` where nothing is to bend.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        buffers: &mut Buffers,
        parts: &Parts,
        model: &Model,
    ) -> Result<Option<Self>, Error> {
        let Some(divided) = model.sections.as_ref() else { return Ok(None) };
        let Sections { sections, joints, around, cuts, holds, .. } = divided;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let table = |name: &str, bytes: &[u8]| upload(shaders.device(), &format!("{label}/{name}"), storage, bytes);
        let section_count = sections.len() - 1;
        let sizes = Sizes {
            section_count: section_count as u32,
            joint_count: joints.len() as u32,
            cut_count: cuts.len() as u32,
            width: divided.width as f32,
            area: model.mean_vertex_area() as f32 / MEAN_WEIGHT as f32,
            bending: COMPLIANCE * parameters.bending,
        };
        // No buffer is empty.
        let joint = Joint::none();
        let joint_list = if joints.is_empty() { std::slice::from_ref(&joint) } else { joints };
        let cut = Cut { a: 0, b: 0, c: 0, triangle: 0, joint: 0, units: 0 };
        let cut_list = if cuts.is_empty() { std::slice::from_ref(&cut) } else { cuts };
        let around: &[u32] = if around.is_empty() { &[0] } else { around };
        let section_table = table("sections", bytemuck::cast_slice::<Section, u8>(sections))?;
        let joints = table("joints", bytemuck::cast_slice::<Joint, u8>(joint_list))?;
        let around = table("joints-around", bytemuck::cast_slice::<u32, u8>(around))?;
        let cuts = table("cuts", bytemuck::cast_slice::<Cut, u8>(cut_list))?;
        let holds = table("holds", bytemuck::cast_slice::<Hold, u8>(holds))?;
        let loads = table("section-loads", bytemuck::cast_slice(&vec![Load::none(); section_count]))?;
        let strengths = table("joint-strengths", &vec![0; 4 * joint_list.len()])?;
        let bends = table("section-bends", bytemuck::cast_slice(&vec![Bend::NONE; section_count]))?;
        let angles = table("joint-angles", &vec![0; 4 * joint_list.len()])?;
        let hinges = table("hinges", &vec![0; size_of::<Hinge>() * section_count])?;
        let [row, ..] = shaders.device().physical().limits.max_compute_work_group_count;
        let rows = model.vertex_count().div_ceil(GROUP).div_ceil(row).max(1);
        let usage = storage | vk::BufferUsageFlags::INDIRECT_BUFFER;
        let still = [0, rows, 1, 0];
        let moving = bytemuck::cast_slice::<u32, u8>(&still);
        let moving = upload(shaders.device(), &format!("{label}/bending"), usage, moving)?;
        for buffer in [&loads, &strengths, &bends, &angles, &hinges, &moving] {
            buffers.keep(shaders, buffer)?;
        }
        let step = |name: &str| {
            Pass::compute("bending", "", &format!("burning/bending{name}.comp")).with("constants", &buffers.constants)
        };
        let clear = step("-clear").constants::<Sizes>().with("Loads", &loads).with("Strengths", &strengths);
        let clear = ping_pong::build(shaders, clear.with("Bending", &moving), &[])?;
        let sum = step("-loads")
            .constants::<Sizes>()
            .with("Flammabilities", &buffers.flammabilities)
            .with("Removed", &buffers.removed)
            .with("Cells", &buffers.cells)
            .with("PartOf", &parts.part_of)
            .with("Parts", &parts.parts)
            .with("Weights", &parts.weights)
            .with("Bends", &parts.bends)
            .with("Cuts", &cuts)
            .with("Holds", &holds)
            .with("Loads", &loads)
            .with("Strengths", &strengths);
        let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
        let sum = ping_pong::build(shaders, sum, &newest)?;
        let bend = step("")
            .constants::<Sizes>()
            .with("Parts", &parts.parts)
            .with("Sections", &section_table)
            .with("Joints", &joints)
            .with("Around", &around)
            .with("Loads", &loads)
            .with("Strengths", &strengths)
            .with("SectionBends", &bends)
            .with("Angles", &angles)
            .with("Hinges", &hinges)
            .with("Bending", &moving)
            .build(shaders)?;
        let turn = step("-sections")
            .constants::<Sizes>()
            .with("Joints", &joints)
            .with("SectionBends", &bends)
            .with("Hinges", &hinges)
            .build(shaders)?;
        let follow = step("-vertices")
            .indirect(&moving)
            .with("Rest", &buffers.rest)
            .with("PartOf", &parts.part_of)
            .with("Bends", &parts.bends)
            .with("Holds", &holds)
            .with("Loads", &loads)
            .with("SectionBends", &bends)
            .build(shaders)?;
        let [even, odd] = [0, 1].map(|tick| {
            let [clear, sum] = [&clear, &sum].map(|passes| passes[tick].clone());
            Pass::steps([clear, sum, bend.clone(), turn.clone(), follow.clone()])
        });
        let [even_clear, even_sum, bend, turn, follow] = even;
        let [odd_clear, odd_sum, ..] = odd;
        Ok(Some(Bending {
            loads,
            strengths,
            sections: bends,
            angles,
            hinges,
            sum: [[even_clear, even_sum], [odd_clear, odd_sum]],
            bend: [bend, turn, follow],
            vertex_count: model.vertex_count(),
            sizes,
        }))
    }

    /// Records the pass in `tick`, the ticks since the fire was lit with this one; loads are summed when parts are new.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: u64) -> Result<(), Error> {
        let mut run = |step: &Pass, threads: u32| {
            frame.compute(step, |dispatch| dispatch.constants(&self.sizes).elements(threads))
        };
        if tick.is_multiple_of(SEARCH_TICKS) {
            let [clear, sum] = &self.sum[(tick % 2) as usize];
            run(clear, self.sizes.section_count.max(self.sizes.joint_count))?;
            run(sum, self.vertex_count + self.sizes.cut_count)?;
        }
        let [bend, turn, follow] = &self.bend;
        run(bend, 1)?;
        run(turn, self.sizes.section_count)?;
        frame.compute(follow, |dispatch| dispatch.groups_indirect())
    }
}

impl Load {
    /// Before the first sum.
    fn none() -> Self {
        Load { weight: 0, part: u32::MAX, is_foot: 0 }
    }
}

//! `parts`: the connected parts of the object, found anew every [`SEARCH_TICKS`] ticks, with their moments. Ours: the
//! dissertation's objects fall apart in place.

use std::sync::Arc;

use ash::vk;
use glam::{Vec3, Vec4};

use super::Burning;
use super::bending::Bending;
use super::buffers::Buffers;
use super::model::Model;
use super::ping_pong::{self, new};
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// A part as a rigid body (`burning/parts.glsl`).
    #[derive(Default)]
    pub struct Part {
        /// Unit quaternion that turns places in the object to the world.
        pub orientation: Vec4,
        /// Added to a turned place, diagonals.
        pub offset: Vec3,
        /// 1 while it lies still.
        pub rests: f32,
        /// Of the centre of mass, diagonals a second.
        pub velocity: Vec3,
        /// Ticks since it last lay still.
        pub fallen_ticks: f32,
        /// Radians a second.
        pub spin: Vec3,
        /// Of its vertices.
        pub weight: f32,
        /// Centre of mass, a place in the object.
        pub center: Vec3,
        /// Over its weight, with that of its height above the ground: diagonals squared a second squared.
        pub energy: f32,
        /// The place about which its moments are taken.
        pub anchor: Vec3,
        /// Root of the mean squared distance of its vertices from the centre.
        pub extent: f32,
    }
}

host_block! {
    /// A rotation about the origin, then a displacement (`burning/sections.glsl`).
    pub struct Bend {
        /// Unit quaternion.
        pub turn: Vec4,
        /// Diagonals.
        pub offset: Vec3,
        _pad: f32,
    }
}

impl Bend {
    /// Of what is as at rest.
    pub const NONE: Bend = Bend { turn: Vec4::W, offset: Vec3::ZERO, _pad: 0.0 };
}

host_block! {
    /// Progress of the search (`burning/parting.glsl`).
    #[derive(Default)]
    pub(super) struct Progress {
        /// 1 where a vertex is not below its root yet.
        pub(super) is_unsettled: u32,
        /// 1 where the parts of the last search have their numbers.
        pub(super) is_numbered: u32,
        /// Of the last search that came to its end.
        pub(super) part_count: u32,
    }
}

host_block! {
    /// Push constants of `burning/parts-unite.comp`.
    pub(super) struct Touches {
        /// Pairs of vertices that touch.
        pub(super) count: u32,
    }
}

/// Parts that fall at most; what comes off beyond them is ash at once.
pub const MOST_PARTS: u32 = 1024;
/// Ticks from one search for parts to the next: what comes off begins to fall within twice as many.
pub const SEARCH_TICKS: u64 = 4;
/// Words of a part's moments (`burning/moments.glsl`).
const MOMENTS: u32 = 38;
/// Vertices that a thread sums up (`burning/parts-moments.comp`).
const RUN: u32 = 16;
/// Weight of a vertex of mean area, and the greatest.
pub(super) const MEAN_WEIGHT: f64 = 16.0;
const MOST_WEIGHT: f64 = 255.0;

/// Of the buffers, beside those of a number a vertex; what a restart brings back is there twice.
pub(super) const BYTES: u32 = 4 * MOST_PARTS * size_of::<Part>() as u32 + 2 * 4 * MOST_PARTS * MOMENTS;
/// Numbers of a vertex.
pub(super) const NUMBERS_OF_VERTEX: u32 = 2 * (4 + 8) + 1;

/// The pass with its buffers.
pub struct Parts {
    /// uint\[N\]: the part of each vertex; [`MOST_PARTS`] and more where it is in none.
    pub part_of: Arc<Buffer>,
    /// [`Part`] of each, as many as the search counted.
    pub parts: Arc<Buffer>,
    /// uint\[N\]: the weight of each vertex.
    pub weights: Arc<Buffer>,
    /// [`Bend`] of each vertex, by which its place in the object differs from what burning alone makes of it.
    pub bends: Arc<Buffer>,
    /// [`Progress`] of the search.
    pub(super) progress: Arc<Buffer>,
    /// Moments of the parts while they are summed up, [`MOMENTS`] words each.
    pub(super) sums: Arc<Buffer>,
    /// Takes over the parts that were found, and sums their moments.
    take: [[Pass; 4]; 2],
    reset: Pass,
    unite: [Pass; 2],
    flatten: Pass,
    check: Pass,
    number: Pass,
    vertex_count: u32,
    triangle_count: u32,
    touches: Touches,
}

impl Burning {
    /// The parts that fall, of an object whose parts do.
    pub fn parts(&self) -> Option<&Parts> {
        self.parts.as_ref()
    }

    /// The pass that bends what hangs by little, of an object in which something may.
    pub fn bending(&self) -> Option<&Bending> {
        self.bending.as_ref()
    }
}

impl Parts {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, label: &str, buffers: &mut Buffers, model: &Model) -> Result<Self, Error> {
        let table = |name: &str, bytes: &[u8]| {
            upload(shaders.device(), &format!("{label}/{name}"), vk::BufferUsageFlags::STORAGE_BUFFER, bytes)
        };
        let list = |name: &str, list: &[u32]| table(name, bytemuck::cast_slice(list));
        let count = model.vertex_count();
        let weights = weights(model);
        let none = vec![u32::MAX; count as usize];
        let zeros = vec![0; count as usize];
        let roots = list("roots", &(0..count).collect::<Vec<_>>())?;
        let attached = list("attached", &zeros)?;
        let numbers = list("part-numbers", &zeros)?;
        let part_of = list("part-of", &none)?;
        let parts = table("parts", bytemuck::cast_slice(&vec![Part::default(); MOST_PARTS as usize]))?;
        let inherited = table("inherited-parts", bytemuck::cast_slice(&vec![Part::default(); MOST_PARTS as usize]))?;
        let sums = list("moments", &vec![0; (MOST_PARTS * MOMENTS) as usize])?;
        let progress = table("parts-progress", bytemuck::bytes_of(&Progress::default()))?;
        let weights = list("vertex-weights", &weights)?;
        let pairs: &[[u32; 2]] = if model.touching.is_empty() { &[[0, 0]] } else { &model.touching };
        let touching = list("touching", pairs.as_flattened())?;
        let bends = table("bends", bytemuck::cast_slice(&vec![Bend::NONE; count as usize]))?;
        for buffer in [&roots, &attached, &numbers, &part_of, &parts, &inherited, &sums, &progress, &bends] {
            buffers.keep(shaders, buffer)?;
        }
        let step = |name: &str| {
            Pass::compute("parts", "", &format!("burning/parts-{name}.comp")).with("constants", &buffers.constants)
        };
        let searched = |name: &str| step(name).with("Searching", &progress);
        let state = new("NewState", &buffers.states);
        let rotations = new("NewRotations", &buffers.rotations);
        let placed = |name: &str| step(name).with("Cells", &buffers.cells).with("Parts", &parts).with("Bends", &bends);
        let inherit = placed("inherit")
            .with("Searching", &progress)
            .with("Roots", &roots)
            .with("Attached", &attached)
            .with("Numbers", &numbers)
            .with("PartOf", &part_of)
            .with("Inherited", &inherited);
        let inherit = ping_pong::build(shaders, inherit, &[state, rotations])?;
        let adopt = searched("adopt")
            .with("Roots", &roots)
            .with("Attached", &attached)
            .with("Numbers", &numbers)
            .with("PartOf", &part_of)
            .with("Parts", &parts)
            .with("Inherited", &inherited)
            .build(shaders)?;
        let clear = Pass::compute("parts", "", "burning/parts-clear.comp").with("Sums", &sums).build(shaders)?;
        let moments = placed("moments").with("PartOf", &part_of).with("Sums", &sums).with("Weights", &weights);
        let moments = ping_pong::build(shaders, moments, &[state, rotations])?;
        let reset = searched("reset").with("Roots", &roots).with("Attached", &attached).build(shaders)?;
        let unite = step("unite")
            .constants::<Touches>()
            .with("Triangles", &buffers.triangles)
            .with("Removed", &buffers.removed)
            .with("Roots", &roots)
            .with("Touching", &touching);
        let unite = ping_pong::build(shaders, unite, &[state])?;
        let flatten = searched("flatten").with("Roots", &roots).build(shaders)?;
        let check = searched("check")
            .with("Triangles", &buffers.triangles)
            .with("Removed", &buffers.removed)
            .with("Roots", &roots)
            .with("Attached", &attached)
            .build(shaders)?;
        let number = searched("number")
            .with("Roots", &roots)
            .with("Attached", &attached)
            .with("Numbers", &numbers)
            .build(shaders)?;
        let [even, odd] = [0, 1].map(|tick| {
            let [inherit, moments] = [&inherit, &moments].map(|passes| passes[tick].clone());
            Pass::steps([
                inherit,
                adopt.clone(),
                clear.clone(),
                moments,
                reset.clone(),
                unite[tick].clone(),
                flatten.clone(),
                check.clone(),
                number.clone(),
            ])
        });
        let [inherit, adopt, clear, moments, reset, unite, flatten, check, number] = even;
        let [odd_inherit, odd_adopt, odd_clear, odd_moments, _, odd_unite, ..] = odd;
        Ok(Parts {
            part_of,
            parts,
            weights,
            bends,
            progress,
            sums,
            take: [[inherit, adopt, clear, moments], [odd_inherit, odd_adopt, odd_clear, odd_moments]],
            reset,
            unite: [unite, odd_unite],
            flatten,
            check,
            number,
            vertex_count: count,
            triangle_count: model.triangle_count(),
            touches: Touches { count: model.touching.len() as u32 },
        })
    }

    /// Gives a pass what moves places in the object to the world (`burning/posed.glsl`).
    pub(super) fn posing(&self, pass: PassBuilder) -> PassBuilder {
        pass.with("PartOf", &self.part_of).with("Parts", &self.parts).with("Bends", &self.bends)
    }

    /// Records the part of the search that belongs to `tick`, the ticks since the fire was lit with this one.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: u64) -> Result<(), Error> {
        let newest = (tick % 2) as usize;
        let mut run = |step: &Pass, threads: u32| frame.compute(step, |dispatch| dispatch.elements(threads));
        match tick % SEARCH_TICKS {
            0 => {
                let [inherit, adopt, clear, moments] = &self.take[newest];
                run(inherit, self.vertex_count)?;
                run(adopt, self.vertex_count.max(MOST_PARTS))?;
                run(clear, MOST_PARTS * MOMENTS)?;
                run(moments, self.vertex_count.div_ceil(RUN))?;
                run(&self.reset, self.vertex_count)
            }
            1 => self.unite(frame, newest),
            2 => {
                self.unite(frame, newest)?;
                frame.compute(&self.flatten, |dispatch| dispatch.elements(self.vertex_count))
            }
            _ => {
                run(&self.check, self.triangle_count)?;
                run(&self.number, 1)
            }
        }
    }

    fn unite(&self, frame: &mut Frame<'_>, newest: usize) -> Result<(), Error> {
        frame.compute(&self.unite[newest], |dispatch| {
            dispatch.constants(&self.touches).elements(self.triangle_count + self.touches.count)
        })
    }
}

/// A third of the area of each vertex's triangles at rest, in whole numbers.
fn weights(model: &Model) -> Vec<u32> {
    let areas = model.vertex_areas();
    let mean = model.mean_vertex_area().max(f64::MIN_POSITIVE);
    areas.iter().map(|area| (area / mean * MEAN_WEIGHT).round().clamp(1.0, MOST_WEIGHT) as u32).collect()
}

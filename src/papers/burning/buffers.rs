//! The buffers of the paper: the object, which never changes, its state, which the ticks change, and the mesh that a
//! frame makes of it.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::chunks::ChunkBuffers;
use super::materials::MaterialLevels;
use super::model::{Chunks, Model};
use super::parameters::{Look, Parameters, TICKS_PER_S, Variant};
use crate::gpu::transfer::{copy_buffers, upload};
use crate::gpu::{Buffer, BufferDesc, Device, Error, ShaderLibrary};
use crate::host_block;

host_block! {
    /// The uniform block of `burning/constants.glsl`, which says what each member is.
    pub(super) struct Constants {
        blocks: [u32; 3],
        block_count: u32,
        grid_origin: Vec3,
        floor_y: f32,
        block_size: Vec3,
        mean_edge: f32,
        albedo: Vec3,
        gravity_per_tick: f32,
        vertex_count: u32,
        triangle_count: u32,
        draw_vertex_count: u32,
        growth_per_tick: f32,
        area_width: f32,
        highest_source_y: f32,
        level_stride: u32,
        gamma: f32,
        spread: f32,
        greatest_rotation_rad: f32,
        greatest_free_rotation_rad: f32,
        omega: f32,
        chi: f32,
        upsilon: f32,
        outward: f32,
        retire_at: f32,
        char_depth: f32,
        active_limit: u32,
        seed: u32,
        levels: u32,
        coarse_count: u32,
        fire_pool: u32,
        smoke_pool: u32,
        charring: f32,
        wind: Vec3,
        evaporation_per_tick: f32,
        embers: f32,
        setting_per_tick: f32,
        last_radius: f32,
        ground_y: f32,
    }
}

host_block! {
    /// A vertex of the object at rest (`burning/vertices.glsl`).
    pub struct RestVertex {
        /// Diagonals.
        pub position: Vec3,
        /// R: the radius at which the boundary reaches it (3.3), diagonals.
        pub boundary_distance: f32,
    }
}

host_block! {
    /// A vertex after some tick (`burning/vertices.glsl`).
    pub struct VertexState {
        /// Diagonals.
        pub position: Vec3,
        /// L, ticks of combustion left.
        pub left: f32,
    }
}

host_block! {
    /// The counts of a block (`burning/blocks.glsl`).
    #[derive(Default)]
    pub struct BlockCounts {
        /// Vertices with some L left: the weight (3.5.1).
        pub live: i32,
        /// Live vertices in the combustion-ready area.
        pub ready: i32,
        /// Sum of the signs of the last tick's events about x (3.5.2).
        pub pitch_sign: i32,
        /// Likewise about y.
        pub yaw_sign: i32,
        /// Likewise about z.
        pub roll_sign: i32,
        /// Ticks with active vertices (5.4).
        pub combustion: i32,
        /// Vertices inside the combustion-ready boundary.
        pub heated: i32,
        /// Last tick with active vertices.
        pub last_active_tick: i32,
    }
}

host_block! {
    /// Counters that the device keeps by itself (`burning/clock.glsl`).
    #[derive(Default)]
    pub struct Counts {
        /// Ticks since the fire was lit.
        pub tick: u32,
        /// Ticks in which the boundary grew.
        pub growth_ticks: u32,
        /// r of the boundary, diagonals.
        pub radius: f32,
        /// Vertices of the deformed area with some flammability left.
        pub active_vertices: u32,
        /// Finest triangles with such a vertex.
        pub active_triangles: u32,
        /// Vertices with some flammability left.
        pub live_vertices: u32,
        /// Live vertices of the combustion-ready area.
        pub ready_vertices: u32,
        /// Finest triangles that have left the stream.
        pub removed_triangles: u32,
        /// Triangles in the stream.
        pub drawn_triangles: u32,
        /// Fire particles that are there.
        pub fire_particles: u32,
        /// Smoke particles that are there.
        pub smoke_particles: u32,
    }
}

/// Standard gravity, diagonals a second squared: the object is taken for 1 m across.
const GRAVITY: f64 = 9.81;

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// Every buffer by the name that the shaders give it, in snake case. N vertices, T finest triangles, C draw vertices.
pub struct Buffers {
    /// Uniform block of the configuration's constants, one of all passes.
    pub(super) constants: Arc<Buffer>,
    /// [`RestVertex`]\[N\].
    pub rest: Arc<Buffer>,
    /// uint\[3T\]: vertices.
    pub triangles: Arc<Buffer>,
    /// uint\[N + 1\].
    pub incidence_offsets: Arc<Buffer>,
    /// uint\[3T\]: triangle * 4 + corner.
    pub incidence: Arc<Buffer>,
    /// uint\[3T\]: draw vertices.
    pub corners: Arc<Buffer>,
    /// uint\[C\]: vertex of each draw vertex.
    pub welds: Arc<Buffer>,
    /// uint\[C + 1\].
    pub corner_incidence_offsets: Arc<Buffer>,
    /// uint\[3T\]: triangle * 4 + corner.
    pub corner_incidence: Arc<Buffer>,
    /// uint\[blocks\].
    pub base_points: Arc<Buffer>,
    /// uint\[N\].
    pub rest_cells: Arc<Buffer>,
    /// float\[N\]: L before the fire, 0 for what does not burn; of one element where all have the same.
    pub flammabilities: Arc<Buffer>,
    /// float\[3T\]: epsilon of the edge after each corner; of one element where all have the same.
    pub meltabilities: Arc<Buffer>,
    /// [`BlockLevels`](super::materials::BlockLevels) of each block.
    pub block_levels: Arc<Buffer>,

    /// [`VertexState`]\[N\], ping-pong: after tick t the newer one is that of index t % 2.
    pub states: [Arc<Buffer>; 2],
    /// uint\[N\]: area of the boundary, 0 to 4.
    pub labels: Arc<Buffer>,
    /// The vertices as the boundary reaches them.
    pub vertex_chunks: ChunkBuffers,
    /// Likewise the finest triangles.
    pub triangle_chunks: ChunkBuffers,
    /// uint\[N\]: the block that each vertex counts in times 8, and as what.
    pub counted: Arc<Buffer>,
    /// uint\[T\]: the highest of the three vertices'.
    pub triangle_labels: Arc<Buffer>,
    /// uint\[T\]: 1 where the triangle has left the stream.
    pub removed: Arc<Buffer>,
    /// uint\[N\]: block of the position.
    pub cells: Arc<Buffer>,
    /// [`BlockCounts`] of each block.
    pub blocks: Arc<Buffer>,
    /// vec4\[blocks\] twice, ping-pong as the states are: pitch, yaw, roll in radians.
    pub rotations: [Arc<Buffer>; 2],
    /// vec4\[blocks\] twice, ping-pong as the states are: displacement of the base point since the start, 1 while it is
    /// active (6.3.4).
    pub base_displacements: [Arc<Buffer>; 2],
    /// vec4\[N\]: displacement by which a vertex has followed the base points, 1 where it keeps its place; of one element
    /// where nothing melts.
    pub flows: Arc<Buffer>,
    /// uint\[N\]: 1 where the vertex exists.
    pub alive: Arc<Buffer>,
    /// [`Counts`].
    pub clock: Arc<Buffer>,

    /// vec4\[N\]: position with the block's rotation, L / L0.
    pub mapped: Arc<Buffer>,
    /// uint\[N\]: the last tick at which a triangle of the vertex moved or left.
    pub touched: Arc<Buffer>,
    /// vec4\[C\]: normal, charred fraction.
    pub normals: Arc<Buffer>,
    /// vec4\[C\]: linear RGB, glow.
    pub colors: Arc<Buffer>,
    /// uint\[3T\]: draw vertices of the drawn triangles, in order.
    pub stream: Arc<Buffer>,
    /// `VkDrawIndexedIndirectCommand`.
    pub arguments: Arc<Buffer>,

    /// Each buffer that a tick needs from the last one, with its copy at the start.
    start: Vec<(Arc<Buffer>, Arc<Buffer>)>,
}

impl Buffers {
    /// Uploads the model and makes the state before the first tick.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        model: &Model,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let name = |what: &str| format!("{label}/{what}");
        let uploaded = |what: &str, bytes: &[u8]| upload(device, &name(what), STORAGE, bytes);
        let list = |what: &str, list: &[u32]| uploaded(what, bytemuck::cast_slice(list));
        let pair = |what: &str, bytes: &[u8]| -> Result<[Arc<Buffer>; 2], Error> {
            Ok([uploaded(&format!("{what}-a"), bytes)?, uploaded(&format!("{what}-b"), bytes)?])
        };
        let empty = |what: &str, bytes: usize, usage| {
            Buffer::new(device, BufferDesc::new(name(what), bytes as u64).usage(STORAGE | usage))
        };
        let plain = vk::BufferUsageFlags::empty();
        let zeros = |what: &str, bytes: usize| uploaded(what, &vec![0; bytes]);
        let vertices = model.rest.len();
        let triangles = model.triangles.len();
        let corners = model.lattice.welds.len();
        let blocks = model.grid.cell_count() as usize;

        let MaterialLevels { flammabilities, meltabilities, blocks: block_levels, holds } =
            MaterialLevels::new(variant, parameters, model);
        // What does not burn has something left for ever.
        let left = flammabilities.iter().cycle().map(|ticks| ticks.max(1.0));
        let before = model.rest.iter().zip(left);
        let before: Vec<VertexState> =
            before.map(|(vertex, left)| VertexState { position: vertex.position, left }).collect();
        let held = |vertex: usize| [0.0, 0.0, 0.0, f32::from(u8::from(holds.get(vertex).is_some_and(|holds| *holds)))];
        let flowing = if variant == Variant::Melting { vertices } else { 1 };
        let flows: Vec<[f32; 4]> = (0..flowing).map(held).collect();
        let alive = alive_at_rest(variant, model);
        let mut counts = vec![BlockCounts::default(); blocks];
        for (&cell, _) in model.rest_cells.iter().zip(&alive).filter(|&(_, &alive)| alive == 1) {
            counts[cell as usize].live += 1;
        }
        let counted: Vec<u32> = model.rest_cells.iter().zip(&alive).map(|(cell, alive)| 8 * cell + alive).collect();
        let live_vertices = alive.iter().sum();
        let clock = Counts { live_vertices, ..Counts::default() };
        let burns = |vertex: u32| flammabilities[vertex as usize % flammabilities.len()] > 0.0;
        let distance = |vertex: u32| model.rest[vertex as usize].boundary_distance;
        let vertex_chunks = Chunks::of_vertices(model.rest.iter().map(|vertex| vertex.boundary_distance));
        let triangle_chunks = Chunks::of_triangles(&model.triangles, distance, burns);
        let (uniform, block) = (vk::BufferUsageFlags::UNIFORM_BUFFER, constants(variant, parameters, model));
        let mut buffers = Buffers {
            constants: upload(device, &name("constants"), uniform, bytemuck::bytes_of(&block))?,
            rest: uploaded("rest", bytemuck::cast_slice(&model.rest))?,
            triangles: list("triangles", model.triangles.as_flattened())?,
            incidence_offsets: list("incidence-offsets", &model.incidence.offsets)?,
            incidence: list("incidence", &model.incidence.entries)?,
            corners: list("corners", model.lattice.finest().as_flattened())?,
            welds: list("welds", &model.lattice.welds)?,
            corner_incidence_offsets: list("corner-incidence-offsets", &model.corner_incidence.offsets)?,
            corner_incidence: list("corner-incidence", &model.corner_incidence.entries)?,
            base_points: list("base-points", &model.base_points)?,
            rest_cells: list("rest-cells", &model.rest_cells)?,
            flammabilities: uploaded("flammabilities", bytemuck::cast_slice(&flammabilities))?,
            meltabilities: uploaded("meltabilities", bytemuck::cast_slice(&meltabilities))?,
            block_levels: uploaded("block-levels", bytemuck::cast_slice(&block_levels))?,
            states: pair("state", bytemuck::cast_slice(&before))?,
            labels: zeros("labels", 4 * vertices)?,
            vertex_chunks: ChunkBuffers::new(shaders, &name("vertices"), &vertex_chunks)?,
            triangle_chunks: ChunkBuffers::new(shaders, &name("triangles"), &triangle_chunks)?,
            counted: list("counted", &counted)?,
            triangle_labels: zeros("triangle-labels", 4 * triangles)?,
            removed: zeros("removed", 4 * triangles)?,
            cells: list("cells", &model.rest_cells)?,
            blocks: uploaded("blocks", bytemuck::cast_slice(&counts))?,
            rotations: pair("rotations", &vec![0; 16 * blocks])?,
            base_displacements: pair("base-displacements", &vec![0; 16 * blocks])?,
            flows: uploaded("flows", bytemuck::cast_slice(&flows))?,
            alive: list("alive", &alive)?,
            clock: uploaded("clock", bytemuck::bytes_of(&clock))?,
            mapped: empty("mapped", 16 * vertices, plain)?,
            touched: zeros("touched", 4 * vertices)?,
            normals: empty("normals", 16 * corners, plain)?,
            colors: empty("colors", 16 * corners, plain)?,
            stream: upload(
                device,
                &name("stream"),
                STORAGE | vk::BufferUsageFlags::INDEX_BUFFER,
                &vec![0; 12 * triangles],
            )?,
            arguments: empty("arguments", 20, vk::BufferUsageFlags::INDIRECT_BUFFER)?,
            start: Vec::new(),
        };
        let Buffers { labels, triangle_labels, removed, cells, blocks, flows, alive, clock, counted, .. } = &buffers;
        // A tick that is divided goes on over the lists that its first slice has made.
        let chunks = [&buffers.vertex_chunks, &buffers.triangle_chunks];
        let chunks = chunks.map(|chunks| [&chunks.finished, &chunks.changed.visited, &chunks.changed.groups]);
        let kept = [labels, triangle_labels, removed, cells, blocks, flows, alive, clock, counted];
        let kept = kept.into_iter().chain(chunks.into_iter().flatten());
        let pairs = [&buffers.states, &buffers.rotations, &buffers.base_displacements];
        let kept: Vec<_> = kept.chain(pairs.into_iter().flatten()).cloned().collect();
        for buffer in kept {
            buffers.keep(shaders, &buffer)?;
        }
        Ok(buffers)
    }

    /// The object, its blocks and the constants: the simulation reads them and no pass writes them.
    pub fn unchanging(&self) -> [&Arc<Buffer>; 18] {
        [
            &self.constants,
            &self.rest,
            &self.triangles,
            &self.incidence_offsets,
            &self.incidence,
            &self.corners,
            &self.welds,
            &self.corner_incidence_offsets,
            &self.corner_incidence,
            &self.base_points,
            &self.rest_cells,
            &self.flammabilities,
            &self.meltabilities,
            &self.block_levels,
            &self.vertex_chunks.order,
            &self.vertex_chunks.spans,
            &self.triangle_chunks.order,
            &self.triangle_chunks.spans,
        ]
    }

    /// Lets a restart bring back the contents of `buffer`, which a tick needs from the last one, at the start.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn keep(&mut self, shaders: &ShaderLibrary, buffer: &Arc<Buffer>) -> Result<(), Error> {
        let desc = BufferDesc::new(format!("{} at the start", buffer.name()), buffer.size_bytes());
        let start = Buffer::new(shaders.device(), desc)?;
        copy_buffers(shaders.device(), &[(buffer, &start)])?;
        self.start.push((buffer.clone(), start));
        Ok(())
    }

    /// Makes the contents of the buffers the start.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn save(&self, device: &Arc<Device>) -> Result<(), Error> {
        let pairs: Vec<_> = self.start.iter().map(|(now, start)| (now, start)).collect();
        copy_buffers(device, &pairs)
    }

    /// Back to the start.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn restore(&self, device: &Arc<Device>) -> Result<(), Error> {
        let pairs: Vec<_> = self.start.iter().map(|(now, start)| (start, now)).collect();
        copy_buffers(device, &pairs)
    }
}

/// 1 for each vertex that exists before the fire: all, but of an object that is refined only those of its coarse
/// triangles.
fn alive_at_rest(variant: Variant, model: &Model) -> Vec<u32> {
    let mut alive = vec![u32::from(!variant.refines()); model.rest.len()];
    for corner in model.lattice.nodes[0].as_flattened() {
        alive[model.lattice.welds[*corner as usize] as usize] = 1;
    }
    alive
}

fn constants(variant: Variant, parameters: &Parameters, model: &Model) -> Constants {
    let p = parameters;
    let tick_s = 1.0 / TICKS_PER_S;
    let is_natural = p.look == Look::Natural;
    Constants {
        blocks: p.blocks,
        block_count: model.block_count(),
        grid_origin: model.grid.origin,
        floor_y: model.floor,
        block_size: model.grid.cell_size,
        mean_edge: model.mean_edge,
        albedo: p.albedo(variant),
        gravity_per_tick: (GRAVITY * tick_s * tick_s) as f32,
        vertex_count: model.vertex_count(),
        triangle_count: model.triangle_count(),
        draw_vertex_count: model.draw_vertex_count(),
        growth_per_tick: (f64::from(p.speed_per_s) * tick_s) as f32,
        area_width: p.width_of_areas,
        highest_source_y: model.sources.iter().map(|s| s.y).fold(f32::NEG_INFINITY, f32::max),
        level_stride: u32::from(p.materials.is_some()),
        gamma: p.gamma,
        spread: p.spread,
        greatest_rotation_rad: GREATEST_ROTATION_RAD,
        greatest_free_rotation_rad: GREATEST_FREE_ROTATION_RAD,
        omega: p.omega,
        chi: p.chi,
        upsilon: p.upsilon,
        outward: model.outward,
        retire_at: if variant == Variant::Solid { p.retire_at } else { 0.0 },
        char_depth: model.char_depth,
        active_limit: if p.active_limit == 0 { u32::MAX } else { p.active_limit },
        seed: p.noise_seed(),
        levels: model.levels,
        coarse_count: model.coarse_count(),
        fire_pool: p.fire,
        smoke_pool: p.smoke,
        charring: if p.chars(variant) { 1.0 } else { 0.0 },
        wind: p.wind,
        evaporation_per_tick: (f64::from(p.evaporation_per_s) * tick_s) as f32,
        embers: if is_natural && (p.chars(variant) || p.materials.is_some()) { 1.0 } else { 0.0 },
        setting_per_tick: if is_natural { (tick_s / f64::from(p.setting_s)) as f32 } else { 0.0 },
        last_radius: last_radius(variant, p, model),
        ground_y: ground_y(p, model),
    }
}

/// Lowest height that is drawn: the ground's by the natural look, where all of the object lies on it or above.
fn ground_y(parameters: &Parameters, model: &Model) -> f32 {
    let stands = parameters.look == Look::Natural && model.floor <= model.bounds.min.y;
    if stands { model.floor } else { f32::MIN }
}

/// Radius of the boundary when the last vertex has burnt out, if it never halts.
pub(super) fn last_radius(variant: Variant, parameters: &Parameters, model: &Model) -> f32 {
    let farthest = model.rest.iter().map(|vertex| vertex.boundary_distance).fold(0.0, f32::max);
    let own = [parameters.flammability];
    let substances = parameters.materials.as_ref().map_or(Vec::new(), |m| m.all(variant, parameters));
    let longest = substances.iter().map(|substance| substance.flammability).chain(own).max().unwrap_or_default();
    let burning = f64::from(parameters.speed_per_s) * f64::from(longest) / TICKS_PER_S;
    farthest + 2.0 * parameters.width_of_areas + burning as f32
}

/// A block rotates by 2 degrees at most (3.5.2: very minute), by 15 where two or more of its sides are free.
const GREATEST_ROTATION_RAD: f32 = 2.0 * std::f32::consts::PI / 180.0;
const GREATEST_FREE_ROTATION_RAD: f32 = 15.0 * std::f32::consts::PI / 180.0;

//! `internal-deformation`: 3.4, for solids 5.3 and for what melts 6.3.

use std::ops::Range;

use ash::vk;

use super::buffers::{Buffers, VertexState, last_radius};
use super::model::Model;
use super::parameters::{Parameters, TICKS_PER_S, Variant};
use super::ping_pong::{self, Swapped, new, old};
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;
use crate::measure::estimate::submission_work;

host_block! {
    /// The frame of a tick that is spread over several (3.7.2), as push constants.
    struct Slice {
        number: u32,
        division: u32,
    }
}

/// Turns of loops for each triangle in the passes of a tick, rather more than fewer: a shell without particles takes about 26 on a CPU of
/// [`submission_work`]'s rate.
const TICK_TURNS: f64 = 48.0;

/// Pairs of sweeps of a tick in which wax sets, beside the one of every tick.
const SETTING_PAIRS: usize = 3;

/// Sweeps of the folding over wax that sets, into a third state and back.
struct Setting {
    /// For each ping-pong index of the tick.
    pairs: [[Pass; 2]; 2],
    /// Those in which it may set; the device knows those in which it does.
    ticks: Range<u64>,
}

/// The pass for each ping-pong index of the tick.
pub struct InternalDeformation {
    /// Of what melts: moves the base points, which guide the vertices, before them.
    base_points: Option<[Pass; 2]>,
    vertices: [Pass; 2],
    setting: Option<Setting>,
    block_count: u32,
    /// Frames that a tick is spread over.
    time_division: u32,
    /// Of a tick, in all of its passes.
    tick_work: f64,
    /// Of a submission.
    most_work: f64,
}

impl InternalDeformation {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        (variant, parameters): (Variant, &Parameters),
        buffers: &Buffers,
        model: &Model,
    ) -> Result<Self, Error> {
        let (section, shader) = match variant {
            Variant::Shell | Variant::LowPoly | Variant::FullySubdivided => ("3.4", "internal-deformation"),
            Variant::Solid => ("5.3", "internal-deformation-solid"),
            Variant::Melting => ("6.3", "internal-deformation-melting"),
        };
        let step = |shader: &str| {
            Pass::compute("internal-deformation", section, &format!("burning/{shader}.comp"))
                .with("constants", &buffers.constants)
                .with("Labels", &buffers.labels)
        };
        let mut vertices = buffers
            .vertex_chunks
            .changing(step(shader))
            .constants::<Slice>()
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("Meltabilities", &buffers.meltabilities)
            .with("Alive", &buffers.alive);
        if variant != Variant::Melting {
            vertices = vertices
                .with("Flammabilities", &buffers.flammabilities)
                .with("RestCells", &buffers.rest_cells)
                .with("BlockConstants", &buffers.block_levels);
        }
        let mut swapped = vec![old("OldState", &buffers.states), new("NewState", &buffers.states)];
        let new_bases = new("NewBases", &buffers.base_displacements);
        if matches!(variant, Variant::Solid | Variant::Melting) {
            vertices = vertices.with("Rest", &buffers.rest);
        }
        if variant == Variant::Melting {
            vertices = vertices
                .with("BasePoints", &buffers.base_points)
                .with("Clock", &buffers.clock)
                .with("Flows", &buffers.flows);
            swapped.push(new_bases);
        }
        let mut vertices = ping_pong::build(shaders, vertices, &swapped)?;
        let (mut base_points, mut setting) = (None, None);
        if variant == Variant::Melting {
            let guide = step("base-points")
                .with("Rest", &buffers.rest)
                .with("BasePoints", &buffers.base_points)
                .with("Blocks", &buffers.blocks)
                .with("Clock", &buffers.clock);
            let [even, odd] =
                ping_pong::build(shaders, guide, &[old("OldBases", &buffers.base_displacements), new_bases])?;
            let [even_vertices, odd_vertices] = vertices;
            if parameters.has_puddle(variant) {
                let [[there, back], [odd_there, odd_back]] = sweeps(shaders, label, buffers, model)?;
                let [even, even_vertices, there, back] = Pass::steps([even, even_vertices, there, back]);
                let [odd, odd_vertices, odd_there, odd_back] = Pass::steps([odd, odd_vertices, odd_there, odd_back]);
                let pairs = [[there, back], [odd_there, odd_back]];
                setting = Some(Setting { pairs, ticks: setting_ticks(variant, parameters, model) });
                (base_points, vertices) = (Some([even, odd]), [even_vertices, odd_vertices]);
            } else {
                let [[even, even_vertices], [odd, odd_vertices]] =
                    [[even, even_vertices], [odd, odd_vertices]].map(Pass::steps);
                (base_points, vertices) = (Some([even, odd]), [even_vertices, odd_vertices]);
            }
        }
        let (block_count, time_division) = (model.block_count(), parameters.time_division);
        let tick_work = TICK_TURNS * f64::from(model.triangle_count());
        let most_work = submission_work(shaders.device());
        Ok(InternalDeformation { base_points, vertices, setting, block_count, time_division, tick_work, most_work })
    }

    /// Records slice `slice` of a tick, `tick` ticks having been lit with it. Ticks beyond the work of a submission, as those before a
    /// late picture of a large mesh, begin another one.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: u64, slice: u32) -> Result<(), Error> {
        let newest = (tick % 2) as usize;
        frame.reserve_work(&self.vertices[newest], self.tick_work / f64::from(self.time_division), self.most_work)?;
        if let Some(base_points) = &self.base_points
            && slice == 0
        {
            frame.compute(&base_points[newest], |dispatch| dispatch.elements(self.block_count))?;
        }
        frame.compute(&self.vertices[newest], |dispatch| {
            dispatch.constants(&Slice { number: slice, division: self.time_division }).groups_indirect();
        })?;
        let sets = self.setting.as_ref().filter(|setting| setting.ticks.contains(&tick));
        let Some(setting) = sets.filter(|_| slice + 1 == self.time_division) else { return Ok(()) };
        let mut sweeps = setting.pairs[newest].iter().cycle().take(2 * SETTING_PAIRS);
        sweeps.try_for_each(|sweep| frame.compute(sweep, |dispatch| dispatch.groups_indirect()))
    }
}

/// A sweep of the folding from the newest state into a third one, and one back, for each ping-pong index of the tick.
fn sweeps(shaders: &ShaderLibrary, label: &str, buffers: &Buffers, model: &Model) -> Result<[[Pass; 2]; 2], Error> {
    let bytes = size_of::<VertexState>() as u64 * u64::from(model.vertex_count());
    let desc = BufferDesc::new(format!("{label}/setting"), bytes).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    let between = Buffer::new(shaders.device(), desc)?;
    let build = |swapped: &[Swapped<'_>]| {
        let sweep = Pass::compute("internal-deformation", "6.3", "burning/internal-deformation-setting.comp")
            .with("constants", &buffers.constants)
            .with("Labels", &buffers.labels)
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("Alive", &buffers.alive)
            .with("Clock", &buffers.clock)
            .with("Flows", &buffers.flows);
        ping_pong::build(shaders, buffers.vertex_chunks.changing(sweep), swapped)
    };
    let third = [&between, &between];
    let [even_there, odd_there] = build(&[new("OldState", &buffers.states), ("NewState", third)])?;
    let [even_back, odd_back] = build(&[("OldState", third), new("NewState", &buffers.states)])?;
    Ok([[even_there, even_back], [odd_there, odd_back]])
}

/// The ticks in which wax may set: a limit of active vertices may delay them.
fn setting_ticks(variant: Variant, parameters: &Parameters, model: &Model) -> Range<u64> {
    let tick_of = |radius: f32| f64::from(radius) / f64::from(parameters.speed_per_s) * TICKS_PER_S;
    let first = tick_of(last_radius(variant, parameters, model));
    let last = first + f64::from(parameters.setting_s) * TICKS_PER_S;
    // The device's clock is one of 32-bit floats.
    let margin = 2.0 + 1e-6 * last;
    let end = if parameters.active_limit == 0 { (last + margin) as u64 } else { u64::MAX };
    (first - margin).max(0.0) as u64..end
}

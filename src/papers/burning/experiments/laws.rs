//! Laws of a fire on any mesh: what nothing holds falls, and wax keeps its volume and its edges and comes to rest.

use std::sync::Arc;

use bytemuck::Pod;
use glam::DVec3;
use serde_json::{Value, json};

use super::super::setup::Setup;
use super::timeline::{MOST_TICKS, at_rest};
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, Mode};
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::result_table::ResultTable;
use crate::measure::{Error, Paper as _};
use crate::papers::burning::reference::falling::components;
use crate::papers::burning::{Burning, Film, MOST_PARTS, Parameters, Part, TICKS_PER_S, Variant, VertexState};

/// Ticks between two looks at what hangs together, and at what has melted.
const STEP: u32 = 5;
/// After the last vertex has burnt out, in which all comes to rest.
const REST_S: f64 = 5.0;
/// Height up to which something is on the ground, diagonals.
const ON_GROUND: f64 = 0.012;
/// Of volumes of the puddle.
const UNIT: f64 = 1.0 / 4_294_967_296.0;
/// By which an edge may miss its limits.
const TOLERANCE: f64 = 0.05;

/// A law with what a fire has shown.
pub struct Law {
    /// The quantity with its unit.
    name: &'static str,
    /// The worst; absent where the mesh has no such quantity.
    measured: Option<f64>,
    /// That it keeps within.
    bound: Bound,
}

enum Bound {
    Least(f64),
    Most(f64),
}

impl Law {
    fn row(&self) -> Vec<Value> {
        let (words, holds) = match self.bound {
            Bound::Least(least) => (format!("at least {least}"), self.measured.map(|measured| measured >= least)),
            Bound::Most(most) => (format!("at most {most}"), self.measured.map(|measured| measured <= most)),
        };
        let holds = holds.map(|holds| if holds { "yes" } else { "no" });
        vec![json!(self.name), json!(self.measured), json!(words), json!(holds)]
    }
}

/// The numbers without any given: no particles, and small pictures, for frames move the parts.
pub fn setup() -> Setup {
    let parameters = Parameters { fire: 0, smoke: 0, width: 64, height: 48, ..Parameters::default() };
    Setup { parameters, ..Setup::default() }
}

/// The table of laws.
pub fn table(laws: &[Law]) -> ResultTable {
    ResultTable {
        title: "Laws of a fire",
        columns: &["law", "measured", "bound", "holds"],
        rows: laws.iter().map(Law::row).collect(),
    }
}

/// A fire that is followed from ignition, a tick a frame.
struct Fire<'a, 'b> {
    machine: &'a mut Machine,
    watch: &'a mut Watch<'b>,
    paper: Burning,
    /// Until it has burnt out and come to rest.
    ticks: u32,
    done: u32,
}

impl<'a, 'b> Fire<'a, 'b> {
    fn new(machine: &'a mut Machine, setup: &Setup, variant: Variant, watch: &'a mut Watch<'b>) -> Result<Self, Error> {
        let paper = at_rest(machine, setup, variant)?;
        let p = &setup.parameters;
        let farthest = paper.model().rest.iter().map(|rest| f64::from(rest.boundary_distance)).fold(0.0, f64::max);
        let burning = (farthest + 2.0 * f64::from(p.width_of_areas)) / f64::from(p.speed_per_s) * TICKS_PER_S;
        let after = (f64::from(p.setting_s) + REST_S) * TICKS_PER_S + f64::from(p.flammability);
        let ticks = ((burning + after) as u32).min(MOST_TICKS);
        Ok(Fire { machine, watch, paper, ticks, done: 0 })
    }

    fn frame(&mut self) -> Result<(), Error> {
        self.watch.check()?;
        let Fire { machine, paper, done, .. } = self;
        machine.recorder.run(Mode::Plain, |frame| paper.record(frame, *done))?;
        self.done += 1;
        (self.watch.progress)(u64::from(self.done), u64::from(self.ticks));
        Ok(())
    }

    fn read<T: Pod>(&self, buffer: &Arc<Buffer>) -> Result<Vec<T>, Error> {
        Ok(bytemuck::pod_collect_to_vec(&read_buffer(&self.machine.device, buffer)?))
    }

    fn vertices(&self) -> Result<Vec<VertexState>, Error> {
        self.read(self.paper.state().0)
    }
}

/// Follows a shell and then wax until they have come to rest.
///
/// # Errors
/// [`Error::Interrupted`]; those of loading and of the Vulkan layer.
pub fn found(machine: &mut Machine, setup: &Setup, watch: &mut Watch<'_>) -> Result<Vec<Law>, Error> {
    let mut laws = of_falling(machine, setup, watch)?;
    laws.extend(of_melting(machine, setup, watch)?);
    Ok(laws)
}

/// Laws of a shell whose parts fall.
fn of_falling(machine: &mut Machine, setup: &Setup, watch: &mut Watch<'_>) -> Result<Vec<Law>, Error> {
    let mut fire = Fire::new(machine, setup, Variant::Shell, watch)?;
    let mut hovering = vec![0; fire.paper.model().rest.len()];
    let (mut longest, mut gained) = (0, 0.0_f64);
    let mut before: Vec<Part> = Vec::new();
    while fire.done < fire.ticks {
        fire.frame()?;
        let Some(parts) = fire.paper.parts() else { break };
        let (part_of, parts) = (parts.part_of.clone(), fire.read::<Part>(&parts.parts)?);
        // Between two searches the parts are the same.
        for (now, then) in parts.iter().zip(&before) {
            if now.center == then.center && now.weight == then.weight {
                gained = gained.max(f64::from(now.energy - then.energy) / (1.0 + f64::from(then.energy)));
            }
        }
        if fire.done.is_multiple_of(STEP) {
            let is_above = unsupported(&fire)?;
            let part_of: Vec<u32> = fire.read(&part_of)?;
            for ((ticks, is_above), &part) in hovering.iter_mut().zip(is_above).zip(&part_of) {
                let is_still = part >= MOST_PARTS || parts[part as usize].fallen_ticks == 0.0;
                *ticks = if is_above && is_still { *ticks + STEP } else { 0 };
                longest = longest.max(*ticks);
            }
        }
        before = parts;
    }
    let hovering_s = f64::from(longest) / TICKS_PER_S;
    Ok(vec![
        Law {
            name: "what nothing holds stays above the ground, s",
            measured: Some(hovering_s),
            bound: Bound::Most(0.5),
        },
        Law {
            name: "energy that a part gains in a tick, of its own",
            measured: Some(gained),
            bound: Bound::Most(1e-5),
        },
    ])
}

/// True for each vertex of something that hangs together and is nowhere on the ground, by a search of the host's.
fn unsupported(fire: &Fire<'_, '_>) -> Result<Vec<bool>, Error> {
    let (model, buffers) = (fire.paper.model(), fire.paper.buffers());
    let removed: Vec<u32> = fire.read(&buffers.removed)?;
    let world: Vec<[f32; 4]> = fire.read(&buffers.mapped)?;
    let state = fire.vertices()?;
    let left = model.triangles.iter().zip(&removed).filter(|(_, removed)| **removed == 0);
    let left: Vec<[usize; 3]> = left.map(|(triangle, _)| triangle.map(|v| v as usize)).collect();
    let holding = model.touching.iter().map(|pair| pair.map(|v| v as usize));
    let holding: Vec<[usize; 2]> = holding.filter(|pair| pair.iter().all(|v| state[*v].left > 0.0)).collect();
    let roots = components(world.len(), &left, &holding);
    let mut lowest = vec![f64::INFINITY; world.len()];
    for &vertex in left.as_flattened() {
        let root = roots[vertex];
        lowest[root] = lowest[root].min(f64::from(world[vertex][1] - model.floor));
    }
    Ok(roots.iter().map(|root| lowest[*root].is_finite() && lowest[*root] > ON_GROUND).collect())
}

/// Laws of wax.
fn of_melting(machine: &mut Machine, setup: &Setup, watch: &mut Watch<'_>) -> Result<Vec<Law>, Error> {
    let mut fire = Fire::new(machine, setup, Variant::Melting, watch)?;
    let start = enclosed(&fire, &fire.vertices()?);
    let mut changed = 0.0_f64;
    while fire.done < fire.ticks {
        fire.frame()?;
        if fire.done.is_multiple_of(STEP) {
            let now = enclosed(&fire, &fire.vertices()?) + melted(&fire)?;
            changed = changed.max(100.0 * (now / start - 1.0).abs());
        }
    }
    let end = fire.vertices()?;
    let in_range = edges_in_range(&fire, &end, &setup.parameters)?;
    for _ in 0..STEP {
        fire.frame()?;
    }
    let now = fire.vertices()?;
    let moved = now.iter().zip(&end).map(|(a, b)| f64::from(a.position.distance(b.position))).fold(0.0, f64::max);
    let floor = fire.paper.model().floor;
    let below = now.iter().map(|vertex| f64::from(floor - vertex.position.y)).fold(0.0, f64::max);
    let volume = (fire.paper.model().is_closed && fire.paper.puddle().is_some()).then_some(changed);
    let speed = moved * TICKS_PER_S / f64::from(STEP);
    Ok(vec![
        Law { name: "change of the volume of wax and puddle, %", measured: volume, bound: Bound::Most(5.0) },
        Law { name: "edges in range once it rests, %", measured: in_range, bound: Bound::Least(95.0) },
        Law {
            name: "speed of the wax 5 s after it has set, diagonals/s",
            measured: Some(speed),
            bound: Bound::Most(1e-3),
        },
        Law { name: "depth of the wax below the ground, diagonals", measured: Some(below), bound: Bound::Most(0.0) },
    ])
}

/// The volume of the mesh by the divergence theorem.
fn enclosed(fire: &Fire<'_, '_>, state: &[VertexState]) -> f64 {
    let model = fire.paper.model();
    let place = |v: u32| state[v as usize].position.as_dvec3();
    let tetrahedron = |&[a, b, c]: &[u32; 3]| DVec3::dot(place(a), place(b).cross(place(c))) / 6.0;
    f64::from(model.outward) * model.triangles.iter().map(tetrahedron).sum::<f64>()
}

/// The volume of the puddle and of what has evaporated of it.
fn melted(fire: &Fire<'_, '_>) -> Result<f64, Error> {
    let Some(puddle) = fire.paper.puddle() else { return Ok(0.0) };
    let heights: Vec<u32> = fire.read(&puddle.heights[(fire.paper.ticks() % 2) as usize])?;
    let film: Vec<Film> = fire.read(&puddle.film)?;
    let evaporated: f64 = film.iter().map(|film| f64::from(film.evaporated)).sum();
    Ok(UNIT * (heights.iter().map(|height| f64::from(*height)).sum::<f64>() + evaporated))
}

/// Percentage of the edges between vertices that have flowed that 6.3.3 leaves alone, within a tolerance.
fn edges_in_range(fire: &Fire<'_, '_>, state: &[VertexState], p: &Parameters) -> Result<Option<f64>, Error> {
    /// Area of the boundary from which on a vertex flows.
    const READY: u32 = 3;
    let model = fire.paper.model();
    let labels: Vec<u32> = fire.read(&fire.paper.buffers().labels)?;
    let longest = f64::from(p.omega) * f64::from(model.mean_edge);
    let shortest = longest / f64::from(p.chi);
    let (mut good, mut all) = (0, 0);
    for &[a, b, c] in &model.triangles {
        for ends in [[a, b], [b, c], [c, a]] {
            let [from, to] = ends.map(|v| v as usize);
            if labels[from] >= READY && labels[to] >= READY {
                let edge = (state[from].position - state[to].position).as_dvec3();
                let is_long = edge.x.hypot(edge.z) > (1.0 + TOLERANCE) * longest;
                good += u32::from(!is_long && edge.length() >= (1.0 - TOLERANCE) * shortest);
                all += 1;
            }
        }
    }
    Ok((all > 0).then(|| 100.0 * f64::from(good) / f64::from(all)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_holds_within_its_bound() {
        for (measured, bound, holds) in [
            (Some(0.4), Bound::Most(0.5), json!("yes")),
            (Some(0.6), Bound::Most(0.5), json!("no")),
            (Some(96.0), Bound::Least(95.0), json!("yes")),
            (Some(94.0), Bound::Least(95.0), json!("no")),
            (None, Bound::Most(5.0), Value::Null),
        ] {
            assert_eq!(Law { name: "it", measured, bound }.row()[3], holds);
        }
    }
}

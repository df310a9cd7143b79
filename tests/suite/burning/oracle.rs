//! The device's state, advanced by the oracle by one tick, is the device's next one.

use std::cell::Cell;
use std::collections::BTreeSet;

use fumarole::gpu::Compiler;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::refinement::Pattern;
use fumarole::papers::burning::reference::{Node, State, boundary};
use fumarole::papers::burning::{Heat, Look, Parameters, Variant};
use fumarole::scene::{Mesh, MeshSource, shapes};
use glam::{DVec3, UVec2, Vec2, Vec3};

use super::dump;
use super::fire::{Fire, text};
use super::twin::Twin;
use crate::common::gpu_test;

/// Distance from a threshold, in lengths, within which rounding may decide either way.
const CLOSE: f64 = 1e-5;
/// Largest difference of the device's numbers.
const EXACT: f64 = 1e-4;
/// The steps that are compared.
const STEPS: [u32; 3] = [1, 50, 200];

/// A boundary that has crossed half of the object after 200 ticks and has left burnt-out vertices behind.
fn parameters() -> Parameters {
    Parameters { speed_per_s: 0.15, flammability: 40, level_of_detail: Some(5), width: 64, height: 48, ..text() }
}

/// About 1,500 triangles of the scanned bunny: no two alike.
fn bunny() -> Mesh {
    with_triangles(&MeshSource::Bunny.load().unwrap(), 1500)
}

/// Burns on the device, and compares at every step; `show` sees the last state.
fn compare_and(variant: Variant, parameters: &Parameters, mesh: &Mesh, show: impl Fn(&State)) {
    compare_at(&STEPS, variant, parameters, mesh, show);
}

fn compare_at(steps: &[u32], variant: Variant, parameters: &Parameters, mesh: &Mesh, show: impl Fn(&State)) {
    for compiler in [Compiler::Glslang, Compiler::Naga] {
        gpu_test(|device| {
            let mut fire = Fire::compiled(device, compiler, variant, parameters, mesh);
            let twin = Twin::new(&fire, variant, parameters, mesh);
            let start = Comparison { fire: &fire, twin: &twin, at: format!("{variant:?} by {compiler} at rest") };
            start.rest(&dump::state(&fire, false));
            let mut done = 0;
            for &step in steps {
                fire.ticks(step - 1 - done);
                done = step;
                let before = dump::state(&fire, false);
                // The frames that the tick is spread over.
                let frames = parameters.time_division;
                ((step - 1) * frames..step * frames).for_each(|number| fire.frame(number));
                let after = dump::state(&fire, true);
                Comparison { fire: &fire, twin: &twin, at: format!("{variant:?} by {compiler} at step {step}") }
                    .all(&before, &after);
                if Some(&step) == steps.last() {
                    show(&after);
                }
            }
        });
    }
}

fn compare(variant: Variant, parameters: &Parameters, mesh: &Mesh) {
    compare_and(variant, parameters, mesh, |_| ());
}

/// One step.
struct Comparison<'a> {
    fire: &'a Fire,
    twin: &'a Twin,
    at: String,
}

impl Comparison<'_> {
    /// Before the first tick.
    fn rest(&self, found: &State) {
        let expected = State::at_rest(&self.twin.tick());
        self.same_points(&expected.positions, &found.positions, "positions");
        self.same_points(&expected.rotations, &found.rotations, "rotations");
        assert_eq!(expected.left, found.left, "{}", self.at);
        assert_eq!(expected.labels, found.labels, "{}", self.at);
        assert_eq!(expected.cells, found.cells, "{}", self.at);
        assert_eq!(expected.blocks, found.blocks, "{}", self.at);
        assert_eq!(expected.removed, found.removed, "{}", self.at);
        assert!(expected.alive == found.alive && expected.statuses == found.statuses, "{}", self.at);
    }

    /// Pass by pass; where rounding decides, the oracle goes on with the device's decision.
    fn all(&self, before: &State, after: &State) {
        let tick = self.twin.tick();
        let mut state = State::at_rest(&tick);
        let [mapped, normals] = [&state.mapped, &state.normals].map(Vec::clone);
        let [chars, glows] = [&state.chars, &state.glows].map(Vec::clone);
        state = State { mapped, normals, chars, glows, ..before.clone() };
        tick.heat(&mut state);
        self.labels(&mut state, after);
        tick.refine(&mut state);
        assert!(state.statuses == after.statuses && state.alive == after.alive, "{}: refinement", self.at);

        let margins = if tick.variant == Variant::Melting {
            let mut guides = tick.guided(&state);
            for (guide, place) in guides.iter_mut().zip(&after.guides) {
                if guide.0.distance(*place) >= EXACT && guide.1 < CLOSE {
                    *guide = (*place, f64::INFINITY);
                }
            }
            tick.follow(&mut state, &guides)
        } else {
            tick.deform(&mut state)
        };
        assert_eq!(state.left, after.left, "{}: flammability", self.at);
        self.settle_positions(&mut state, after, &margins);
        self.same_points(&state.guides, &after.guides, "guides");
        self.same_points(&state.flows, &after.flows, "flows");

        let margins = tick.locate(&mut state);
        self.settle(&mut state.cells, &after.cells, &margins, "blocks of vertices");
        let margins = tick.weigh(before, &mut state);
        if tick.variant != Variant::Solid {
            // Nothing else heeds the counter.
            state.blocks.iter_mut().zip(&after.blocks).for_each(|(our, their)| our.burning = their.burning);
        }
        self.settle(&mut state.blocks, &after.blocks, &margins, "weights of blocks");
        tick.rotate(&mut state);
        self.same_points(&state.rotations, &after.rotations, "rotations");
        tick.map(&mut state);
        self.same_points(&state.mapped, &after.mapped, "mapped positions");
        tick.remove(&mut state);
        assert!(state.left_out == after.left_out, "{}: triangles left out of the search", self.at);
        assert_eq!(state.removed, after.removed, "{}: removed triangles", self.at);
        self.shading(&mut state, after);
        self.counts(&state);
    }

    fn labels(&self, state: &mut State, after: &State) {
        let tick = self.twin.tick();
        assert_eq!([state.tick, state.growth_ticks], [after.tick, after.growth_ticks], "{}", self.at);
        let radius = tick.radius(state.growth_ticks);
        assert!(
            (radius - f64::from(self.fire.paper.counts().unwrap().radius)).abs() < 1e-6,
            "{}: radius {radius}",
            self.at
        );
        let limits = boundary::limits(radius, self.twin.constants.width);
        let margin = |reach: &f64| limits.map(|limit| (reach - limit).abs()).into_iter().fold(f64::INFINITY, f64::min);
        let margins: Vec<f64> = self.twin.constants.reaches.iter().map(margin).collect();
        // Chapter 3 has no virtual area: where the device labels it, nothing follows.
        let is_known = |label: u32| tick.variant != Variant::Shell || label != boundary::area::VIRTUAL;
        let labels: Vec<u32> = after.labels.iter().map(|l| if is_known(*l) { *l } else { 0 }).collect();
        self.settle(&mut state.labels, &labels, &margins, "areas");
        // Counted before anything moves.
        state.active_vertices = (0..state.labels.len()).filter(|v| tick.is_active(state, *v)).count() as u32;
        assert_eq!(state.active_vertices, after.active_vertices, "{}", self.at);
        let is_active = |t: &&Node| t.vertices.iter().any(|v| tick.is_active(state, *v));
        let active = self.twin.model.triangles.iter().filter(is_active).count();
        assert_eq!(active, self.fire.paper.counts().unwrap().active_triangles as usize, "{}", self.at);
    }

    /// Equal but where the decision was close; then the device's holds. Few are.
    fn settle<T: PartialEq + Clone + std::fmt::Debug>(
        &self,
        ours: &mut [T],
        theirs: &[T],
        margins: &[f64],
        what: &str,
    ) {
        assert_eq!(ours.len(), theirs.len());
        let mut settled = 0;
        for (i, (our, their)) in ours.iter_mut().zip(theirs).enumerate() {
            if our != their {
                assert!(margins[i] < CLOSE, "{}: {what}: {i} is {their:?}, not {our:?}, by {}", self.at, margins[i]);
                *our = their.clone();
                settled += 1;
            }
        }
        assert!(settled * 100 <= ours.len(), "{}: {what}: {settled} close calls of {}", self.at, ours.len());
    }

    fn settle_positions(&self, state: &mut State, after: &State, margins: &[f64]) {
        let mut settled = 0;
        for (v, margin) in margins.iter().enumerate() {
            let apart = state.positions[v].distance(after.positions[v]);
            if apart >= EXACT && *margin < CLOSE {
                (state.positions[v], state.flows[v]) = (after.positions[v], after.flows[v]);
                settled += 1;
            }
        }
        // What has been folded to the end of the range stays there to the last bit, so some are always close.
        assert!(settled * 25 <= margins.len(), "{}: {settled} close calls of {}", self.at, margins.len());
        self.same_points(&state.positions, &after.positions, "positions");
    }

    fn same_points(&self, ours: &[DVec3], theirs: &[DVec3], what: &str) {
        assert_eq!(ours.len(), theirs.len());
        let apart = ours.iter().zip(theirs).map(|(a, b)| a.distance(*b));
        let (v, worst) = apart.enumerate().fold((0, 0.0), |worst, next| if next.1 > worst.1 { next } else { worst });
        assert!(worst < EXACT, "{}: {what}: {v} is {}, not {}", self.at, theirs[v], ours[v]);
    }

    fn shading(&self, state: &mut State, after: &State) {
        let tick = self.twin.tick();
        tick.shade(state);
        let mut compared = 0;
        for c in 0..state.normals.len() {
            let numbers = [[state.chars[c], after.chars[c]], [state.glows[c], after.glows[c]]];
            assert!(numbers.iter().all(|[a, b]| (a - b).abs() < EXACT), "{}: colour of {c}: {numbers:?}", self.at);
            // Rounded positions turn triangles much smaller than the mesh's.
            if state.alive[self.twin.model.welds[c]] && tick.normal_sum(state, c).length() < 1e-5 {
                continue;
            }
            compared += 1;
            let [ours, theirs] = [state.normals[c], after.normals[c]];
            assert!(ours.distance(theirs) < 1e-3, "{}: normal of {c} is {theirs}, not {ours}", self.at);
        }
        assert!(compared * 10 > state.normals.len(), "{}: {compared} normals", self.at);
    }

    fn counts(&self, state: &State) {
        let (counts, tick) = (self.fire.paper.counts().unwrap(), self.twin.tick());
        let live = (0..state.left.len()).filter(|v| state.is_live(*v)).count();
        assert_eq!(counts.live_vertices as usize, live, "{}", self.at);
        let ready: u32 = state.blocks.iter().map(|b| b.ready).sum();
        assert_eq!(counts.ready_vertices, ready, "{}", self.at);
        let mut stream: Vec<[usize; 3]> = dump::stream(self.fire).iter().map(|t| t.map(|c| c as usize)).collect();
        match self.fire.paper.refinement() {
            None => {
                let mut expected = tick.stream(state);
                let (variant, parameters) = self.fire.paper.made_of();
                if parameters.orders_triangles(variant, false) {
                    stream.sort_unstable();
                    expected.sort_unstable();
                }
                assert!(stream == expected, "{}: stream", self.at);
            }
            Some(_) => self.leaves(state, self.twin.finest, &stream),
        }
        assert_eq!(counts.drawn_triangles as usize, stream.len(), "{}", self.at);
        let removed = state.removed.iter().filter(|r| **r).count();
        assert_eq!(counts.removed_triangles as usize, removed, "{}", self.at);
    }
}

impl Comparison<'_> {
    /// The drawn triangles of a pattern, node by node. Which diagonal a transition cuts along is left open.
    fn leaves(&self, state: &State, finest: u32, stream: &[[usize; 3]]) {
        let model = &self.twin.model;
        let pattern = Pattern::new(model, &state.statuses);
        let mut left = stream;
        for (node, expected) in pattern.drawn(finest) {
            if pattern.is_consumed(node, &|t| state.removed[t]) {
                continue;
            }
            assert!(left.len() >= expected.len(), "{}: the stream ends before node {node}", self.at);
            let (found, rest) = left.split_at(expected.len());
            left = rest;
            let found: Vec<[usize; 3]> = found.iter().map(|t| t.map(|c| model.welds[c])).collect();
            assert_eq!(outline(&found), outline(&expected), "{}: node {node}", self.at);
        }
        assert!(left.is_empty(), "{}: {} triangles too many", self.at, left.len());
    }
}

/// Directed edges that no other of the triangles has the other way.
fn outline(triangles: &[[usize; 3]]) -> BTreeSet<[usize; 2]> {
    let edges: BTreeSet<[usize; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a])).copied().collect()
}

#[test]
fn shell() {
    compare(Variant::Shell, &parameters(), &bunny());
}

#[test]
fn blocks_in_random_directions() {
    compare(Variant::Shell, &Parameters { random_rotation: true, ..parameters() }, &bunny());
}

#[test]
fn fully_subdivided() {
    let parameters = Parameters { levels: Some(3), ..parameters() };
    compare(Variant::FullySubdivided, &parameters, &shapes::cuboid());
}

#[test]
fn low_poly() {
    for level_of_detail in [5, 2] {
        let parameters = Parameters { levels: Some(4), level_of_detail: Some(level_of_detail), ..parameters() };
        compare(Variant::LowPoly, &parameters, &shapes::cuboid());
    }
}

#[test]
fn solid() {
    compare(Variant::Solid, &Parameters { levels: Some(0), ..parameters() }, &bunny());
    // So much displacement that vertices come down to their cores.
    let fierce = Parameters { levels: Some(0), beta: 0.9, flammability: 150, ..parameters() };
    compare(Variant::Solid, &fierce, &bunny());
    // Vertices that retire, and larger triangles that are refined.
    let parameters = Parameters { levels: Some(3), retire_at: 0.4, ..parameters() };
    compare(Variant::Solid, &parameters, &shapes::cuboid());
}

#[test]
fn melting() {
    compare(Variant::Melting, &Parameters { levels: Some(0), ..parameters() }, &bunny());
    // By the natural look it sets.
    let (look, heat) = (Look::Natural, Some(Heat::Air));
    let sets = Parameters { levels: Some(0), look, heat, setting_s: 2.0, speed_per_s: 0.5, ..parameters() };
    compare(Variant::Melting, &sets, &bunny());
    // Lit in the middle: structures above it turn.
    let sources = vec![Vec3::new(0.0, 0.2, 0.25), Vec3::new(-0.2, 0.1, 0.0)];
    let parameters = Parameters { levels: Some(3), sources, ..parameters() };
    compare(Variant::Melting, &parameters, &shapes::cuboid());
}

/// By the natural look alone; the text knows no ground.
#[test]
fn what_lies_on_the_ground_is_not_drawn_below_it() {
    let sheet = with_triangles(&shapes::plane(Vec2::ONE, UVec2::ONE), 1500);
    for look in [Look::Natural, Look::Dissertation] {
        let parameters = Parameters { look, heat: Some(Heat::Air), collapse: false, ..parameters() };
        gpu_test(|device| {
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &sheet);
            fire.ticks(199);
            fire.frame(199);
            let state = dump::state(&fire, true);
            let lowest = |places: &[DVec3]| places.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
            let [simulated, drawn] = [&state.positions, &state.mapped].map(|places| lowest(places));
            assert!(simulated < -0.005, "{look:?}: {simulated}");
            assert_eq!(drawn > -1e-6, look == Look::Natural, "{look:?}: {drawn}");
        });
    }
}

#[test]
fn a_tick_over_several_frames() {
    for variant in [Variant::Shell, Variant::Melting] {
        compare(variant, &Parameters { levels: Some(0), time_division: 3, ..parameters() }, &bunny());
    }
}

#[test]
fn a_limit_of_active_vertices() {
    let parameters = Parameters { active_limit: 60, ..parameters() };
    compare_and(Variant::Shell, &parameters, &bunny(), |state| {
        assert!(state.growth_ticks < state.tick && state.active_vertices > 30, "the limit never held the boundary");
    });
}

#[test]
fn what_comes_off_without_keeping_it_connected() {
    // A search begins with the second of them and ends with the last.
    let steps = [1, 200, 203];
    let removed = [true, false].map(|keep_connected| {
        let parameters = Parameters { keep_connected, blocks: [12, 14, 16], ..parameters() };
        let count = Cell::new(0);
        compare_at(&steps, Variant::Shell, &parameters, &bunny(), |state| {
            count.set(state.removed.iter().filter(|r| **r).count());
        });
        count.get()
    });
    assert!(0 < removed[0] && removed[0] < removed[1], "{removed:?}");
}

/// As many triangles around one vertex as are taken, beneath it or above it: the longest loops that there are, all of which
/// the device has to end by themselves. The rim goes to and fro as it rises, so that no triangle is a needle.
fn fan(is_apex_above: bool) -> Mesh {
    const TRIANGLES: u32 = 8192;
    let rim = (0..=TRIANGLES).map(|i| {
        let along = i as f32 / TRIANGLES as f32;
        let swept = (33.0 * along).rem_euclid(2.0);
        let place = Vec2::from_angle(3.0 * if swept > 1.0 { 2.0 - swept } else { swept });
        let height = 0.2 + 0.8 * along;
        Vec3::new(place.x, if is_apex_above { -height } else { height }, place.y)
    });
    let mut mesh = Mesh {
        name: "fan".to_owned(),
        positions: std::iter::once(Vec3::ZERO).chain(rim).collect(),
        indices: (1..=TRIANGLES).flat_map(|i| [0, i, i + 1]).collect(),
        ..Mesh::default()
    };
    mesh.smooth_normals();
    mesh.validate().unwrap();
    mesh
}

/// The apex is where the fire begins: the lowest vertex, and of what melts the highest.
#[test]
fn a_fan_of_all_the_triangles_that_a_vertex_may_have() {
    // At rest, ready, deformed, and with the rim's nearest on fire.
    const STEPS: [u32; 4] = [1, 25, 40, 60];
    for (variant, levels) in [
        (Variant::Shell, 0),
        (Variant::FullySubdivided, 1),
        (Variant::LowPoly, 1),
        (Variant::Solid, 0),
        (Variant::Melting, 0),
    ] {
        let parameters = Parameters { levels: Some(levels), ..parameters() };
        compare_at(&STEPS, variant, &parameters, &fan(variant == Variant::Melting), |state| {
            assert!(state.left.iter().zip(&state.labels).any(|(left, label)| *label == 4 && *left < 40), "{variant:?}");
        });
    }
}

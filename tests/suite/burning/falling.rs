//! Parts that nothing holds: which they are, and how they fall.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::falling::{Body, components, moments};
use fumarole::papers::burning::{Bend, Heat, MOST_PARTS, Parameters, Part, SEARCH_TICKS, Variant};
use fumarole::scene::{Mesh, MeshSource, shapes};
use glam::{DQuat, DVec3, Mat4, Quat, Vec3};

use super::bending::bent;
use super::fire::{Fire, State};
use crate::common::gpu_test;

/// A fast fire in which parts fall, and blocks hardly turn: places in the object are the simulated positions.
fn natural() -> Parameters {
    Parameters {
        width: 32,
        height: 24,
        speed_per_s: 0.3,
        flammability: 20,
        blocks: [4, 4, 4],
        gamma: f32::MIN_POSITIVE,
        ..Parameters::default()
    }
}

/// A fall without fire, from a height of 0.4.
fn dropped() -> Parameters {
    Parameters { sources: vec![Vec3::new(0.0, 900.0, 0.0)], floor: Some(-0.4), ..natural() }
}

/// Boxes of sizes at places.
fn boxes(parts: &[(Vec3, Vec3)]) -> Mesh {
    joined(
        parts.iter().map(|&(size, at)| {
            shapes::cuboid().transformed(&(Mat4::from_translation(at) * Mat4::from_scale(size / 2.0)))
        }),
    )
}

fn joined(mut parts: impl Iterator<Item = Mesh>) -> Mesh {
    let mut mesh = parts.next().expect("one at least");
    for part in parts {
        let first = mesh.positions.len() as u32;
        mesh.indices.extend(part.indices.iter().map(|i| first + i));
        mesh.positions.extend(&part.positions);
        mesh.normals.extend(&part.normals);
        mesh.texture_coordinates.extend(&part.texture_coordinates);
    }
    mesh
}

/// A table whose legs burn through: a box for the top, four for the legs.
fn table() -> Mesh {
    let top = (Vec3::new(2.0, 0.12, 1.4), Vec3::new(0.0, 1.06, 0.0));
    let legs = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let legs = legs.map(|(x, z)| (Vec3::new(0.12, 1.0, 0.12), Vec3::new(0.8 * x, 0.5, 0.5 * z)));
    with_triangles(&boxes(&[&[top][..], &legs].concat()), 2500)
}

pub fn meshes() -> [Mesh; 4] {
    let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 1500);
    let teapot = with_triangles(&MeshSource::Teapot.load().unwrap(), 1500);
    [bunny, teapot, table(), with_triangles(&shapes::sphere(32, 32), 1000)]
}

/// The parts of a fire after some tick, with each vertex's place in the object and in the world.
struct Seen {
    part_of: Vec<u32>,
    parts: Vec<Part>,
    weights: Vec<f64>,
    places: Vec<DVec3>,
}

impl Seen {
    fn of(fire: &Fire) -> Self {
        let parts = fire.paper.parts().expect("parts fall");
        let state = fire.state();
        let weights: Vec<u32> = fire.read(&parts.weights);
        Seen {
            part_of: fire.read(&parts.part_of),
            parts: fire.read(&parts.parts),
            weights: weights.into_iter().map(f64::from).collect(),
            places: fire
                .read::<Bend>(&parts.bends)
                .iter()
                .zip(&state.vertices)
                .map(|(bend, v)| bent(bend, v.position))
                .collect(),
        }
    }

    fn members(&self, part: u32) -> (Vec<DVec3>, Vec<f64>) {
        (0..self.places.len()).filter(|v| self.part_of[*v] == part).map(|v| (self.places[v], self.weights[v])).unzip()
    }

    fn body(&self, part: u32) -> Body {
        let part = &self.parts[part as usize];
        Body {
            orientation: DQuat::from_array(part.orientation.to_array().map(f64::from)).normalize(),
            offset: part.offset.as_dvec3(),
            rests: part.rests != 0.0,
            velocity: part.velocity.as_dvec3(),
            spin: part.spin.as_dvec3(),
        }
    }
}

/// Triangles that are there, by their vertices.
fn left(fire: &Fire, removed: &[u32]) -> Vec<[usize; 3]> {
    let all = fire.paper.model().triangles.iter().zip(removed);
    all.filter(|(_, r)| **r == 0).map(|(t, _)| t.map(|v| v as usize)).collect()
}

/// Pairs of vertices of separate parts of the mesh that hold each other.
fn holding(fire: &Fire, state: &State) -> Vec<[usize; 2]> {
    let holds = |pair: &&[u32; 2]| pair.iter().all(|v| state.vertices[*v as usize].left > 0.0);
    let touching = fire.paper.model().touching.iter().filter(holds);
    touching.map(|pair| pair.map(|v| v as usize)).collect()
}

#[test]
fn parts_are_what_hangs_together() {
    gpu_test(|device| {
        for mesh in meshes() {
            // A sphere of heat parts what a fire along the surface eats up from its end.
            let parameters = Parameters { heat: Some(Heat::Air), ..natural() };
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &mesh);
            let count = fire.paper.model().rest.len();
            let mut most = 0;
            for _ in 0..40 {
                // The search begins with what is left after its first tick, and has seen what is left before its last.
                let before = fire.state();
                fire.ticks(SEARCH_TICKS as u32 - 2);
                let within = fire.state();
                fire.ticks(2);
                let part_of: Vec<u32> = fire.read(&fire.paper.parts().unwrap().part_of);
                let [more, less] =
                    [&before, &within].map(|s| components(count, &left(&fire, &s.removed), &holding(&fire, s)));
                let mut there = vec![false; count];
                left(&fire, &within.removed).as_flattened().iter().for_each(|v| there[*v] = true);
                let mut part_at = vec![None; count];
                let mut more_of = vec![None; count];
                for v in (0..count).filter(|v| there[*v]) {
                    assert!(part_of[v] < MOST_PARTS, "vertex {v} of tick {}", before.counts.tick);
                    // Together before the search's end: one part. In one part: together at its beginning.
                    assert_eq!(*part_at[less[v]].get_or_insert(part_of[v]), part_of[v]);
                    assert_eq!(*more_of[part_of[v] as usize].get_or_insert(more[v]), more[v]);
                }
                assert!((0..count).all(|v| there[v] || part_of[v] == u32::MAX));
                most = most.max(more_of.iter().flatten().count());
            }
            assert!(most > 1, "nothing came apart");
        }
    });
}

/// Steps a fall in the air and on the ground by the oracle, from the device's state of every tick.
fn compare(device: &Arc<Device>, mesh: &Mesh) {
    let mut fire = Fire::new(device, Variant::Shell, &dropped(), mesh);
    fire.ticks(SEARCH_TICKS as u32);
    let mut before = Seen::of(&fire);
    let (places, weights) = before.members(0);
    let (center, inertia) = moments(&places, &weights);
    let mut energy = f64::INFINITY;
    let (mut compared, mut differing) = (0, 0);
    for tick in 0..240 {
        fire.ticks(1);
        let after = Seen::of(&fire);
        let (expected, margin) = before.body(0).step(&places, &weights, -0.4);
        let found = after.body(0);
        // Where two vertices are as near, rounding chooses one.
        if margin > 2e-6 {
            compared += 1;
            let is_same = expected.rests == found.rests
                && expected.velocity.distance(found.velocity) < 2e-3
                && expected.spin.distance(found.spin) < 2e-2
                && expected.world(center).distance(found.world(center)) < 1e-4;
            differing += u32::from(!is_same);
            assert!(is_same || tick >= 12, "tick {tick}, in the air: {expected:?} {found:?}");
        }
        assert!(after.parts[0].center.as_dvec3().distance(center) < 1e-5);
        let now = found.energy(center, inertia, -0.4);
        assert!((now - f64::from(after.parts[0].energy)).abs() < 1e-3 * (1.0 + now), "tick {tick}");
        assert!(now <= energy + 1e-5, "tick {tick}: energy {now} after {energy}");
        energy = now;
        let lowest = places.iter().map(|p| found.world(*p).y + 0.4).fold(f64::INFINITY, f64::min);
        assert!(lowest > -0.004, "tick {tick}: {lowest} below the ground");
        for &[a, b, _] in &fire.paper.model().triangles {
            let [a, b] = [a, b].map(|v| before.places[v as usize]);
            let length = found.world(a).distance(found.world(b));
            assert!((length - a.distance(b)).abs() < 1e-6, "an edge of {}", a.distance(b));
        }
        before = after;
    }
    let heights = places.iter().map(|p| before.body(0).world(*p).y + 0.4);
    assert!(heights.fold(f64::INFINITY, f64::min) < 0.01);
    // Which contact comes first, and whether a step would gain energy, rounding decides now and then.
    assert!(compared > 60 && 5 * differing < compared, "{differing} of {compared} ticks differ");
}

#[test]
fn a_fall_is_the_oracles() {
    gpu_test(|device| {
        let lean = |mesh: &Mesh, radians: f32| {
            mesh.transformed(&Mat4::from_quat(Quat::from_rotation_z(radians) * Quat::from_rotation_x(0.3 * radians)))
        };
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 1500);
        compare(device, &bunny);
        compare(device, &lean(&bunny, 0.9));
        let slab = shapes::cuboid().transformed(&Mat4::from_scale(Vec3::new(1.0, 2.1, 0.3)));
        compare(device, &with_triangles(&lean(&slab, 0.4), 600));
    });
}

/// Burns a mesh and asserts that nothing without support hovers, and that no part gains energy. Answers with how many
/// parts were seen to fall, in all ticks together.
pub fn assert_supported(device: &Arc<Device>, name: &str, mesh: &Mesh) -> usize {
    let mut fire = Fire::new(device, Variant::Shell, &natural(), mesh);
    let count = fire.paper.model().rest.len();
    let mut hovering = vec![0; count];
    let mut fallen = 0;
    let mut parts: Vec<Part> = Vec::new();
    for _ in 0..300 {
        fire.ticks(1);
        let (state, seen) = (fire.state(), Seen::of(&fire));
        let roots = components(count, &left(&fire, &state.removed), &holding(&fire, &state));
        let world: Vec<DVec3> = (0..count)
            .map(|v| match seen.part_of[v] {
                part if part < MOST_PARTS => seen.body(part).world(seen.places[v]),
                _ => seen.places[v],
            })
            .collect();
        let mut lowest = vec![f64::INFINITY; count];
        left(&fire, &state.removed).as_flattened().iter().for_each(|v| {
            lowest[roots[*v]] = lowest[roots[*v]].min(world[*v].y);
        });
        for v in 0..count {
            let part = seen.part_of[v];
            let is_still = part >= MOST_PARTS || seen.parts[part as usize].fallen_ticks == 0.0;
            let is_above = lowest[roots[v]].is_finite() && lowest[roots[v]] > 0.012;
            hovering[v] = if is_still && is_above { hovering[v] + 1 } else { 0 };
            assert!(hovering[v] <= 30, "{name}: vertex {v} hovers at tick {}", state.counts.tick);
        }
        let falls = |part: &Part| part.fallen_ticks > 3.0 && part.velocity.y < -0.3;
        fallen += seen.parts.iter().filter(|part| falls(part)).count();
        // Between two searches the parts are the same.
        for (now, before) in seen.parts.iter().zip(&parts) {
            if now.center == before.center && now.weight == before.weight {
                let [now, before] = [now.energy, before.energy];
                assert!(now <= before + 1e-5 * (1.0 + before), "{name}: energy {now} after {before}");
            }
        }
        parts = seen.parts;
    }
    fallen
}

#[test]
fn nothing_hovers_and_energy_never_grows() {
    gpu_test(|device| {
        for (mesh, name) in meshes().iter().zip(["bunny", "teapot", "table", "sphere"]) {
            let fallen = assert_supported(device, name, mesh);
            assert!(fallen > 20, "{name}: {fallen}");
        }
    });
}

#[test]
fn what_touches_is_held_and_the_text_alone_is_the_same_simulation() {
    gpu_test(|device| {
        // A lid lies on the teapot: nothing falls before the fire.
        let cold = Parameters { sources: dropped().sources, ..natural() };
        for mesh in meshes() {
            let mut fire = Fire::new(device, Variant::Shell, &cold, &mesh);
            fire.ticks(60);
            let seen = Seen::of(&fire);
            let moved =
                seen.part_of.iter().filter(|part| **part < MOST_PARTS && seen.parts[**part as usize].rests == 0.0);
            assert_eq!(moved.count(), 0);
        }
        let text = Parameters { collapse: false, keep_connected: false, ..natural() };
        let [mut whole, mut parts] = [text, natural()].map(|p| Fire::new(device, Variant::Shell, &p, &meshes()[0]));
        for _ in 0..6 {
            for fire in [&mut whole, &mut parts] {
                fire.ticks(25);
            }
            assert!(whole.state().vertices == parts.state().vertices && whole.state().removed == parts.state().removed);
        }
        assert!(parts.state().counts.removed_triangles > 200);
    });
}

#[test]
fn a_part_comes_to_lie_on_another() {
    gpu_test(|device| {
        let lower = (Vec3::new(1.0, 0.3, 1.0), Vec3::new(0.0, 0.15, 0.0));
        let upper = (Vec3::new(0.5, 0.2, 0.5), Vec3::new(0.05, 0.5, 0.02));
        let mesh = boxes(&[lower, upper]);
        let cold = Parameters { sources: dropped().sources, ..natural() };
        let mut fire = Fire::new(device, Variant::Shell, &cold, &with_triangles(&mesh, 3000));
        let mut energy = f32::INFINITY;
        for tick in 0..150 {
            fire.ticks(1);
            let seen = Seen::of(&fire);
            let Some(part) = seen.parts.iter().find(|part| part.fallen_ticks > 0.0) else { continue };
            assert!(part.energy <= energy + 1e-5, "tick {tick}: {} after {energy}", part.energy);
            energy = part.energy;
        }
        let seen = Seen::of(&fire);
        let part = (0..2).find(|part| seen.parts[*part as usize].fallen_ticks > 0.0).expect("one has fallen");
        assert!(seen.parts[1 - part as usize].rests == 1.0, "the other lies still");
        let (places, _) = seen.members(part);
        let heights = places.iter().map(|place| seen.body(part).world(*place).y);
        let lowest = heights.fold(f64::INFINITY, f64::min);
        let diagonal = Vec3::new(1.0, 0.6, 1.0).length();
        let top = f64::from(0.3 / diagonal);
        assert!(lowest > top - 0.02 && lowest < top + 0.05, "{lowest} above {top}");
        assert!(seen.body(part).velocity.length() < 0.1, "{:?}", seen.parts[part as usize]);
    });
}

#[test]
fn parts_that_fall_at_once_meet() {
    gpu_test(|device| {
        // Three boxes above each other come down at once: the lower two are still falling when the next one comes.
        let lower = (Vec3::new(0.8, 0.2, 0.8), Vec3::new(0.0, 0.1, 0.0));
        let middle = (Vec3::new(0.5, 0.2, 0.5), Vec3::new(0.03, 0.45, 0.02));
        let upper = (Vec3::new(0.3, 0.2, 0.3), Vec3::new(0.01, 0.8, -0.02));
        let mut fire =
            Fire::new(device, Variant::Shell, &dropped(), &with_triangles(&boxes(&[lower, middle, upper]), 3000));
        fire.ticks(SEARCH_TICKS as u32);
        let start = Seen::of(&fire);
        let mut order: Vec<u32> = (0..3).collect();
        let lowest_at_start =
            |part: &u32| start.members(*part).0.iter().map(|place| place.y).fold(f64::INFINITY, f64::min);
        order.sort_by(|a, b| lowest_at_start(a).total_cmp(&lowest_at_start(b)));
        let mut energies = [f32::INFINITY; 3];
        for tick in 0..180 {
            fire.ticks(1);
            let seen = Seen::of(&fire);
            // They lie askew on each other, and so their middles are what is compared with their thickness of 0.138.
            let middles = [0, 1, 2].map(|at: usize| {
                let (part, (places, _)) = (order[at], seen.members(order[at]));
                places.iter().map(|place| seen.body(part).world(*place).y).sum::<f64>() / places.len() as f64
            });
            for at in [0, 1] {
                let apart = middles[at + 1] - middles[at];
                assert!(apart > 0.11, "tick {tick}: box {} sinks into the one below it: {middles:?}", at + 1);
                assert!(tick < 120 || apart < 0.21, "tick {tick}: box {} hangs in the air: {middles:?}", at + 1);
            }
            for (energy, part) in energies.iter_mut().zip(&seen.parts) {
                assert!(part.energy <= *energy + 1e-5 * (1.0 + *energy), "tick {tick}: {} after {energy}", part.energy);
                *energy = part.energy;
            }
        }
        let seen = Seen::of(&fire);
        assert!(seen.parts[..3].iter().all(|part| part.velocity.length() < 0.1), "{:?}", &seen.parts[..3]);
    });
}

#[test]
fn equal_time_gives_equal_bits_and_a_restart_replays() {
    use fumarole::measure::Paper;
    gpu_test(|device| {
        let mesh = table();
        let bits = |fire: &Fire| -> (Vec<u32>, Vec<u32>) {
            let parts = fire.paper.parts().unwrap();
            (fire.read(&parts.part_of), fire.read(&parts.parts))
        };
        let mut reference = Fire::new(device, Variant::Shell, &natural(), &mesh);
        reference.ticks(121);
        let expected = bits(&reference);
        let mut jump = Fire::new(device, Variant::Shell, &natural(), &mesh);
        jump.frame(120);
        assert!(bits(&jump) == expected);
        jump.paper.restart().unwrap();
        (0..=120).for_each(|number| jump.frame(number));
        assert!(bits(&jump) == expected);
        let halves = Parameters { time_step_s: 1.0 / 120.0, ..natural() };
        let mut fire = Fire::new(device, Variant::Shell, &halves, &mesh);
        (0..242).for_each(|number| fire.frame(number));
        assert!(bits(&fire) == expected);
    });
}

/// Beside a body of so many vertices that sums over it are longer than a word, chips fall as they do anywhere.
#[test]
fn chips_beside_a_body_of_100000_vertices_fall_to_the_ground() {
    gpu_test(|device| {
        let chips: Vec<(Vec3, Vec3)> = (0..12)
            .map(|k| {
                let (z, x) = (0.5 * k as f32).sin_cos();
                (Vec3::new(0.02, 0.012, 0.03), Vec3::new(1.4 * x, -0.8 + 0.02 * k as f32, 1.4 * z))
            })
            .collect();
        let mesh = joined([shapes::sphere(400, 260), boxes(&chips)].into_iter());
        let parameters = Parameters { floor: None, bending: 0.0, ..dropped() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &mesh);
        assert!(fire.paper.model().vertex_count() > 100_000);
        let floor = fire.paper.model().floor;
        let mut fallen = 0;
        for _ in 0..12 {
            fire.ticks(4);
            let seen = Seen::of(&fire);
            let numbers: std::collections::BTreeSet<u32> =
                seen.part_of.iter().copied().filter(|&part| part < MOST_PARTS).collect();
            fallen = 0;
            for &part in &numbers {
                let state = &seen.parts[part as usize];
                assert!(state.energy.is_finite() && state.energy > -0.3, "part {part}: energy {}", state.energy);
                let body = seen.body(part);
                let lowest = seen.members(part).0.iter().map(|&place| body.world(place).y).fold(f64::MAX, f64::min);
                // What spins by radians in a tick comes into the ground, by some of its lengths.
                assert!(lowest > f64::from(floor) - 0.03, "part {part}: {lowest}, the ground at {floor}");
                let center = state.center.as_dvec3();
                fallen += usize::from(body.world(center).y < center.y - 0.01);
            }
        }
        assert!(fallen >= 10, "{fallen} chips have fallen");
    });
}

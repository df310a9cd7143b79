//! Parts that hang by little come down before they break, and nothing else moves.

use fumarole::measure::Paper;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::bending::{Bending, FARTHEST, turned};
use fumarole::papers::burning::{Bend, Heat, Hinge, Load, MOST_PARTS, Parameters, Part, Variant};
use fumarole::scene::{Bounds, Mesh, MeshSource, shapes};
use glam::{DQuat, DVec3, Mat4, Vec3};

use super::falling::meshes;
use super::fire::Fire;
use super::registries;
use crate::common::gpu_test;

/// A post on a wide foot, with an arm that ends in the air.
fn gallows() -> Mesh {
    let mut mesh = shapes::cuboid().transformed(&Mat4::from_scale(Vec3::new(0.05, 0.5, 0.05)));
    mesh = with_triangles(&mesh, 3000);
    let radius = 0.2 / std::f32::consts::FRAC_PI_2;
    for place in &mut mesh.positions {
        let along = place.y + 0.5;
        let wide = 1.0 + 60.0 * (0.1 - along).max(0.0);
        let angle = ((along - 0.4) / 0.2).clamp(0.0, 1.0) * std::f32::consts::FRAC_PI_2;
        let (sin, cos) = angle.sin_cos();
        let middle = Vec3::new(radius * (1.0 - cos) + (along - 0.6).max(0.0), along.min(0.4) + radius * sin, 0.0);
        *place = middle + wide * (place.x * Vec3::new(cos, -sin, 0.0) + place.z * Vec3::Z);
    }
    mesh
}

/// A fire in the middle of the arm.
fn burning(mesh: &Mesh) -> Parameters {
    let bounds = Bounds::of_points(mesh.positions.iter().copied());
    let base = Vec3::new(0.5 * (bounds.min.x + bounds.max.x), bounds.min.y, 0.5 * (bounds.min.z + bounds.max.z));
    let source = (Vec3::new(0.3, 0.53, 0.0) - base) / (bounds.max - bounds.min).length();
    Parameters {
        width: 32,
        height: 24,
        speed_per_s: 0.1,
        flammability: 90,
        blocks: [4, 4, 4],
        gamma: f32::MIN_POSITIVE,
        heat: Some(Heat::Air),
        sources: vec![source],
        ..Parameters::default()
    }
}

pub fn bent(bend: &Bend, place: Vec3) -> DVec3 {
    let turn = DQuat::from_array(bend.turn.to_array().map(f64::from));
    turn * place.as_dvec3() + bend.offset.as_dvec3()
}

fn bends(fire: &Fire) -> Vec<Bend> {
    fire.read(&fire.paper.parts().unwrap().bends)
}

fn of_sections(fire: &Fire) -> Vec<(DQuat, DVec3)> {
    let bends: Vec<Bend> = fire.read(&fire.paper.bending().unwrap().sections);
    let turn = |bend: &Bend| DQuat::from_array(bend.turn.to_array().map(f64::from)).normalize();
    bends.iter().map(|bend| (turn(bend), bend.offset.as_dvec3())).collect()
}

#[test]
fn an_arm_droops_before_it_falls() {
    gpu_test(|device| {
        let mesh = gallows();
        let mut fire = Fire::new(device, Variant::Shell, &burning(&mesh), &mesh);
        let weights: Vec<u32> = fire.read(&fire.paper.parts().unwrap().weights);
        let mut before = bends(&fire);
        let mut parts: Vec<Part> = Vec::new();
        let (mut drooped, mut fallen, mut stretched) = (0.0_f64, false, 0.0_f64);
        for tick in 0..420 {
            fire.ticks(1);
            let (state, now) = (fire.state(), bends(&fire));
            let part_of: Vec<u32> = fire.read(&fire.paper.parts().unwrap().part_of);
            let then = std::mem::replace(&mut parts, fire.read(&fire.paper.parts().unwrap().parts));
            // Bending lowers what it moves: without the kinetic energy that it never has, energy does not grow.
            let mut raised = 0.0;
            for (v, vertex) in state.vertices.iter().enumerate() {
                let [from, to] = [&before, &now].map(|bends| bent(&bends[v], vertex.position));
                raised += f64::from(weights[v]) * (to.y - from.y);
                let falls = |parts: &[Part]| {
                    parts.get(part_of[v] as usize).is_some_and(|part| part.rests == 0.0 && part.fallen_ticks > 4.0)
                };
                if part_of[v] < MOST_PARTS && falls(&then) {
                    fallen = true;
                    assert!(now[v] == before[v], "tick {tick}: vertex {v} bends while it falls");
                } else if part_of[v] < MOST_PARTS && !fallen {
                    drooped = drooped.max(f64::from(vertex.position.y) - to.y);
                }
            }
            raised /= f64::from(weights.iter().sum::<u32>());
            assert!(raised < 1e-6, "tick {tick}: raised by {raised}");
            if tick % 10 == 0 {
                let left =
                    fire.paper.model().triangles.iter().zip(&state.removed).filter(|(_, removed)| **removed == 0);
                for (&[a, b, c], _) in left {
                    for [a, b] in [[a, b], [b, c], [c, a]].map(|edge| edge.map(|v| v as usize)) {
                        let rest = state.vertices[a].position.distance(state.vertices[b].position);
                        let [from, to] = [a, b].map(|v| bent(&now[v], state.vertices[v].position));
                        if rest > 0.2 * fire.paper.model().mean_edge {
                            stretched = stretched.max((from.distance(to) / f64::from(rest) - 1.0).abs());
                        }
                    }
                }
            }
            before = now;
        }
        println!("drooped by {drooped}, stretched by {stretched}");
        assert!(fallen && drooped > 0.03, "{fallen} {drooped}");
        assert!(stretched < 0.5, "an edge by {stretched} of its length");
    });
}

#[test]
fn what_is_whole_keeps_its_shape() {
    gpu_test(|device| {
        let far = vec![Vec3::new(0.0, 900.0, 0.0)];
        let of_files = registries::FILES.map(registries::load);
        for mesh in meshes().iter().chain(&of_files).chain(&[gallows()]) {
            let cold = Parameters { sources: far.clone(), ..burning(mesh) };
            let mut fire = Fire::new(device, Variant::Shell, &cold, mesh);
            fire.ticks(40);
            assert!(bends(&fire).iter().all(|bend| *bend == Bend::NONE));
            assert!(fire.paper.bending().is_some());
        }
        let none = Parameters { bending: 0.0, ..burning(&gallows()) };
        assert!(Fire::new(device, Variant::Shell, &none, &gallows()).paper.bending().is_none());
    });
}

#[test]
fn equal_time_bends_equally_and_a_restart_bends_back() {
    gpu_test(|device| {
        let mesh = gallows();
        let mut reference = Fire::new(device, Variant::Shell, &burning(&mesh), &mesh);
        reference.ticks(150);
        let expected = bends(&reference);
        assert!(expected.iter().any(|bend| *bend != Bend::NONE));
        let coarse = Parameters { time_step_s: 3.0 / 60.0, ..burning(&mesh) };
        let mut fire = Fire::new(device, Variant::Shell, &coarse, &mesh);
        for _ in 0..2 {
            (0..50).for_each(|number| fire.frame(number));
            assert!(bends(&fire) == expected);
            fire.paper.restart().unwrap();
            assert!(bends(&fire).iter().all(|bend| *bend == Bend::NONE));
        }
    });
}

#[test]
fn joints_turn_as_their_loads_ask() {
    gpu_test(|device| {
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 1500);
        for mesh in [gallows(), bunny] {
            let mut fire = Fire::new(device, Variant::Shell, &burning(&mesh), &mesh);
            let mut compared = 0;
            for _ in 0..60 {
                fire.ticks(1);
                let before = of_sections(&fire);
                let angles: Vec<f32> = fire.read(&fire.paper.bending().unwrap().angles);
                let angles: Vec<f64> = angles.into_iter().map(f64::from).collect();
                let parts: Vec<Part> = fire.read(&fire.paper.parts().unwrap().parts);
                fire.ticks(1);
                let bending = fire.paper.bending().unwrap();
                let (loads, strengths): (Vec<Load>, Vec<u32>) =
                    (fire.read(&bending.loads), fire.read(&bending.strengths));
                let hinges: Vec<Hinge> = fire.read(&bending.hinges);
                let down = |part: u32| {
                    let turn = DQuat::from_array(parts[part as usize].orientation.to_array().map(f64::from));
                    turn.inverse() * DVec3::NEG_Y
                };
                let oracle = Bending {
                    divided: fire.paper.model().sections.as_ref().unwrap(),
                    loads: &loads,
                    strengths: &strengths,
                    bends: &before,
                    angles: &angles,
                    area: bending.sizes.area.into(),
                    rests: &|part| parts[part as usize].rests != 0.0,
                    down: &down,
                };
                let bearings = oracle.bearings();
                let mut turns = Vec::new();
                for (section, hinge) in hinges.iter().enumerate().filter(|(_, hinge)| hinge.angle > 0.0) {
                    let bearing = bearings.iter().find(|bearing| bearing.joint == hinge.joint);
                    let bearing = bearing.unwrap_or_else(|| panic!("joint {} bears nothing alone", hinge.joint));
                    assert_eq!(bearing.beyond[0], section);
                    let angle = f64::from(hinge.angle);
                    assert!(hinge.axis.as_dvec3().distance(bearing.axis) < 1e-3, "{hinge:?} {bearing:?}");
                    assert!(hinge.pivot.as_dvec3().distance(bearing.pivot) < 1e-5, "{hinge:?} {bearing:?}");
                    let is_asked = (angle - bearing.asked).abs() < 1e-5 + 1e-2 * bearing.asked;
                    let is_limited = angle < bearing.asked && angle * bearing.reach < FARTHEST;
                    assert!(is_asked || is_limited, "{angle} of {bearing:?}");
                    compared += u32::from(is_asked);
                    turns.push((bearing.clone(), angle));
                }
                // Of every one that is asked for more than a trifle.
                for bearing in bearings.iter().filter(|bearing| bearing.asked > 2e-5 && bearing.asked.is_finite()) {
                    assert!(turns.iter().any(|(turn, _)| turn.joint == bearing.joint), "{bearing:?} stays");
                }
                for (now, expected) in of_sections(&fire).iter().zip(turned(&before, &turns)) {
                    assert!(now.1.distance(expected.1) < 1e-4 && now.0.dot(expected.0).abs() > 1.0 - 1e-6);
                }
                fire.ticks(2);
            }
            assert!(compared > 20, "{compared}");
        }
    });
}

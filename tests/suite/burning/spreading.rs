//! Several objects in one scene: the fire goes from one to the next, along surfaces and then through the air.

use fumarole::measure::study::Study;
use fumarole::papers::burning::setup::Setup;
use fumarole::papers::burning::{Beside, Heat, Parameters, Variant};
use fumarole::scene::MeshSource;
use glam::Vec3;

use super::fire::{Fire, quick};
use crate::common::gpu_test;

/// Three balls in a row, lit at the first.
fn row() -> Setup {
    let beside = |x: f32| Beside { source: MeshSource::Sphere, base: Vec3::new(x, 0.0, 0.0), yaw_deg: 0.0, scale: 1.0 };
    Setup {
        mesh: MeshSource::Sphere,
        objects: vec![beside(0.7), beside(1.4)],
        triangles: Some(3000),
        parameters: Parameters {
            heat: Some(Heat::Surface),
            // In the scene's own diagonals, beyond the first.
            sources: vec![Vec3::new(-1.0, 0.1, 0.0)],
            ..quick()
        },
        ..Setup::default()
    }
}

#[test]
fn fire_goes_from_one_object_to_the_next() {
    gpu_test(|device| {
        let setup = row();
        let scene = setup.load().unwrap();
        let mut fire = Fire::new(device, Variant::Shell, &setup.parameters, &scene.mesh);
        let rest = fire.paper.model().rest.clone();
        let (low, high) = rest.iter().fold((f32::MAX, f32::MIN), |(low, high), vertex| {
            (low.min(vertex.position.x), high.max(vertex.position.x))
        });
        // Between the balls' middles.
        let ball = |x: f32| (3.0 * (x - low) / (high - low)).clamp(0.0, 2.0) as usize;
        let mut first_ticks = [None; 3];
        for tick in (0..600).step_by(5) {
            fire.ticks(5);
            for (vertex, label) in rest.iter().zip(fire.state().labels) {
                if label >= 3 {
                    first_ticks[ball(vertex.position.x)].get_or_insert(tick);
                }
            }
        }
        let ticks = first_ticks.map(|tick| tick.expect("each ball burns"));
        assert!(ticks[0] + 20 < ticks[1] && ticks[1] + 20 < ticks[2], "{ticks:?}");
        assert_eq!(fire.paper.counts().unwrap().live_vertices, 0, "all of them burn out");
        // Through the air alone it is there sooner than along them.
        let air = Parameters { heat: Some(Heat::Air), ..setup.parameters.clone() };
        let straight = Fire::new(device, Variant::Shell, &air, &scene.mesh);
        let reach = |fire: &Fire| fire.paper.model().rest.iter().map(|v| v.boundary_distance).fold(0.0, f32::max);
        assert!(reach(&fire) > 1.1 * reach(&straight), "{} {}", reach(&fire), reach(&straight));
    });
}

#[test]
fn every_part_keeps_its_own_reach_to_rounding_in_any_order_of_triangles() {
    gpu_test(|device| {
        let setup = row();
        let scene = setup.load().unwrap();
        let mut turned = scene.mesh.clone();
        // The same triangles, from last to first.
        let triangles: Vec<[u32; 3]> = turned.indices.chunks_exact(3).rev().map(|t| [t[0], t[1], t[2]]).collect();
        turned.indices = triangles.into_flattened();
        let [one, other] = [&scene.mesh, &turned].map(|mesh| {
            let fire = Fire::new(device, Variant::Shell, &setup.parameters, mesh);
            fire.paper.model().rest.iter().map(|v| (v.position, v.boundary_distance)).collect::<Vec<_>>()
        });
        assert_eq!(one.len(), other.len());
        for ((place, reach), (same, again)) in one.iter().zip(&other) {
            assert!(place == same && (reach - again).abs() < 1e-5, "{place}: {reach} {again}");
        }
    });
}

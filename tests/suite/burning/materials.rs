//! Objects of several materials: each burns as it would alone, and metal does not.

use std::sync::Arc;

use fumarole::papers::burning::materials::{Kind, Materials, Substance};
use fumarole::papers::burning::{Parameters, Variant};
use fumarole::scene::{Mesh, shapes};
use glam::{Mat4, Vec3};

use super::fire::{Fire, quick};
use crate::common::gpu_test;

/// A closed bar along x, of 32 slices; the left half is of the first material.
fn bar() -> (Mesh, Vec<u32>) {
    let bar = shapes::sphere(32, 32).placed(&Mat4::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let bar = bar.placed(&Mat4::from_scale(Vec3::new(4.0, 1.0, 1.0)));
    let of_vertex = bar.positions.iter().map(|position| if position.x < 0.0 { 1 } else { 2 }).collect();
    (bar, of_vertex)
}

/// Lit in the middle.
fn parameters(materials: Option<Materials>) -> Parameters {
    Parameters {
        materials: materials.map(Arc::new),
        sources: vec![Vec3::ZERO],
        keep_connected: false,
        blocks: [16, 2, 2],
        ..quick()
    }
}

fn of(substances: [Substance; 2], of_vertex: &[u32]) -> Materials {
    Materials { substances: substances.to_vec(), of_vertex: of_vertex.to_vec(), sha256: String::new() }
}

/// Farther from the border than what happens at it comes in the time.
const FAR: f32 = 0.2;

#[test]
fn each_of_two_materials_burns_as_it_does_alone() {
    gpu_test(|device| {
        let (mesh, of_vertex) = bar();
        let wood = Substance { flammability: 30, ..Substance::of(Kind::Wood) };
        let paper = Substance { flammability: 9, epsilon: 0.4, ..Substance::of(Kind::Paper) };
        for variant in [Variant::Shell, Variant::Solid] {
            let alone = |substance: &Substance| {
                let parameters = Parameters {
                    flammability: substance.flammability,
                    epsilon: substance.epsilon,
                    beta: substance.beta,
                    rho: substance.rho,
                    phi: substance.phi,
                    levels: Some(0),
                    ..parameters(None)
                };
                Fire::new(device, variant, &parameters, &mesh)
            };
            let both =
                Parameters { levels: Some(0), ..parameters(Some(of([wood.clone(), paper.clone()], &of_vertex))) };
            let mut fires = [Fire::new(device, variant, &both, &mesh), alone(&wood), alone(&paper)];
            let rest: Vec<Vec3> = fires[0].paper.model().rest.iter().map(|vertex| vertex.position).collect();
            for _ in 0..4 {
                fires.iter_mut().for_each(|fire| fire.ticks(20));
                let [both, wood, paper] = fires.each_ref().map(Fire::state);
                let mut compared = [0, 0];
                for (vertex, at) in rest.iter().enumerate().filter(|(_, at)| at.x.abs() > FAR) {
                    let (side, alone) = if at.x < 0.0 { (0, &wood) } else { (1, &paper) };
                    let (found, expected) = (both.vertices[vertex], alone.vertices[vertex]);
                    assert_eq!(found.left, expected.left, "{variant:?} {at}");
                    assert!(
                        found.position.distance(expected.position) < 1e-6,
                        "{variant:?} {at}: {found:?} {expected:?}"
                    );
                    compared[side] += usize::from(found.left < 9.0);
                }
                let is_over = fires[0].paper.ticks() == 80;
                assert!(!is_over || compared.iter().all(|count| *count > 20), "{compared:?}");
            }
        }
    });
}

#[test]
fn metal_neither_burns_nor_moves_and_what_burns_on_it_goes() {
    gpu_test(|device| {
        let (mesh, of_vertex) = bar();
        let metal = Substance { conductivity: 1.0, ..Substance::of(Kind::Metal) };
        let paper = Substance::of(Kind::Paper);
        for variant in [Variant::Shell, Variant::LowPoly, Variant::Solid, Variant::Melting] {
            let levels = Some(u32::from(variant == Variant::LowPoly));
            let materials = of([metal.clone(), paper.clone()], &of_vertex);
            let parameters = Parameters { levels, ..parameters(Some(materials)) };
            let mut fire = Fire::new(device, variant, &parameters, &mesh);
            let before = fire.state();
            fire.ticks(140);
            let now = fire.state();
            let model = fire.paper.model();
            let is_metal = |vertex: usize| model.substances[vertex] == 1;
            let count = now.vertices.len();
            assert!((0..count).filter(|v| is_metal(*v)).all(|v| now.vertices[v] == before.vertices[v]), "{variant:?}");
            assert!((0..count).all(|v| !is_metal(v) || now.labels[v] <= 2));
            let alive: Vec<u32> = fire.read(&fire.paper.buffers().alive);
            let burnt = |v: usize| is_metal(v) || alive[v] == 0 || now.vertices[v].left == 0.0;
            assert!((0..count).all(burnt), "{variant:?}");
            // Of the shell only the metal is left, whole.
            for (triangle, &removed) in model.triangles.iter().zip(&now.removed) {
                let metal = triangle.iter().filter(|v| is_metal(**v as usize)).count();
                let goes = variant.removes() && metal < 3;
                assert!(variant == Variant::LowPoly || (removed == 1) == goes, "{variant:?} {metal}");
            }
        }
    });
}

#[test]
fn heat_comes_through_metal_sooner() {
    gpu_test(|device| {
        let (mesh, _) = bar();
        // Metal up to the right end, which is of wood.
        let of_vertex: Vec<u32> = mesh.positions.iter().map(|p| if p.x < 2.0 { 1 } else { 2 }).collect();
        let at_left = |materials| Parameters {
            sources: vec![Vec3::new(-0.5, 0.1, 0.0)],
            levels: Some(0),
            ..parameters(materials)
        };
        let burning = |materials| {
            let mut fire = Fire::new(device, Variant::Shell, &at_left(materials), &mesh);
            fire.ticks(70);
            let labels = fire.state().labels;
            let model = fire.paper.model();
            model.rest.iter().zip(labels).filter(|(rest, label)| rest.position.x > 0.35 && *label >= 3).count()
        };
        let metal = of([Substance::of(Kind::Metal), Substance::of(Kind::Wood)], &of_vertex);
        assert!(burning(Some(metal)) > 0 && burning(None) == 0);
    });
}

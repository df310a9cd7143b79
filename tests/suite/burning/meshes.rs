//! Meshes as they come: degenerate, non-manifold, in pieces; and counts.

use std::collections::HashSet;
use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::measure::{Paper, Variant as _};
use fumarole::papers::burning::model::{Model, with_triangles};
use fumarole::papers::burning::{Parameters, Variant};
use fumarole::scene::{Mesh, MeshSource, shapes};
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::fire::{Fire, quick, text};
use crate::common::gpu_test;

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh {
        name: "made".to_owned(),
        positions: positions.iter().map(|&p| p.into()).collect(),
        indices: triangles.as_flattened().to_vec(),
        ..Mesh::default()
    };
    mesh.smooth_normals();
    mesh.validate().unwrap();
    mesh
}

/// Burns out by every method, with pictures; the shell's fire.
fn burn(device: &Arc<Device>, mesh: &Mesh) -> Fire {
    for &variant in Variant::ALL.iter().filter(|v| **v != Variant::Shell) {
        burn_by(device, mesh, variant);
    }
    burn_by(device, mesh, Variant::Shell)
}

fn burn_by(device: &Arc<Device>, mesh: &Mesh, variant: Variant) -> Fire {
    let levels = (variant != Variant::Shell).then_some(2);
    let mut fire = Fire::new(device, variant, &Parameters { levels, ..quick() }, mesh);
    [0, 30, 60, 100, 160, 260].into_iter().for_each(|number| fire.frame(number));
    let buffers = fire.paper.buffers();
    let drawn: Vec<f32> =
        [&buffers.mapped, &buffers.normals, &buffers.colors].into_iter().flat_map(|b| fire.read::<f32>(b)).collect();
    assert!(drawn.iter().all(|v| v.is_finite()), "{} {variant:?}", mesh.name);
    let state = fire.state();
    assert!(state.vertices.iter().all(|v| v.position.is_finite() && v.left.is_finite()));
    assert!(state.rotations.iter().flatten().all(|angle| angle.is_finite()));
    assert_eq!(state.counts.live_vertices, 0);
    fire
}

#[test]
fn bad_geometry_burns_without_nan() {
    gpu_test(|device| {
        // Two corners in one place, three in a line, a triangle twice and once turned over, an edge with three
        // triangles, and a piece by itself.
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.5, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.3, -0.2, 0.4],
            [3.0, 0.0, 0.0],
            [3.0, 1.0, 0.0],
            [3.0, 0.0, 1.0],
        ];
        let triangles =
            [[0, 1, 2], [0, 3, 1], [0, 4, 1], [0, 1, 2], [0, 2, 1], [0, 1, 5], [0, 1, 6], [7, 8, 9], [7, 7, 8]];
        let fire = burn(device, &mesh(&positions, &triangles));
        assert_eq!(fire.paper.model().degenerate, 2);
        let warnings = fire.paper.warnings();
        assert!(warnings[0].starts_with("2 triangles"), "{warnings:?}");
        // Flat, so that the grid is as thin as its margin.
        burn(device, &shapes::plane(Vec2::splat(2.0), UVec2::splat(8)));
        // One triangle, far from the origin.
        burn(device, &mesh(&[[1e6, 1e6, 1e6], [1e6 + 1.0, 1e6, 1e6], [1e6, 1e6 + 1.0, 1e6]], &[[0, 1, 2]]));
    });
}

#[test]
fn coincident_corners_are_one_vertex() {
    let parameters = text();
    let model = |mesh: &Mesh, levels| {
        let parameters = Parameters { levels: Some(levels), ..parameters.clone() };
        Model::new(mesh, Variant::Shell, &parameters, 1 << 27).unwrap()
    };
    for (levels, vertices, draw_vertices) in [(0, 8, 24), (1, 26, 54), (3, 386, 486)] {
        let model = model(&shapes::cuboid(), levels);
        assert_eq!((model.rest.len(), model.lattice.welds.len()), (vertices, draw_vertices));
        assert_eq!(model.triangles.len(), 12 << (2 * levels));
        // No two vertices in one place; every edge has two triangles, so nothing can rip.
        let places: HashSet<[u32; 3]> =
            model.lattice.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        assert_eq!(places.len(), vertices);
        let mut edges = std::collections::HashMap::new();
        for [a, b, c] in &model.triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&balance| balance == 0));
        let bounds = model.bounds;
        assert!((bounds.diagonal().length() - 1.0).abs() < 1e-6 && bounds.min.y == 0.0);
        // The incidence lists hold every corner once, by triangle.
        for vertex in 0..vertices as u32 {
            let list = model.incidence.of(vertex);
            assert!(!list.is_empty() && list.is_sorted());
            assert!(list.iter().all(|&e| model.triangles[e as usize / 4][e as usize % 4] == vertex));
        }
    }
}

#[test]
fn meshes_come_to_their_counts() {
    for (source, wanted, slack) in [
        (MeshSource::Bunny, 15_949, 2),
        (MeshSource::Teapot, 20_000, 2),
        (MeshSource::Box, 12_288, 2),
        (MeshSource::Teapot, 1_000, 200),
        (MeshSource::Sphere, 1_000, 20),
    ] {
        let mesh = source.load().unwrap();
        let counted = with_triangles(&mesh, wanted);
        counted.validate().unwrap();
        assert!(counted.triangle_count().abs_diff(wanted) <= slack, "{source}: {}", counted.triangle_count());
        let (before, after) = (mesh.bounds(), counted.bounds());
        assert!((before.max - after.max).abs().max_element() < 0.1 * before.diagonal().length());
        if wanted > mesh.triangle_count() {
            assert_eq!(before, after);
            let area = |mesh: &Mesh| -> f64 {
                let place = |i: u32| mesh.positions[i as usize].as_dvec3();
                mesh.indices
                    .chunks_exact(3)
                    .map(|t| (place(t[1]) - place(t[0])).cross(place(t[2]) - place(t[0])).length())
                    .sum()
            };
            assert!((area(&counted) / area(&mesh) - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn several_sources_burn_from_the_nearest() {
    let sources = [Vec3::new(0.5, 0.0, 0.0), Vec3::new(-0.5, 0.3, 0.0)];
    let distances = |sources: &[Vec3]| -> Vec<f32> {
        let parameters = Parameters { sources: sources.to_vec(), ..text() };
        let model = Model::new(&shapes::sphere(16, 16), Variant::Shell, &parameters, 1 << 27).unwrap();
        model.rest.iter().map(|r| r.boundary_distance).collect()
    };
    let both = distances(&sources);
    let each = sources.map(|source| distances(&[source]));
    for (vertex, distance) in both.iter().enumerate() {
        assert_eq!(*distance, each[0][vertex].min(each[1][vertex]));
    }
}

#[test]
fn more_triangles_than_the_device_binds_are_refused() {
    let parameters = Parameters { levels: Some(5), ..text() };
    let error = Model::new(&shapes::cuboid(), Variant::Shell, &parameters, 100_000).err().unwrap().to_string();
    assert!(error.contains("`levels` 5"), "{error}");
}

#[test]
fn a_fan_that_no_thread_can_visit_is_refused() {
    let fan = |triangles: u32| {
        let rim = (0..=triangles).map(|i| Vec2::from_angle(6.0 * i as f32 / triangles as f32));
        let positions: Vec<[f32; 3]> = [[0.0; 3]].into_iter().chain(rim.map(|p| [p.x, 0.0, p.y])).collect();
        mesh(&positions, &(1..=triangles).map(|i| [0, i, i + 1]).collect::<Vec<_>>())
    };
    let model = |triangles: u32| Model::new(&fan(triangles), Variant::Shell, &quick(), u64::MAX);
    assert!(model(8192).is_ok());
    let error = model(8193).err().expect("it is refused").to_string();
    assert!(error.contains("8193") && error.contains("`mesh`") && !error.contains('\n'), "{error}");
}

#[test]
fn an_open_mesh_as_a_solid_is_told() {
    gpu_test(|device| {
        let mut turned = shapes::cuboid();
        turned.indices.swap(0, 1);
        let open = shapes::plane(Vec2::splat(2.0), UVec2::splat(2));
        for (variant, mesh, is_told) in [
            (Variant::Solid, shapes::cuboid(), false),
            (Variant::Solid, turned, true),
            (Variant::Solid, open.clone(), true),
            (Variant::Shell, open, false),
        ] {
            let fire = Fire::new(device, variant, &quick(), &mesh);
            assert_eq!(fire.paper.warnings().iter().any(|w| w.contains("not closed")), is_told, "{variant:?}");
        }
    });
}

#[test]
fn a_solid_that_encloses_nothing_is_told() {
    gpu_test(|device| {
        let thin = |height: f32| shapes::cuboid().transformed(&Mat4::from_scale(Vec3::new(1.0, height, 1.0)));
        for (variant, height, is_told) in
            [(Variant::Solid, 1e-4, true), (Variant::Solid, 0.1, false), (Variant::Shell, 1e-4, false)]
        {
            let fire = Fire::new(device, variant, &quick(), &thin(height));
            let warnings = fire.paper.warnings();
            assert_eq!(warnings.iter().any(|w| w.contains("next to nothing")), is_told, "{variant:?}: {warnings:?}");
        }
    });
}

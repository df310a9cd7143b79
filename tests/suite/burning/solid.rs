//! Solids (chapter 5): they burn inwards, and nothing of their surface leaves; by the natural look they burn to ash.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::{Look, Parameters, Variant};
use fumarole::scene::{Mesh, shapes};

use super::fire::{Fire, State, ball, quick};
use crate::common::gpu_test;

fn volume(fire: &Fire, state: &State) -> f64 {
    let place = |vertex: u32| state.vertices[vertex as usize].position.as_dvec3();
    let triangles = fire.paper.model().triangles.iter();
    triangles.map(|&[a, b, c]| place(a).dot(place(b).cross(place(c))) / 6.0).sum()
}

/// Burns all of a mesh; the volume after every 20 ticks, as shares of that at rest.
fn burn(device: &Arc<Device>, parameters: &Parameters, mesh: &Mesh) -> Vec<f64> {
    let mut fire = Fire::new(device, Variant::Solid, parameters, mesh);
    let at_rest = volume(&fire, &fire.state());
    let mut shares = Vec::new();
    while fire.state().vertices.iter().any(|v| v.left > 0.0) {
        fire.ticks(20);
        shares.push(volume(&fire, &fire.state()) / at_rest);
        assert!(shares.len() < 100, "it burns out");
    }
    assert_eq!(fire.state().counts.removed_triangles, 0);
    shares
}

#[test]
fn the_enclosed_volume_shrinks_and_stays_positive_and_no_triangle_leaves() {
    gpu_test(|device| {
        for (beta, flammability) in [(0.05, 60), (0.2, 60)] {
            let parameters = Parameters { beta, flammability, keep_connected: false, ..quick() };
            let shares = burn(device, &parameters, &ball());
            assert!(shares.iter().all(|share| *share > 0.0 && *share < 1.001), "{shares:?}");
            assert!(shares.last().is_some_and(|&share| share < 0.99), "{shares:?}");
        }
    });
}

#[test]
fn by_the_natural_look_a_solid_burns_to_ash() {
    gpu_test(|device| {
        for burn_away in [true, false] {
            let parameters = Parameters { look: Look::Natural, burn_away, ..quick() };
            let mut fire = Fire::new(device, Variant::Solid, &parameters, &ball());
            assert_eq!(fire.paper.parts().is_some(), burn_away, "what falls comes off");
            let mut removed = vec![0];
            while fire.state().vertices.iter().any(|vertex| vertex.left > 0.0) {
                fire.ticks(20);
                removed.push(fire.state().counts.removed_triangles);
                assert!(removed.len() < 100, "it burns out");
            }
            fire.ticks(20);
            let all = fire.paper.model().triangle_count();
            let last = fire.state().counts.removed_triangles;
            assert!(removed.is_sorted() && last == if burn_away { all } else { 0 }, "{last} of {all}: {removed:?}");
            // Little by little.
            let some = removed.iter().filter(|count| **count > 0 && **count < all).count();
            assert!(!burn_away || some > 2, "{removed:?}");
        }
    });
}

/// Great values of what moves vertices inwards in table 3.1, by a ball, flat sides and a thin shell of a pot.
#[test]
fn no_constants_turn_a_solid_inside_out() {
    gpu_test(|device| {
        let teapot = with_triangles(&shapes::teapot(), 2000);
        for (name, mesh) in [("ball", ball()), ("box", with_triangles(&shapes::cuboid(), 768)), ("teapot", teapot)] {
            let ends = [(0.9, 0.5, 0.5, 200), (0.99, 0.99, 0.5, 200), (0.99, 0.99, 0.99, 20), (0.99, 0.99, 0.99, 200)];
            for (beta, rho, phi, flammability) in ends {
                let parameters = Parameters { beta, rho, phi, flammability, ..quick() };
                let shares = burn(device, &parameters, &mesh);
                assert!(shares.iter().all(|&share| share > 0.0), "{name}, beta {beta}, L {flammability}: {shares:?}");
            }
        }
    });
}

#[test]
fn a_solid_burns_inwards_and_a_shell_does_not() {
    gpu_test(|device| {
        let parameters = Parameters { beta: 0.5, ..quick() };
        let volumes = [Variant::Shell, Variant::Solid].map(|variant| {
            let mut fire = Fire::new(device, variant, &parameters, &ball());
            fire.ticks(200);
            volume(&fire, &fire.state())
        });
        assert!(volumes[1] < 0.95 * volumes[0], "{volumes:?}");
    });
}

#[test]
fn a_vertex_that_has_burnt_far_enough_leaves_the_group() {
    gpu_test(|device| {
        let parameters = Parameters { retire_at: 0.5, ..quick() };
        let mut fire = Fire::new(device, Variant::Solid, &parameters, &ball());
        fire.ticks(200);
        let before = fire.state();
        assert!(before.vertices.iter().all(|v| v.left == 10.0), "half of an L of 20 is left everywhere");
        assert_eq!((before.counts.active_vertices, before.counts.live_vertices as usize), (0, before.vertices.len()));
        fire.ticks(20);
        assert!(fire.state().vertices == before.vertices, "nothing moves any more");
    });
}

#[test]
fn blocks_count_the_ticks_that_they_burn() {
    gpu_test(|device| {
        let mut fire = Fire::new(device, Variant::Solid, &quick(), &ball());
        let blocks = fire.state().blocks.len();
        let mut expected = vec![0; blocks];
        for _ in 0..60 {
            let before = fire.state();
            fire.ticks(1);
            let state = fire.state();
            let mut burns = vec![false; blocks];
            for ((&cell, &label), vertex) in state.cells.iter().zip(&state.labels).zip(&before.vertices) {
                burns[cell as usize] |= label == 4 && vertex.left > 0.0;
            }
            for (count, burns) in expected.iter_mut().zip(burns) {
                *count += i32::from(burns);
            }
            assert_eq!(state.blocks.iter().map(|b| b.combustion).collect::<Vec<_>>(), expected);
        }
        assert!(expected.iter().any(|&count| count > 10));
    });
}

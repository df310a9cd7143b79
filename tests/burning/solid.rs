//! Solids (chapter 5): they burn inwards, and nothing of their surface leaves.

use fumarole::papers::burning::{Parameters, Variant};
use glam::DVec3;

use crate::common::gpu_test;
use crate::fire::{Fire, State, ball, quick};

fn volume(fire: &Fire, state: &State) -> f64 {
    let place = |vertex: u32| {
        let [x, y, z, _] = state.vertices[vertex as usize];
        DVec3::new(x.into(), y.into(), z.into())
    };
    let triangles = fire.paper.model().triangles.iter();
    triangles.map(|&[a, b, c]| place(a).dot(place(b).cross(place(c))) / 6.0).sum()
}

#[test]
fn the_enclosed_volume_shrinks_and_stays_positive_and_no_triangle_leaves() {
    gpu_test(|device| {
        for (beta, flammability) in [(0.05, 60), (0.2, 60)] {
            let parameters = Parameters { beta, flammability, keep_connected: false, ..quick() };
            let mut fire = Fire::new(device, Variant::Solid, &parameters, &ball());
            let at_rest = volume(&fire, &fire.state());
            for _ in 0..20 {
                fire.ticks(20);
                let volume = volume(&fire, &fire.state());
                assert!(volume > 0.0 && volume < 1.001 * at_rest, "{volume} of {at_rest}");
            }
            let state = fire.state();
            assert!(state.vertices.iter().all(|v| v[3] == 0.0), "all of it has burnt");
            assert!(volume(&fire, &state) < 0.99 * at_rest);
            assert_eq!(state.counts.removed_triangles, 0);
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
        assert!(before.vertices.iter().all(|v| v[3] == 10.0), "half of an L of 20 is left everywhere");
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
                burns[cell as usize] |= label == 4 && vertex[3] > 0.0;
            }
            for (count, burns) in expected.iter_mut().zip(burns) {
                *count += i32::from(burns);
            }
            assert_eq!(state.blocks.iter().map(|b| b[5]).collect::<Vec<_>>(), expected);
        }
        assert!(expected.iter().any(|&count| count > 10));
    });
}

//! Melting objects (chapter 6): wax runs down, keeps its edges in range and comes to rest.

use fumarole::papers::burning::{Parameters, Variant};
use fumarole::scene::shapes;
use glam::DVec3;

use super::fire::{Fire, State, ball, quick};
use crate::common::gpu_test;

fn wax() -> Parameters {
    Parameters { speed_per_s: 0.05, flammability: 60, blocks: [6, 7, 8], ..quick() }
}

fn place(state: &State, vertex: u32) -> DVec3 {
    state.vertices[vertex as usize].position.as_dvec3()
}

/// Weighted by the triangles' areas.
fn height(fire: &Fire, state: &State) -> f64 {
    let (mut sum, mut areas) = (0.0, 0.0);
    for corners in &fire.paper.model().triangles {
        let [a, b, c] = corners.map(|vertex| place(state, vertex));
        let area = (b - a).cross(c - a).length();
        sum += area * (a.y + b.y + c.y) / 3.0;
        areas += area;
    }
    sum / areas
}

/// Share of the edges between flow-true vertices that 6.3.3 leaves alone, within 5 %.
pub fn in_range(fire: &Fire, state: &State, parameters: &Parameters) -> f64 {
    let longest = f64::from(parameters.omega) * f64::from(fire.paper.model().mean_edge);
    let shortest = longest / f64::from(parameters.chi);
    let (mut good, mut all) = (0, 0);
    for &[a, b, c] in &fire.paper.model().triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if state.labels[from as usize] >= 3 && state.labels[to as usize] >= 3 {
                let edge = place(state, from) - place(state, to);
                let horizontal = edge.x.hypot(edge.z);
                good += u32::from(horizontal <= 1.05 * longest && edge.length() >= 0.95 * shortest);
                all += 1;
            }
        }
    }
    f64::from(good) / f64::from(all)
}

#[test]
fn it_sinks_stays_above_the_floor_and_rests_with_its_edges_in_range() {
    gpu_test(|device| {
        for mesh in [ball(), shapes::teapot()] {
            let parameters = wax();
            let mut fire = Fire::new(device, Variant::Melting, &parameters, &mesh);
            let rest = fire.state();
            let floor = fire.paper.model().floor;
            let tall = f64::from(fire.paper.model().bounds.max.y - floor);
            let start = height(&fire, &rest);
            let mut lowest = start;
            for _ in 0..250 {
                fire.ticks(10);
                let state = fire.state();
                assert!(
                    state
                        .vertices
                        .iter()
                        .all(|v| v.position.y >= floor && v.position.is_finite() && v.left.is_finite())
                );
                let height = height(&fire, &state);
                assert!(height <= lowest + 0.01 * tall, "{height} after {lowest}");
                lowest = lowest.min(height);
            }
            let state = fire.state();
            assert!(height(&fire, &state) < 0.5 * start);
            let share = in_range(&fire, &state, &parameters);
            assert!(share >= 0.95, "{share} of the edges are in range");
        }
    });
}

#[test]
fn fixed_points_stay_and_the_floor_can_lie_lower() {
    gpu_test(|device| {
        let parameters = Parameters { floor: Some(-0.2), ..wax() };
        let mut fire = Fire::new(device, Variant::Melting, &parameters, &ball());
        let mut lowest = f32::INFINITY;
        for _ in 0..10 {
            fire.ticks(150);
            let state = fire.state();
            for ((vertex, rest), &label) in state.vertices.iter().zip(&fire.paper.model().rest).zip(&state.labels) {
                assert!(label >= 3 || vertex.position == rest.position);
                lowest = lowest.min(vertex.position.y);
            }
        }
        assert!((-0.2..-0.1).contains(&lowest), "{lowest}");
    });
}

#[test]
fn blocks_turn_only_outside_the_boundary_and_above_the_ignition() {
    gpu_test(|device| {
        // Lit at its highest vertex, nothing lies above.
        let mut fire = Fire::new(device, Variant::Melting, &wax(), &ball());
        fire.ticks(400);
        assert!(fire.state().rotations.iter().all(|r| *r == [0.0; 4]));
        // Lit at half the height, what is above comes to lean.
        let middle = glam::Vec3::new(0.3, 0.3, 0.0);
        let parameters = Parameters { sources: vec![middle], ..wax() };
        let mut fire = Fire::new(device, Variant::Melting, &parameters, &ball());
        let mut before = fire.state();
        let mut turned = 0;
        for _ in 0..100 {
            fire.ticks(5);
            let now = fire.state();
            let grid = &fire.paper.model().grid;
            for (cell, (new, old)) in now.rotations.iter().zip(&before.rotations).enumerate() {
                if new != old {
                    assert!(grid.midpoint(cell as u32).y > middle.y, "{cell}");
                    turned += 1;
                }
            }
            before = now;
        }
        assert!(turned > 0);
    });
}

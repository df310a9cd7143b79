//! Laws of every fire, whatever the numbers.

use std::collections::BTreeSet;

use fumarole::measure::Paper;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::falling::components;
use fumarole::papers::burning::{Heat, Look, Parameters, Variant};
use fumarole::scene::MeshSource;

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

#[test]
fn flammability_never_rises_and_the_boundary_only_grows() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        let mut before = fire.state();
        let mut burnt = 0;
        for _ in 0..15 {
            fire.ticks(10);
            let now = fire.state();
            assert!(now.counts.radius > before.counts.radius);
            for (vertex, (now, before)) in now.vertices.iter().zip(&before.vertices).enumerate() {
                assert!(now.left <= before.left && now.left >= 0.0 && now.left.fract() == 0.0, "{vertex}: {now:?}");
            }
            assert!(now.labels.iter().zip(&before.labels).all(|(now, before)| now >= before));
            assert!(now.removed.iter().zip(&before.removed).all(|(now, before)| now >= before));
            burnt = now.vertices.iter().filter(|v| v.left == 0.0).count();
            before = now;
        }
        // 150 ticks at 0.5 a second reach past the whole ball.
        assert!(burnt > before.vertices.len() / 2, "{burnt}");
    });
}

#[test]
fn the_radius_and_the_areas_follow_from_the_tick() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        fire.ticks(37);
        let state = fire.state();
        let parameters = quick();
        let radius = f64::from(parameters.speed_per_s) * 37.0 / 60.0;
        let width = f64::from(parameters.width_of_areas);
        assert_eq!((state.counts.tick, state.counts.growth_ticks), (37, 37));
        assert!((f64::from(state.counts.radius) - radius).abs() < 1e-6);
        let mut seen = [0; 5];
        for (rest, label) in fire.paper.model().rest.iter().zip(&state.labels) {
            let distance = f64::from(rest.boundary_distance);
            let edges = [radius + 2.0 * width, radius, radius - width, radius - 2.0 * width];
            let expected = edges.iter().filter(|&&edge| distance <= edge).count() as u32;
            if edges.iter().all(|edge| (distance - edge).abs() > 1e-5) {
                assert_eq!(*label, expected, "{distance}");
            }
            seen[*label as usize] += 1;
        }
        assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
    });
}

#[test]
fn blocks_count_the_live_vertices() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        for _ in 0..6 {
            fire.ticks(20);
            let state = fire.state();
            let mut live = vec![0; state.blocks.len()];
            let mut ready = vec![0; state.blocks.len()];
            for ((vertex, &cell), &label) in state.vertices.iter().zip(&state.cells).zip(&state.labels) {
                if vertex.left > 0.0 {
                    live[cell as usize] += 1;
                    ready[cell as usize] += i32::from(label == 3);
                }
            }
            let counted: (Vec<i32>, Vec<i32>) = state.blocks.iter().map(|b| (b.live, b.ready)).unzip();
            assert_eq!(counted, (live.clone(), ready.clone()));
            assert_eq!(state.counts.live_vertices as i32, live.iter().sum::<i32>());
            assert_eq!(state.counts.ready_vertices as i32, ready.iter().sum::<i32>());
        }
    });
}

#[test]
fn drawn_and_removed_triangles_are_all_there_are() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        let total = fire.paper.model().triangles.len();
        let mut most_removed = 0;
        for number in [0, 40, 80, 120, 160] {
            fire.frame(number);
            let state = fire.state();
            let stream: Vec<[u32; 3]> = fire.read(&fire.paper.buffers().stream);
            let arguments: Vec<u32> = fire.read(&fire.paper.buffers().arguments);
            let removed = state.removed.iter().filter(|&&r| r == 1).count();
            assert_eq!(state.counts.removed_triangles as usize, removed);
            assert_eq!(state.counts.drawn_triangles as usize + removed, total);
            assert_eq!(arguments, [3 * state.counts.drawn_triangles, 1, 0, 0, 0]);
            // Sorted, since they are drawn in the order of vertex caches.
            let corners = fire.paper.model().lattice.finest();
            let mut expected: Vec<[u32; 3]> =
                corners.iter().zip(&state.removed).filter(|(_, r)| **r == 0).map(|(t, _)| *t).collect();
            let mut drawn = stream[..state.counts.drawn_triangles as usize].to_vec();
            drawn.sort_unstable();
            expected.sort_unstable();
            assert!(drawn == expected, "{number}");
            most_removed = removed;
        }
        assert!(most_removed > total / 4, "{most_removed}");
    });
}

#[test]
fn by_the_natural_look_the_same_triangles_are_drawn_in_the_order_of_caches() {
    gpu_test(|device| {
        let parameters = Parameters { look: Look::Natural, heat: Some(Heat::Air), collapse: false, ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        for number in [0, 60, 80, 140] {
            fire.frame(number);
            let state = fire.state();
            let corners = fire.paper.model().lattice.finest();
            let left = (0..corners.len()).filter(|triangle| state.removed[*triangle] == 0);
            let own: Vec<[u32; 3]> = left.map(|triangle| corners[triangle]).collect();
            let stream: Vec<[u32; 3]> = fire.read(&fire.paper.buffers().stream);
            let drawn = &stream[..state.counts.drawn_triangles as usize];
            assert!(drawn != own || own.is_empty(), "{number}: in an order of its own");
            let sorted = |triangles: &[[u32; 3]]| {
                let mut triangles = triangles.to_vec();
                triangles.sort_unstable();
                triangles
            };
            assert_eq!(sorted(drawn), sorted(&own), "{number}");
        }
        assert!(fire.state().counts.removed_triangles > 100);
    });
}

#[test]
fn without_a_need_for_it_nothing_consumed_stays() {
    gpu_test(|device| {
        let parameters = Parameters { keep_connected: false, ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        for _ in 0..180 {
            fire.ticks(1);
            let state = fire.state();
            for (at, corners) in fire.paper.model().triangles.iter().enumerate() {
                let is_consumed = corners.iter().all(|&vertex| state.vertices[vertex as usize].left == 0.0);
                assert_eq!(state.removed[at] == 1, is_consumed, "triangle {at} at tick {}", state.counts.tick);
            }
        }
        assert!(fire.state().removed.iter().all(|&removed| removed == 1));
    });
}

#[test]
fn what_is_kept_connected_stays_in_one() {
    gpu_test(|device| {
        // Heat through the air comes over a bunny from all sides: its ears and tail would come off.
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 1500);
        for (variant, levels) in [(Variant::Shell, 0), (Variant::LowPoly, 1)] {
            let parameters = Parameters { levels: Some(levels), ..quick() };
            let mut fire = Fire::new(device, variant, &parameters, &bunny);
            let (count, mut kept, mut most) = (fire.paper.model().rest.len(), 0, 0);
            for _ in 0..200 {
                fire.ticks(3);
                let state = fire.state();
                let parts = |is_there: &dyn Fn(usize) -> bool| {
                    let triangles = fire.paper.model().triangles.iter().enumerate();
                    let there: Vec<[usize; 3]> =
                        triangles.filter(|(at, _)| is_there(*at)).map(|(_, t)| t.map(|v| v as usize)).collect();
                    let lowest = components(count, &there, &[]);
                    there.iter().map(|t| lowest[t[0]]).collect::<BTreeSet<usize>>().len()
                };
                let is_consumed = |at: usize| {
                    let corners = fire.paper.model().triangles[at];
                    corners.iter().all(|&vertex| state.vertices[vertex as usize].left == 0.0)
                };
                assert!(parts(&|at| state.removed[at] == 0) <= 1, "{variant:?}, tick {}", state.counts.tick);
                most = most.max(parts(&|at| !is_consumed(at)));
                kept += (0..state.removed.len()).filter(|at| is_consumed(*at) && state.removed[*at] == 0).count();
                assert!((0..state.removed.len()).all(|at| is_consumed(at) || state.removed[at] == 0));
            }
            assert!(most > 1 && kept > 0, "{variant:?}: nothing had to be held: {most} {kept}");
            assert!(fire.state().removed.iter().all(|&removed| removed == 1), "{variant:?}: something is left");
        }
    });
}

#[test]
fn rotations_stay_small_and_some_blocks_turn() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        let mut largest: f32 = 0.0;
        for _ in 0..10 {
            fire.ticks(10);
            let state = fire.state();
            largest = state.rotations.iter().flatten().fold(largest, |most, angle| most.max(angle.abs()));
        }
        assert!(largest > 1e-4 && largest <= 15.001_f32.to_radians(), "{largest}");
    });
}

#[test]
fn what_was_uploaded_once_is_never_written() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        let statics = |fire: &Fire| -> Vec<Vec<u32>> {
            let b = fire.paper.buffers();
            let all = [
                &b.rest,
                &b.triangles,
                &b.incidence_offsets,
                &b.incidence,
                &b.corners,
                &b.welds,
                &b.corner_incidence_offsets,
                &b.corner_incidence,
                &b.base_points,
                &b.rest_cells,
            ];
            all.iter().map(|buffer| fire.read(buffer)).collect()
        };
        let before = statics(&fire);
        (0..60).for_each(|number| fire.frame(3 * number));
        assert!(before == statics(&fire));
    });
}

#[test]
fn ten_thousand_ticks_end_finite_and_bounded() {
    gpu_test(|device| {
        let parameters = Parameters { flammability: 2000, speed_per_s: 0.05, ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        fire.ticks(10_000);
        let state = fire.state();
        assert_eq!(state.counts.tick, 10_000);
        // At most `flammability` ticks of falling, from an object of diagonal 1.
        let fall = 2000.0 * parameters.epsilon * 9.81 / 3600.0;
        for vertex in &state.vertices {
            let [x, y, z] = vertex.position.to_array();
            assert!(x.abs() <= 1.0 && z.abs() <= 1.0 && y <= 1.0 && y >= -fall - 1.0, "{vertex:?}");
        }
        assert!(state.rotations.iter().flatten().all(|angle| angle.is_finite()));
        assert_eq!(state.counts.live_vertices, 0);
    });
}

#[test]
fn a_source_too_far_away_burns_nothing_and_says_so() {
    gpu_test(|device| {
        let parameters = Parameters { sources: vec![glam::Vec3::new(50.0, 0.0, 0.0)], ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        let before = fire.state().vertices;
        fire.frame(120);
        let state = fire.state();
        assert!(state.vertices == before && state.counts.removed_triangles == 0);
        let warnings = fire.paper.warnings();
        assert!(warnings.len() == 1 && warnings[0].contains("nothing burns"), "{warnings:?}");
        let mut near = Fire::shell(device, &ball());
        near.frame(120);
        assert_eq!(near.paper.warnings(), Vec::<String>::new());
    });
}

#[test]
fn the_active_limit_halts_the_boundary() {
    gpu_test(|device| {
        let limited = Parameters { active_limit: 40, flammability: 60, ..quick() };
        let free = Parameters { active_limit: 0, ..limited.clone() };
        let [limited, free] = [limited, free].map(|parameters| {
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
            let mut most = 0;
            for _ in 0..60 {
                fire.ticks(2);
                most = most.max(fire.state().counts.active_vertices);
            }
            (most, fire.state().counts)
        });
        assert!(limited.1.growth_ticks < free.1.growth_ticks && free.1.growth_ticks == 120);
        // One tick's growth may pass the limit.
        assert!(limited.0 < free.0 / 2, "{} {}", limited.0, free.0);
    });
}

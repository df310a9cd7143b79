//! A tick visits the chunks that the fire changes; what it leaves out is what it would have made.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::burning::model::{CHUNK, with_triangles};
use fumarole::papers::burning::{BlockCounts, ChunkBuffers, Look, Parameters, Variant, VertexState};
use fumarole::scene::{Mesh, MeshSource, shapes};

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

/// All that a tick has to make anew of what was before it.
struct Before {
    vertices: Vec<VertexState>,
    alive: Vec<u32>,
}

impl Before {
    fn of(fire: &Fire) -> Self {
        Before { vertices: fire.state().vertices, alive: fire.read(&fire.paper.buffers().alive) }
    }
}

/// True for each element that was visited.
fn visited(fire: &Fire, chunks: &ChunkBuffers, count: usize) -> Vec<bool> {
    let (order, list): (Vec<u32>, Vec<u32>) = (fire.read(&chunks.order), fire.read(&chunks.changed.visited));
    let listed = &list[1..=list[0] as usize];
    assert!(listed.is_sorted_by(|a, b| a < b), "each once, in order");
    assert_eq!(fire.read::<u32>(&chunks.changed.groups), [list[0], 1, 1]);
    let mut visited = vec![false; count];
    for chunk in listed {
        let elements = &order[*chunk as usize * CHUNK..][..CHUNK];
        elements.iter().filter(|&&element| element != u32::MAX).for_each(|&element| visited[element as usize] = true);
    }
    visited
}

/// The area of a boundary of radius `r` that R lies in.
fn area(reach: f32, r: f32, width: f32) -> u32 {
    match reach {
        _ if reach <= r - 2.0 * width => 4,
        _ if reach <= r - width => 3,
        _ if reach <= r => 2,
        _ if reach <= r + 2.0 * width => 1,
        _ => 0,
    }
}

/// Holds all that the tick left, visited or not, against what a tick over everything makes.
fn check(fire: &Fire, parameters: &Parameters, variant: Variant, before: &Before, at: &str) {
    let (buffers, model) = (fire.paper.buffers(), fire.paper.model());
    let state = fire.state();
    let counts = state.counts;
    let flammabilities: Vec<f32> = fire.read(&buffers.flammabilities);
    let burns: Vec<f32> = flammabilities.iter().copied().cycle().take(model.rest.len()).collect();
    let alive: Vec<u32> = fire.read(&buffers.alive);
    let width = parameters.width_of_areas;

    let innermost = |burns: &f32| if *burns > 0.0 { 4 } else { 2 };
    let reaches = model.rest.iter().map(|vertex| vertex.boundary_distance);
    let labels: Vec<u32> =
        reaches.zip(&burns).map(|(reach, burns)| area(reach, counts.radius, width).min(innermost(burns))).collect();
    assert!(labels == state.labels, "{at}: labels");
    let highest = model.triangles.iter().map(|t| t.map(|v| labels[v as usize]).into_iter().max().unwrap());
    assert!(highest.eq(fire.read::<u32>(&buffers.triangle_labels)), "{at}: labels of triangles");

    let retired = |v: usize| if variant == Variant::Solid { parameters.retire_at * burns[v] } else { 0.0 };
    let is_active = |v: usize| labels[v] == 4 && before.vertices[v].left > retired(v) && before.alive[v] == 1;
    let active = (0..labels.len()).filter(|&v| is_active(v)).count();
    assert_eq!(counts.active_vertices as usize, active, "{at}: active vertices");
    let active = model.triangles.iter().filter(|t| t.iter().any(|&v| is_active(v as usize))).count();
    assert_eq!(counts.active_triangles as usize, active, "{at}: active triangles");

    let mut blocks = vec![[0; 3]; state.blocks.len()];
    for (v, vertex) in state.vertices.iter().enumerate().filter(|(v, _)| alive[*v] == 1) {
        let is_live = vertex.left > 0.0;
        let as_what = [is_live, is_live && labels[v] == 3, labels[v] >= 3];
        let block = &mut blocks[state.cells[v] as usize];
        block.iter_mut().zip(as_what).for_each(|(count, does)| *count += i32::from(does));
    }
    let theirs = state.blocks.iter().map(|b: &BlockCounts| [b.live, b.ready, b.heated]);
    assert!(theirs.eq(blocks.iter().copied()), "{at}: blocks");
    let sum = |k: usize| blocks.iter().map(|block| block[k] as u32).sum::<u32>();
    assert_eq!([counts.live_vertices, counts.ready_vertices], [sum(0), sum(1)], "{at}: vertices of blocks");

    if variant.removes() && !parameters.keep_connected && parameters.look == Look::Dissertation {
        let is_spent = |v: u32| state.vertices[v as usize].left <= 0.0;
        let gone = model.triangles.iter().map(|t| u32::from(t.iter().all(|&v| is_spent(v))));
        assert!(gone.eq(state.removed.iter().copied()), "{at}: removed triangles");
    }

    // Both states hold what is left out, which the tick would not have changed either.
    let states: [Vec<VertexState>; 2] = [0, 1].map(|k| fire.read(&buffers.states[k]));
    let moves = |v: usize| alive[v] == 1 && (is_active(v) || (variant == Variant::Melting && labels[v] >= 3));
    for (v, was_visited) in visited(fire, &buffers.vertex_chunks, labels.len()).into_iter().enumerate() {
        let is_still = states[0][v] == states[1][v] && state.vertices[v] == before.vertices[v];
        assert!(was_visited || (is_still && !moves(v)), "{at}: vertex {v} is left out");
    }
    visited(fire, &buffers.triangle_chunks, model.triangles.len());
}

/// Burns all of a mesh, and checks every tick.
fn burn(device: &Arc<Device>, variant: Variant, parameters: &Parameters, mesh: &Mesh, ticks: u32) {
    let mut fire = Fire::new(device, variant, parameters, mesh);
    let division = parameters.time_division;
    let mut most_active = 0;
    for tick in 0..ticks {
        let before = Before::of(&fire);
        (tick * division..(tick + 1) * division).for_each(|number| fire.frame(number));
        check(&fire, parameters, variant, &before, &format!("{variant:?}, tick {}", tick + 1));
        most_active = most_active.max(fire.state().counts.active_vertices);
    }
    assert!(most_active > 0 && fire.state().counts.active_vertices == 0, "the case is too tame: {most_active}");
}

#[test]
fn a_shell_has_all_that_a_tick_over_everything_makes() {
    gpu_test(|device| {
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 3000);
        let free = Parameters { keep_connected: false, ..quick() };
        burn(device, Variant::Shell, &free, &ball(), 190);
        burn(device, Variant::Shell, &Parameters { time_division: 3, ..free.clone() }, &bunny, 190);
        burn(device, Variant::Shell, &Parameters { active_limit: 60, flammability: 8, ..free }, &ball(), 320);
    });
}

#[test]
fn parts_solids_and_wax_have_it_too() {
    gpu_test(|device| {
        let parts = Parameters { look: Look::Natural, ..quick() };
        burn(device, Variant::Shell, &parts, &with_triangles(&shapes::teapot(), 2000), 190);
        burn(device, Variant::Solid, &Parameters { retire_at: 0.5, ..quick() }, &ball(), 190);
        burn(device, Variant::Melting, &Parameters { look: Look::Natural, ..quick() }, &ball(), 190);
    });
}

#[test]
fn refined_objects_have_it_too() {
    gpu_test(|device| {
        let parameters = Parameters { levels: Some(4), keep_connected: false, ..quick() };
        burn(device, Variant::LowPoly, &parameters, &shapes::cuboid(), 230);
        burn(device, Variant::FullySubdivided, &parameters, &shapes::cuboid(), 230);
    });
}

#[test]
fn the_visits_follow_the_fire() {
    gpu_test(|device| {
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 40_000);
        let parameters = Parameters { speed_per_s: 0.2, flammability: 10, ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &bunny);
        let (vertices, triangles) = (fire.paper.model().rest.len(), fire.paper.model().triangles.len());
        let mut shares = Vec::new();
        for _ in 0..12 {
            fire.ticks(25);
            let buffers = fire.paper.buffers();
            let lists = [(&buffers.vertex_chunks, vertices, 0.25), (&buffers.triangle_chunks, triangles, 0.6)];
            let share = |count: usize, of: usize| count as f64 / of as f64;
            let active = share(fire.state().counts.active_vertices as usize, vertices);
            for (chunks, count, more) in lists {
                let visited = visited(&fire, chunks, count).into_iter().filter(|is| *is).count();
                // Borders of areas pass through chunks, the wider the triangles are, and a chunk burns until its last vertex has.
                assert!(share(visited, count) < active + more, "{visited} of {count}, {active} active");
            }
            shares.push(active);
        }
        assert!(shares.iter().any(|share| *share > 0.02), "the case is too tame: {shares:?}");
    });
}

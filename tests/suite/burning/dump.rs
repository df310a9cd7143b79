//! The device's buffers as the oracle has them.

use std::iter::repeat;

use fumarole::papers::burning::reference::{Block, State};
use fumarole::papers::burning::{BlockCounts, VertexState};
use glam::DVec3;

use super::fire::Fire;

/// All that a tick changes; without what only a shown tick makes, unless the last one was shown.
pub fn state(fire: &Fire, is_shown: bool) -> State {
    let buffers = fire.paper.buffers();
    let (state, rotations) = fire.paper.state();
    let point = |v: &[f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let points = |buffer| fire.read::<[f32; 4]>(buffer);
    let state: Vec<VertexState> = fire.read(state);
    let shown = |buffer| if is_shown { points(buffer) } else { Vec::new() };
    let [mapped, normals, colors] = [&buffers.mapped, &buffers.normals, &buffers.colors].map(shown);
    let block = |b: &BlockCounts| Block {
        live: b.live as u32,
        ready: b.ready as u32,
        signs: [b.pitch_sign, b.yaw_sign, b.roll_sign],
        burning: b.combustion as u32,
    };
    let counts = fire.paper.counts().unwrap();
    State {
        tick: counts.tick,
        growth_ticks: counts.growth_ticks,
        active_vertices: counts.active_vertices,
        positions: state.iter().map(|v| v.position.as_dvec3()).collect(),
        left: state.iter().map(|v| v.left as u32).collect(),
        labels: fire.read(&buffers.labels),
        alive: fire.read::<u32>(&buffers.alive).iter().map(|a| *a != 0).collect(),
        statuses: statuses(fire),
        cells: fire.read::<u32>(&buffers.cells).iter().map(|c| *c as usize).collect(),
        blocks: fire.read::<BlockCounts>(&buffers.blocks).iter().map(block).collect(),
        rotations: points(rotations).iter().map(point).collect(),
        guides: points(&buffers.base_displacements[(counts.tick % 2) as usize]).iter().map(point).collect(),
        // Nothing else flows than what melts.
        flows: points(&buffers.flows).iter().map(point).chain(repeat(DVec3::ZERO)).take(state.len()).collect(),
        mapped: mapped.iter().map(point).collect(),
        removed: fire.read::<u32>(&buffers.removed).iter().map(|r| *r != 0).collect(),
        left_out: match fire.paper.connection() {
            Some(connection) => fire.read::<u32>(&connection.held).iter().map(|held| *held == 2).collect(),
            None => vec![false; fire.paper.model().triangles.len()],
        },
        normals: normals.iter().map(point).collect(),
        chars: normals.iter().map(|n| n[3].into()).collect(),
        glows: colors.iter().map(|c| c[3].into()).collect(),
    }
}

/// Drawn triangles in order: draw vertices.
pub fn stream(fire: &Fire) -> Vec<[u32; 3]> {
    let [index_count, instances, ..]: [u32; 5] =
        fire.read(&fire.paper.buffers().arguments).try_into().expect("five words");
    assert_eq!(instances, 1);
    let stream: Vec<[u32; 3]> = fire.read(&fire.paper.buffers().stream);
    stream[..index_count as usize / 3].to_vec()
}

/// Of the pattern's nodes, coarse triangle by coarse triangle.
fn statuses(fire: &Fire) -> Vec<i32> {
    match fire.paper.refinement() {
        Some(refinement) => fire.read(&refinement.statuses),
        // Nothing is refined: the coarse triangles stay.
        None => {
            let nodes = &fire.paper.model().lattice.nodes;
            let each = nodes.iter().map(Vec::len).sum::<usize>() / nodes[0].len();
            (0..nodes[0].len() * each).map(|n| i32::from(n % each == 0)).collect()
        }
    }
}

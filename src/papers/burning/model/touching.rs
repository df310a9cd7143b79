//! Places where separate parts of a mesh touch at rest: a lid lies on its pot, a leg is stuck into a body.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use crate::papers::triangle_tree::TriangleTree;

/// Farthest that vertices of two parts lie apart where the parts hold each other, in diagonals; at least a mean edge.
const NEAR: f32 = 0.02;

/// Pairs of vertices of different parts that hold each other: for each vertex the nearest of another part within reach, and
/// where an edge of one part, longer by that reach at both ends, passes through a triangle of another, the nearest end and
/// corner. None for a mesh in one part.
pub fn touching(positions: &[Vec3], triangles: &[[u32; 3]], mean_edge: f32) -> Vec<[u32; 2]> {
    let roots = roots_of(positions.len(), triangles);
    if triangles.iter().all(|&[a, ..]| roots[a as usize] == roots[triangles[0][0] as usize]) {
        return Vec::new();
    }
    let near = NEAR.max(mean_edge);
    let cell = |p: Vec3| (p / near).floor().as_ivec3();
    // Of each cell one vertex of each part is enough to find the parts that meet there.
    let mut cells: HashMap<IVec3, Vec<(u32, u32)>> = HashMap::new();
    for (vertex, &position) in (0..).zip(positions) {
        let root = roots[vertex as usize];
        let there = cells.entry(cell(position)).or_default();
        if there.iter().all(|&(other, _)| other != root) {
            there.push((root, vertex));
        }
    }
    let mut pairs = crossing(positions, triangles, &roots, near);
    for (vertex, &position) in (0..).zip(positions) {
        let root = roots[vertex as usize];
        let middle = cell(position);
        let around = (0..27).map(|i| middle + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1);
        let others = around.filter_map(|at| cells.get(&at)).flatten().filter(|(other, _)| *other != root);
        let distance = |other: u32| positions[other as usize].distance(position);
        let nearest = others.map(|&(_, other)| other).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        pairs.extend(nearest.filter(|&other| distance(other) <= near).map(|other| [vertex, other]));
    }
    pairs
}

/// Vertices where parts pass through each other, or end within `near` of the middle of each other's triangles.
fn crossing(positions: &[Vec3], triangles: &[[u32; 3]], roots: &[u32], near: f32) -> Vec<[u32; 2]> {
    let tree = TriangleTree::of(positions.to_vec(), triangles);
    let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut pairs: Vec<[u32; 2]> = edges
        .filter_map(|edge| {
            let [from, to] = edge.map(|end| positions[end as usize]);
            let beyond = near * (to - from).normalize_or_zero();
            let [from, to] = [from - beyond, to + beyond];
            let is_other = |triangle: &[u32; 3]| roots[triangle[0] as usize] != roots[edge[0] as usize];
            let (triangle, t) = tree.met_between(from, to, is_other)?;
            let at = from.lerp(to, t);
            let nearest = |vertices: &[u32]| {
                let distance = |vertex: u32| positions[vertex as usize].distance(at);
                vertices.iter().copied().min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
            };
            Some([nearest(&edge)?, nearest(&triangle)?])
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The lowest vertex that each one hangs together with.
pub fn roots_of(count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    fn root(above: &mut [u32], vertex: u32) -> u32 {
        let mut at = vertex;
        while above[at as usize] != at {
            above[at as usize] = above[above[at as usize] as usize];
            at = above[at as usize];
        }
        at
    }
    let mut above: Vec<u32> = (0..count as u32).collect();
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c)] {
            let [from, to] = [from, to].map(|vertex| root(&mut above, vertex));
            above[from.max(to) as usize] = from.min(to);
        }
    }
    (0..count as u32).map(|vertex| root(&mut above, vertex)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_each_other_where_they_touch() {
        let triangle = |y: f32| [Vec3::new(0.0, y, 0.0), Vec3::new(0.1, y, 0.0), Vec3::new(0.0, y, 0.1)];
        let positions = [triangle(0.0), triangle(0.01), triangle(0.5)].concat();
        let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let pairs = touching(&positions, &triangles, 0.001);
        assert_eq!(pairs, [[0, 3], [1, 4], [2, 5], [3, 0], [4, 1], [5, 2]]);
        assert!(touching(&positions[..3], &triangles[..1], 0.001).is_empty());
    }

    #[test]
    fn parts_hold_each_other_where_they_pass_through_each_other() {
        // A long needle through the middle of a wide plate, above it, and too far above it: no vertex is near any other.
        let plate = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(0.0, 0.0, 1.2)];
        let needle = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.1, 1.0, 0.0), Vec3::new(0.0, 1.0, 0.1)];
        for (lower_end, holds) in [(-0.4, true), (0.015, true), (0.03, false), (-1.03, false)] {
            let needle = needle.map(|p| p + Vec3::new(0.0, lower_end, 0.0));
            let pairs = touching(&[plate, needle].concat(), &[[0, 1, 2], [3, 4, 5]], 0.001);
            assert_eq!(!pairs.is_empty(), holds, "{lower_end}: {pairs:?}");
            assert!(pairs.iter().all(|[a, b]| *a == 3 && (0..3).contains(b)), "{lower_end}: its lower end: {pairs:?}");
        }
    }
}

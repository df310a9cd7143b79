//! The refinement pattern of a coarse triangle (section 4.4.1): a full tree of nodes, four children each.
//!
//! The node (a, b, c) has the children (a, mab, mca), (mab, b, mbc), (mca, mbc, c) and (mab, mbc, mca). Nodes are
//! numbered level by level, inside a level by the digits of the path from the root. Everything else is arithmetic on
//! these numbers, here and in `shaders/burning/tree.glsl`.

use std::collections::BTreeMap;

/// Level whose vertices are section 4.4.2's barycentric points: 45 of them.
const BARYCENTRIC_LEVEL: u32 = 3;

/// Number of triangles of `level`.
pub const fn triangles_of(level: u32) -> u32 {
    1 << (2 * level)
}

/// Number of nodes of the levels above `level`.
pub const fn nodes_above(level: u32) -> u32 {
    (triangles_of(level) - 1) / 3
}

/// Number of nodes of a pattern of `levels` levels below its coarse triangle.
pub const fn nodes_of(levels: u32) -> u32 {
    nodes_above(levels + 1)
}

/// Index of corner `corner` (0 to 2) of the node in the corners of its coarse triangle's finest triangles. Child c
/// keeps its parent's corner c.
pub const fn corner_at(levels: u32, level: u32, index: u32, corner: u32) -> u32 {
    let below = levels - level;
    3 * (index * triangles_of(below) + corner * nodes_above(below)) + corner
}

/// The indices, as of [`corner_at`], of the barycentric points of a pattern of `levels` levels, each point once: the
/// vertices of level 3, or of the finest level where that is coarser.
pub fn barycentric_points(levels: u32) -> Vec<u32> {
    let level = levels.min(BARYCENTRIC_LEVEL);
    let mut indices = BTreeMap::new();
    for index in 0..triangles_of(level) {
        for (corner, point) in (0..3).zip(corners_of(level, index)) {
            indices.entry(point).or_insert_with(|| corner_at(levels, level, index, corner));
        }
    }
    indices.into_values().collect()
}

/// The corners of a node of `level`, in steps of that level's edge along two sides of the coarse triangle.
fn corners_of(level: u32, index: u32) -> [[u32; 2]; 3] {
    let mut corners = [[0, 0], [1 << level, 0], [0, 1 << level]];
    for digit in (0..level).rev().map(|place| index >> (2 * place) & 3) {
        let [a, b, c] = corners;
        let middle = |p: [u32; 2], q: [u32; 2]| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        corners = match digit {
            0 => [a, ab, ca],
            1 => [ab, b, bc],
            2 => [ca, bc, c],
            _ => [ab, bc, ca],
        };
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn levels_hold_four_times_the_nodes_of_the_one_above() {
        let sizes: Vec<u32> = (0..=5).map(triangles_of).collect();
        assert_eq!(sizes, [1, 4, 16, 64, 256, 1024]);
        assert_eq!(nodes_of(5), 1365);
        for level in 0..5 {
            assert_eq!(nodes_above(level + 1), nodes_above(level) + triangles_of(level));
        }
    }

    /// A corner is one point, whichever level it is looked up from.
    #[test]
    fn a_node_s_corners_are_found_among_the_finest_triangles() {
        for levels in 0..=5 {
            for level in 0..=levels {
                for index in 0..triangles_of(level) {
                    let scale = 1 << (levels - level);
                    for (corner, point) in (0..3).zip(corners_of(level, index)) {
                        let at = corner_at(levels, level, index, corner);
                        let found = corners_of(levels, at / 3)[at as usize % 3];
                        assert_eq!(found, point.map(|p| p * scale), "{levels} {level} {index} {corner}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_barycentric_points_are_45_evenly_spread() {
        for (levels, count) in [(0, 3), (1, 6), (2, 15), (3, 45), (4, 45), (5, 45)] {
            let step = 1 << (levels - levels.min(3));
            let found: BTreeSet<[u32; 2]> = barycentric_points(levels)
                .iter()
                .map(|at| corners_of(levels, at / 3)[*at as usize % 3])
                .inspect(|p| assert!(p.iter().all(|x| x % step == 0) && p[0] + p[1] <= 1 << levels))
                .collect();
            assert_eq!((found.len(), barycentric_points(levels).len()), (count, count), "{levels} levels");
        }
    }
}

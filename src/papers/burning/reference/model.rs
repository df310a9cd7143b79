//! A mesh as the simulation knows it, made plainly from positions and triangles: welding, the lattice of section
//! 4.4.1, incidence. It has nothing in common with the tables that the device gets, so that it checks them too.

use std::collections::HashMap;

use glam::DVec3;

use super::blocks::Grid;
use super::solid::{area, volume};

/// A triangle of the refinement pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Simulated vertices.
    pub vertices: [usize; 3],
    /// Drawn vertices, which keep texture seams and smoothing groups apart.
    pub corners: [usize; 3],
}

/// A mesh at rest: the diagonal of its bounding box is 1, its middle stands on the origin.
#[derive(Debug, Clone)]
pub struct Model {
    /// Times that each triangle of the mesh is cut into four.
    pub levels: u32,
    /// Triangles of the mesh without those that have two equal corners.
    pub coarse: usize,
    /// Rest positions of the simulated vertices.
    pub rest: Vec<DVec3>,
    /// The simulated vertex of each drawn one.
    pub welds: Vec<usize>,
    /// Level by level within a coarse triangle, children in the order corner 0, 1, 2, middle.
    pub nodes: Vec<Node>,
    /// The nodes of the last level, which the simulation works on.
    pub triangles: Vec<Node>,
    /// Triangle and corner of each simulated vertex.
    pub incidence: Vec<Vec<[usize; 2]>>,
    /// Triangles of each drawn vertex.
    pub corner_incidence: Vec<Vec<usize>>,
    /// Mean side of the triangles: d_mean of section 3.4, Dist of table 6.1.
    pub mean_edge: f64,
    /// 1 where normals by winding point out, -1 where the mesh at rest is inside out.
    pub outward: f64,
    /// Three quarters of the volume at rest over its surface.
    pub char_depth: f64,
    /// The blocks of section 3.5.1.
    pub grid: Grid,
    /// Block of each vertex at rest.
    pub rest_cells: Vec<usize>,
    /// Section 6.3.4: of each block the vertex that lies nearest to its middle at rest.
    pub base_points: Vec<Option<usize>>,
}

/// Positions scaled to a bounding box of diagonal 1 whose bottom's middle is the origin.
pub fn scaled(positions: &[DVec3]) -> Vec<DVec3> {
    let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let foot = (low + high).with_y(2.0 * low.y) / 2.0;
    positions.iter().map(|p| (p - foot) / low.distance(high)).collect()
}

impl Model {
    /// `positions` are scaled; coincident ones become one simulated vertex. Vertices are numbered as triangles meet
    /// them.
    pub fn new(positions: &[DVec3], triangles: &[[usize; 3]], levels: u32, blocks: [usize; 3]) -> Self {
        let mut vertex_at = HashMap::new();
        let mut corner_of = HashMap::new();
        let mut model = Model {
            levels,
            coarse: 0,
            rest: Vec::new(),
            welds: Vec::new(),
            nodes: Vec::new(),
            triangles: Vec::new(),
            incidence: Vec::new(),
            corner_incidence: Vec::new(),
            mean_edge: 0.0,
            outward: 1.0,
            char_depth: 0.0,
            grid: Grid::around(positions, blocks),
            rest_cells: Vec::new(),
            base_points: Vec::new(),
        };
        let key = |i: usize| (positions[i] + DVec3::ZERO).to_array().map(f64::to_bits);
        let mut midpoints = Midpoints::default();
        for triangle in triangles {
            let [a, b, c] = triangle.map(key);
            if a == b || b == c || c == a {
                continue;
            }
            let corners = triangle.map(|i| {
                let vertex = *vertex_at.entry(key(i)).or_insert_with(|| {
                    model.rest.push(positions[i]);
                    model.rest.len() - 1
                });
                *corner_of.entry(i).or_insert_with(|| {
                    model.welds.push(vertex);
                    model.welds.len() - 1
                })
            });
            model.coarse += 1;
            model.divide(corners, &mut midpoints);
        }
        model.connect();
        model
    }

    /// The coarse triangle and all its descendants, level by level.
    fn divide(&mut self, corners: [usize; 3], midpoints: &mut Midpoints) {
        let mut level = vec![corners];
        for depth in 0..=self.levels {
            let nodes: Vec<Node> =
                level.iter().map(|&corners| Node { vertices: corners.map(|c| self.welds[c]), corners }).collect();
            self.nodes.extend_from_slice(&nodes);
            if depth == self.levels {
                self.triangles.extend_from_slice(&nodes);
                return;
            }
            level = level
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| self.midpoint(p, q, midpoints));
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
    }

    fn midpoint(&mut self, p: usize, q: usize, midpoints: &mut Midpoints) -> usize {
        let sorted = |p: usize, q: usize| (p.min(q), p.max(q));
        let (a, b) = (self.welds[p], self.welds[q]);
        let vertex = *midpoints.vertices.entry(sorted(a, b)).or_insert_with(|| {
            self.rest.push((self.rest[a] + self.rest[b]) / 2.0);
            self.rest.len() - 1
        });
        *midpoints.corners.entry(sorted(p, q)).or_insert_with(|| {
            self.welds.push(vertex);
            self.welds.len() - 1
        })
    }

    /// All that follows from rest positions, welds and nodes.
    fn connect(&mut self) {
        self.incidence = vec![Vec::new(); self.rest.len()];
        self.corner_incidence = vec![Vec::new(); self.welds.len()];
        let mut sum = 0.0;
        for (t, node) in self.triangles.iter().enumerate() {
            for k in 0..3 {
                self.incidence[node.vertices[k]].push([t, k]);
                self.corner_incidence[node.corners[k]].push(t);
                sum += self.rest[node.vertices[k]].distance(self.rest[node.vertices[(k + 1) % 3]]);
            }
        }
        self.mean_edge = sum / (3 * self.triangles.len()) as f64;
        let triangles = || self.triangles.iter().map(|t| t.vertices);
        let enclosed = volume(&self.rest, triangles());
        self.outward = if enclosed < 0.0 { -1.0 } else { 1.0 };
        self.char_depth = 0.75 * enclosed.abs() / area(&self.rest, triangles());
        self.rest_cells = self.rest.iter().map(|p| self.grid.cell(*p)).collect();
        self.base_points = vec![None; self.grid.cells()];
        for (v, &cell) in self.rest_cells.iter().enumerate() {
            let away = |v: usize| self.rest[v].distance_squared(self.grid.midpoint(cell));
            let best = &mut self.base_points[cell];
            if best.is_none_or(|b| away(v) < away(b)) {
                *best = Some(v);
            }
        }
    }

    /// The same model with vertex `v` under the number `vertices[v]` and drawn vertex `c` under `corners[c]`: ties by
    /// index are decided as the owner of those numbers decides them.
    pub fn renumbered(&self, vertices: &[usize], corners: &[usize]) -> Self {
        let mut model = self.clone();
        for (old, &new) in vertices.iter().enumerate() {
            model.rest[new] = self.rest[old];
        }
        for (old, &new) in corners.iter().enumerate() {
            model.welds[new] = vertices[self.welds[old]];
        }
        for node in model.nodes.iter_mut().chain(&mut model.triangles) {
            *node = Node { vertices: node.vertices.map(|v| vertices[v]), corners: node.corners.map(|c| corners[c]) };
        }
        model.connect();
        model
    }

    /// Nodes of one coarse triangle.
    pub fn nodes_each(&self) -> usize {
        self.nodes.len() / self.coarse.max(1)
    }

    /// The first node of a level within a coarse triangle.
    pub fn level_start(level: u32) -> usize {
        (4usize.pow(level) - 1) / 3
    }
}

/// Midpoints by the sorted ends of their edge.
#[derive(Default)]
struct Midpoints {
    vertices: HashMap<(usize, usize), usize>,
    corners: HashMap<(usize, usize), usize>,
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{boxed, sphere};
    use super::*;

    #[test]
    fn a_box_of_24_corners_is_one_closed_surface_of_eight_vertices() {
        let (positions, triangles) = boxed();
        assert_eq!(positions.len(), 24);
        let model = Model::new(&positions, &triangles, 0, [2, 2, 2]);
        assert_eq!((model.rest.len(), model.welds.len(), model.triangles.len()), (8, 24, 12));
        for levels in 1..4 {
            let fine = Model::new(&positions, &triangles, levels, [2, 2, 2]);
            let triangles = 12 * 4usize.pow(levels);
            assert_eq!(fine.triangles.len(), triangles);
            // Euler: V - E + F = 2 and 2 E = 3 F on a closed surface.
            assert_eq!(fine.rest.len(), triangles / 2 + 2);
            assert!((fine.mean_edge * f64::from(1 << levels) - model.mean_edge).abs() < 1e-12);
        }
    }

    #[test]
    fn degenerate_triangles_are_dropped() {
        let positions = scaled(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO]);
        let model = Model::new(&positions, &[[0, 1, 2], [0, 3, 1], [2, 2, 1]], 1, [1, 1, 1]);
        assert_eq!((model.coarse, model.triangles.len(), model.rest.len()), (1, 4, 6));
    }

    #[test]
    fn other_numbers_are_the_same_model() {
        let (positions, triangles) = sphere(1);
        let model = Model::new(&positions, &triangles, 1, [3, 3, 3]);
        let rotated = |n: usize| (0..n).map(|i| (i + 5) % n).collect::<Vec<_>>();
        let (vertices, corners) = (rotated(model.rest.len()), rotated(model.welds.len()));
        let other = model.renumbered(&vertices, &corners);
        assert!((other.mean_edge - model.mean_edge).abs() < 1e-14);
        for (v, &number) in vertices.iter().enumerate() {
            assert_eq!(other.rest[number], model.rest[v]);
            assert_eq!(other.incidence[number], model.incidence[v]);
            assert_eq!(other.rest_cells[number], model.rest_cells[v]);
        }
    }
}

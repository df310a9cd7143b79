//! Every coarse triangle divided into 4^levels, by halving its edges; neighbours share the vertices of their edge.

use std::collections::HashMap;

use glam::Vec3;

use super::weld::Welded;

/// All nodes of all levels, and the vertices that they need.
pub struct Lattice {
    /// Rest positions of the simulated vertices.
    pub positions: Vec<Vec3>,
    /// The simulated vertex of each draw vertex.
    pub welds: Vec<u32>,
    /// As many as draw vertices, or empty.
    pub texture_coordinates: Vec<[f32; 2]>,
    /// The material of each draw vertex, or empty where there is one alone.
    pub substances: Vec<u32>,
    /// Draw vertices of the nodes, by level: child `i` of node `n` of level k is node `4 n + i` of level k + 1. The
    /// last level are the finest triangles.
    pub nodes: Vec<Vec<[u32; 3]>>,
}

/// The vertex in the middle of each edge, by the lower and the higher end.
type Middles = HashMap<(u32, u32), u32>;

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Lattice {
    /// Divides every triangle `levels` times; the children of (a, b, c) are those at a, b, c, then the middle one.
    /// `substances` are the materials of the vertices of the mesh, or empty.
    pub fn new(welded: Welded, substances: &[u32], levels: u32) -> Self {
        let mut positions = vec![Vec3::ZERO; welded.vertex_count as usize];
        for (&vertex, &position) in welded.welds.iter().zip(&welded.positions) {
            positions[vertex as usize] = position;
        }
        let mut lattice = Lattice {
            positions,
            welds: welded.welds,
            texture_coordinates: welded.texture_coordinates,
            substances: welded.origins.iter().filter_map(|at| substances.get(*at as usize).copied()).collect(),
            nodes: vec![welded.triangles],
        };
        let (mut drawn, mut simulated) = (Middles::new(), Middles::new());
        for level in 0..levels as usize {
            let children = (0..lattice.nodes[level].len()).flat_map(|node| {
                let [a, b, c] = lattice.nodes[level][node];
                let [ab, bc, ca] =
                    [(a, b), (b, c), (c, a)].map(|(a, b)| lattice.middle(a, b, &mut drawn, &mut simulated));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            });
            let children = children.collect();
            lattice.nodes.push(children);
        }
        lattice
    }

    /// The finest triangles: draw vertices.
    pub fn finest(&self) -> &[[u32; 3]] {
        self.nodes.last().map_or(&[], Vec::as_slice)
    }

    fn middle(&mut self, a: u32, b: u32, drawn: &mut Middles, simulated: &mut Middles) -> u32 {
        if let Some(&middle) = drawn.get(&key(a, b)) {
            return middle;
        }
        let [from, to] = [a, b].map(|end| self.welds[end as usize]);
        let vertex = *simulated.entry(key(from, to)).or_insert_with(|| {
            self.positions.push(0.5 * (self.positions[from as usize] + self.positions[to as usize]));
            self.positions.len() as u32 - 1
        });
        let middle = self.welds.len() as u32;
        self.welds.push(vertex);
        if let (Some(s), Some(t)) = (self.texture_coordinates.get(a as usize), self.texture_coordinates.get(b as usize))
        {
            let texture_coordinate = [0.5 * (s[0] + t[0]), 0.5 * (s[1] + t[1])];
            self.texture_coordinates.push(texture_coordinate);
        }
        if let (Some(s), Some(t)) = (self.substances.get(a as usize), self.substances.get(b as usize)) {
            self.substances.push(*s.min(t));
        }
        drawn.insert(key(a, b), middle);
        middle
    }
}

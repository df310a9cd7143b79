//! Coincident corners become one simulated vertex, so that nothing rips along a seam of normals or texture coordinates.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec3};

use crate::scene::{Bounds, Mesh};

/// A mesh scaled to a diagonal of 1, with both kinds of vertices.
pub struct Welded {
    /// Rest positions of the draw vertices: those of the mesh that some triangle uses, in its order.
    pub positions: Vec<Vec3>,
    /// As many, or empty.
    pub texture_coordinates: Vec<[f32; 2]>,
    /// The simulated vertex of each draw vertex, numbered in order of first use.
    pub welds: Vec<u32>,
    /// The vertex of the mesh of each draw vertex.
    pub origins: Vec<u32>,
    /// Distinct positions.
    pub vertex_count: u32,
    /// Draw vertices of each triangle with three different simulated vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles left out because two of their corners coincide.
    pub degenerate: u32,
}

impl Welded {
    /// Scales the mesh and welds its corners.
    pub fn new(mesh: &Mesh) -> Self {
        let used = |at: u32| mesh.positions[at as usize];
        let bounds = Bounds::of_points(mesh.indices.iter().map(|&i| used(i)));
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let base = DVec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
        let scale = 1.0 / (high - low).length().max(f64::MIN_POSITIVE);

        let mut welded = Welded {
            positions: Vec::new(),
            texture_coordinates: Vec::new(),
            welds: Vec::new(),
            origins: Vec::new(),
            vertex_count: 0,
            triangles: Vec::new(),
            degenerate: 0,
        };
        let mut is_used = vec![false; mesh.positions.len()];
        mesh.indices.iter().for_each(|&i| is_used[i as usize] = true);
        let mut number = vec![0; mesh.positions.len()];
        let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
        for (at, position) in mesh.positions.iter().enumerate().filter(|&(at, _)| is_used[at]) {
            number[at] = welded.positions.len() as u32;
            // -0 and +0 are one position.
            let scaled = ((position.as_dvec3() - base) * scale).as_vec3() + Vec3::ZERO;
            let next = vertices.len() as u32;
            welded.welds.push(*vertices.entry(scaled.to_array().map(f32::to_bits)).or_insert(next));
            welded.positions.push(scaled);
            welded.origins.push(at as u32);
            welded.texture_coordinates.extend(mesh.texture_coordinates.get(at).map(|t| t.to_array()));
        }
        welded.vertex_count = vertices.len() as u32;
        for corners in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| number[corners[k] as usize]);
            let [a, b, c] = corners.map(|corner| welded.welds[corner as usize]);
            if a == b || b == c || c == a {
                welded.degenerate += 1;
            } else {
                welded.triangles.push(corners);
            }
        }
        welded
    }

    /// True for a mesh each edge of which has two triangles, which run along it in opposite directions.
    pub fn is_closed(&self) -> bool {
        let vertices = |triangle: &[u32; 3]| triangle.map(|corner| self.welds[corner as usize]);
        let sides = || self.triangles.iter().map(vertices).flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut directed = HashSet::new();
        sides().all(|side| directed.insert(side)) && sides().all(|[from, to]| directed.contains(&[to, from]))
    }
}

//! Meshes of any size from small ones: every triangle divided evenly, the surface as it was.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::scene::Mesh;

/// Parts of an edge, and whether each small triangle is divided again at its middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pattern {
    edge: u64,
    has_middles: bool,
}

impl Pattern {
    fn parts(self) -> u64 {
        self.edge * self.edge * if self.has_middles { 3 } else { 1 }
    }

    /// The pattern of the fewest parts that are at least `wanted`: 1, 3, 4, 9, 12, 16, 25, 27, ...
    fn of(wanted: u64) -> Self {
        let edge_of = |count: u64| (1..).find(|edge| edge * edge >= count).unwrap_or(1);
        let [whole, middles] = [
            Pattern { edge: edge_of(wanted), has_middles: false },
            Pattern { edge: edge_of(wanted.div_ceil(3)), has_middles: true },
        ];
        if middles.parts() < whole.parts() { middles } else { whole }
    }
}

/// Divides every triangle evenly, into n^2 or 3 n^2 parts, so that there are at least `triangles`. Triangles that share
/// an edge share its new vertices; where two edges lie in one place, as at a seam, so do theirs, bit for bit. Normals and
/// texture coordinates are interpolated.
pub fn divided(mesh: &Mesh, triangles: u64) -> Mesh {
    let count = mesh.triangle_count() as u64;
    let pattern = Pattern::of(triangles.div_ceil(count.max(1)));
    if pattern.parts() == 1 {
        return mesh.clone();
    }
    let mut dividing = Dividing::new(mesh, pattern);
    for corners in mesh.indices.as_chunks::<3>().0 {
        dividing.divide(*corners);
    }
    dividing.made
}

struct Dividing<'a> {
    from: &'a Mesh,
    pattern: Pattern,
    made: Mesh,
    /// First of the new vertices on an edge, which are numbered from the end with the lower number.
    edges: HashMap<(u32, u32), u32>,
    /// Vertices of the triangle that is being divided, row by row.
    lattice: Vec<u32>,
}

impl<'a> Dividing<'a> {
    fn new(from: &'a Mesh, pattern: Pattern) -> Self {
        let faces = from.triangle_count();
        let edge = pattern.edge as usize;
        let inside = (edge - 1) * edge.saturating_sub(2) / 2 + if pattern.has_middles { edge * edge } else { 0 };
        // Edges of a closed mesh; one that is open has more, and the vectors grow.
        let vertices = from.positions.len() + faces * 3 / 2 * (edge - 1) + faces * inside;
        let mut made =
            Mesh { indices: Vec::with_capacity(from.indices.len() * pattern.parts() as usize), ..from.clone() };
        made.positions.reserve_exact(vertices - from.positions.len());
        made.normals.reserve_exact(vertices - from.positions.len());
        if !from.texture_coordinates.is_empty() {
            made.texture_coordinates.reserve_exact(vertices - from.positions.len());
        }
        Dividing { from, pattern, made, edges: HashMap::new(), lattice: Vec::new() }
    }

    fn divide(&mut self, corners: [u32; 3]) {
        let n = self.pattern.edge as usize;
        let [a, b, c] = corners;
        let (ab, bc, ca) = (self.edge(a, b), self.edge(b, c), self.edge(c, a));
        self.lattice.clear();
        for j in 0..=n {
            for i in 0..=n - j {
                let vertex = match (i, j) {
                    (0, 0) => a,
                    _ if i == n => b,
                    _ if j == n => c,
                    (_, 0) => self.on_edge(ab, a, b, i),
                    (0, _) => self.on_edge(ca, c, a, n - j),
                    _ if i + j == n => self.on_edge(bc, b, c, j),
                    _ => {
                        let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                        self.add(corners, [1.0 - u - v, u, v])
                    }
                };
                self.lattice.push(vertex);
            }
        }
        let row = |j: usize| j * (n + 1) - j * j.saturating_sub(1) / 2;
        for j in 0..n {
            for i in 0..n - j {
                let at = |i: usize, j: usize| self.lattice[row(j) + i];
                let up = [at(i, j), at(i + 1, j), at(i, j + 1)];
                let down = (i + j + 1 < n).then(|| [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                self.triangle(up);
                down.into_iter().for_each(|down| self.triangle(down));
            }
        }
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        if !self.pattern.has_middles {
            self.made.indices.extend(corners);
            return;
        }
        let middle = self.made.positions.len() as u32;
        let [a, b, c] = corners.map(|corner| corner as usize);
        let made = &mut self.made;
        made.positions.push((made.positions[a] + made.positions[b] + made.positions[c]) / 3.0);
        made.normals.push(unit(made.normals[a] + made.normals[b] + made.normals[c], made.normals[a]));
        if let [_, ..] = made.texture_coordinates[..] {
            let uv = &made.texture_coordinates;
            let middle = (uv[a] + uv[b] + uv[c]) / 3.0;
            made.texture_coordinates.push(middle);
        }
        let [a, b, c] = corners;
        made.indices.extend([a, b, middle, b, c, middle, c, a, middle]);
    }

    /// Number of the first new vertex between two corners, which are made where they are not there yet.
    fn edge(&mut self, a: u32, b: u32) -> u32 {
        let (low, high) = (a.min(b), a.max(b));
        if let Some(&first) = self.edges.get(&(low, high)) {
            return first;
        }
        let first = self.made.positions.len() as u32;
        self.edges.insert((low, high), first);
        // An edge in the same place gets the same positions, whichever way round its corners are numbered.
        let bits = |corner: u32| self.from.positions[corner as usize].to_array().map(f32::to_bits);
        let is_turned = bits(low) > bits(high);
        let n = self.pattern.edge;
        for k in 1..n {
            if is_turned {
                let t = (n - k) as f32 / n as f32;
                self.add([high, low, low], [1.0 - t, t, 0.0]);
            } else {
                let t = k as f32 / n as f32;
                self.add([low, high, high], [1.0 - t, t, 0.0]);
            }
        }
        first
    }

    /// The `k`-th vertex from `a` to `b`.
    fn on_edge(&self, first: u32, a: u32, b: u32, k: usize) -> u32 {
        let k = k as u32;
        if a < b { first + k - 1 } else { first + self.pattern.edge as u32 - k - 1 }
    }

    fn add(&mut self, corners: [u32; 3], weights: [f32; 3]) -> u32 {
        let Mesh { positions, normals, texture_coordinates, .. } = self.from;
        let number = self.made.positions.len() as u32;
        let [a, b, c] = corners.map(|corner| corner as usize);
        let mix = |of: &[Vec3]| of[a] * weights[0] + of[b] * weights[1] + of[c] * weights[2];
        self.made.positions.push(mix(positions));
        self.made.normals.push(unit(mix(normals), normals[a]));
        if !texture_coordinates.is_empty() {
            let of = texture_coordinates;
            let uv: Vec2 = of[a] * weights[0] + of[b] * weights[1] + of[c] * weights[2];
            self.made.texture_coordinates.push(uv);
        }
        self.made.tags.add_between(&self.from.tags, [a, b, c], weights);
        number
    }
}

/// The direction of a sum of normals; `usual` where they cancel.
fn unit(sum: Vec3, usual: Vec3) -> Vec3 {
    sum.try_normalize().unwrap_or(usual)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::scene::MeshSource;

    fn area(mesh: &Mesh) -> f64 {
        let corner = |index: &u32| mesh.positions[*index as usize].as_dvec3();
        let area = |t: &[u32; 3]| (corner(&t[1]) - corner(&t[0])).cross(corner(&t[2]) - corner(&t[0])).length() / 2.0;
        mesh.indices.as_chunks::<3>().0.iter().map(area).sum()
    }

    /// Six times the volume, which every triangle facing out adds to.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |index: &u32| mesh.positions[*index as usize].as_dvec3();
        mesh.indices.as_chunks::<3>().0.iter().map(|t| corner(&t[0]).dot(corner(&t[1]).cross(corner(&t[2])))).sum()
    }

    #[test]
    fn the_fewest_parts_that_are_enough() {
        let parts: Vec<u64> =
            [1, 2, 3, 4, 5, 10, 13, 17, 26, 28, 1000].map(|wanted| Pattern::of(wanted).parts()).into();
        assert_eq!(parts, [1, 3, 3, 4, 9, 12, 16, 25, 27, 36, 1024]);
    }

    #[test]
    fn a_divided_mesh_is_the_same_surface() {
        for source in [MeshSource::Teapot, MeshSource::Box, MeshSource::Bunny, MeshSource::Sphere] {
            let mesh = source.load().unwrap();
            let count = mesh.triangle_count();
            for parts in [3, 4, 9, 12, 25] {
                let made = divided(&mesh, (count * parts) as u64);
                made.validate().unwrap();
                assert_eq!(made.triangle_count(), count * parts, "{source}");
                assert!((area(&made) / area(&mesh) - 1.0).abs() < 1e-5, "{source} {parts}");
                assert!((volume(&made) / volume(&mesh) - 1.0).abs() < 1e-4, "{source} {parts}");
                assert!(made.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{source}");
            }
        }
        let teapot = MeshSource::Teapot.load().unwrap();
        assert_eq!(divided(&teapot, 1), teapot);
    }

    #[test]
    fn neighbours_share_the_vertices_of_their_edge_and_seams_their_places() {
        let mesh = MeshSource::Sphere.load().unwrap();
        let made = divided(&mesh, 16 * mesh.triangle_count() as u64);
        // By place: every edge of a closed surface has two triangles, one each way round, seams included.
        let place = |index: u32| (made.positions[index as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut open = HashSet::new();
        for t in made.indices.as_chunks::<3>().0 {
            for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
                let (a, b) = (place(a), place(b));
                if a != b && !open.remove(&(b, a)) {
                    open.insert((a, b));
                }
            }
        }
        assert!(open.is_empty(), "{} edges have one triangle", open.len());
    }
}

//! A mesh brought to about a number of triangles.

use std::collections::{BinaryHeap, HashMap};

use glam::Vec3;
use meshopt::SimplifyOptions;

use crate::scene::Mesh;

/// Simplifies `mesh` to about `wanted` triangles where it has more, and splits its longest edges where it has fewer;
/// the split mesh has at most one triangle too many an edge that more than two share. A simplified mesh may keep more
/// than wanted: it never closes holes nor joins parts.
pub fn with_triangles(mesh: &Mesh, wanted: usize) -> Mesh {
    if mesh.triangle_count() < wanted {
        let mut splitting = Splitting::new(mesh);
        splitting.until(wanted);
        return splitting.mesh;
    }
    let points: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let indices =
        meshopt::simplify_decoder(&mesh.indices, &points, wanted * 3, f32::MAX, SimplifyOptions::Regularize, None);
    // What has no volume may simplify to nothing; such a mesh stays as it is.
    let simplified = Mesh { indices, ..mesh.clone() };
    if simplified.validate().is_ok() { simplified } else { mesh.clone() }
}

/// An edge between places: the numbers of the first vertices there, the lower one first.
type Edge = (u32, u32);

/// Splits the longest edges of a mesh.
pub(super) struct Splitting {
    mesh: Mesh,
    /// The ends of the edge that each new vertex is in the middle of.
    ends: Vec<[u32; 2]>,
    /// The first vertex at each vertex's place.
    places: Vec<u32>,
    triangles: HashMap<Edge, Vec<u32>>,
    /// By squared length; lengths are positive, so their bits sort as they do.
    longest: BinaryHeap<(u32, Edge)>,
}

impl Splitting {
    pub fn new(mesh: &Mesh) -> Self {
        let mut firsts = HashMap::new();
        let place = |(at, p): (u32, &Vec3)| *firsts.entry((*p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(at);
        let places = (0..).zip(&mesh.positions).map(place).collect();
        let mut splitting = Splitting {
            mesh: mesh.clone(),
            ends: Vec::new(),
            places,
            triangles: HashMap::new(),
            longest: BinaryHeap::new(),
        };
        (0..mesh.triangle_count() as u32).for_each(|triangle| splitting.add(triangle));
        splitting
    }

    /// Splits until there are so many triangles.
    fn until(&mut self, wanted: usize) {
        while self.mesh.triangle_count() < wanted && self.split_longest() {}
    }

    /// Splits until no edge is longer than `length`; false where that takes more than `most` triangles.
    pub fn until_no_longer(&mut self, length: f32, most: usize) -> bool {
        while self.longest.peek().is_some_and(|(bits, _)| f32::from_bits(*bits) > length * length) {
            if self.mesh.triangle_count() >= most {
                return false;
            }
            self.split_longest();
        }
        true
    }

    /// False where no edge is left.
    fn split_longest(&mut self) -> bool {
        let Some((_, edge)) = self.longest.pop() else { return false };
        // Split already, or named by several triangles.
        if let Some(triangles) = self.triangles.remove(&edge) {
            self.split(edge, &triangles);
        }
        true
    }

    pub fn triangle_count(&self) -> usize {
        self.mesh.triangle_count()
    }

    /// The mesh, whose new vertices come last, and the ends of the edge that each of those is in the middle of.
    pub fn into_mesh(self) -> (Mesh, Vec<[u32; 2]>) {
        (self.mesh, self.ends)
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        [0, 1, 2].map(|k| self.mesh.indices[3 * triangle as usize + k])
    }

    fn edge(&self, a: u32, b: u32) -> Edge {
        let [a, b] = [a, b].map(|v| self.places[v as usize]);
        (a.min(b), a.max(b))
    }

    /// Enters a triangle under its edges; an edge from a place to itself is none.
    fn add(&mut self, triangle: u32) {
        let [a, b, c] = self.corners(triangle);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = self.edge(from, to);
            if edge.0 != edge.1 {
                let length = self.mesh.positions[from as usize].distance_squared(self.mesh.positions[to as usize]);
                self.triangles.entry(edge).or_default().push(triangle);
                self.longest.push((length.to_bits(), edge));
            }
        }
    }

    fn split(&mut self, edge: Edge, triangles: &[u32]) {
        let mut middles = HashMap::new();
        let mut first = None;
        for &triangle in triangles {
            let corners = self.corners(triangle);
            let Some(k) = (0..3).find(|&k| self.edge(corners[k], corners[(k + 1) % 3]) == edge) else { continue };
            let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let middle = *middles.entry((a.min(b), a.max(b))).or_insert_with(|| self.middle(a, b));
            let place = *first.get_or_insert(middle);
            self.places[middle as usize] = place;
            for other in [self.edge(b, c), self.edge(c, a)] {
                if let Some(list) = self.triangles.get_mut(&other) {
                    list.retain(|&t| t != triangle);
                }
            }
            let new = self.mesh.triangle_count() as u32;
            self.mesh.indices[3 * triangle as usize..][..3].copy_from_slice(&[a, middle, c]);
            self.mesh.indices.extend([middle, b, c]);
            self.add(triangle);
            self.add(new);
        }
    }

    /// A vertex in the middle of two.
    fn middle(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (a as usize, b as usize);
        let mesh = &mut self.mesh;
        mesh.positions.push(0.5 * (mesh.positions[a] + mesh.positions[b]));
        mesh.normals.push((mesh.normals[a] + mesh.normals[b]).normalize_or(mesh.normals[a]));
        if let (Some(&s), Some(&t)) = (mesh.texture_coordinates.get(a), mesh.texture_coordinates.get(b)) {
            mesh.texture_coordinates.push(0.5 * (s + t));
        }
        mesh.tags.double(a);
        self.ends.push([a as u32, b as u32]);
        let number = mesh.positions.len() as u32 - 1;
        self.places.push(number);
        number
    }
}

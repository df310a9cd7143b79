//! Normals of meshes that have none: smooth across edges up to the crease angle, and broken at sharper ones, where a
//! vertex is doubled.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::mesh::Parts;
use super::normals::double_area_vector;
use super::numbering::Numbering;

/// Triangles along one edge of which each is compared with each; more are no surface, and their edge is sharp.
const MOST_ALONG_AN_EDGE: usize = 16;
/// Points whose corners are grouped at once.
const POINTS_AT_ONCE: usize = 1 << 16;

/// Fills in the normals that are missing (none at all, or zero) of a mesh whose positions are finite and whose indices
/// are in range.
///
/// Triangles around a point share a normal there, weighted by their areas, where they are joined by edges at which
/// their own normals differ by at most `crease_deg`; so they do across seams of texture coordinates. A vertex of several
/// such groups becomes as many, the others after all that were there. One that no triangle of positive area touches
/// gets +Y. At 180 degrees all triangles around a point share its normal, whether they are joined or not.
pub(super) fn fill_normals(parts: &mut Parts, crease_deg: f32) {
    let count = parts.positions.len();
    parts.normals.resize(count, Vec3::ZERO);
    if !parts.normals.contains(&Vec3::ZERO) {
        return;
    }
    let mut around = Around::new(parts);
    let least_cosine = f64::from(crease_deg.to_radians()).cos() - 1e-9;
    let state = |normal: &Vec3| if *normal == Vec3::ZERO { State::Missing } else { State::Given };
    let mut states: Vec<State> = parts.normals.iter().map(state).collect();
    let points = around.offsets.len() - 1;
    // Wave by wave, so that the groups of few points are in memory at once.
    let wave = POINTS_AT_ONCE * rayon::current_num_threads();
    for first in (0..points).step_by(wave) {
        let chunks: Vec<_> = (first..points.min(first + wave)).step_by(POINTS_AT_ONCE).collect();
        let grouped: Vec<Groups> = chunks
            .into_par_iter()
            .map(|start| {
                let mut grouping = Grouping::new(&around, parts, least_cosine);
                (start..points.min(start + POINTS_AT_ONCE)).for_each(|point| grouping.add(point));
                grouping.groups
            })
            .collect();
        grouped.iter().for_each(|groups| assign(parts, &mut states, &mut around.points, groups));
    }
    for normal in &mut parts.normals[..count] {
        if *normal == Vec3::ZERO {
            *normal = Vec3::Y;
        }
    }
}

/// Source of a vertex's normal.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Missing,
    /// That of a group.
    Found,
    /// The file's own.
    Given,
}

/// Gives each group's normal to its vertices, and doubles those that have another group's.
fn assign(parts: &mut Parts, states: &mut [State], points: &mut Vec<u32>, groups: &Groups) {
    let mut rest = &groups.corners[..];
    for &(count, normal) in &groups.normals {
        let (corners, after) = rest.split_at(count as usize);
        rest = after;
        // Those of one vertex lie together.
        let mut rest = corners;
        while let Some(&first) = rest.first() {
            let vertex = parts.indices[first as usize] as usize;
            let length = rest.iter().take_while(|&&corner| parts.indices[corner as usize] as usize == vertex).count();
            let (of_vertex, after) = rest.split_at(length);
            rest = after;
            match states[vertex] {
                State::Given => {}
                State::Missing => {
                    states[vertex] = State::Found;
                    parts.normals[vertex] = normal;
                }
                State::Found => {
                    // There are no more vertices than indices, which are fewer than 2^32.
                    let twin = parts.positions.len() as u32;
                    parts.positions.push(parts.positions[vertex]);
                    parts.normals.push(normal);
                    points.push(points[vertex]);
                    if let Some(&coordinate) = parts.texture_coordinates.get(vertex) {
                        parts.texture_coordinates.push(coordinate);
                    }
                    parts.tags.double(vertex);
                    of_vertex.iter().for_each(|&corner| parts.indices[corner as usize] = twin);
                }
            }
        }
    }
}

/// Corners of triangles, by the point that they lie at.
struct Around {
    /// Begin of the corners of each point in `corners`, and the end.
    offsets: Vec<u32>,
    /// Places in the list of indices, in order for each point.
    corners: Vec<u32>,
    /// The point of each vertex: vertices at one position are at one point.
    points: Vec<u32>,
}

impl Around {
    fn new(parts: &Parts) -> Self {
        let mut numbering = Numbering::default();
        let points: Vec<u32> = parts.positions.iter().map(|&p| numbering.number(Numbering::key_of(p))).collect();
        let mut offsets = vec![0_u32; numbering.len() + 1];
        drop(numbering);
        for &index in &parts.indices {
            offsets[points[index as usize] as usize + 1] += 1;
        }
        for at in 1..offsets.len() {
            offsets[at] += offsets[at - 1];
        }
        let mut corners = vec![0; parts.indices.len()];
        for (corner, &index) in (0..).zip(&parts.indices) {
            let offset = &mut offsets[points[index as usize] as usize];
            corners[*offset as usize] = corner;
            *offset += 1;
        }
        // Each offset is now the next one's.
        offsets.rotate_right(1);
        offsets[0] = 0;
        Around { offsets, corners, points }
    }
}

/// Groups of corners at one point that share a normal.
#[derive(Default)]
struct Groups {
    /// Places in the list of indices, group by group, in each by the vertex.
    corners: Vec<u32>,
    /// Corners of each group, and its normal.
    normals: Vec<(u32, Vec3)>,
}

/// Finds the groups, point by point.
struct Grouping<'a> {
    around: &'a Around,
    parts: &'a Parts,
    least_cosine: f64,
    /// Of the point's triangles that have an area: the corner, and twice the area along the normal.
    faces: Vec<(u32, DVec3)>,
    /// The other ends of the edges from the point, with the triangle's place in `faces`.
    edges: Vec<(u32, u32)>,
    /// A place in `faces` that each is joined to, its own or one before it.
    joined: Vec<u32>,
    groups: Groups,
}

impl<'a> Grouping<'a> {
    fn new(around: &'a Around, parts: &'a Parts, least_cosine: f64) -> Self {
        let (faces, edges, joined) = (Vec::new(), Vec::new(), Vec::new());
        Grouping { around, parts, least_cosine, faces, edges, joined, groups: Groups::default() }
    }

    fn add(&mut self, point: usize) {
        let Parts { positions, indices, .. } = self.parts;
        let [from, to] = [point, point + 1].map(|at| self.around.offsets[at] as usize);
        self.faces.clear();
        self.edges.clear();
        for &corner in &self.around.corners[from..to] {
            let first = corner - corner % 3;
            let [a, b, c] = [0, 1, 2].map(|k| indices[(first + (corner + k) % 3) as usize]);
            let [p, q, r] = [a, b, c].map(|index| positions[index as usize]);
            let area = double_area_vector(p, q, r);
            if area != DVec3::ZERO {
                let face = self.faces.len() as u32;
                self.faces.push((corner, area));
                self.edges.extend([b, c].map(|index| (self.around.points[index as usize], face)));
            }
        }
        self.join();
        self.collect();
    }

    /// Joins the triangles along each edge.
    fn join(&mut self) {
        self.joined.clear();
        if self.least_cosine <= -1.0 {
            self.joined.resize(self.faces.len(), 0);
            return;
        }
        self.joined.extend(0..self.faces.len() as u32);
        self.edges.sort_unstable();
        let Grouping { faces, edges, joined, least_cosine, .. } = self;
        for along in edges.chunk_by(|a, b| a.0 == b.0).filter(|along| along.len() <= MOST_ALONG_AN_EDGE) {
            for (at, &(_, a)) in along.iter().enumerate() {
                for &(_, b) in &along[at + 1..] {
                    let [n, m] = [a, b].map(|face| faces[face as usize].1);
                    if n.dot(m) >= *least_cosine * (n.length_squared() * m.length_squared()).sqrt() {
                        let [a, b] = [a, b].map(|face| root(joined, face));
                        joined[a.max(b) as usize] = a.min(b);
                    }
                }
            }
        }
    }

    /// Writes the groups down, in the order of their first corners.
    fn collect(&mut self) {
        let Grouping { faces, edges, joined, groups, parts, .. } = self;
        let vertex = |face: u32| parts.indices[faces[face as usize].0 as usize];
        // The list of edges serves for the triangles with their groups.
        edges.clear();
        edges.extend((0..faces.len() as u32).map(|face| (root(joined, face), face)));
        edges.sort_unstable_by_key(|&(group, face)| (group, vertex(face), face));
        for group in edges.chunk_by(|a, b| a.0 == b.0) {
            let members = group.iter().map(|&(_, face)| faces[face as usize]);
            groups.corners.extend(members.clone().map(|(corner, _)| corner));
            // Summed in the order of the corners, whatever vertices they have.
            let mut areas: Vec<(u32, DVec3)> = members.collect();
            areas.sort_unstable_by_key(|&(corner, _)| corner);
            let sum: DVec3 = areas.iter().map(|(_, area)| *area).sum();
            groups.normals.push((group.len() as u32, sum.normalize_or(DVec3::Y).as_vec3()));
        }
    }
}

/// The first of those that `face` is joined to; the way there is made shorter.
fn root(joined: &mut [u32], mut face: u32) -> u32 {
    while joined[face as usize] != face {
        joined[face as usize] = joined[joined[face as usize] as usize];
        face = joined[face as usize];
    }
    face
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::normals;
    use crate::scene::shapes;

    /// A shape with one vertex for each of its places, without normals.
    fn bare(mesh: &crate::scene::Mesh) -> Parts {
        let mut numbering = Numbering::default();
        let indices = mesh.indices.iter().map(|&i| numbering.number(Numbering::key_of(mesh.positions[i as usize])));
        let indices = indices.collect();
        Parts { positions: numbering.into_positions(), indices, ..Parts::default() }
    }

    #[test]
    fn a_cube_of_eight_corners_is_flat_and_at_a_right_angle_round() {
        let mut flat = bare(&shapes::cuboid());
        let before = flat.indices.clone();
        assert_eq!(flat.positions.len(), 8);
        fill_normals(&mut flat, 30.0);
        assert_eq!((flat.positions.len(), flat.normals.len()), (24, 24));
        for corners in flat.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| flat.positions[corners[i] as usize]);
            let own = double_area_vector(a, b, c).normalize().as_vec3();
            assert!(corners.iter().all(|&i| flat.normals[i as usize] == own));
        }
        // Each vertex keeps its first group, the others follow.
        assert!(flat.indices.iter().zip(&before).all(|(now, before)| now == before || *now >= 8));
        let mut round = bare(&shapes::cuboid());
        fill_normals(&mut round, 90.0);
        assert_eq!((round.positions.len(), &round.indices), (8, &before));
    }

    #[test]
    fn a_fine_surface_is_smooth_as_without_creases() {
        let mut ball = bare(&shapes::sphere(48, 48));
        let expected = normals::smooth(&ball.positions, &ball.indices);
        fill_normals(&mut ball, 30.0);
        assert_eq!(ball.positions.len(), expected.len());
        assert!(ball.normals.iter().zip(expected).all(|(a, b)| (*a - b).length() < 1e-6));
    }

    #[test]
    fn an_edge_is_sharp_beyond_the_angle_alone() {
        // Two squares that meet at an edge, at an angle of 40 degrees.
        let (sin, cos) = 40_f32.to_radians().sin_cos();
        let positions =
            vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::X + Vec3::Z, Vec3::new(-cos, sin, 0.0), Vec3::new(-cos, sin, 1.0)];
        let indices = vec![0, 1, 2, 2, 1, 3, 0, 4, 1, 1, 4, 5];
        for (crease_deg, vertices) in [(39.9, 8), (40.1, 6)] {
            let mut parts = Parts { positions: positions.clone(), indices: indices.clone(), ..Parts::default() };
            fill_normals(&mut parts, crease_deg);
            assert_eq!(parts.positions.len(), vertices, "{crease_deg}");
        }
    }

    #[test]
    fn given_normals_seams_and_what_has_no_area() {
        // A seam: both triangles of a square have vertices of their own.
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::ONE];
        let normals = vec![Vec3::X, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO];
        let indices = vec![0, 1, 2, 3, 4, 5, 6, 6, 6];
        let mut parts = Parts { positions, normals, indices, ..Parts::default() };
        fill_normals(&mut parts, 0.0);
        assert_eq!(parts.normals, [Vec3::X, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y]);
    }

    /// Many triangles around a point or along an edge take no square of their number.
    #[test]
    fn fans_and_fins_take_no_longer_than_their_length() {
        let count = 300_000_u32;
        let rim = (0..count).map(|i| {
            let angle = i as f32 * (std::f32::consts::TAU / count as f32);
            Vec3::new(angle.cos(), angle.sin(), 0.0)
        });
        let positions: Vec<Vec3> = [Vec3::ZERO, Vec3::Z].into_iter().chain(rim).collect();
        let fan = (0..count).flat_map(|i| [0, 2 + i, 2 + (i + 1) % count]).collect();
        let fins = (0..count).flat_map(|i| [0, 1, 2 + i]).collect();
        for indices in [fan, fins] {
            let mut parts = Parts { positions: positions.clone(), indices, ..Parts::default() };
            let started = std::time::Instant::now();
            fill_normals(&mut parts, 30.0);
            assert!(started.elapsed().as_secs_f64() < 10.0, "{:?}", started.elapsed());
        }
    }
}

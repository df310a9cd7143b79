use super::teapot_patches::{CONTROL_POINTS, PATCHES};
use crate::scene::Mesh;
use crate::scene::numbering::Numbering;
use glam::{DVec3, Vec3};

/// Cells along each side of a patch.
const CELLS: usize = 10;

/// Number of parts: body with rim and bottom, handle, spout, lid.
const PARTS: usize = 4;

/// The patches of a part, each of which is one smooth surface. Parts touch without sharing edges.
fn patches(part: usize) -> impl Iterator<Item = &'static [u16; 16]> {
    let part_of = |patch| match patch {
        12..16 => 1,
        16..20 => 2,
        20..28 => 3,
        _ => 0,
    };
    let numbered = PATCHES.iter().enumerate();
    numbered.filter(move |(patch, _)| part_of(*patch) == part).map(|(_, patch)| patch)
}

/// Newell's Utah teapot with lid and bottom, its 32 bicubic patches in 10 x 10 cells: 6,320
/// triangles.
///
/// The 80 triangles without area at the two poles (lid knob, middle of the bottom) are dropped.
/// Sizes are those of the original data in metres: x -3..3.43 (handle to spout), y 0..3.15, z
/// -2..2. Normals are those of the patches, averaged where patches meet. The surface is open at the
/// rim under the lid and where handle and spout enter the body.
pub fn teapot() -> Mesh {
    let mut mesh = Mesh { name: "teapot".to_owned(), ..Mesh::default() };
    for part in 0..PARTS {
        let mut weld = Numbering::default();
        let first = mesh.positions.len() as u32;
        for patch in patches(part) {
            tessellate(patch, first, &mut weld, &mut mesh);
        }
    }
    // At a pole a patch has no normal; the symmetric ring of triangles around it has.
    let mut faceted = mesh.clone();
    faceted.smooth_normals();
    for (normal, around) in mesh.normals.iter_mut().zip(faceted.normals) {
        *normal = normal.try_normalize().unwrap_or(around);
    }
    mesh
}

/// Appends one patch; points already in `weld` are shared, the first of which is vertex `first`.
fn tessellate(patch: &[u16; 16], first: u32, weld: &mut Numbering, mesh: &mut Mesh) {
    let control = patch.map(|point| y_up(DVec3::from(CONTROL_POINTS[usize::from(point)])));
    let mut vertices = [[0; CELLS + 1]; CELLS + 1];
    for (i, row) in vertices.iter_mut().enumerate() {
        for (j, vertex) in row.iter_mut().enumerate() {
            let (position, normal) = evaluate(&control, i, j);
            let known = weld.len();
            *vertex = first + weld.number(Numbering::key_of(position));
            if weld.len() > known {
                mesh.positions.push(position);
                mesh.normals.push(Vec3::ZERO);
            }
            mesh.normals[*vertex as usize] += normal;
        }
    }
    for (row, next) in vertices.iter().zip(&vertices[1..]) {
        for (edge, opposite) in row.windows(2).zip(next.windows(2)) {
            let [a, b, c, d] = [edge[0], opposite[0], opposite[1], edge[1]];
            for [p, q, r] in [[a, c, b], [a, d, c]] {
                if p != q && q != r && r != p {
                    mesh.indices.extend([p, q, r]);
                }
            }
        }
    }
}

fn y_up(point: DVec3) -> DVec3 {
    DVec3::new(point.x, point.z, -point.y)
}

/// Position and unit normal at (`i`, `j`) of [`CELLS`]; the normal is zero at a pole.
///
/// Positions are rounded to multiples of 2^-18, exact in `f32`, so that patches that meet give the
/// same bits: control points are multiples of 10^-5 and weights of 10^-6, and no multiple of 10^-11
/// comes within 3 x 10^-14 of a tie.
fn evaluate(control: &[DVec3; 16], i: usize, j: usize) -> (Vec3, Vec3) {
    const GRID: f64 = 262_144.0;
    let (weights_u, slopes_u) = bernstein(i);
    let (weights_v, slopes_v) = bernstein(j);
    let sum = |u: &[f64; 4], v: &[f64; 4]| -> DVec3 { (0..16).map(|k| control[k] * (u[k / 4] * v[k % 4])).sum() };
    let position = (sum(&weights_u, &weights_v) * GRID).round() / GRID;
    let normal = sum(&weights_u, &slopes_v).cross(sum(&slopes_u, &weights_v));
    let normal = if normal.length() > 1e-9 { normal.normalize() } else { DVec3::ZERO };
    (position.as_vec3(), normal.as_vec3())
}

/// Cubic Bernstein polynomials at `step` of [`CELLS`] and their derivatives.
fn bernstein(step: usize) -> ([f64; 4], [f64; 4]) {
    let t = step as f64 / CELLS as f64;
    let s = (CELLS - step) as f64 / CELLS as f64;
    let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    let slopes = [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t];
    (weights, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MeshSource;
    use crate::scene::normals::double_area_vector;
    use std::collections::HashMap;

    fn triangles(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> {
        mesh.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|i| mesh.positions[t[i] as usize]))
    }

    #[test]
    fn counts_and_extents_are_those_of_the_literature() {
        let mesh = teapot();
        mesh.validate().unwrap();
        assert_eq!(mesh.triangle_count(), 6_320);
        let bounds = mesh.bounds();
        assert!((bounds.min - Vec3::new(-3.0, 0.0, -2.0)).length() < 1e-2, "{bounds:?}");
        assert!((bounds.max - Vec3::new(3.434, 3.15, 2.0)).length() < 1e-2, "{bounds:?}");
    }

    #[test]
    fn triangles_have_area_and_face_their_normals() {
        let mesh = teapot();
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[corners[i] as usize]);
            let area_vector = double_area_vector(a, b, c);
            assert!(area_vector.length() > 1e-7, "{a} {b} {c}");
            for &corner in corners {
                let normal = mesh.normals[corner as usize].as_dvec3();
                assert!(area_vector.dot(normal) > 0.0, "{a} {b} {c}: {normal}");
            }
        }
    }

    #[test]
    fn normals_face_out() {
        let mesh = teapot();
        let towards_axis = |p: Vec3| Vec3::new(-p.x, 0.0, -p.z);
        let belly = |p: &Vec3| (0.5..2.0).contains(&p.y) && p.x.hypot(p.z) < 2.01;
        let body_vertices = mesh.positions.iter().zip(&mesh.normals).take(12 * 121);
        let mut seen = 0;
        for (position, normal) in body_vertices.filter(|(p, _)| belly(p) && p.x.hypot(p.z) > 1.6) {
            seen += 1;
            assert!(normal.dot(towards_axis(*position)) < 0.0, "{position}");
        }
        assert!(seen > 300, "{seen}");
        let at = |point: Vec3| {
            let is_there = |p: &Vec3| p.distance(point) < 1e-5;
            mesh.positions.iter().position(is_there).unwrap()
        };
        assert!((mesh.normals[at(Vec3::new(0.0, 3.15, 0.0))] - Vec3::Y).length() < 1e-5);
        assert!((mesh.normals[at(Vec3::ZERO)] - Vec3::NEG_Y).length() < 1e-5);
    }

    #[test]
    fn normals_are_smooth_across_seams() {
        // A seam whose patches disagree would leave an average far from both.
        for part in 0..PARTS {
            let mut weld = Numbering::default();
            let mut sums = Mesh::default();
            for patch in patches(part) {
                tessellate(patch, 0, &mut weld, &mut sums);
            }
            for patch in patches(part) {
                let control = patch.map(|p| y_up(DVec3::from(CONTROL_POINTS[usize::from(p)])));
                for (i, j) in (0..=CELLS).flat_map(|i| (0..=CELLS).map(move |j| (i, j))) {
                    let (position, normal) = evaluate(&control, i, j);
                    let average = sums.normals[weld.number(Numbering::key_of(position)) as usize].normalize_or_zero();
                    assert!(normal == Vec3::ZERO || normal.dot(average) > 0.999, "part {part} at {position}");
                }
            }
        }
    }

    #[test]
    fn open_edges_lie_only_at_the_rims_of_the_parts() {
        let mesh = teapot();
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        for corners in mesh.indices.chunks_exact(3) {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                *edges.entry((corners[from], corners[to])).or_default() += 1;
                *edges.entry((corners[to], corners[from])).or_default() -= 1;
            }
        }
        assert!(edges.values().all(|balance| balance.abs() <= 1));
        let open = edges.values().filter(|balance| **balance == 1).count();
        // The body's mouth and the lid are rings of four patches; handle and spout end in rings of
        // two, twice each.
        assert_eq!(open, 4 * CELLS + 4 * CELLS + 4 * (2 * CELLS));
    }

    #[test]
    fn another_tessellation_lies_on_the_surface() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/teapot.obj");
        let other = MeshSource::File(path.into()).load().unwrap();
        let mesh = teapot();
        let scale = mesh.bounds().diagonal().y / other.bounds().diagonal().y;
        let offset = mesh.bounds().center() - other.bounds().center() * scale;
        let surface: Vec<[Vec3; 3]> = triangles(&mesh).collect();
        let distances: Vec<f32> = other
            .positions
            .iter()
            .map(|position| {
                let point = position * scale + offset;
                let distances = surface.iter().map(|triangle| distance_to(triangle, point));
                distances.fold(f32::INFINITY, f32::min)
            })
            .collect();
        // Its vertices at the rim are the worst; the mean shows that shape and scale are the same.
        let worst = distances.iter().copied().fold(0.0, f32::max);
        let mean = distances.iter().sum::<f32>() / distances.len() as f32;
        assert!(worst < 0.03 && mean < 0.004, "{worst} {mean}");
    }

    /// Distance from `point` to a triangle (Ericson, Real-Time Collision Detection, 5.1.5, by edges
    /// and plane).
    fn distance_to(triangle: &[Vec3; 3], point: Vec3) -> f32 {
        let [a, b, c] = *triangle;
        let normal = (b - a).cross(c - a);
        let edges = [(a, b), (b, c), (c, a)];
        if edges.iter().all(|(p, q)| (q - p).cross(point - p).dot(normal) >= 0.0) {
            return (point - a).dot(normal).abs() / normal.length();
        }
        edges
            .iter()
            .map(|(p, q)| {
                let t = (point - p).dot(q - p) / (q - p).length_squared();
                (p + (q - p) * t.clamp(0.0, 1.0)).distance(point)
            })
            .fold(f32::INFINITY, f32::min)
    }
}

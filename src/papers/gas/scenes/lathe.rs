//! Surfaces of revolution: glasses, chess pieces, pedestals.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use crate::scene::Mesh;

/// Turns `profile`, points of (radius, height) from the bottom to the top of the outside, about the Y axis. Normals are
/// smooth but where the profile repeats a point, which makes an edge.
pub fn turned(name: &str, profile: &[Vec2], slices: u32) -> Mesh {
    let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
    for run in profile.chunk_by(|a, b| a != b) {
        add_run(&mut mesh, run, slices);
    }
    mesh
}

fn add_run(mesh: &mut Mesh, run: &[Vec2], slices: u32) {
    let first = mesh.positions.len() as u32;
    let normals: Vec<Vec2> = (0..run.len())
        .map(|i| {
            let along = run[(i + 1).min(run.len() - 1)] - run[i.saturating_sub(1)];
            Vec2::new(along.y, -along.x).normalize_or(Vec2::X)
        })
        .collect();
    for slice in 0..=slices {
        let angle_rad = if slice == slices { 0.0 } else { TAU * slice as f32 / slices as f32 };
        let (sin, cos) = angle_rad.sin_cos();
        let turn = |v: Vec2| Vec3::new(v.x * cos, v.y, -v.x * sin);
        mesh.positions.extend(run.iter().map(|&p| turn(p)));
        mesh.normals.extend(normals.iter().map(|&n| turn(n)));
    }
    let rows = run.len() as u32;
    for slice in 0..slices {
        for row in 0..rows.saturating_sub(1) {
            let here = first + slice * rows + row;
            let [a, b, c, d] = [here, here + rows, here + rows + 1, here + 1];
            // At the axis a quad is a triangle.
            if run[row as usize].x > 0.0 {
                mesh.indices.extend([a, b, c]);
            }
            if run[row as usize + 1].x > 0.0 {
                mesh.indices.extend([a, c, d]);
            }
        }
    }
}

/// A curve through `points` (Catmull and Rom), each piece in `pieces` parts.
pub fn curve(points: &[Vec2], pieces: u32) -> Vec<Vec2> {
    let mut all = Vec::new();
    for i in 0..points.len().saturating_sub(1) {
        let at = |k: usize| points[k.min(points.len() - 1)];
        let [a, b, c, d] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
        for part in 0..pieces {
            let t = part as f32 / pieces as f32;
            let tangent =
                (c - a) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d) * t * t + (b * 3.0 - a - c * 3.0 + d) * t * t * t;
            let point = b + tangent * 0.5;
            all.push(Vec2::new(point.x.max(0.0), point.y));
        }
    }
    all.extend(points.last());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_profile_is_valid_and_faces_out() {
        let profile = curve(&[(0.0, 0.0), (1.0, 0.0), (0.6, 1.0), (0.0, 2.0)].map(|(x, y)| Vec2::new(x, y)), 6);
        let mesh = turned("vase", &profile, 24);
        mesh.validate().unwrap();
        let out = |t: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[t[i] as usize]);
            (b - a).cross(c - a).dot(mesh.normals[t[0] as usize])
        };
        assert!(mesh.indices.chunks_exact(3).all(|t| out(t) > -1e-6));
        assert!(mesh.indices.chunks_exact(3).filter(|t| out(t) > 0.0).count() > 200);
    }

    #[test]
    fn a_curve_goes_through_its_points() {
        let points = [(1.0, 0.0), (2.0, 1.0), (0.5, 3.0)].map(|(x, y)| Vec2::new(x, y));
        let curve = curve(&points, 8);
        assert!(points.iter().all(|p| curve.iter().any(|c| c.distance(*p) < 1e-6)));
    }
}

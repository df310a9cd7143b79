//! Silhouettes swept sideways: what is no surface of revolution.

use std::f32::consts::FRAC_PI_2;

use earcut::Earcut;
use glam::Vec2;

use crate::scene::Mesh;

/// Parts of the rounding on each side.
const PARTS: usize = 4;

/// Sweeps a closed `outline`, counter-clockwise in the plane z = 0, by `half_m` to both sides, the mirror images of each
/// other; its rims are rounded by `rounding_m`, less than half of what is narrowest in the outline, whose corners are no
/// sharper than about 60 degrees: the rounding folds sharper ones over.
pub fn swept(name: &str, outline: &[Vec2], half_m: f32, rounding_m: f32) -> Mesh {
    let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
    let count = outline.len();
    let outwards: Vec<Vec2> = (0..count)
        .map(|i| {
            let along = outline[(i + 1) % count] - outline[(i + count - 1) % count];
            Vec2::new(along.y, -along.x).normalize_or(Vec2::X)
        })
        .collect();
    // From the back to the front: how far each ring has turned from the plane of the outline.
    let quarter = (0..=PARTS).map(|part| part as f32 / PARTS as f32);
    let angles: Vec<f32> = quarter.clone().map(|t| t - 1.0).chain(quarter).map(|t| t * FRAC_PI_2).collect();
    for &angle_rad in &angles {
        let (sin, cos) = angle_rad.sin_cos();
        let side =
            if angle_rad > 0.0 || (angle_rad == 0.0 && mesh.positions.len() > PARTS * count) { 1.0 } else { -1.0 };
        let z = side * (half_m - rounding_m) + sin * rounding_m;
        for (point, out) in outline.iter().zip(&outwards) {
            mesh.positions.push((*point - *out * (1.0 - cos) * rounding_m).extend(z));
            mesh.normals.push((*out * cos).extend(sin));
        }
    }
    for ring in 0..angles.len() - 1 {
        for i in 0..count {
            let (a, b) = (ring * count + i, ring * count + (i + 1) % count);
            let corners = [a, b, b + count, a, b + count, a + count];
            mesh.indices.extend(corners.map(|corner| corner as u32));
        }
    }
    let mut flat = Vec::new();
    let last = (angles.len() - 1) * count;
    let corners = mesh.positions[last..].iter().map(|p| [f64::from(p.x), f64::from(p.y)]);
    Earcut::new().earcut(corners, &[], &mut flat);
    for triangle in flat.chunks_exact(3) {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|corner: usize| corner as u32);
        let [p, q, r] = [a, b, c].map(|corner| mesh.positions[last + corner as usize].truncate());
        let [b, c] = if (q - p).perp_dot(r - p) >= 0.0 { [b, c] } else { [c, b] };
        mesh.indices.extend([a, b, c].map(|corner| last as u32 + corner));
        mesh.indices.extend([a, c, b]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_swept_outline_is_closed_and_faces_out() {
        let outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 1.4), (0.0, 2.0)].map(|(x, y)| Vec2::new(x, y));
        let mesh = swept("letter", &outline, 0.5, 0.1);
        mesh.validate().unwrap();
        let mut volume = 0.0;
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[t[i] as usize]);
            let normal: Vec3 = t.iter().map(|&i| mesh.normals[i as usize]).sum();
            assert!((b - a).cross(c - a).dot(normal) > -1e-6);
            volume += a.dot(b.cross(c)) / 6.0;
        }
        // The outline's area, 3.4, times the width, less the rounding.
        assert!(volume > 3.1 && volume < 3.4, "{volume}");
        let middle: Vec3 = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
        assert!(middle.z.abs() < 1e-6);
    }
}

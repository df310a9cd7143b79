use glam::{DVec3, Vec3};

use super::numbering::Numbering;

/// Area-weighted vertex normals of a triangle list, in single precision and of unit length.
///
/// Vertices at one position share a normal, so that seams of texture coordinates stay smooth. A
/// vertex that no triangle of positive area touches gets +Y. Positions must be finite and indices
/// in range.
pub(super) fn smooth(positions: &[Vec3], indices: &[u32]) -> Vec<Vec3> {
    let mut numbering = Numbering::default();
    let points: Vec<u32> = positions.iter().map(|&p| numbering.number(Numbering::key_of(p))).collect();
    let mut sums = vec![DVec3::ZERO; numbering.len()];
    for corners in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| corners[i] as usize);
        let area_vector = double_area_vector(positions[a], positions[b], positions[c]);
        for corner in [a, b, c] {
            sums[points[corner] as usize] += area_vector;
        }
    }
    points.iter().map(|&point| sums[point as usize].normalize_or(DVec3::Y).as_vec3()).collect()
}

/// The normal of a triangle scaled by twice its area, in double precision so that no finite input
/// overflows.
pub(super) fn double_area_vector(a: Vec3, b: Vec3, c: Vec3) -> DVec3 {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seam_of_doubled_vertices_is_smooth_and_weighted_by_area() {
        // Two faces at a right angle share the edge x = z = 0; the second is three times as large
        // as the first.
        let positions = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(-0.0, 0.0, -0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, 3.0),
        ];
        let normals = smooth(&positions, &[0, 1, 2, 3, 4, 5]);
        let seam = Vec3::new(3.0, 0.0, 1.0).normalize();
        for vertex in [0, 2, 3, 4] {
            assert!((normals[vertex] - seam).length() < 1e-6, "{vertex}");
        }
        assert_eq!(normals[1], Vec3::Z);
        assert_eq!(normals[5], Vec3::X);
    }

    #[test]
    fn degenerate_and_unused_vertices_get_a_unit_normal() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::ONE];
        assert_eq!(smooth(&positions, &[0, 1, 2]), vec![Vec3::Y; 4]);
    }

    #[test]
    fn the_largest_finite_coordinates_do_not_overflow() {
        let positions = [Vec3::ZERO, Vec3::X * f32::MAX, Vec3::Y * f32::MAX];
        assert_eq!(smooth(&positions, &[0, 1, 2]), vec![Vec3::Z; 3]);
    }
}

use crate::scene::Mesh;
use glam::{UVec2, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Most cells along one direction: 4096 x 4096 make 33,554,432 triangles.
const MAX_CELLS: u32 = 4096;

/// A sphere of radius 1 m around the origin, cut along meridians (`slices`) and parallels
/// (`stacks`), with poles on the Y axis: `2 * slices * (stacks - 1)` triangles.
///
/// `slices` is brought into 3..=4096 and `stacks` into 2..=4096.
pub fn sphere(slices: u32, stacks: u32) -> Mesh {
    let (slices, stacks) = (slices.clamp(3, MAX_CELLS), stacks.clamp(2, MAX_CELLS));
    let mut mesh = grid("sphere", UVec2::new(slices, stacks), |u, v| {
        // Whole turns and the poles are set exactly, so that the seam and the poles close.
        let longitude_rad = if u == 1.0 { 0.0 } else { u * TAU };
        let (sin, cos) = longitude_rad.sin_cos();
        let radius = if v == 0.0 || v == 1.0 { 0.0 } else { (v * PI).sin() };
        let normal = Vec3::new(radius * cos, -(v * PI).cos(), -radius * sin);
        (normal, normal)
    });
    let positions = &mesh.positions;
    let mut kept = Vec::with_capacity(mesh.indices.len());
    for corners in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| positions[corners[i] as usize]);
        if a != b && b != c && c != a {
            kept.extend_from_slice(corners);
        }
    }
    mesh.indices = kept;
    mesh
}

/// A flat rectangle in y = 0 around the origin, facing +Y, `size_m.x` along X and `size_m.y` along
/// Z, in `cells.x` x `cells.y` cells of two triangles.
///
/// `size_m` must be positive and finite; `cells` is brought into 1..=4096 each.
pub fn plane(size_m: Vec2, cells: UVec2) -> Mesh {
    let cells = cells.clamp(UVec2::ONE, UVec2::splat(MAX_CELLS));
    grid("plane", cells, |u, v| {
        let position = Vec3::new((u - 0.5) * size_m.x, 0.0, (0.5 - v) * size_m.y);
        (position, Vec3::Y)
    })
}

/// A cube from (-1, -1, -1) to (1, 1, 1) m: 12 triangles, 24 vertices, since each face has its own
/// normals.
pub fn cuboid() -> Mesh {
    let mut mesh = Mesh { name: "box".to_owned(), ..Mesh::default() };
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let up = if normal.y == 0.0 { Vec3::Y } else { Vec3::X };
        let right = up.cross(normal);
        let first = mesh.positions.len() as u32;
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let offset = right * (2.0 * x - 1.0) + up * (2.0 * y - 1.0);
            mesh.positions.push(normal + offset);
            mesh.normals.push(normal);
            mesh.texture_coordinates.push(Vec2::new(x, y));
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    mesh
}

/// `cells.x` x `cells.y` cells of a surface that maps (u, v) in [0, 1]^2 to position and normal and
/// faces the side from which u, v turn counter-clockwise.
fn grid(name: &str, cells: UVec2, surface: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
    for row in 0..=cells.y {
        for column in 0..=cells.x {
            let uv = Vec2::new(column as f32, row as f32) / cells.as_vec2();
            let (position, normal) = surface(uv.x, uv.y);
            mesh.positions.push(position);
            mesh.normals.push(normal);
            mesh.texture_coordinates.push(uv);
        }
    }
    let width = cells.x + 1;
    for row in 0..cells.y {
        for column in 0..cells.x {
            let corner = row * width + column;
            let [a, b, c, d] = [corner, corner + 1, corner + width + 1, corner + width];
            mesh.indices.extend([a, b, c, a, c, d]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::normals::double_area_vector;
    use crate::scene::numbering::Numbering;
    use std::collections::HashMap;

    /// True when every edge between positions is used once in each direction.
    fn is_closed(mesh: &Mesh) -> bool {
        let mut weld = Numbering::default();
        let points: Vec<u32> = mesh.positions.iter().map(|&p| weld.number(Numbering::key_of(p))).collect();
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| points[corners[i] as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_default() += 1;
                *edges.entry((to, from)).or_default() -= 1;
            }
        }
        edges.values().all(|balance| *balance == 0)
    }

    fn signed_volume(mesh: &Mesh) -> f64 {
        let position = |index: u32| mesh.positions[index as usize].as_dvec3();
        mesh.indices.chunks_exact(3).map(|t| position(t[0]).dot(position(t[1]).cross(position(t[2]))) / 6.0).sum()
    }

    fn faces_its_normals(mesh: &Mesh) -> bool {
        mesh.indices.chunks_exact(3).all(|corners| {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[corners[i] as usize]);
            let area_vector = double_area_vector(a, b, c);
            corners.iter().all(|&i| area_vector.dot(mesh.normals[i as usize].as_dvec3()) > 0.0)
        })
    }

    #[test]
    fn sphere_is_closed_round_and_counted() {
        for (slices, stacks) in [(32, 32), (3, 2), (7, 5), (0, 0)] {
            let mesh = sphere(slices, stacks);
            mesh.validate().unwrap();
            let (slices, stacks) = (slices.max(3) as usize, stacks.max(2) as usize);
            assert_eq!(mesh.triangle_count(), 2 * slices * (stacks - 1));
            assert!(is_closed(&mesh) && faces_its_normals(&mesh));
            assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        }
        let volume = signed_volume(&sphere(128, 128));
        assert!((volume - 4.0 / 3.0 * f64::from(PI)).abs() < 0.01, "{volume}");
    }

    #[test]
    fn cuboid_is_a_cube_of_edge_two() {
        let mesh = cuboid();
        mesh.validate().unwrap();
        assert_eq!(mesh.triangle_count(), 12);
        assert!(is_closed(&mesh) && faces_its_normals(&mesh));
        assert!((signed_volume(&mesh) - 8.0).abs() < 1e-9);
        assert_eq!((mesh.bounds().min, mesh.bounds().max), (Vec3::NEG_ONE, Vec3::ONE));
    }

    #[test]
    fn plane_has_its_size_and_cells() {
        let mesh = plane(Vec2::new(4.0, 6.0), UVec2::new(3, 5));
        mesh.validate().unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangle_count()), (24, 30));
        assert!(faces_its_normals(&mesh));
        assert_eq!(mesh.bounds().diagonal(), Vec3::new(4.0, 0.0, 6.0));
        assert_eq!(mesh.bounds().center(), Vec3::ZERO);
        let area: f64 = mesh
            .indices
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[t[i] as usize]);
                double_area_vector(a, b, c).length() / 2.0
            })
            .sum();
        assert!((area - 24.0).abs() < 1e-4);
        assert_eq!(plane(Vec2::ONE, UVec2::ZERO).triangle_count(), 2);
    }
}

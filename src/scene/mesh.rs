use crate::scene::error::{Fault, Place};
use crate::scene::loading::timed;
use crate::scene::tags::Tags;
use crate::scene::{Bounds, creases, normals};
use glam::{Mat3, Mat4, Vec2, Vec3};

/// An indexed triangle mesh, counter-clockwise triangles facing out.
///
/// Meshes from [`crate::scene::MeshSource::load`] and [`crate::scene::shapes`] pass
/// [`Mesh::validate`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The shape's name or the file's name without its ending.
    pub name: String,
    /// Object space, metres.
    pub positions: Vec<Vec3>,
    /// Unit vectors, as many as positions.
    pub normals: Vec<Vec3>,
    /// As many as positions, or empty. (0, 0) is the lower left corner of the picture.
    pub texture_coordinates: Vec<Vec2>,
    /// Three vertex numbers a triangle.
    pub indices: Vec<u32>,
    /// Parts and colours, of a mesh that was loaded with them.
    pub tags: Tags,
}

impl Mesh {
    /// Farthest that a coordinate may be from 0: squares of distances are then numbers that single precision has, in papers and
    /// shaders.
    pub const MOST_COORDINATE: f32 = 1e18;
    /// Shortest that the longest side of the box around a mesh may be, for the same reason.
    pub const LEAST_SIDE: f32 = 1e-18;

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// The smallest box around all positions.
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.positions.iter().copied())
    }

    /// True where no coordinate is farther from 0 than [`Self::MOST_COORDINATE`], of a mesh that was placed.
    pub fn is_within_reach(&self) -> bool {
        self.positions.iter().all(is_within_reach)
    }

    /// The mesh with positions and normals in the space that `transform`, an affine matrix, leads
    /// to.
    ///
    /// Triangles still face out after a reflection: their winding is reversed.
    pub fn transformed(&self, transform: &Mat4) -> Self {
        self.clone().placed(transform)
    }

    /// As [`Mesh::transformed`], in place.
    pub fn placed(mut self, transform: &Mat4) -> Self {
        let placement = Placement::new(transform);
        self.positions.iter_mut().for_each(|p| *p = transform.transform_point3(*p));
        self.normals.iter_mut().for_each(|n| *n = placement.normal(*n));
        if placement.reflects {
            for corners in self.indices.chunks_exact_mut(3) {
                corners.swap(1, 2);
            }
        }
        self
    }

    /// Replaces all normals by area-weighted ones, smooth across vertices at the same position.
    ///
    /// A vertex that no triangle of positive area touches gets +Y.
    ///
    /// # Panics
    /// If an index is out of range, which [`Mesh::validate`] rules out.
    pub fn smooth_normals(&mut self) {
        self.normals = normals::smooth(&self.positions, &self.indices);
    }

    /// Checks what the field descriptions promise, that at least one triangle has a positive area, and that the mesh is neither
    /// too far nor too small ([`Self::MOST_COORDINATE`], [`Self::LEAST_SIDE`]).
    ///
    /// # Errors
    /// The first violation, with the number of its vertex or triangle.
    pub fn validate(&self) -> Result<(), Fault> {
        check_geometry(&self.positions, &self.indices)?;
        if self.normals.len() != self.positions.len() {
            let (normals, positions) = (self.normals.len(), self.positions.len());
            let reason = format!("{normals} normals for {positions} positions");
            return Err(Fault::new(Place::Whole, reason));
        }
        let is_unit = |n: &Vec3| (n.length_squared() - 1.0).abs() < 1e-3;
        if let Some(vertex) = self.normals.iter().position(|normal| !is_unit(normal)) {
            let reason = format!("the normal {} is not of unit length", self.normals[vertex]);
            return Err(Fault::new(Place::Vertex(vertex), reason));
        }
        check_texture_coordinates(&self.texture_coordinates, self.positions.len())
    }
}

/// Effect of an affine transform on normals and windings.
pub(super) struct Placement {
    cofactor: Mat3,
    /// It turns triangles over.
    pub reflects: bool,
}

impl Placement {
    pub fn new(transform: &Mat4) -> Self {
        let axes = [transform.x_axis, transform.y_axis, transform.z_axis].map(|a| a.truncate());
        let largest = axes.iter().map(|axis| axis.abs().max_element()).fold(0.0, f32::max);
        // By a power of two, which changes no direction: products of lengths of 1e13 or 1e-13 are none that a float has.
        let exponent = if largest.is_normal() { largest.log2().floor() as i32 } else { 0 };
        let [x, y, z] = axes.map(|axis| axis * 2_f32.powi(-exponent.clamp(-126, 126)));
        let reflects = x.dot(y.cross(z)) < 0.0;
        // The cofactor matrix is the inverse transpose up to the determinant, and exists for
        // singular matrices too.
        let cofactor = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Placement { cofactor: if reflects { -cofactor } else { cofactor }, reflects }
    }

    /// Of unit length; zero for what has none.
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        (self.cofactor * normal).normalize_or_zero()
    }
}

/// A mesh as a file gives it, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Parts {
    /// Positions of the vertices, in the file's unit.
    pub positions: Vec<Vec3>,
    /// None, or as many as positions; zero or not finite where there is none.
    pub normals: Vec<Vec3>,
    /// None, or as many as positions.
    pub texture_coordinates: Vec<Vec2>,
    /// Three vertex numbers a triangle.
    pub indices: Vec<u32>,
    /// Of the vertices, where they are asked for.
    pub tags: Tags,
}

impl Parts {
    /// A valid mesh; normals that are missing are computed, broken at edges sharper than `crease_deg`.
    pub fn into_mesh(mut self, crease_deg: f32) -> Result<Mesh, Fault> {
        check_geometry(&self.positions, &self.indices)?;
        check_texture_coordinates(&self.texture_coordinates, self.positions.len())?;
        for normal in &mut self.normals {
            *normal = normal.as_dvec3().normalize_or_zero().as_vec3();
        }
        timed(|parts| &mut parts.normals_ms, || creases::fill_normals(&mut self, crease_deg));
        let Parts { positions, normals, texture_coordinates, indices, tags } = self;
        Ok(Mesh { name: String::new(), positions, normals, texture_coordinates, indices, tags })
    }
}

/// False for a position that is not finite, too.
fn is_within_reach(position: &Vec3) -> bool {
    position.abs().cmple(Vec3::splat(Mesh::MOST_COORDINATE)).all()
}

/// Every coordinate of every position must be finite and within reach, and there must not be more than 32-bit
/// indices can name. No message shows a value: that of a glTF may come from any file.
pub(super) fn check_positions(positions: &[Vec3]) -> Result<(), Fault> {
    if positions.len() >= u32::MAX as usize || positions.is_empty() {
        let reason = format!("{} vertices; a mesh needs from 1 to 4294967294", positions.len());
        return Err(Fault::new(Place::Whole, reason));
    }
    let Some(vertex) = positions.iter().position(|position| !is_within_reach(position)) else { return Ok(()) };
    let reason = if positions[vertex].is_finite() {
        let most = Mesh::MOST_COORDINATE;
        format!("its position is beyond {most:e}, too far to reckon with; the mesh has to be scaled down")
    } else {
        "its position is not finite".to_owned()
    };
    Err(Fault::new(Place::Vertex(vertex), reason))
}

fn check_geometry(positions: &[Vec3], indices: &[u32]) -> Result<(), Fault> {
    check_positions(positions)?;
    if !indices.len().is_multiple_of(3) || indices.len() > u32::MAX as usize {
        let reason = format!("{} indices; they must be a multiple of three below 2^32", indices.len());
        return Err(Fault::new(Place::Whole, reason));
    }
    let beyond = |&index: &u32| index as usize >= positions.len();
    if let Some(corner) = indices.iter().position(beyond) {
        let reason = format!("it names vertex {}, but there are {}", indices[corner], positions.len());
        return Err(Fault::new(Place::Face(corner / 3), reason));
    }
    let has_area = |corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| positions[corners[i] as usize]);
        normals::double_area_vector(a, b, c) != glam::DVec3::ZERO
    };
    if !indices.chunks_exact(3).any(has_area) {
        let reason =
            format!("none of its {} triangles has a positive area; a mesh needs at least one", indices.len() / 3);
        return Err(Fault::new(Place::Whole, reason));
    }
    let least = Mesh::LEAST_SIDE;
    if Bounds::of_points(positions.iter().copied()).diagonal().max_element() < least {
        let reason =
            format!("its longest side is below {least:e}, too small to reckon with; the mesh has to be scaled up");
        return Err(Fault::new(Place::Whole, reason));
    }
    Ok(())
}

fn check_texture_coordinates(coordinates: &[Vec2], vertex_count: usize) -> Result<(), Fault> {
    if !coordinates.is_empty() && coordinates.len() != vertex_count {
        let reason = format!("{} texture coordinates for {vertex_count} positions", coordinates.len());
        return Err(Fault::new(Place::Whole, reason));
    }
    match coordinates.iter().position(|uv| !uv.is_finite()) {
        Some(vertex) => Err(Fault::new(Place::Vertex(vertex), "its texture coordinate is not finite")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;
    use glam::Quat;

    fn winding_agrees(mesh: &Mesh) -> bool {
        mesh.indices.chunks_exact(3).all(|corners| {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[corners[i] as usize]);
            (b - a).cross(c - a).dot(mesh.normals[corners[0] as usize]) > 0.0
        })
    }

    #[test]
    fn transforms_keep_normals_unit_and_outward() {
        let rotation = Quat::from_rotation_x(0.7) * Quat::from_rotation_y(-2.0);
        for scale in [Vec3::new(2.0, 0.5, 3.0), Vec3::new(-2.0, 0.5, 3.0)] {
            let transform = Mat4::from_scale_rotation_translation(scale, rotation, Vec3::ONE);
            let mesh = shapes::cuboid().transformed(&transform);
            mesh.validate().unwrap();
            assert!(winding_agrees(&mesh), "{scale}");
        }
    }

    #[test]
    fn normals_are_the_same_at_any_scale() {
        let plain = shapes::cuboid().transformed(&Mat4::from_scale(Vec3::new(1.0, -1.0, 2.0))).normals;
        for power in [-60, -100, 60, 100] {
            let scale = 2_f32.powi(power);
            let scaled = shapes::cuboid().transformed(&Mat4::from_scale(scale * Vec3::new(1.0, -1.0, 2.0)));
            assert_eq!(scaled.normals, plain, "2^{power}");
            assert!(scaled.indices != shapes::cuboid().indices, "turned over");
        }
    }

    #[test]
    fn a_sheared_normal_stays_perpendicular_to_its_face() {
        let shear =
            Mat4::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let mesh = shapes::cuboid().transformed(&shear);
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b] = [0, 1].map(|i| mesh.positions[corners[i] as usize]);
            assert!((b - a).dot(mesh.normals[corners[0] as usize]).abs() < 1e-5);
        }
    }

    #[test]
    fn every_violation_is_found_and_located() {
        let good = || shapes::cuboid();
        let faulty = |change: fn(&mut Mesh)| {
            let mut mesh = good();
            change(&mut mesh);
            mesh.validate().unwrap_err()
        };
        assert!(good().validate().is_ok());
        assert_eq!(faulty(|m| m.positions[3].y = f32::NAN).place, Place::Vertex(3));
        assert_eq!(faulty(|m| m.positions[2].z = -1.1e18).place, Place::Vertex(2));
        assert_eq!(faulty(|m| m.indices[4] = 24).place, Place::Face(1));
        assert_eq!(faulty(|m| m.normals[5] *= 2.0).place, Place::Vertex(5));
        assert_eq!(faulty(|m| m.normals[5].x = f32::NAN).place, Place::Vertex(5));
        assert_eq!(faulty(|m| m.texture_coordinates[7].x = f32::INFINITY).place, Place::Vertex(7));
        for change in [
            |m: &mut Mesh| m.indices.clear(),
            |m: &mut Mesh| m.indices.truncate(4),
            |m: &mut Mesh| m.positions.fill(Vec3::ONE),
            |m: &mut Mesh| m.positions.iter_mut().for_each(|p| *p *= 1e-19),
            |m: &mut Mesh| *m = Mesh::default(),
            |m: &mut Mesh| m.normals.truncate(3),
            |m: &mut Mesh| m.texture_coordinates.truncate(3),
        ] {
            assert_eq!(faulty(change).place, Place::Whole);
        }
    }

    #[test]
    fn missing_zero_and_broken_normals_are_computed() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let given = [Vec3::NAN, Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0)];
        for (normals, expected) in [(vec![], [Vec3::Z; 3]), (given.to_vec(), [Vec3::Z, Vec3::Z, Vec3::Y])] {
            let parts = Parts { positions: positions.clone(), normals, indices: vec![0, 1, 2], ..Parts::default() };
            let mesh = parts.into_mesh(30.0).unwrap();
            assert_eq!(mesh.normals, expected);
            mesh.validate().unwrap();
        }
    }
}

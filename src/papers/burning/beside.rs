//! Objects that burn beside the first: meshes with their places, and all of them as one mesh.

use std::ffi::OsStr;
use std::path::PathBuf;

use glam::{DVec3, Mat4, Vec2, Vec3};

use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one, with_place};
use crate::scene::{Mesh, MeshOptions, MeshSource, Tags};

/// A mesh with its place. As text: the source and `@X,Y,Z[,DEGREES[,SCALE]]`, in diagonals of the first object.
#[derive(Debug, Clone, PartialEq)]
pub struct Beside {
    /// Shape or file.
    pub source: MeshSource,
    /// Middle of its lower side; the first object's is the origin.
    pub base: Vec3,
    /// Turn about the vertical, degrees, from x towards -z.
    pub yaw_deg: f32,
    /// Its diagonal, above 0.
    pub scale: f32,
}

impl Beside {
    /// The mesh in its place, scaled.
    ///
    /// # Errors
    /// Those of [`MeshSource::load`].
    fn load(&self, options: &MeshOptions) -> Result<Mesh, Error> {
        let mesh = self.source.load_with(&MeshOptions { is_optimised: self.source.path().is_some(), ..*options })?;
        let place = Mat4::from_translation(self.base)
            * Mat4::from_rotation_y(self.yaw_deg.to_radians())
            * Mat4::from_scale(Vec3::splat(self.scale));
        Ok(scaled(mesh).placed(&place))
    }
}

/// Brings the diagonal of the box around a mesh to 1 and the middle of its lower side to the origin.
fn scaled(mut mesh: Mesh) -> Mesh {
    let bounds = mesh.bounds();
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let base = DVec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    let scale = 1.0 / (high - low).length().max(f64::MIN_POSITIVE);
    mesh.positions.iter_mut().for_each(|position| *position = ((position.as_dvec3() - base) * scale).as_vec3());
    mesh
}

/// The first object with those beside it as one mesh, in diagonals of the first. With tags each is a part by its name and
/// as `object-N`, the first being 1.
///
/// # Errors
/// Those of [`MeshSource::load`].
pub fn together(first: Mesh, beside: &[Beside], options: &MeshOptions) -> Result<Mesh, Error> {
    let name = first.name.clone();
    let mut meshes = vec![scaled(first)];
    for object in beside {
        meshes.push(object.load(options)?);
    }
    let is_textured = meshes.iter().any(|mesh| !mesh.texture_coordinates.is_empty());
    let is_coloured = meshes.iter().any(|mesh| !mesh.tags.colors.is_empty());
    let mut whole = Mesh { name, ..Mesh::default() };
    for (number, mesh) in (1..).zip(meshes) {
        let (before, count) = (whole.positions.len() as u32, mesh.positions.len());
        whole.indices.extend(mesh.indices.iter().map(|vertex| before + vertex));
        whole.positions.extend(mesh.positions);
        whole.normals.extend(mesh.normals);
        whole.texture_coordinates.extend(mesh.texture_coordinates);
        let Tags { mut names, part_of, colors } = mesh.tags;
        if options.keeps_tags {
            let first_part = whole.tags.names.len() as u32;
            if part_of.is_empty() {
                names = vec![Vec::new()];
            }
            names.iter_mut().for_each(|names| names.extend([mesh.name.clone(), format!("object-{number}")]));
            whole.tags.names.extend(names);
            let parts = part_of.into_iter().chain(std::iter::repeat(0)).take(count);
            whole.tags.part_of.extend(parts.map(|part| first_part + part));
        }
        whole.tags.colors.extend(colors);
        // Objects without coordinates or colours have the lower left corner of the texture, and white.
        if is_textured {
            whole.texture_coordinates.resize(whole.positions.len(), Vec2::ZERO);
        }
        if is_coloured {
            whole.tags.colors.resize(whole.positions.len(), Vec3::ONE);
        }
    }
    Ok(whole)
}

impl Value for Beside {
    const SHAPE: Shape = Shape::single("SHAPE|FILE@PLACE");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        const PLACE: &str = "give its place, @X,Y,Z[,DEGREES[,SCALE]] in diagonals of the first object";
        let [text] = texts else { return Err(one(texts).err().unwrap_or_else(|| PLACE.to_owned())) };
        let Some((name, numbers)) = with_place(text)? else { return Err(PLACE.to_owned()) };
        let (base, yaw_deg, scale) = match numbers[..] {
            [x, y, z] => ([x, y, z], 0.0, 1.0),
            [x, y, z, yaw_deg] => ([x, y, z], yaw_deg, 1.0),
            [x, y, z, yaw_deg, scale] => ([x, y, z], yaw_deg, scale),
            _ => return Err(format!("{PLACE}; {} numbers are given", numbers.len())),
        };
        let base = Vec3::from(base);
        if !(scale > 0.0 && scale <= 1e3 && base.abs().max_element() <= 1e3 && yaw_deg.is_finite()) {
            return Err("its scale must be above 0 to 1000, its place within 1000 diagonals".to_owned());
        }
        Ok(Beside { source: <MeshSource as Value>::parse(&[OsStr::new(name)])?, base, yaw_deg, scale })
    }

    fn text(&self) -> String {
        let Beside { source, base, yaw_deg, scale } = self;
        format!("{}@{},{},{},{yaw_deg},{scale}", source.text(), base.x, base.y, base.z)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Bounds, shapes};

    fn parsed(text: &str) -> Result<Beside, String> {
        Beside::parse(&[OsStr::new(text)])
    }

    #[test]
    fn places_are_read_and_written() {
        for (text, base, yaw_deg, scale) in [
            ("teapot@1,0,-2", Vec3::new(1.0, 0.0, -2.0), 0.0, 1.0),
            ("box@0.5,0.25,0,90", Vec3::new(0.5, 0.25, 0.0), 90.0, 1.0),
            ("a@b.obj@0,0,0,-30,0.5", Vec3::ZERO, -30.0, 0.5),
        ] {
            let beside = parsed(text).unwrap();
            assert_eq!((beside.base, beside.yaw_deg, beside.scale), (base, yaw_deg, scale), "{text}");
            assert_eq!(parsed(&beside.text()).unwrap(), beside);
        }
        for text in ["teapot", "box@1,2", "box@1,2,3,4,5,6", "box@0,0,0,0,0", "box@0,0,1e9"] {
            assert!(parsed(text).is_err_and(|error| error.contains("diagonals")), "{text}");
        }
    }

    #[test]
    fn objects_become_parts_of_one_mesh() {
        let options = MeshOptions { keeps_tags: true, ..MeshOptions::default() };
        let first = shapes::cuboid().placed(&Mat4::from_scale(Vec3::splat(7.0)));
        let beside = [parsed("sphere@2,0,0,0,0.5").unwrap(), parsed("sphere@0,1,0").unwrap()];
        let mesh = together(first.clone(), &beside, &options).unwrap();
        let names: Vec<_> = mesh.tags.names.iter().map(|names| names.last().unwrap().as_str()).collect();
        assert_eq!(names, ["object-1", "object-2", "object-3"]);
        assert!(mesh.tags.names[1].contains(&"sphere".to_owned()));
        let of = |part: u32| {
            let own = mesh.positions.iter().zip(&mesh.tags.part_of).filter(move |(_, of)| **of == part);
            Bounds::of_points(own.map(|(position, _)| *position))
        };
        for (part, diagonal, base) in [(0, 1.0, Vec3::ZERO), (1, 0.5, 2.0 * Vec3::X), (2, 1.0, Vec3::Y)] {
            let Bounds { min, max } = of(part);
            let middle = Vec3::new(0.5 * (min.x + max.x), min.y, 0.5 * (min.z + max.z));
            assert!((min.distance(max) - diagonal).abs() < 1e-5 && middle.distance(base) < 1e-5, "{part}: {min} {max}");
        }
        assert!(mesh.validate().is_ok() && mesh.positions.len() == mesh.normals.len());
        assert!(mesh.indices[..first.indices.len()] == first.indices);
    }
}

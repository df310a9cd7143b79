//! Polygon objects as a user names them: a mesh, and where it stands.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::PathBuf;

use glam::{Mat4, Vec3};

use super::collision::Collider;
use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one, parse_numbers};
use crate::scene::{Mesh, MeshOptions, MeshSource};

/// A mesh, where it is or in a place on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectSource {
    /// The mesh.
    pub mesh: MeshSource,
    /// None for a mesh in the maps' frame.
    pub place: Option<Stand>,
}

/// A place on the ground that an object stands on with its lowest point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Metres east of the origin.
    pub east_m: f32,
    /// Metres south of it.
    pub south_m: f32,
    /// About the vertical, counterclockwise seen from above, degrees.
    pub yaw_deg: f32,
    /// Factor of its size, above 0.
    pub scale: f32,
}

impl ObjectSource {
    /// # Errors
    /// [`Error::Scene`].
    pub fn load(&self, crease_deg: f32) -> Result<Mesh, Error> {
        Ok(self.mesh.load_with(&MeshOptions::to_draw(crease_deg))?)
    }
}

impl Stand {
    /// The mesh on the ground of `collider`.
    pub fn place(&self, mesh: &Mesh, collider: &Collider) -> Mesh {
        let Stand { east_m, south_m, yaw_deg, scale } = *self;
        let ground_m = collider.ground_m(f64::from(east_m), f64::from(south_m)) as f32;
        let turned =
            mesh.transformed(&(Mat4::from_rotation_y(yaw_deg.to_radians()) * Mat4::from_scale(Vec3::splat(scale))));
        let lowest_m = turned.positions.iter().map(|position| position.y).fold(f32::INFINITY, f32::min);
        turned.placed(&Mat4::from_translation(Vec3::new(east_m, ground_m - lowest_m, south_m)))
    }
}

impl fmt::Display for ObjectSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            None => self.mesh.fmt(formatter),
            Some(Stand { east_m, south_m, yaw_deg, scale }) => {
                write!(formatter, "{}@{east_m},{south_m},{yaw_deg},{scale}", self.mesh)
            }
        }
    }
}

impl Value for ObjectSource {
    const SHAPE: Shape = Shape::single("SHAPE|FILE[@EAST,SOUTH,DEGREES,SCALE]");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let place = |text: &str| -> Result<Option<Stand>, String> {
            // A file's own name may have an @.
            let Ok([east_m, south_m, yaw_deg, scale]) = parse_numbers::<4>(text) else {
                let is_meant = text.split(',').all(|part| part.trim().parse::<f32>().is_ok());
                return if is_meant { Err("give east, south, degrees and scale after @".to_owned()) } else { Ok(None) };
            };
            let is_size = scale > 0.0 && scale <= 1e6;
            if !is_size || east_m.abs().max(south_m.abs()) > 1e8 {
                return Err("its scale must be above 0 to 1000000, its place within 100000 km".to_owned());
            }
            Ok(Some(Stand { east_m, south_m, yaw_deg, scale }))
        };
        let Ok(whole) = one(texts) else { return Ok(ObjectSource { mesh: MeshSource::parse(texts)?, place: None }) };
        let (name, place) = match whole.rsplit_once('@') {
            Some((name, text)) => match place(text)? {
                Some(place) => (name, Some(place)),
                None => (whole, None),
            },
            None => (whole, None),
        };
        let name = OsString::from(name);
        Ok(ObjectSource { mesh: MeshSource::parse(&[name.as_os_str()])?, place })
    }

    fn text(&self) -> String {
        self.to_string()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.mesh.files()
    }
}

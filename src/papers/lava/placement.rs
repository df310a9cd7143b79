//! Polygon objects as a user names and places them.

use std::ffi::OsStr;
use std::path::PathBuf;

use glam::{Mat4, Vec3};
use serde_json::{Value as Json, json};

use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one, parse_finite};
use crate::scene::{Camera, Mesh, MeshSource};

/// Place of an object in the simulation space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// In the middle of the space, standing at half its height, where the lava is; its longest side is as long as the
    /// shortest side of the space.
    Fitted,
    /// The coordinates of the file are metres in the simulation space.
    Own,
    /// By numbers.
    At {
        /// Middle of its lower side, metres.
        base_m: Vec3,
        /// Turn about the vertical, degrees, from x towards -z.
        turn_deg: f32,
        /// Factor of its own size, above 0; without one the size of [`Place::Fitted`].
        scale: Option<f32>,
    },
}

/// A mesh with its place. As text: the source, then nothing, `@own` or `@X,Y,Z[,DEGREES[,SCALE]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Shape or file.
    pub source: MeshSource,
    /// Where it stands.
    pub place: Place,
}

impl Object {
    /// The mesh in the simulation space, whose sides are `space_m`.
    ///
    /// # Errors
    /// Those of [`MeshSource::load`]; [`Error::Input`] for coordinates that leave the range of floats.
    pub fn load(&self, space_m: Vec3) -> Result<Mesh, Error> {
        let mesh = self.source.load()?;
        let bounds = mesh.bounds();
        let (low, size) = (bounds.min.as_dvec3(), bounds.max.as_dvec3() - bounds.min.as_dvec3());
        let foot = low + size * glam::DVec3::new(0.5, 0.0, 0.5);
        let (base_m, turn_deg, scale) = match self.place {
            Place::Own => return Ok(mesh),
            Place::Fitted => (0.5 * space_m, 0.0, None),
            Place::At { base_m, turn_deg, scale } => (base_m, turn_deg, scale),
        };
        let fitted = f64::from(space_m.min_element()) / size.max_element();
        let scale = scale.unwrap_or(fitted as f32);
        let place = Mat4::from_translation(base_m)
            * Mat4::from_rotation_y(turn_deg.to_radians())
            * Mat4::from_scale(Vec3::splat(scale))
            * Mat4::from_translation(-foot.as_vec3());
        let placed = mesh.transformed(&place);
        if placed.positions.iter().all(|p| p.is_finite()) {
            return Ok(placed);
        }
        Err(Error::Input(format!("`object` {}: its coordinates are beyond 3.4e38 metres; scale it down", self.text())))
    }
}

/// Lines on the objects that a camera cannot show: outside of its view, or around its eye. `aspect` is the picture's
/// width over height.
pub fn warnings(meshes: &[Mesh], camera: &Camera, aspect: f32) -> Vec<String> {
    let to_clip = camera.projection(aspect) * camera.view();
    let warning = |(number, mesh): (usize, &Mesh)| {
        let clip: Vec<_> = mesh.positions.iter().map(|p| to_clip * p.extend(1.0)).collect();
        let beyond = |is_beyond: fn(glam::Vec4) -> bool| clip.iter().all(|&p| is_beyond(p));
        let is_outside = beyond(|p| p.x > p.w)
            || beyond(|p| p.x < -p.w)
            || beyond(|p| p.y > p.w)
            || beyond(|p| p.y < -p.w)
            || beyond(|p| p.z > p.w)
            || beyond(|p| p.z < 0.0);
        let bounds = mesh.bounds();
        let lies = if is_outside {
            "is outside the picture"
        } else if bounds.contains(camera.eye) {
            "surrounds the camera"
        } else {
            return None;
        };
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.to_array().map(|c| c.to_string()).join(","));
        let all = meshes.len();
        Some(format!("`object` {number} of {all}, {}, {lies}: it reaches from {min} to {max} metres", mesh.name))
    };
    (1..).zip(meshes).filter_map(warning).collect()
}

impl Value for Object {
    const SHAPE: Shape = Shape::single("SHAPE|FILE[@PLACE]");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let source = |text: &OsStr| <MeshSource as Value>::parse(&[text]);
        let [text] = texts else { return one(texts).map(|_| Object { source: MeshSource::Box, place: Place::Fitted }) };
        // A file's name may hold an @ itself: only what looks like a place is one.
        let placed = text.to_str().and_then(|text| text.rsplit_once('@'));
        let is_number = |c: char| c.is_ascii_digit() || "+-.,eE ".contains(c);
        match placed {
            Some((name, "own")) => Ok(Object { source: source(OsStr::new(name))?, place: Place::Own }),
            Some((name, place)) if !place.is_empty() && place.chars().all(is_number) => {
                Ok(Object { source: source(OsStr::new(name))?, place: at(place)? })
            }
            _ => Ok(Object { source: source(text)?, place: Place::Fitted }),
        }
    }

    fn text(&self) -> String {
        let source = self.source.text();
        match self.place {
            Place::Fitted => source,
            Place::Own => format!("{source}@own"),
            Place::At { base_m, turn_deg, scale } => {
                let scale = scale.map_or(String::new(), |scale| format!(",{scale}"));
                format!("{source}@{},{},{},{turn_deg}{scale}", base_m.x, base_m.y, base_m.z)
            }
        }
    }

    fn json(&self) -> Json {
        json!(self.text())
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }
}

/// `X,Y,Z[,DEGREES[,SCALE]]`.
fn at(text: &str) -> Result<Place, String> {
    let numbers = text.split(',').map(|part| parse_finite(part.trim())).collect::<Result<Vec<_>, _>>()?;
    let (base, turn_deg, scale) = match numbers[..] {
        [x, y, z] => ([x, y, z], 0.0, None),
        [x, y, z, turn_deg] => ([x, y, z], turn_deg, None),
        [x, y, z, turn_deg, scale] => ([x, y, z], turn_deg, Some(scale)),
        _ => {
            return Err(format!(
                "a place is X,Y,Z, X,Y,Z,DEGREES or X,Y,Z,DEGREES,SCALE; {} numbers are given",
                numbers.len()
            ));
        }
    };
    match scale {
        Some(scale) if scale <= 0.0 => Err(format!("the scale {scale} of the place must be above 0")),
        _ => Ok(Place::At { base_m: Vec3::from_array(base), turn_deg, scale }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Object, String> {
        Object::parse(&[OsStr::new(text)])
    }

    #[test]
    fn text_round_trips() {
        for text in ["box", "teapot@own", "a@b.obj", "mesh@home", "bunny@1,-0.5,0.25,30,2", "./x.ply@1,2,3,0,0.001"] {
            assert_eq!(parse(text).unwrap().text(), text);
        }
        assert_eq!(parse("box@1,2,3").unwrap(), parse("box@1,2,3,0").unwrap());
        let file = parse("a@b.obj").unwrap();
        assert_eq!((file.files(), file.place), (vec![PathBuf::from("a@b.obj")], Place::Fitted));
        for (text, part) in [("box@1,2", "2 numbers"), ("box@1,2,3,0,0", "scale"), ("box@1,,3", "finite")] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn places_are_what_they_say() {
        let space = Vec3::new(4.0, 1.0, 2.0);
        let bounds = |text: &str| parse(text).unwrap().load(space).unwrap().bounds();
        let is_near = |a: Vec3, b: Vec3| (a - b).abs().max_element() < 1e-5;
        let fitted = bounds("teapot");
        let longest = fitted.diagonal().max_element();
        assert!((fitted.min.y - 0.5).abs() < 1e-5, "it stands in the lava, not under it");
        assert!(
            (longest - 1.0).abs() < 1e-5
                && is_near(fitted.center() * Vec3::new(1.0, 0.0, 1.0), Vec3::new(2.0, 0.0, 1.0))
        );
        assert_eq!(bounds("teapot@own"), MeshSource::Teapot.load().unwrap().bounds());
        let side = MeshSource::Box.load().unwrap().bounds().diagonal();
        let placed = bounds("box@0.5,0.25,1,90,0.5");
        assert!(is_near(placed.diagonal(), 0.5 * Vec3::new(side.z, side.y, side.x)), "{placed:?}");
        assert!(is_near(placed.min + 0.25 * Vec3::new(side.z, 0.0, side.x), Vec3::new(0.5, 0.25, 1.0)), "{placed:?}");
        assert!(parse("box@0,0,0,0,1e38").unwrap().load(space).is_ok());
        assert!(parse("box@0,0,0,0,3e38").unwrap().load(space).is_err());
    }

    #[test]
    fn what_the_camera_cannot_show_is_named() {
        let camera = crate::papers::lava::CAMERAS[0].1;
        let said = |text: &str| warnings(&[parse(text).unwrap().load(Vec3::new(4.0, 1.0, 1.0)).unwrap()], &camera, 1.5);
        assert_eq!(said("bunny"), Vec::<String>::new());
        for (text, part) in
            [("box@0,50,0,0,1", "outside the picture"), ("sphere@-0.7,-4,2.4,0,10", "surrounds the camera")]
        {
            let warnings = said(text);
            assert!(
                warnings.len() == 1 && warnings[0].contains(part) && warnings[0].contains("1 of 1"),
                "{warnings:?}"
            );
        }
    }
}

//! Polygon objects as a user names, places and paints them.

use std::ffi::OsStr;
use std::path::PathBuf;

use glam::{Mat4, Vec3};

use crate::measure::Error;
use crate::measure::components;
use crate::measure::parameter::{Shape, Value, one, with_place};
use crate::papers::gas::model::Object;
use crate::scene::{Mesh, MeshOptions, MeshSource};

/// The grey of an object that names no colour.
const GREY: Vec3 = Vec3::splat(0.6);

/// A mesh with its place and its paint. As text: the source, then nothing, or `@` and 3, 4, 5, 8 or 9 numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedObject {
    /// Shape or file.
    pub source: MeshSource,
    /// Place and paint; without, it stands at the file's own coordinates, metres.
    pub stand: Option<Stand>,
}

/// Place and paint of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Middle of its lower side, metres.
    pub base_m: Vec3,
    /// Turn about the vertical, degrees, from x towards -z.
    pub yaw_deg: f32,
    /// Factor of its own size, above 0.
    pub scale: f32,
    /// Linear RGB, 0 to 1.
    pub color: Vec3,
    /// 0 to 1.
    pub opacity: f32,
}

impl PlacedObject {
    /// The object in the scene.
    ///
    /// # Errors
    /// Those of [`MeshSource::load`]; [`Error::Input`] for coordinates beyond [`Mesh::MOST_COORDINATE`].
    pub fn load(&self, crease_deg: f32) -> Result<Object, Error> {
        let mesh = self.source.load_with(&MeshOptions::to_draw(crease_deg))?;
        let Some(Stand { base_m, yaw_deg, scale, color, opacity }) = self.stand else {
            return Ok(Object::new(mesh, GREY));
        };
        let bounds = mesh.bounds();
        let foot = bounds.center().with_y(bounds.min.y);
        let place = Mat4::from_translation(base_m)
            * Mat4::from_rotation_y(yaw_deg.to_radians())
            * Mat4::from_scale(Vec3::splat(scale))
            * Mat4::from_translation(-foot);
        let placed = mesh.placed(&place);
        if placed.is_within_reach() {
            return Ok(Object { opacity, ..Object::new(placed, color) });
        }
        let most_m = Mesh::MOST_COORDINATE;
        Err(Error::Input(format!(
            "`object` {}: its coordinates are beyond {most_m:e} metres; scale it down",
            self.text()
        )))
    }
}

impl Value for PlacedObject {
    const SHAPE: Shape = Shape::single("SHAPE|FILE[@PLACE]");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let [text] = texts else {
            return one(texts).map(|_| PlacedObject { source: MeshSource::Box, stand: None });
        };
        let (source, stand) = match with_place(text)? {
            Some((name, numbers)) => (OsStr::new(name), Some(Stand::of(&numbers)?)),
            None => (*text, None),
        };
        Ok(PlacedObject { source: <MeshSource as Value>::parse(&[source])?, stand })
    }

    fn text(&self) -> String {
        let source = self.source.text();
        self.stand.map_or(source.clone(), |Stand { base_m, yaw_deg, scale, color, opacity }| {
            format!("{source}@{},{yaw_deg},{scale},{},{opacity}", components(base_m), components(color))
        })
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }
}

impl Stand {
    fn of(numbers: &[f32]) -> Result<Self, String> {
        let (place, rest) = numbers.split_at(numbers.len().min(3));
        let &[x, y, z] = place else { return Err(form(numbers)) };
        let (yaw_deg, scale, color, opacity) = match *rest {
            [] => (0.0, 1.0, GREY, 1.0),
            [yaw_deg] => (yaw_deg, 1.0, GREY, 1.0),
            [yaw_deg, scale] => (yaw_deg, scale, GREY, 1.0),
            [yaw_deg, scale, r, g, b] => (yaw_deg, scale, Vec3::new(r, g, b), 1.0),
            [yaw_deg, scale, r, g, b, opacity] => (yaw_deg, scale, Vec3::new(r, g, b), opacity),
            _ => return Err(form(numbers)),
        };
        if scale <= 0.0 {
            return Err(format!("the scale {scale} of the place must be above 0"));
        }
        if !color.to_array().iter().chain([&opacity]).all(|part| (0.0..=1.0).contains(part)) {
            return Err(format!("the colour {} and the opacity {opacity} must be 0 to 1", components(color)));
        }
        Ok(Stand { base_m: Vec3::new(x, y, z), yaw_deg, scale, color, opacity })
    }
}

fn form(numbers: &[f32]) -> String {
    format!("a place is X,Y,Z[,DEGREES[,SCALE[,R,G,B[,OPACITY]]]]; {} numbers are given", numbers.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<PlacedObject, String> {
        PlacedObject::parse(&[OsStr::new(text)])
    }

    #[test]
    fn text_round_trips() {
        for text in ["box", "a@b.obj", "bunny@1,-0.5,0.25,30,2,0.1,0.2,0.3,0.5"] {
            assert_eq!(parse(text).unwrap().text(), text);
        }
        assert_eq!(parse("box@1,2,3").unwrap(), parse("box@1,2,3,0,1,0.6,0.6,0.6,1").unwrap());
        for (text, part) in [
            ("box@1,2", "2 numbers"),
            ("box@1,2,3,0,1,0.5", "6 numbers"),
            ("box@1,2,3,0,0", "scale"),
            ("box@1,2,3,0,1,2,0,0", "0 to 1"),
            ("box@1,2,3,0,1,1,0,0,-1", "0 to 1"),
            ("box@1,,3", "finite"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn it_stands_where_it_is_told() {
        let side = MeshSource::Box.load().unwrap().bounds().diagonal();
        let object = parse("box@0.5,0.25,1,90,0.5,1,0,0,0.25").unwrap().load(30.0).unwrap();
        let bounds = object.mesh.bounds();
        let corner = Vec3::new(0.5, 0.25, 1.0) - 0.25 * Vec3::new(side.z, 0.0, side.x);
        assert!((bounds.min - corner).abs().max_element() < 1e-5, "{bounds:?}");
        assert_eq!((object.color, object.opacity), (Vec3::X, 0.25));
        let own = parse("teapot").unwrap().load(30.0).unwrap();
        assert_eq!(own.mesh.bounds(), MeshSource::Teapot.load().unwrap().bounds());
        assert!(parse("box@0,0,0,0,5e17").unwrap().load(30.0).is_ok());
        assert!(parse("box@0,0,0,0,2e18").unwrap().load(30.0).is_err());
    }
}

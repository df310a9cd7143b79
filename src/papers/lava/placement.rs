//! Polygon objects as a user names and places them.

use std::ffi::OsStr;
use std::path::PathBuf;

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one, with_place};
use crate::scene::{Bounds, Camera, Mesh, MeshOptions, MeshSource};

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
        yaw_deg: f32,
        /// Factor of its own size, above 0; without one the size of [`Place::Fitted`].
        scale: Option<f32>,
    },
}

/// A mesh with its place. As text: the source, then nothing, `@own` or `@X,Y,Z[,DEGREES[,SCALE]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Shape or file.
    pub source: MeshSource,
    /// Its foot, size and rotation.
    pub place: Place,
}

impl Object {
    /// The mesh in the simulation space, whose sides are `space_m`.
    ///
    /// # Errors
    /// Those of [`MeshSource::load`]; [`Error::Input`] for coordinates beyond [`Mesh::MOST_COORDINATE`].
    pub fn load(&self, space_m: Vec3, crease_deg: f32) -> Result<Mesh, Error> {
        let mesh = self.source.load_with(&MeshOptions::to_draw(crease_deg))?;
        let bounds = mesh.bounds();
        let (low, size) = (bounds.min.as_dvec3(), bounds.max.as_dvec3() - bounds.min.as_dvec3());
        let foot = low + size * glam::DVec3::new(0.5, 0.0, 0.5);
        let (base_m, yaw_deg, scale) = match self.place {
            Place::Own => return Ok(mesh),
            Place::Fitted => (0.5 * space_m, 0.0, None),
            Place::At { base_m, yaw_deg, scale } => (base_m, yaw_deg, scale),
        };
        let fitted = f64::from(space_m.min_element()) / size.max_element();
        let scale = scale.unwrap_or(fitted as f32);
        let place = Mat4::from_translation(base_m)
            * Mat4::from_rotation_y(yaw_deg.to_radians())
            * Mat4::from_scale(Vec3::splat(scale))
            * Mat4::from_translation(-foot.as_vec3());
        let placed = mesh.placed(&place);
        if placed.is_within_reach() {
            return Ok(placed);
        }
        let most_m = Mesh::MOST_COORDINATE;
        Err(Error::Input(format!(
            "`object` {}: its coordinates are beyond {most_m:e} metres; scale it down",
            self.text()
        )))
    }
}

/// All that ends within so many distances of the near plane is small enough to bring that nearer.
const NEAR_PLANES: f32 = 20.0;

/// The camera with its near and far plane moved so that space and objects lie between them, where they do not: a view from
/// far away, or of a space of centimetres, is no reason for a black picture. `aspect` is the picture's width over height.
pub fn reaching(camera: &Camera, space_m: Vec3, meshes: &[Mesh], aspect: f32) -> Camera {
    let space = Bounds { min: Vec3::ZERO, max: space_m };
    let all: Vec<Bounds> = meshes.iter().map(Mesh::bounds).chain([space]).collect();
    let forward = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
    let depth = |corner: Vec3| (corner - camera.eye).dot(forward);
    let farthest = |b: &Bounds| depth(Vec3::select(forward.cmpgt(Vec3::ZERO), b.max, b.min));
    let far_m = 1.01 * all.iter().map(farthest).fold(0.0, f32::max);
    if 0.0 < far_m && far_m < NEAR_PLANES * camera.near_m {
        return Camera { near_m: far_m * camera.near_m / camera.far_m, far_m, ..*camera };
    }
    if far_m <= camera.far_m || !far_m.is_finite() {
        return *camera;
    }
    // What is seen at some distance has at least so much of it along the view.
    let half = (camera.vertical_fov_rad / 2.0).tan();
    let along = (1.0 + half * half * (1.0 + aspect * aspect)).sqrt().recip();
    let distance = |b: &Bounds| camera.eye.distance(camera.eye.clamp(b.min, b.max));
    let nearest_m = all.iter().map(distance).fold(f32::INFINITY, f32::min);
    Camera { near_m: camera.near_m.max(0.9 * along * nearest_m), far_m, ..*camera }
}

/// Pixels below which the lava is hard to find in a picture.
const FEW_PIXELS: f32 = 8.0;

/// A line where the camera does not show the space, or shows it as a few pixels of a picture of `width` x `height`.
pub fn space_warning(camera: &Camera, space_m: Vec3, (width, height): (u32, u32)) -> Option<String> {
    let to_clip = camera.projection(width as f32 / height as f32) * camera.view();
    let corners = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * space_m);
    let clip: Vec<Vec4> = corners.map(|corner| to_clip * corner.extend(1.0)).collect();
    if is_outside(&clip) {
        return Some("the lava is outside the picture: turn `camera` towards it".to_owned());
    }
    if clip.iter().any(|corner| corner.w <= 0.0) {
        return None;
    }
    let places = clip.iter().map(|corner| corner.truncate().truncate() / corner.w);
    let (low, high) = places.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let pixels = ((high - low) / 2.0 * Vec2::new(width as f32, height as f32)).max_element();
    (pixels < FEW_PIXELS).then(|| {
        format!("the lava is {pixels:.1} pixels large in the picture: bring `camera` nearer, or make `size` larger")
    })
}

/// True when all points lie beyond one side of the picture or of its depths.
fn is_outside(clip: &[Vec4]) -> bool {
    let beyond = |is_beyond: fn(Vec4) -> bool| clip.iter().all(|&p| is_beyond(p));
    beyond(|p| p.x > p.w)
        || beyond(|p| p.x < -p.w)
        || beyond(|p| p.y > p.w)
        || beyond(|p| p.y < -p.w)
        || beyond(|p| p.z > p.w)
        || beyond(|p| p.z < 0.0)
}

/// Lines on the objects that lie under the surface wholly. `surface` has a texel for each of `columns` x `rows` over the
/// space, normals and heights in metres.
pub fn buried(meshes: &[Mesh], surface: &[[f32; 4]], columns: u32, rows: u32, space_m: Vec3) -> Vec<String> {
    let texels = Vec2::new(columns as f32, rows as f32);
    // The least height around a place: no interpolation lies lower.
    let height_m = |place: Vec3| {
        let at = Vec2::new(place.x / space_m.x, place.z / space_m.z) * texels - 0.5;
        let texel = |x: f32, y: f32| {
            let [x, y] = [x.clamp(0.0, texels.x - 1.0), y.clamp(0.0, texels.y - 1.0)].map(|c| c as usize);
            surface.get(y * columns as usize + x).map_or(f32::NEG_INFINITY, |texel| texel[3])
        };
        let (low, high) = (at.floor(), at.floor() + 1.0);
        texel(low.x, low.y).min(texel(high.x, low.y)).min(texel(low.x, high.y)).min(texel(high.x, high.y))
    };
    let is_under = |place: &Vec3| {
        let is_inside = place.x >= 0.0 && place.x <= space_m.x && place.z >= 0.0 && place.z <= space_m.z;
        is_inside && place.y < height_m(*place)
    };
    let warning = |(number, mesh): (usize, &Mesh)| {
        let highest_m = mesh.bounds().max.y;
        mesh.positions.iter().all(is_under).then(|| {
            let all = meshes.len();
            format!(
                "`object` {number} of {all}, {}, lies under the lava, which hides it from above: its highest point is at \
                 {highest_m} m",
                mesh.name
            )
        })
    };
    (1..).zip(meshes).filter_map(warning).collect()
}

/// Lines on the objects that a camera cannot show: outside of its view, or around its eye. `aspect` is the picture's
/// width over height.
pub fn warnings(meshes: &[Mesh], camera: &Camera, aspect: f32) -> Vec<String> {
    let to_clip = camera.projection(aspect) * camera.view();
    let warning = |(number, mesh): (usize, &Mesh)| {
        let clip: Vec<_> = mesh.positions.iter().map(|p| to_clip * p.extend(1.0)).collect();
        let bounds = mesh.bounds();
        let lies = if is_outside(&clip) {
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
        if let Some(name) = text.to_str().and_then(|text| text.strip_suffix("@own")) {
            return Ok(Object { source: source(OsStr::new(name))?, place: Place::Own });
        }
        match with_place(text)? {
            Some((name, numbers)) => Ok(Object { source: source(OsStr::new(name))?, place: at(&numbers)? }),
            None => Ok(Object { source: source(text)?, place: Place::Fitted }),
        }
    }

    fn text(&self) -> String {
        let source = self.source.text();
        match self.place {
            Place::Fitted => source,
            Place::Own => format!("{source}@own"),
            Place::At { base_m, yaw_deg, scale } => {
                let scale = scale.map_or(String::new(), |scale| format!(",{scale}"));
                format!("{source}@{},{},{},{yaw_deg}{scale}", base_m.x, base_m.y, base_m.z)
            }
        }
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }
}

/// `X,Y,Z[,DEGREES[,SCALE]]`.
fn at(numbers: &[f32]) -> Result<Place, String> {
    let (base, yaw_deg, scale) = match *numbers {
        [x, y, z] => ([x, y, z], 0.0, None),
        [x, y, z, yaw_deg] => ([x, y, z], yaw_deg, None),
        [x, y, z, yaw_deg, scale] => ([x, y, z], yaw_deg, Some(scale)),
        _ => {
            return Err(format!(
                "a place is X,Y,Z, X,Y,Z,DEGREES or X,Y,Z,DEGREES,SCALE; {} numbers are given",
                numbers.len()
            ));
        }
    };
    match scale {
        Some(scale) if scale <= 0.0 => Err(format!("the scale {scale} of the place must be above 0")),
        _ => Ok(Place::At { base_m: Vec3::from_array(base), yaw_deg, scale }),
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
        let bounds = |text: &str| parse(text).unwrap().load(space, 30.0).unwrap().bounds();
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
        assert!(parse("box@0,0,0,0,4e17").unwrap().load(space, 30.0).is_ok());
        assert!(parse("box@0,0,0,0,2e18").unwrap().load(space, 30.0).is_err());
    }

    #[test]
    fn a_camera_reaches_what_there_is_to_see() {
        let near = crate::papers::lava::CAMERAS[0].1;
        let space = Vec3::new(4.0, 1.0, 1.0);
        assert_eq!(reaching(&near, space, &[], 1.5), near);
        let small = Camera { eye: 1e-3 * near.eye, target: 1e-3 * near.target, ..near };
        let camera = reaching(&small, 1e-3 * space, &[], 1.5);
        assert!(camera.near_m < 3e-5 && (0.004..0.01).contains(&camera.far_m), "{camera:?}");
        assert_eq!(space_warning(&camera, 1e-3 * space, (800, 600)), None);
        let away = Camera { eye: Vec3::new(2.0, 3000.0, 4000.0), ..near };
        let camera = reaching(&away, space, &[], 1.5);
        assert!(camera.near_m > 3500.0 && camera.near_m < 4999.0 && camera.far_m > 5000.0, "{camera:?}");
        let beside = parse("sphere@-0.7,3.0,2.2").unwrap().load(space, 30.0).unwrap();
        let camera = reaching(&away, space, &[beside], 1.5);
        assert!(camera.near_m < 4990.0 && camera.far_m < 5100.0);
    }

    #[test]
    fn a_picture_without_lava_says_so() {
        let (near, space) = (crate::papers::lava::CAMERAS[0].1, Vec3::new(4.0, 1.0, 1.0));
        assert_eq!(space_warning(&near, space, (800, 600)), None);
        let inside = Camera { eye: Vec3::new(2.0, 0.9, 0.5), ..near };
        assert_eq!(space_warning(&inside, space, (800, 600)), None);
        let away = Camera { target: 2.0 * near.eye, ..near };
        assert!(space_warning(&away, space, (800, 600)).unwrap().contains("outside"));
        let far = reaching(&Camera { eye: 1000.0 * near.eye, ..near }, space, &[], 1.5);
        assert!(space_warning(&far, space, (800, 600)).unwrap().contains("pixels large"));
    }

    #[test]
    fn what_lies_under_the_surface_wholly_is_named() {
        let space = Vec3::new(4.0, 1.0, 1.0);
        // A slope from 0 at x = 0 to 0.9 m.
        let surface: Vec<[f32; 4]> = (0..2).flat_map(|_| (0..4).map(|x| [0.0, 1.0, 0.0, 0.3 * x as f32])).collect();
        let said = |text: &str| buried(&[parse(text).unwrap().load(space, 30.0).unwrap()], &surface, 4, 2, space);
        assert!(said("sphere@3,0,0.5,0,0.1")[0].contains("under the lava"));
        for text in ["sphere@1,0,0.5,0,0.2", "sphere@3,0.9,0.5,0,0.1", "sphere@5,-3,0.5,0,0.1"] {
            assert!(said(text).is_empty(), "{text}");
        }
    }

    #[test]
    fn what_the_camera_cannot_show_is_named() {
        let camera = crate::papers::lava::CAMERAS[0].1;
        let said =
            |text: &str| warnings(&[parse(text).unwrap().load(Vec3::new(4.0, 1.0, 1.0), 30.0).unwrap()], &camera, 1.5);
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

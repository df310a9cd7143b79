//! The numbers of a configuration.

use std::f32::consts::FRAC_PI_4;
use std::ffi::OsStr;

use glam::Vec3;
use serde_json::{Value as Json, json};

use super::placement::Placement;
use crate::measure::parameter::{
    self, Cost, EyeAndTarget, Field, Parameter, Range, Shape, Value, one, parse_finite, parse_numbers,
};
use crate::measure::{self, ParameterError, components, config};
use crate::scene::{Camera, HeightMap};
use crate::{choice, field, named, size_field};

named! {
    /// The applications of section 4, and what a user would do without them.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Variant: measure::Variant {
        /// Section 4, first application: everything on the processor, on all cores.
        Cpu = "cpu",
        /// Section 4, second application: depth, normal and illumination by compute stages.
        GpuCompute = "gpu-compute",
        /// The same three as full-screen fragment passes.
        GpuFragment = "gpu-fragment",
        /// The map as an indexed triangle grid, rasterised.
        Mesh = "mesh",
        /// The map as patches of triangles at the level of detail that the picture needs, rasterised.
        MeshLod = "mesh-lod",
        /// Not the paper's: rays that go from border to border of blocks of cells, by compute stages.
        DdaCompute = "dda-compute",
        /// The same as full-screen fragment passes.
        DdaFragment = "dda-fragment",
        /// The same on the processor, on all cores.
        DdaCpu = "dda-cpu",
        /// As [`Variant::GpuCompute`], over maps of which the device holds the tiles that rays ask for.
        TiledCompute = "tiled-compute",
    }
}

impl Variant {
    /// The paper's, and what it is compared with.
    pub const PAPER: &[Variant] =
        &[Variant::Cpu, Variant::GpuCompute, Variant::GpuFragment, Variant::Mesh, Variant::MeshLod];

    /// Everything on the processor.
    pub fn is_host(self) -> bool {
        matches!(self, Variant::Cpu | Variant::DdaCpu)
    }

    /// Maps lie on the device as a whole.
    pub fn holds_whole_maps(self) -> bool {
        !self.is_host() && self != Variant::TiledCompute
    }

    /// Triangles instead of rays.
    pub fn is_rasterised(self) -> bool {
        matches!(self, Variant::Mesh | Variant::MeshLod)
    }
}

choice! {
    /// The level of detail: the end of a ray's subdivision.
    pub enum Lod {
        /// To the interpolated surface of the data.
        Exact = ("exact", "To the interpolated surface of the data"),
        /// To the footprint of a pixel, with heights from the level of that size.
        Pixel = ("pixel", "To the footprint of a pixel, with heights from the level of that size"),
    }
}

choice! {
    /// The surface between the samples.
    pub enum Interpolation {
        /// Eq. 7.
        Bilinear = ("bilinear", "Eq. 7"),
        /// Catmull-Rom: through the samples, with a continuous slope.
        Bicubic = ("bicubic", "Catmull-Rom"),
    }
}

choice! {
    /// The beginning of the rays that walk from cell to cell on the device, over a plane. Hits are the same.
    pub enum Start {
        /// The depth up to which the beam of 8 x 8 pixels around them is free; adds the pass `start`.
        Tiles = ("tiles", "Where the beam of 8 x 8 pixels around them may first meet the map"),
        /// The place where each comes over the map.
        Rays = ("rays", "Where each comes over the map"),
    }
}

choice! {
    /// The reading of a bilinear cell's corners by the rays that walk from cell to cell on the device. Hits are the same.
    pub enum Corners {
        /// [`Corners::Packed`] where the device has room for that.
        Auto = ("auto", "Packed where that takes at most a quarter of the device's memory, image elsewhere"),
        /// By one fetch, from images that are made of the levels.
        Packed = ("packed", "By one fetch, from 14 to 21 bytes more a sample of 16 bits, 26 to 39 of a float"),
        /// Each by its own, from the levels.
        Image = ("image", "By four fetches from the levels"),
    }
}

choice! {
    /// The normals of the terrain's surface.
    pub enum Normals {
        /// [`Normals::Nodes`] where the cells of a bilinear surface are larger than a pixel, [`Normals::Surface`] elsewhere.
        Auto = ("auto", "Nodes where a bilinear cell is larger than a pixel, surface elsewhere"),
        /// Interpolated between those of the samples, which follow from their neighbours.
        Nodes = ("nodes", "Interpolated between those of the samples, without steps from cell to cell"),
        /// Of the interpolated surface itself.
        Surface = ("surface", "Of the interpolated surface itself"),
    }
}

/// The base surface P that heights are added to along its normal (eq. 5, 6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Base {
    Plane,
    /// An ellipsoid of revolution, by its semi-axes, 1 to 100,000,000 m and within a factor of 4 of each other. Maps lie by
    /// longitude and latitude.
    Ellipsoid {
        /// Semi-axis in the plane of the equator, metres.
        equatorial_m: f32,
        /// Semi-axis to the poles, metres.
        polar_m: f32,
    },
    /// By its radius, 1 to 100,000,000 m. Its axis runs north and south; maps are wound around it eastwards.
    Cylinder {
        /// Radius in metres.
        radius_m: f32,
    },
}

impl Base {
    /// The Earth's, WGS84.
    pub const EARTH: Base = Base::Ellipsoid { equatorial_m: 6_378_137.0, polar_m: 6_356_752.5 };

    /// The value of `BASE` in the shaders' variants: rays stay straight over a plane alone.
    pub fn kind(self) -> &'static str {
        match self {
            Base::Plane => "plane",
            Base::Ellipsoid { .. } | Base::Cylinder { .. } => "curved",
        }
    }
}

impl Value for Base {
    const SHAPE: Shape = Shape::single("BASE");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        match text.split_once(':') {
            None if text == "plane" => Ok(Base::Plane),
            None if text == "earth" => Ok(Base::EARTH),
            Some(("ellipsoid", axes)) => {
                parse_numbers(axes).map(|[equatorial_m, polar_m]| Base::Ellipsoid { equatorial_m, polar_m })
            }
            Some(("cylinder", radius)) => parse_finite(radius).map(|radius_m| Base::Cylinder { radius_m }),
            _ => Err("give plane, earth, ellipsoid:EQUATORIAL,POLAR or cylinder:RADIUS".to_owned()),
        }
    }

    fn text(&self) -> String {
        match self {
            Base::Plane => "plane".to_owned(),
            Base::Ellipsoid { equatorial_m, polar_m } => format!("ellipsoid:{equatorial_m},{polar_m}"),
            Base::Cylinder { radius_m } => format!("cylinder:{radius_m}"),
        }
    }

    fn json(&self) -> Json {
        match self {
            Base::Plane => json!("plane"),
            Base::Ellipsoid { equatorial_m, polar_m } => json!({"ellipsoid": [equatorial_m, polar_m]}),
            Base::Cylinder { radius_m } => json!({"cylinder": radius_m}),
        }
    }
}

/// The sun's place in the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Clockwise from north, -2 pi to 2 pi.
    pub azimuth_rad: f32,
    /// Above the horizon, 0 to pi/2.
    pub elevation_rad: f32,
}

impl Sun {
    /// The unit direction to it; north is -z and east +x.
    pub fn direction(self) -> Vec3 {
        let (east, north) = self.azimuth_rad.sin_cos();
        let (up, along) = self.elevation_rad.sin_cos();
        Vec3::new(east * along, up, -north * along)
    }
}

/// The camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// From the south and a little above, as figure 2.
    Side,
    /// From straight above, north up, as figure 1.
    Top,
    /// In the maps' frame: x east, y up from the base, z south, from the middle of the first map.
    Camera(Camera),
}

/// The near plane of what is rasterised for a camera that a user sets, a thousandth of the target's distance at most: rays see what
/// is nearer, too. Depth buffers know depths as well however near it is, and large triangles that begin there less well.
const NEAR_M: f32 = 0.01;
/// The nearest that it may be: depths of 100,000 km are numbers there.
const NEAREST_M: f32 = 1e-9;

impl Value for View {
    const SHAPE: Shape = Shape { placeholder: "side|top|EYE,TARGET", ..EyeAndTarget::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let camera = |EyeAndTarget { eye, target }| {
            let near_m = (1e-3 * eye.distance(target)).clamp(NEAREST_M, NEAR_M);
            View::Camera(Camera { eye, target, up: Vec3::Y, vertical_fov_rad: FRAC_PI_4, near_m, far_m: 1.0e6 })
        };
        match one(texts)? {
            "side" => Ok(View::Side),
            "top" => Ok(View::Top),
            _ => EyeAndTarget::parse(texts).map(camera).map_err(|e| format!("side, top, or eye and target: {e}")),
        }
    }

    fn text(&self) -> String {
        match self {
            View::Side => "side".to_owned(),
            View::Top => "top".to_owned(),
            View::Camera(camera) => [camera.eye, camera.target].map(components).join(","),
        }
    }

    fn json(&self) -> Json {
        match self {
            View::Side | View::Top => json!(self.text()),
            View::Camera(camera) => config::camera(camera),
        }
    }
}

/// Every number of a configuration, in the ranges of [`Parameters::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// The end of a ray's subdivision.
    pub lod: Lod,
    /// The surface between the samples.
    pub interpolation: Interpolation,
    /// The beginning of rays in the variants `dda-compute` and `dda-fragment`.
    pub start: Start,
    /// The reading of corners by rays in the variants `dda-compute` and `dda-fragment`.
    pub corners: Corners,
    /// The normals of the terrain's surface.
    pub normals: Normals,
    /// The surface below the heights.
    pub base: Base,
    /// The height in the maps' own frame at which the base lies, metres; the lowest sample without one.
    pub base_level_m: Option<f32>,
    /// The camera.
    pub view: View,
    /// The source of parallel light.
    pub sun: Sun,
    /// The terrain throws shadows on itself; adds the pass `shadow`.
    pub shadows: bool,
    /// The most pixels by which triangles of the variant `mesh-lod` are off, 0.01 to 1000.
    pub mesh_error_px: f32,
    /// Device memory for the tiles of all maps in the variant `tiled-compute`, 1 to 65536 MiB.
    pub tile_memory_mib: u32,
    /// Extinction by haze per kilometre, 0 to 1000; by the scene's size without one.
    pub haze_per_km: Option<f32>,
    /// Size of the picture in pixels.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
}

/// Azimuth and elevation, degrees.
const SUN: Field<Parameters, [f32; 2]> = Field {
    get: |p| [p.sun.azimuth_rad.to_degrees(), p.sun.elevation_rad.to_degrees()],
    set: |p, [azimuth, elevation]| {
        p.sun = Sun { azimuth_rad: azimuth.to_radians(), elevation_rad: elevation.to_radians() };
    },
};

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            lod: Lod::Pixel,
            interpolation: Interpolation::Bilinear,
            start: Start::Tiles,
            corners: Corners::Auto,
            normals: Normals::Auto,
            base: Base::Plane,
            base_level_m: None,
            view: View::Side,
            sun: Sun { azimuth_rad: 300.0_f32.to_radians(), elevation_rad: 35.0_f32.to_radians() },
            shadows: false,
            mesh_error_px: 1.0,
            tile_memory_mib: 64,
            haze_per_km: None,
            width: 800,
            height: 600,
        }
    }
}

impl Parameters {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Parameters>> {
        vec![
            Parameter::new("interpolation", field!(Parameters.interpolation))
                .help("The surface between the samples")
                .section("3")
                .cost(Cost::Pipelines),
            Parameter::new("normals", field!(Parameters.normals))
                .help("Normals of the surface that is seen")
                .section("4"),
            Parameter::new("base", field!(Parameters.base))
                .help(
                    "Base surface that heights are added to: plane, earth (WGS84), ellipsoid:EQUATORIAL,POLAR or \
                     cylinder:RADIUS, semi-axes (within a factor of 4 of each other) and radius in metres, 1 to 100000000; \
                     the cylinder's axis runs north and south",
                )
                .section("eq. 5, 6")
                .cost(Cost::Pipelines),
            Parameter::new("base-level", field!(Parameters.base_level_m))
                .range(Range::from(-HeightMap::MOST_HEIGHT_M).to(HeightMap::MOST_HEIGHT_M))
                .unit("metres")
                .help("Height at which the base surface lies")
                .default_text("the maps' minimum")
                .cost(Cost::Buffers),
            Parameter::new("shadows", field!(Parameters.shadows))
                .help("Shadows of the terrain, by rays towards the sun")
                .cost(Cost::Pipelines)
                .everyday(),
            Parameter::new("lod", field!(Parameters.lod))
                .help("End of a ray's subdivision")
                .section("3")
                .cost(Cost::Pipelines)
                .everyday(),
            Parameter::new("start", field!(Parameters.start))
                .help("Beginning of the rays of variants dda-compute and dda-fragment over a plane; hits are the same")
                .section("3")
                .cost(Cost::Pipelines),
            Parameter::new("corners", field!(Parameters.corners))
                .help("Reading of a bilinear cell's corners by rays of variants dda-compute and dda-fragment; hits are the same")
                .section("3")
                .cost(Cost::Pipelines),
            Parameter::new("mesh-error", field!(Parameters.mesh_error_px))
                .range(Range::from(0.01).to(1000.0))
                .unit("pixels")
                .help("Bound of the error on the screen of the triangles of variant mesh-lod")
                .section("4"),
            Parameter::new("tile-memory", field!(Parameters.tile_memory_mib))
                .range(Range::from(1.0).to(65536.0))
                .unit("MiB")
                .help("Device memory for the tiles of all maps in variant tiled-compute, those of the coarsest levels at least")
                .cost(Cost::Buffers),
            Parameter::new("sun", SUN)
                .placeholder("AZIMUTH,ELEVATION")
                .help("Place of the sun: degrees clockwise from north, degrees above the horizon")
                .default_text("300,35"),
            Parameter::new("haze", field!(Parameters.haze_per_km))
                .range(Range::from(0.0).to(1000.0))
                .unit("per kilometre")
                .help("Extinction by haze")
                .default_text("0.24 over the maps' longest side, or half of the eye's distance where that is longer"),
            Parameter::new("camera", field!(Parameters.view))
                .help("Camera: side, top, or eye and target x,y,z,x,y,z in metres: east, up from the base, south")
                .everyday(),
            parameter::size(size_field!(Parameters)),
        ]
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        parameter::check(&Self::declared(), self)?;
        match self.base {
            Base::Plane => {}
            Base::Cylinder { radius_m } => {
                let range = "its radius must be 1 to 100000000 metres";
                ParameterError::check((1.0..=1.0e8).contains(&radius_m), "base", self.base.text(), range)?;
            }
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let is_good = [equatorial_m, polar_m].iter().all(|axis| (1.0..=1.0e8).contains(axis))
                    && (0.25..=4.0).contains(&(polar_m / equatorial_m));
                let range = "its semi-axes must be 1 to 100000000 metres and within a factor of 4 of each other";
                ParameterError::check(is_good, "base", self.base.text(), range)?;
            }
        }
        let [azimuth, elevation] = (SUN.get)(self);
        let sun = format!("{azimuth},{elevation}");
        ParameterError::check(azimuth.abs() <= 360.01, "sun", &sun, "its azimuth must be -360 to 360 degrees")?;
        ParameterError::check(
            (0.0..=90.01).contains(&elevation),
            "sun",
            &sun,
            "its elevation must be 0 to 90 degrees",
        )?;
        let View::Camera(camera) = self.view else { return Ok(()) };
        let place = [camera.eye, camera.target].map(components).join(",");
        let is_near = camera.eye.abs().max_element() <= 1.0e8;
        ParameterError::check(is_near, "camera", place, "must lie within 100000 km")?;
        ParameterError::check_camera(&camera)
    }

    /// Checks a map's place over the base.
    ///
    /// # Errors
    /// A place that is not finite or too far away, and a turn on a base that is not a plane.
    pub fn validate_placement(&self, placement: &Placement) -> Result<(), ParameterError> {
        let Placement { center_m, yaw_rad } = *placement;
        let place = format!("{},{},{}", center_m.x, center_m.y, yaw_rad.to_degrees());
        let is_near = center_m.is_finite() && center_m.abs().max_element() <= 1.0e8 && yaw_rad.is_finite();
        ParameterError::check(is_near, "place", &place, "must lie within 100000 km and be finite")?;
        let is_turnable = self.base == Base::Plane || yaw_rad == 0.0;
        ParameterError::check(is_turnable, "place", &place, "only maps on a plane can be turned; give 0 degrees")
    }

    /// The number of pixels of the picture.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Device memory for tiles, in bytes.
    pub fn tile_bytes(&self) -> u64 {
        u64::from(self.tile_memory_mib) << 20
    }

    /// Width over height of the picture.
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A centimetre before the eye the picture begins, and near a target nearer.
    #[test]
    fn near_things_are_before_a_user_s_camera() {
        for (text, most_m) in
            [("0,50,0,0,50,-9000", 0.01), ("0,1,0,0,1,-1", 1e-3), ("0,0,0,0,0,1e-4", 1e-7), ("0,0,0,0,0,1e-8", 1e-9)]
        {
            let Ok(View::Camera(camera)) = View::parse(&[OsStr::new(text)]) else { panic!("{text}") };
            let parameters = Parameters { view: View::Camera(camera), ..Parameters::default() };
            assert_eq!(parameters.validate(), Ok(()), "{text}");
            assert!(camera.near_m > 0.0 && camera.near_m <= most_m * 1.001, "{text}: {} m", camera.near_m);
        }
    }
}

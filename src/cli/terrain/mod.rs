//! The options of the `terrain` paper, resolved into a setup.

mod experiment;

use std::convert::Infallible;
use std::f32::consts::FRAC_PI_4;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::{DVec2, Vec3};

use self::experiment::Experiments;
use super::failure::Failure;
use super::options::{Size, parse_eye_and_target, parse_finite, parse_numbers, parse_size};
use super::paper::PaperArgs;
use crate::experiment::terrain::{PlacedMap, Setup, figures};
use crate::papers::terrain::{Base, Interpolation, Lod, Parameters, Placement, Sun, View};
use crate::scene::{Camera, HeightMapSource, MeshSource};

/// Where the picture is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CameraWord {
    Side,
    Top,
    At([Vec3; 2]),
}

fn parse_camera(text: &str) -> Result<CameraWord, String> {
    match text {
        "side" => Ok(CameraWord::Side),
        "top" => Ok(CameraWord::Top),
        _ => parse_eye_and_target(text).map(CameraWord::At).map_err(|e| format!("side, top, or eye and target: {e}")),
    }
}

fn parse_map(text: &str) -> Result<HeightMapSource, Infallible> {
    text.parse()
}

/// Figures of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// Figure 1: 200 x 200 samples from above
    #[value(name = "figure-1")]
    Figure1,
    /// Figure 2: 200 x 200 samples from the side
    #[value(name = "figure-2")]
    Figure2,
}

impl Preset {
    fn word(self) -> &'static str {
        match self {
            Preset::Figure1 => "figure-1",
            Preset::Figure2 => "figure-2",
        }
    }

    fn view(self) -> View {
        match self {
            Preset::Figure1 => View::Top,
            Preset::Figure2 => View::Side,
        }
    }
}

/// How far a ray is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LodWord {
    /// To the footprint of a pixel, with heights from the level of that size
    Pixel,
    /// To the interpolated surface of the data
    Exact,
}

/// The surface between the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InterpolationWord {
    /// Eq. 7
    Bilinear,
    /// Catmull-Rom
    Bicubic,
}

fn parse_base(text: &str) -> Result<Base, String> {
    match text.split_once(':') {
        None if text == "plane" => Ok(Base::Plane),
        None if text == "earth" => Ok(Base::EARTH),
        Some(("ellipsoid", axes)) => {
            parse_numbers::<2>(axes).map(|[equatorial_m, polar_m]| Base::Ellipsoid { equatorial_m, polar_m })
        }
        Some(("cylinder", radius)) => parse_finite(radius).map(|radius_m| Base::Cylinder { radius_m }),
        _ => Err("give plane, earth, ellipsoid:EQUATORIAL,POLAR or cylinder:RADIUS".to_owned()),
    }
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct TerrainArgs {
    /// Take the numbers of a figure; options given beside it win
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// Height map: volcano, maunga-whau, jacksboro, or a .hgt, .hdr with .bil or .dem, .tif, .png or .asc file; repeatable, the
    /// terrains are united [default: volcano]
    #[arg(long, value_name = "NAME|FILE", value_parser = parse_map)]
    map: Vec<HeightMapSource>,
    /// Where a map's middle lies: metres east and south of the origin, degrees counterclockwise; once for each map
    /// [default: 0,0,0]
    #[arg(long, value_name = "EAST,SOUTH,DEGREES", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    place: Vec<[f32; 3]>,
    /// Polygon mesh in the maps' frame, metres (x east, y up from the base, z south): teapot, sphere, box, bunny, plane, or an
    /// OBJ, PLY, STL, glTF or GLB file; repeatable
    #[arg(long, value_name = "SHAPE|FILE")]
    object: Vec<MeshSource>,
    /// Picture over the first map in place of the colour ramp, PNG, north up
    #[arg(long, value_name = "FILE.png")]
    drape: Option<PathBuf>,
    /// Shadows of the terrain, by rays towards the sun
    #[arg(long)]
    shadows: bool,
    /// Samples a side of the synthetic volcano, 2 to 16384 [default: 1024]
    #[arg(long, value_name = "N")]
    resolution: Option<u32>,
    /// Metres between samples, above 0 [default: what the map says of itself]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    spacing: Option<f32>,
    /// What heights are multiplied by, above 0 [default: 1]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    exaggeration: Option<f32>,
    /// How far a ray is followed [default: pixel]
    #[arg(long, value_enum)]
    lod: Option<LodWord>,
    /// The surface between the samples [default: bilinear]
    #[arg(long, value_enum)]
    interpolation: Option<InterpolationWord>,
    /// Base surface that heights are added to: plane, earth (WGS84), ellipsoid:EQUATORIAL,POLAR or cylinder:RADIUS, semi-axes
    /// and radius in metres, 1 to 100000000; the cylinder's axis runs north and south [default: plane]
    #[arg(long, value_name = "BASE", value_parser = parse_base)]
    base: Option<Base>,
    /// Height at which the base surface lies, -1000000 to 1000000 metres [default: the maps' minimum]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    base_level: Option<f32>,
    /// Where the sun stands: degrees clockwise from north, degrees above the horizon [default: 300,35]
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    sun: Option<[f32; 2]>,
    /// Extinction by haze per kilometre, 0 to 1000 [default: 0.02]
    #[arg(long, value_name = "K", value_parser = parse_finite, allow_negative_numbers = true)]
    haze: Option<f32>,
    /// Camera: side, top, or eye and target x,y,z,x,y,z in metres: east, up from the base, south [default: side]
    #[arg(long, value_name = "side|top|EYE,TARGET", value_parser = parse_camera, allow_hyphen_values = true)]
    camera: Option<CameraWord>,
    /// Size of the picture in pixels [default: 800x600]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Size>,
    /// Seed of the synthetic volcano [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
}

impl PaperArgs for TerrainArgs {
    type Study = Setup;
    type Experiment = Experiments;

    const ABOUT: &'static str = "The volcano paper's terrain, ray-cast from a shape texture (Vyatkin), pass by pass";
    const BENCHED: &'static str = "cpu,gpu-compute,gpu-fragment,mesh";
    const RENDERED: &'static str = "gpu-compute";

    fn quick() -> Setup {
        Setup::default()
    }

    fn resolve(&self, process: u32) -> Result<Setup, Failure> {
        let mut setup = Setup { process, ..Setup::default() };
        let p: &mut Parameters = &mut setup.parameters;
        if let Some(preset) = self.preset {
            setup.resolution = figures::SIDE;
            p.view = preset.view();
            p.interpolation = Interpolation::Bilinear;
            setup.preset = Some(preset.word().to_owned());
        }
        p.base = self.base.unwrap_or(p.base);
        if let Some(interpolation) = self.interpolation {
            p.interpolation = match interpolation {
                InterpolationWord::Bilinear => Interpolation::Bilinear,
                InterpolationWord::Bicubic => Interpolation::Bicubic,
            };
        }
        if let Some(lod) = self.lod {
            p.lod = match lod {
                LodWord::Pixel => Lod::Pixel,
                LodWord::Exact => Lod::Exact,
            };
        }
        p.base_level_m = self.base_level;
        if let Some([azimuth, elevation]) = self.sun {
            p.sun = Sun { azimuth_rad: azimuth.to_radians(), elevation_rad: elevation.to_radians() };
        }
        p.shadows = self.shadows;
        p.haze_per_km = self.haze.unwrap_or(p.haze_per_km);
        match self.camera {
            None => {}
            Some(CameraWord::Side) => p.view = View::Side,
            Some(CameraWord::Top) => p.view = View::Top,
            Some(CameraWord::At([eye, target])) => {
                p.view = View::Camera(Camera {
                    eye,
                    target,
                    up: Vec3::Y,
                    vertical_fov_rad: FRAC_PI_4,
                    near_m: 1.0,
                    far_m: 1.0e6,
                });
            }
        }
        if let Some(size) = self.size {
            (p.width, p.height) = (size.width, size.height);
        }
        if !self.map.is_empty() {
            let placed =
                |source: &HeightMapSource| PlacedMap { source: source.clone(), placement: Placement::default() };
            setup.maps = self.map.iter().map(placed).collect();
        }
        if self.place.len() > setup.maps.len() {
            let message =
                format!("--place: {} places for {} maps; give one for each", self.place.len(), setup.maps.len());
            return Err(Failure::Input(message));
        }
        for (placed, [east, south, degrees]) in setup.maps.iter_mut().zip(&self.place) {
            placed.placement = Placement {
                center_m: DVec2::new(f64::from(*east), f64::from(*south)),
                turn_rad: f64::from(*degrees).to_radians(),
            };
        }
        setup.objects.clone_from(&self.object);
        setup.drape.clone_from(&self.drape);
        let has_volcano = setup.maps.iter().any(|placed| placed.source == HeightMapSource::Volcano);
        if let (Some(resolution), false) = (self.resolution, has_volcano) {
            let message =
                format!("--resolution {resolution}: only the synthetic volcano has any size; name --map volcano");
            return Err(Failure::Input(message));
        }
        setup.resolution = self.resolution.unwrap_or(setup.resolution);
        setup.spacing_m = self.spacing.map(f64::from);
        setup.exaggeration = self.exaggeration.unwrap_or(1.0);
        setup.seed = self.seed.unwrap_or(setup.seed);
        Ok(setup)
    }
}

impl TerrainArgs {
    /// Whether a map was named.
    fn names_maps(&self) -> bool {
        !self.map.is_empty()
    }

    /// Whether a number of samples a side was named.
    fn names_resolution(&self) -> bool {
        self.resolution.is_some()
    }

    /// Whether a camera was named.
    fn names_camera(&self) -> bool {
        self.camera.is_some()
    }

    /// Whether a size of the picture was named.
    fn names_size(&self) -> bool {
        self.size.is_some()
    }
}

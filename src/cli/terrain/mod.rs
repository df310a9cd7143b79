//! The options of the `terrain` paper, resolved into a setup.

mod collide;
mod experiment;
mod land;

use std::f32::consts::FRAC_PI_4;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::collide::TerrainVerbs;
use self::experiment::Experiments;
use self::land::LandArgs;
use super::failure::Failure;
use super::options::{Size, parse_eye_and_target, parse_finite, parse_numbers, parse_size};
use super::paper::PaperArgs;
use crate::papers::terrain::{Interpolation, Lod, Parameters, Sun, View};
use crate::papers::terrain::{experiments::figures, setup::Setup};
use crate::scene::{Camera, MeshSource};

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
    fn as_str(self) -> &'static str {
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

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct TerrainArgs {
    /// Take the numbers of a figure; options given beside it win
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    #[command(flatten)]
    land: LandArgs,
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
    /// How far a ray is followed [default: pixel]
    #[arg(long, value_enum)]
    lod: Option<LodWord>,
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
}

impl PaperArgs for TerrainArgs {
    type Study = Setup;
    type Experiment = Experiments;
    type Own = TerrainVerbs;

    const ABOUT: &'static str = "The volcano paper's terrain, ray-cast from a shape texture (Vyatkin), pass by pass";
    const BENCHED: &'static str = "cpu,gpu-compute,gpu-fragment,mesh";
    const RENDERED: &'static str = "gpu-compute";

    fn quick() -> Setup {
        Setup::default()
    }

    fn resolve(&self) -> Result<Setup, Failure> {
        let mut setup = Setup::default();
        let p: &mut Parameters = &mut setup.parameters;
        if let Some(preset) = self.preset {
            setup.resolution = figures::SIDE;
            p.view = preset.view();
            p.interpolation = Interpolation::Bilinear;
            setup.preset = Some(preset.as_str().to_owned());
        }
        if let Some(lod) = self.lod {
            p.lod = match lod {
                LodWord::Pixel => Lod::Pixel,
                LodWord::Exact => Lod::Exact,
            };
        }
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
        setup.objects.clone_from(&self.object);
        setup.drape.clone_from(&self.drape);
        self.land.write(&mut setup)?;
        Ok(setup)
    }
}

impl TerrainArgs {
    /// Whether a map was named.
    fn names_maps(&self) -> bool {
        self.land.names_maps()
    }

    /// Whether a number of samples a side was named.
    fn names_resolution(&self) -> bool {
        self.land.names_resolution()
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

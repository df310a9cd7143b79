//! The options of the `caustics` paper under the thesis's own words, resolved into a setup.

mod experiment;

use std::convert::Infallible;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::experiment::Experiments;
use super::failure::Failure;
use super::options::{Size, parse_eye_and_target, parse_finite, parse_numbers, parse_size, set};
use super::paper::PaperArgs;
use crate::measure::Error;
use crate::measure::ParameterError;
use crate::papers::caustics::setup::{Setup, water_map};
use crate::papers::caustics::{Parameters, SmartPlacement};
use crate::scene::{Camera, HeightMapSource, Light, MeshSource};

/// How smart slicing places its planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PlacementWord {
    Fitted,
    Kept,
}

/// Where the camera stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CameraWord {
    Above,
    Below,
    At([Vec3; 2]),
}

fn parse_camera(text: &str) -> Result<CameraWord, String> {
    match text {
        "above" => Ok(CameraWord::Above),
        "below" => Ok(CameraWord::Below),
        _ => {
            parse_eye_and_target(text).map(CameraWord::At).map_err(|e| format!("above, below, or eye and target: {e}"))
        }
    }
}

/// Figures and tables of the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// Table 5-1 and figure 5-10 at their last row: teapot, 101 planes, 512 x 512 maps
    #[value(name = "5-1")]
    Table51,
}

impl Preset {
    fn as_str(self) -> &'static str {
        match self {
            Preset::Table51 => "5-1",
        }
    }
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct CausticsArgs {
    /// Take the numbers of a table or figure; options given beside it win
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// Receiver: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file; repeatable
    #[arg(long, value_name = "SHAPE|FILE")]
    mesh: Vec<MeshSource>,
    /// The pool's floor receives caustics as well
    #[arg(long)]
    floor: bool,
    /// Reference (sample) planes of each receiver, 1 to 4096 [default: 31]
    #[arg(long, value_name = "N")]
    planes: Option<u32>,
    /// Texels a side of the position, caustics and slice maps [default: 512]
    #[arg(long, value_name = "N")]
    map_size: Option<u32>,
    /// Triangles of the water's mesh, 2 to 20000000; rounded to whole cells [default: 10000]
    #[arg(long, value_name = "N")]
    water_triangles: Option<u32>,
    /// Position map and diffuse map in two passes (figure 5-5) instead of one with two targets (figure 5-6)
    #[arg(long)]
    no_mrt: bool,
    /// Depth levels of smart slicing's profile, 1 to 65536 [default: 100]
    #[arg(long, value_name = "N")]
    levels: Option<u32>,
    /// Acceptance threshold of smart slicing in metres, above 0 [default: h / (2 (planes - 1)), as in table 5-4]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    epsilon: Option<f32>,
    /// Smart slicing: planes fitted into sub-boxes, or the uniform planes whose cell holds a texel
    #[arg(long, value_enum, default_value = "fitted")]
    smart_placement: PlacementWord,
    /// Refraction index of water against air, above 1 and at most 4 [default: 1.3333]
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_negative_numbers = true)]
    refraction_index: Option<f32>,
    /// Absorption K of eq. 4-17 per metre, 0 to 1000000 [default: 0.1]
    #[arg(long, value_name = "K", value_parser = parse_finite, allow_negative_numbers = true)]
    absorption: Option<f32>,
    /// Depth of the pool in metres, above 0 and at most 1000 [default: 3]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    water_depth: Option<f32>,
    /// Number of sine waves on the water, 0 (flat) to 64 [default: 12]
    #[arg(long, value_name = "N")]
    waves: Option<u32>,
    /// Sum of the waves' amplitudes in metres, 0 to 10 [default: 0.05]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    amplitude: Option<f32>,
    /// Longest wavelength in metres, above 0 [default: 1.2]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    wavelength: Option<f32>,
    /// Water by a height map instead of waves: volcano, maunga-whau, jacksboro, or a file; heights are metres about the
    /// water's level, within 10 m of it
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["waves", "amplitude", "wavelength"])]
    water_map: Option<HeightMapSource>,
    /// Metres between the samples of --water-map, above 0 [default: what the map says of itself]
    #[arg(long, value_name = "M", requires = "water_map", value_parser = parse_finite, allow_negative_numbers = true)]
    water_map_spacing: Option<f32>,
    /// Scale --water-map so that its heights span this many metres about the water's level, above 0
    #[arg(long, value_name = "M", requires = "water_map", value_parser = parse_finite, allow_negative_numbers = true)]
    water_map_range: Option<f32>,
    /// Direction of parallel light, x,y,z, downwards; repeatable [default: 0,-1,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    light: Vec<[f32; 3]>,
    /// Position of a point light above the water, x,y,z in metres; repeatable
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    point_light: Vec<[f32; 3]>,
    /// Camera: above (through the water's surface), below (plainly underwater), or eye and target x,y,z,x,y,z in metres,
    /// the water's level being y = 0 [default: above]
    #[arg(long, value_name = "above|below|EYE,TARGET", value_parser = parse_camera, allow_hyphen_values = true)]
    camera: Option<CameraWord>,
    /// Size of the picture in pixels [default: 800x600]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Size>,
    /// Seed of the waves' directions and phases [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Simulated time between two frames in seconds, at least 0 [default: 0.0333]
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_negative_numbers = true)]
    time_step: Option<f32>,
}

impl PaperArgs for CausticsArgs {
    type Study = Setup;
    type Experiment = Experiments;
    type Own = Infallible;

    const ABOUT: &'static str = "Refractive water caustics with level maps (Tipprasert), pass by pass";
    // The stencil method takes seconds a frame without a GPU.
    const BENCHED: &'static str = "level-map,level-map-smart,volumetric";
    const RENDERED: &'static str = "level-map";

    fn quick() -> Setup {
        Setup {
            parameters: Parameters::default(),
            meshes: vec![MeshSource::Bunny],
            floor: true,
            preset: None,
            process: 0,
        }
    }

    fn resolve(&self, process: u32) -> Result<Setup, Failure> {
        let mut p = Parameters::default();
        match self.preset {
            None => {}
            Some(Preset::Table51) => {
                p.planes = 101;
                p.map_size = 512;
                p.water_triangles = 10_000;
            }
        }
        set(&mut p.planes, self.planes);
        set(&mut p.map_size, self.map_size);
        set(&mut p.water_triangles, self.water_triangles);
        p.mrt &= !self.no_mrt;
        set(&mut p.smart.levels, self.levels);
        p.smart.placement = match self.smart_placement {
            PlacementWord::Fitted => SmartPlacement::Fitted { epsilon_m: self.epsilon },
            PlacementWord::Kept if self.epsilon.is_some() => {
                let message = "--epsilon: --smart-placement kept keeps the uniform planes; leave one of them out";
                return Err(Failure::Input(message.to_owned()));
            }
            PlacementWord::Kept => SmartPlacement::Kept,
        };
        set(&mut p.refraction_index, self.refraction_index);
        set(&mut p.absorption_per_m, self.absorption);
        set(&mut p.water_depth_m, self.water_depth);
        set(&mut p.waves.count, self.waves);
        set(&mut p.waves.amplitude_m, self.amplitude);
        set(&mut p.waves.wavelength_m, self.wavelength);
        if let Some(source) = &self.water_map {
            let positive = "must be above 0 metres";
            for (name, value) in
                [("--water-map-spacing", self.water_map_spacing), ("--water-map-range", self.water_map_range)]
            {
                let value = value.unwrap_or(1.0);
                ParameterError::check(value > 0.0, name, value, positive).map_err(Error::from)?;
            }
            p.water_map = Some(water_map(source, self.water_map_spacing, self.water_map_range)?);
        }
        p.camera = match self.camera.unwrap_or(CameraWord::Above) {
            CameraWord::Above => Parameters::camera_above(p.water_depth_m),
            CameraWord::Below => Parameters::camera_below(p.water_depth_m),
            CameraWord::At([eye, target]) => Camera { eye, target, ..Parameters::camera_above(p.water_depth_m) },
        };
        if let Some(size) = self.size {
            (p.width, p.height) = (size.width, size.height);
        }
        set(&mut p.seed, self.seed);
        set(&mut p.time_step_s, self.time_step);
        let intensity = Vec3::ONE;
        let parallel = self.light.iter().map(|&d| Light::Parallel { direction: d.into(), intensity });
        let points = self.point_light.iter().map(|&p| Light::Point { position: p.into(), intensity });
        let lights: Vec<Light> = parallel.chain(points).collect();
        if !lights.is_empty() {
            p.lights = lights;
        }
        let meshes = if self.mesh.is_empty() { vec![MeshSource::Teapot] } else { self.mesh.clone() };
        Ok(Setup {
            parameters: p,
            meshes,
            floor: self.floor,
            preset: self.preset.map(|p| p.as_str().to_owned()),
            process,
        })
    }
}

impl CausticsArgs {
    /// Whether a number of planes was named.
    pub fn names_planes(&self) -> bool {
        self.planes.is_some()
    }

    /// Whether a camera was named.
    pub fn names_camera(&self) -> bool {
        self.camera.is_some()
    }

    /// Whether a mesh was named.
    pub fn names_meshes(&self) -> bool {
        !self.mesh.is_empty()
    }
}

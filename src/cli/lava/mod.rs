//! The options of the `lava` paper under the thesis's own words, resolved into a setup.

mod experiment;

use std::convert::Infallible;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::experiment::Experiments;
use super::failure::Failure;
use super::options::{Size, parse_extents, parse_eye_and_target, parse_finite, parse_numbers, parse_size, set};
use super::paper::PaperArgs;
use crate::papers::lava::setup::Setup;
use crate::papers::lava::{CAMERAS, Parameters, Preset, Shading};
use crate::scene::{Camera, MeshSource};

/// Where the camera stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CameraWord {
    /// Index of a figure's camera.
    Figure(usize),
    At([Vec3; 2]),
}

fn parse_camera(text: &str) -> Result<CameraWord, String> {
    if let Some(figure) = CAMERAS.iter().position(|(name, _)| *name == text) {
        return Ok(CameraWord::Figure(figure));
    }
    let figures = CAMERAS.map(|(name, _)| name).join(", ");
    parse_eye_and_target(text).map(CameraWord::At).map_err(|e| format!("{figures}, or eye and target: {e}"))
}

/// Figures and tables of the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PresetWord {
    /// Chapter 8: the pictures and the 20 frames a second
    Results,
    /// Figures 5.1, 5.2 and 6.2: 65,536 particles, a finer grid
    #[value(name = "fig-6.2")]
    Fig62,
    /// Figure 8.5 at its smallest splats, which leave holes; --splat-radius names its others
    #[value(name = "fig-8.5")]
    Fig85,
}

impl PresetWord {
    fn preset(self) -> Preset {
        match self {
            PresetWord::Results => Preset::Results,
            PresetWord::Fig62 => Preset::Fig62,
            PresetWord::Fig85 => Preset::Fig85,
        }
    }
}

/// What colours the splats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ShadingWord {
    /// Colour times rock: the finished picture
    Lava,
    /// The calculated colour alone
    Color,
    /// The rock texture alone
    Rock,
    /// The normals of the surface as colours
    Normals,
    /// The heights of the surface as grey
    Heights,
    /// No surface: every particle as a point
    Particles,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct LavaArgs {
    /// Take the numbers of a table or figure; options given beside it win
    #[arg(long, value_enum)]
    preset: Option<PresetWord>,
    /// Simulation space along x, y and z in metres, each side above 0 and at most 1000 [default: 4x1x1]
    #[arg(long, value_name = "XxYxZ", value_parser = parse_extents::<f32, 3>)]
    space: Option<[f32; 3]>,
    /// Particles, 1 to 16777216 [default: 40000]
    #[arg(long, value_name = "N")]
    particles: Option<u32>,
    /// Effective radius of a particle in metres, above 0, at most the shortest side of the space [default: 0.08]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    radius: Option<f32>,
    /// Grid points along x, grid planes along y, grid points along z, each at least 1 [default: 100x24x24]
    #[arg(long, value_name = "XxYxZ", value_parser = parse_extents::<u32, 3>)]
    density: Option<[u32; 3]>,
    /// Density that the isosurface takes in, above 0 [default: the particles' mean density]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    rho: Option<f32>,
    /// Splats along x and z, each at least 1 [default: 600x150]
    #[arg(long, value_name = "XxZ", value_parser = parse_extents::<u32, 2>)]
    splats: Option<[u32; 2]>,
    /// Radius of a splat in metres, above 0, at most the shortest side of the space [default: 0.020625]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    splat_radius: Option<f32>,
    /// How far behind the nearest splat another one is blended in metres (eq. 7.1), above 0 and at most 1000 [default: 0.05]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    epsilon: Option<f32>,
    /// Distance from the borders over which the surface falls off in metres, 0 to 1000 [default: 0.2]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    border: Option<f32>,
    /// Mean speed of the flow in metres a second, 0 to 1000 [default: 0.2]
    #[arg(long, value_name = "M/S", value_parser = parse_finite, allow_negative_numbers = true)]
    speed: Option<f32>,
    /// The constant orange of section 7.2 as the display takes it: red,green,blue, each 0 to 1000 [default: 2.5,1.2,0.28]
    #[arg(long, value_name = "R,G,B", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    color: Option<[f32; 3]>,
    /// Picture of the rock that is laid over the lava, PNG, at least 2 x 2 texels [default: the shipped one]
    #[arg(long, value_name = "FILE")]
    rock: Option<PathBuf>,
    /// Side of the square that the rock covers once in metres, above 0 and at most 1000 [default: 2]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    rock_tile: Option<f32>,
    /// Polygon mesh in the simulation space, metres: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file;
    /// repeatable
    #[arg(long, value_name = "SHAPE|FILE")]
    object: Vec<MeshSource>,
    /// What colours the splats [default: lava]
    #[arg(long, value_enum)]
    shading: Option<ShadingWord>,
    /// Draw the splats as instanced quads instead of by a geometry stage
    #[arg(long)]
    no_geometry_stage: bool,
    /// Camera: fig-8.1, fig-8.2, fig-8.3, fig-8.4, or eye and target x,y,z,x,y,z in metres [default: fig-8.1]
    #[arg(long, value_name = "FIGURE|EYE,TARGET", value_parser = parse_camera, allow_hyphen_values = true)]
    camera: Option<CameraWord>,
    /// Size of the picture in pixels [default: 800x600]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Size>,
    /// Seed of the particles [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Simulated time between two frames in seconds, 0 to 1000 [default: 0.0333]
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_negative_numbers = true)]
    time_step: Option<f32>,
}

impl PaperArgs for LavaArgs {
    type Study = Setup;
    type Experiment = Experiments;
    type Own = Infallible;

    const ABOUT: &'static str = "Lava: particles to density to isosurface to splats (Unnthorsson), pass by pass";
    const BENCHED: &'static str = "paper";
    const RENDERED: &'static str = "paper";

    fn quick() -> Setup {
        Setup { parameters: Parameters::default(), rock: None, objects: Vec::new(), preset: None }
    }

    fn resolve(&self) -> Result<Setup, Failure> {
        Ok(self.over(self.preset_parameters(), self.preset.map(|word| word.preset().as_str())))
    }
}

impl LavaArgs {
    /// The preset's numbers, or the defaults.
    fn preset_parameters(&self) -> Parameters {
        self.preset.map_or_else(Parameters::default, |word| word.preset().configurations().swap_remove(0))
    }

    /// What was typed over the numbers of a preset.
    fn over(&self, mut p: Parameters, preset: Option<&str>) -> Setup {
        set(&mut p.space_m, self.space.map(Vec3::from));
        set(&mut p.particles, self.particles);
        set(&mut p.radius_m, self.radius);
        set(&mut p.density, self.density);
        p.rho = self.rho.or(p.rho);
        set(&mut p.splats, self.splats);
        set(&mut p.splat_radius_m, self.splat_radius);
        set(&mut p.epsilon_m, self.epsilon);
        set(&mut p.border_m, self.border);
        set(&mut p.speed_m_s, self.speed);
        set(&mut p.color, self.color.map(Vec3::from));
        set(&mut p.rock_tile_m, self.rock_tile);
        let shading = |word| match word {
            ShadingWord::Lava => Shading::Lava,
            ShadingWord::Color => Shading::Color,
            ShadingWord::Rock => Shading::Rock,
            ShadingWord::Normals => Shading::Normals,
            ShadingWord::Heights => Shading::Heights,
            ShadingWord::Particles => Shading::Particles,
        };
        set(&mut p.shading, self.shading.map(shading));
        p.geometry_stage &= !self.no_geometry_stage;
        match self.camera {
            None => {}
            Some(CameraWord::Figure(figure)) => p.camera = CAMERAS[figure].1,
            Some(CameraWord::At([eye, target])) => p.camera = Camera { eye, target, ..CAMERAS[0].1 },
        }
        if let Some(size) = self.size {
            (p.width, p.height) = (size.width, size.height);
        }
        set(&mut p.seed, self.seed);
        set(&mut p.time_step_s, self.time_step);
        Setup {
            parameters: p,
            rock: self.rock.clone(),
            objects: self.object.clone(),
            preset: preset.map(str::to_owned),
        }
    }
}

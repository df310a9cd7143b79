//! The options of the `gas` paper under the paper's own words, resolved into a setup.

mod experiment;

use std::convert::Infallible;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::experiment::Experiments;
use super::failure::Failure;
use super::options::{Size, parse_eye_and_target, parse_finite, parse_numbers, parse_size, set};
use super::paper::PaperArgs;
use crate::experiment::gas::Setup;
use crate::papers::gas::model::{DensityFunction, HenyeyGreenstein};
use crate::papers::gas::scenes::{self, Preset};
use crate::scene::{Light, MeshSource};

/// The figures' scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SceneWord {
    /// Figure 3: a gallery with a gaseous sculpture
    #[value(name = "fig-3")]
    Fig3,
    /// Figure 4: surface-defined fog over a chess board
    #[value(name = "fig-4")]
    Fig4,
    /// Figure 5: the gallery, for the shadow table
    #[value(name = "fig-5")]
    Fig5,
    /// Figure 6: steam from a glass, glasses in front of, around and behind it
    #[value(name = "fig-6")]
    Fig6,
    /// Figure 7: volume fog that rolls over a chess board
    #[value(name = "fig-7")]
    Fig7,
    /// Figure 8: steam and one glass
    #[value(name = "fig-8")]
    Fig8,
    /// A solid (hypertexture) volume
    Solid,
}

impl SceneWord {
    fn preset(self) -> Preset {
        match self {
            SceneWord::Fig3 => Preset::Fig3,
            SceneWord::Fig4 => Preset::Fig4,
            SceneWord::Fig5 => Preset::Fig5,
            SceneWord::Fig6 => Preset::Fig6,
            SceneWord::Fig7 => Preset::Fig7,
            SceneWord::Fig8 => Preset::Fig8,
            SceneWord::Solid => Preset::Solid,
        }
    }
}

/// Density functions whose numbers the scene's volumes keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DensityWord {
    /// The same everywhere
    Constant,
    /// Turbulence (1985)
    Turbulence,
    /// A sine wave through the turbulent space
    Clouds,
    /// Figure 7's fog behind its front, moved along a helix as the frames go on
    Fog,
    /// Figures 6 and 8's steam, which rises and thins with its height
    Steam,
    /// A soft ball whose surface the turbulence moves
    Hypertexture,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct GasArgs {
    /// Scene of a figure with its numbers; options given beside it win [default: fig-8]
    #[arg(long, value_enum)]
    preset: Option<SceneWord>,
    /// Polygon mesh in the scene: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file; repeatable
    #[arg(long, value_name = "SHAPE|FILE")]
    object: Vec<MeshSource>,
    /// Steps along a volume's longest side, 1 to 100000 [default: the scene's, 40]
    #[arg(long, value_name = "N")]
    steps: Option<u32>,
    /// Entries of the density and shadow tables along each axis, 2 to 512 [default: the scene's, 64]
    #[arg(long, value_name = "N")]
    table: Option<u32>,
    /// Octaves of turbulence go on while their scale exceeds it, 0.0001 to 1 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    pixel_size: Option<f32>,
    /// Density below which no shadow of the gas on itself is computed, at least 0 [default: the scene's]
    #[arg(long, value_name = "D", value_parser = parse_finite, allow_negative_numbers = true)]
    shadow_threshold: Option<f32>,
    /// Transparency below which a pixel's tracing ends, 0 (never) to 1 [default: 0.01]
    #[arg(long, value_name = "T", value_parser = parse_finite, allow_negative_numbers = true)]
    early_end: Option<f32>,
    /// Density function of all volumes [default: the scene's]
    #[arg(long, value_enum)]
    density: Option<DensityWord>,
    /// Factor of all volumes' density (the paper's opaque), 0 to 1000000 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    opaque: Option<f32>,
    /// Exponent of all volumes' density, above 0 and at most 100 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    power: Option<f32>,
    /// Texture units a metre of all volumes, 0.0001 to 10000 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    texture_scale: Option<f32>,
    /// Optical depth of density 1, per metre, of all volumes, 0 to 1000000 [default: the scene's]
    #[arg(long, value_name = "TAU", value_parser = parse_finite, allow_negative_numbers = true)]
    tau: Option<f32>,
    /// Albedo of all gases, 0 to 1 [default: the scene's]
    #[arg(long, value_name = "A", value_parser = parse_finite, allow_negative_numbers = true)]
    albedo: Option<f32>,
    /// Two Henyey-Greenstein functions of all gases: weight,g,weight,g; weights add up to 1, g between -1 and 1
    /// [default: 0.8,0.5,0.2,-0.3]
    #[arg(long, value_name = "W,G,W,G", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    phase: Option<[f32; 4]>,
    /// Share of the way from the boundary to the middle over which all gases fade, 0 to 1 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    falloff: Option<f32>,
    /// Direction of light from infinity, x,y,z; repeatable; takes the place of the scene's lights
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    light: Vec<[f32; 3]>,
    /// Position of a point light, x,y,z in metres; repeatable; takes the place of the scene's lights
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    point_light: Vec<[f32; 3]>,
    /// Ambient light, linear red,green,blue, 0 to 64 [default: the scene's]
    #[arg(long, value_name = "R,G,B", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    ambient: Option<[f32; 3]>,
    /// The scene's frame that frame 0 shows [default: one in which there is gas]
    #[arg(long, value_name = "N")]
    first_frame: Option<u32>,
    /// Frames of the scene from one frame to the next; 0 holds the first [default: 0]
    #[arg(long, value_name = "N")]
    frame_step: Option<u32>,
    /// Make the triangles' footprints in the vertex stage instead of by a geometry stage
    #[arg(long)]
    no_geometry_stage: bool,
    /// Most bytes of a buffer of the A-buffer's lists, at least 4096: the picture is done in bands of rows whose lists fit
    /// [default: what the device binds]
    #[arg(long, value_name = "N")]
    list_bytes: Option<u64>,
    /// Camera: eye and target, x,y,z,x,y,z in metres [default: the scene's]
    #[arg(long, value_name = "EYE,TARGET", value_parser = parse_eye_and_target, allow_hyphen_values = true)]
    camera: Option<[Vec3; 2]>,
    /// Size of the picture in pixels [default: the figure's]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Size>,
    /// Seed of noise and jitter [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
}

impl PaperArgs for GasArgs {
    type Study = Setup;
    type Experiment = Experiments;
    type Own = Infallible;

    const ABOUT: &'static str =
        "Gas: A-buffer surfaces and volume-traced gases in one picture (Ebert, Parent), pass by pass";
    // Tracing shadows from every sample takes many times as long.
    const BENCHED: &'static str = "no-volume,none,surfaces,table";
    const RENDERED: &'static str = "table";

    /// Figure 8 at half its size.
    fn quick() -> Setup {
        let mut setup = Setup { preset: None, ..Setup::of(Preset::Fig8) };
        (setup.parameters.width, setup.parameters.height) = (180, 125);
        setup
    }

    fn resolve(&self, process: u32) -> Result<Setup, Failure> {
        let setup = Setup::of(self.scene());
        Ok(Setup { process, preset: self.preset.and(setup.preset.clone()), ..self.over(setup) })
    }
}

impl GasArgs {
    /// The scene that was named, or figure 8's.
    fn scene(&self) -> Preset {
        self.preset.map_or(Preset::Fig8, SceneWord::preset)
    }

    /// Whether a scene was named.
    fn names_scene(&self) -> bool {
        self.preset.is_some()
    }

    /// What was typed over a scene's numbers.
    fn over(&self, mut setup: Setup) -> Setup {
        let p = &mut setup.parameters;
        set(&mut p.steps, self.steps);
        set(&mut p.table_size, self.table);
        set(&mut p.pixel_size, self.pixel_size);
        set(&mut p.shadow_threshold, self.shadow_threshold);
        set(&mut p.early_end, self.early_end);
        for volume in &mut p.volumes {
            set(&mut volume.texture.function, self.density.map(function));
            set(&mut volume.texture.opaque, self.opaque);
            set(&mut volume.texture.power, self.power);
            set(&mut volume.texture.scale_per_m, self.texture_scale);
            set(&mut volume.tau_per_m, self.tau);
            set(&mut volume.albedo, self.albedo.map(Vec3::splat));
            set(&mut volume.falloff, self.falloff);
            if let Some([w0, g0, w1, g1]) = self.phase {
                volume.phase = [HenyeyGreenstein { weight: w0, g: g0 }, HenyeyGreenstein { weight: w1, g: g1 }];
            }
        }
        // As bright at the origin as the scenes' own light, wherever it stands.
        let parallel = self.light.iter().map(|&d| Light::Parallel { direction: d.into(), intensity: Vec3::ONE });
        let points = self.point_light.iter().map(|&p| {
            let position = Vec3::from(p);
            Light::Point { position, intensity: Vec3::splat(position.length_squared().max(1e-3)) }
        });
        let lights: Vec<Light> = parallel.chain(points).collect();
        if !lights.is_empty() {
            p.lights = lights;
        }
        set(&mut p.ambient, self.ambient.map(Vec3::from));
        set(&mut p.first_frame, self.first_frame);
        set(&mut p.frame_step, self.frame_step);
        if let Some([eye, target]) = self.camera {
            (p.camera.eye, p.camera.target) = (eye, target);
        }
        if let Some(size) = self.size {
            (p.width, p.height) = (size.width, size.height);
        }
        set(&mut p.seed, self.seed);
        p.geometry_stage &= !self.no_geometry_stage;
        p.list_bytes = self.list_bytes.or(p.list_bytes);
        setup.objects.clone_from(&self.object);
        setup
    }
}

fn function(word: DensityWord) -> DensityFunction {
    match word {
        DensityWord::Constant => DensityFunction::Constant,
        DensityWord::Turbulence => DensityFunction::Turbulence,
        DensityWord::Clouds => DensityFunction::Clouds { frequency: 4.0 },
        DensityWord::Fog => scenes::FOG,
        DensityWord::Steam => scenes::STEAM,
        DensityWord::Hypertexture => scenes::HYPERTEXTURE,
    }
}

//! The options of the `gas` paper under the paper's own words, resolved into a setup.

mod experiment;
mod volumes;

use std::convert::Infallible;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::experiment::Experiments;
use self::volumes::VolumeArgs;
use super::failure::Failure;
use super::options::{Size, parse_eye_and_target, parse_finite, parse_numbers, parse_size, set};
use super::paper::PaperArgs;
use crate::papers::gas::Variant;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::setup::Setup;
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

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct GasArgs {
    /// Scene of a figure with its numbers; options given beside it win [default: fig-8]
    #[arg(long, value_enum)]
    preset: Option<SceneWord>,
    #[command(flatten)]
    volumes: VolumeArgs,
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

    fn resolve(&self) -> Result<Setup, Failure> {
        let setup = Setup::of(self.scene());
        let preset = self.preset.and(setup.preset.clone());
        let setup = self.over(setup);
        self.check([&setup])?;
        Ok(Setup { preset, ..setup })
    }

    /// The figure's; of figure 4, which has no volumes, `table` where the user adds some.
    fn rendered(&self) -> Variant {
        match self.scene().variant() {
            Variant::NoVolume if self.volumes.adds_volumes() => Variant::Table,
            variant => variant,
        }
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

    /// Checks that one of the scenes heeds each option of the gases.
    ///
    /// # Errors
    /// [`Failure::Input`], naming the first option that none heeds.
    fn check<'a>(&self, setups: impl IntoIterator<Item = &'a Setup>) -> Result<(), Failure> {
        self.volumes.check(setups.into_iter().flat_map(|setup| &setup.parameters.volumes))
    }

    /// What was typed over a scene's numbers.
    fn over(&self, mut setup: Setup) -> Setup {
        let p = &mut setup.parameters;
        set(&mut p.steps, self.steps);
        set(&mut p.table_size, self.table);
        set(&mut p.pixel_size, self.pixel_size);
        set(&mut p.shadow_threshold, self.shadow_threshold);
        set(&mut p.early_end, self.early_end);
        self.volumes.over(&mut p.volumes);
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

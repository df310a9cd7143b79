//! The options of the `burning` paper under the dissertation's own words, resolved into a setup.

mod experiment;

use std::convert::Infallible;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::Vec3;

use self::experiment::Experiments;
use super::failure::Failure;
use super::options::{Size, parse_extents, parse_eye_and_target, parse_finite, parse_numbers, parse_size, set};
use super::paper::PaperArgs;
use crate::papers::burning::experiments::presets::Preset;
use crate::papers::burning::setup::Setup;
use crate::papers::burning::{Material, Shading, Variant, seen_from};
use crate::scene::MeshSource;

/// What the surface is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MaterialWord {
    /// The albedo alone
    Plain,
    /// The albedo with the rings of a tree
    Wood,
}

/// What colours the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ShadingWord {
    /// Lit, charred and glowing: the finished picture
    Lit,
    /// The areas of the heat boundary
    Areas,
    /// The blocks
    Blocks,
    /// Normals as colours
    Normals,
    /// Lit, with the edges of the drawn triangles
    Wire,
}

/// Objects and numbers of the dissertation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PresetWord {
    /// Section 3.8: a shell of 15,949 triangles, 3,000 fire and 1,800 smoke particles
    #[value(name = "3.8")]
    Results38,
    /// Section 4.6: a box of 12 triangles, for low-poly
    Box,
    /// A door of 12 triangles, for low-poly
    Door,
    /// Section 5.5: a block of 45,000 triangles, for solid
    #[value(name = "solid-45k")]
    Solid45k,
    /// Section 6.5: wax of 40,000 triangles, for melting
    #[value(name = "melt-40k")]
    Melt40k,
}

impl PresetWord {
    fn preset(self) -> Preset {
        match self {
            PresetWord::Results38 => Preset::Results38,
            PresetWord::Box => Preset::Box,
            PresetWord::Door => Preset::Door,
            PresetWord::Solid45k => Preset::Solid45k,
            PresetWord::Melt40k => Preset::Melt40k,
        }
    }
}

/// The finest level that is drawn; without a number, by distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct LevelWord(Option<u32>);

fn parse_level(text: &str) -> Result<LevelWord, String> {
    match text {
        "auto" => Ok(LevelWord(None)),
        _ => text
            .parse()
            .map(|level| LevelWord(Some(level)))
            .map_err(|_| format!("{text:?} is neither auto nor a level")),
    }
}

fn parse_time_step(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{text:?} is not a finite number")),
    }
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub struct BurningArgs {
    /// Take object, numbers and method of a section; options given beside it win
    #[arg(long, value_enum)]
    preset: Option<PresetWord>,
    /// What burns: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file; scaled to a diagonal of 1,
    /// its base centred at the origin [default: bunny]
    #[arg(long, value_name = "SHAPE|FILE")]
    mesh: Option<MeshSource>,
    /// Stretch the mesh along x, y and z, each factor above 0 and at most 1000 [default: 1,1,1]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    stretch: Option<[f32; 3]>,
    /// Simplify or subdivide the mesh to about so many triangles, 4 to 4000000 [default: as it is]
    #[arg(long, value_name = "N")]
    triangles: Option<u32>,
    /// Divide each triangle into 4^N, 0 to 5 [default: low-poly and fully-subdivided 5, shell 0, solid and melting by --edge]
    #[arg(long, value_name = "N")]
    levels: Option<u32>,
    /// solid and melting are divided until no edge is longer, above 0 and at most 1 [default: 0.1]
    #[arg(long, value_name = "D", value_parser = parse_finite, allow_negative_numbers = true)]
    edge: Option<f32>,
    /// Heat source: x,y,z in the scaled object's space; repeatable [default: the lowest vertex, melting the highest]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    source: Vec<[f32; 3]>,
    /// Heat index of the boundary's squared distance, above 0 and at most 100 [default: 1]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    psi: Option<f32>,
    /// Growth of the boundary's radius in diagonals a second, above 0 and at most 10 [default: 0.05]
    #[arg(long, value_name = "V", value_parser = parse_finite, allow_negative_numbers = true)]
    speed: Option<f32>,
    /// Width of an area of the boundary in diagonals, above 0 and at most 1 [default: 0.04]
    #[arg(long, value_name = "W", value_parser = parse_finite, allow_negative_numbers = true)]
    area_width: Option<f32>,
    /// L, ticks of combustion of a vertex, 1 to 1000000 [default: 60]
    #[arg(long, value_name = "L")]
    flammability: Option<u32>,
    /// Meltability, above 0 and below 1 [default: 0.1]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    epsilon: Option<f32>,
    /// Displacement scale, above 0 and below 1 [default: 0.05]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    beta: Option<f32>,
    /// Material density, above 0 and below 1 [default: 0.5]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    rho: Option<f32>,
    /// Bond strength, above 0 and below 1 [default: 0.5]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    phi: Option<f32>,
    /// Rotation of blocks (eq. 4), above 0 and below 1 [default: 0.1]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    gamma: Option<f32>,
    /// x of 3.5.2, a block's share of its neighbours' rotation, above 0 and below 1 [default: 0.5]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    spread: Option<f32>,
    /// melting: longest edge in mean edges, above 0 and below 1 [default: 0.8]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    omega: Option<f32>,
    /// melting: longest over shortest edge, 2 to 1000 [default: 4]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    chi: Option<f32>,
    /// melting: share of a violation that is folded in a tick, above 0 and below 1 [default: 0.2]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    upsilon: Option<f32>,
    /// melting: height that nothing sinks below, -10 to 1 [default: the object's base]
    #[arg(long, value_name = "Y", value_parser = parse_finite, allow_negative_numbers = true)]
    floor: Option<f32>,
    /// solid: share of L at which a vertex leaves the deforming group, 0 to below 1 [default: 0]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    retire_at: Option<f32>,
    /// Blocks along x, y and z, each 1 to 256 [default: 6x7x8]
    #[arg(long, value_name = "XxYxZ", value_parser = parse_extents::<u32, 3>)]
    blocks: Option<[u32; 3]>,
    /// Halt the boundary while more vertices are active (3.7.1); 0 never does [default: 0]
    #[arg(long, value_name = "N")]
    active_limit: Option<u32>,
    /// Spread each tick over so many frames (3.7.2), 1 to 64 [default: 1]
    #[arg(long, value_name = "K")]
    time_division: Option<u32>,
    /// Load what never changes before the first frame (3.7.4; the default)
    #[arg(long, overrides_with = "no_preload")]
    preload: bool,
    /// Load it again in every frame
    #[arg(long)]
    no_preload: bool,
    /// Never leave a block that has weight without neighbours (the default)
    #[arg(long, overrides_with = "no_keep_connected")]
    keep_connected: bool,
    /// Remove whatever is consumed, and let pieces come off
    #[arg(long)]
    no_keep_connected: bool,
    /// Most fire particles, 0 to 1000000 [default: 3000]
    #[arg(long, value_name = "N")]
    fire: Option<u32>,
    /// Most smoke particles, 0 to 1000000 [default: 1800]
    #[arg(long, value_name = "N")]
    smoke: Option<u32>,
    /// Radius of a particle in diagonals, above 0 and at most 1 [default: 0.02]
    #[arg(long, value_name = "D", value_parser = parse_finite, allow_negative_numbers = true)]
    particle_radius: Option<f32>,
    /// low-poly: finest level that is drawn, auto (by distance) or 0 to 5 [default: auto]
    #[arg(long, value_name = "auto|N", value_parser = parse_level)]
    lod: Option<LevelWord>,
    /// What the surface is made of [default: wood]
    #[arg(long, value_enum)]
    material: Option<MaterialWord>,
    /// PNG that covers the mesh by its texture coordinates, in place of a material; at most 8192 pixels a side
    #[arg(long, value_name = "FILE.png", conflicts_with = "material")]
    texture: Option<PathBuf>,
    /// Albedo, linear red,green,blue, each 0 to 1; a factor of a texture [default: 0.36,0.17,0.07, with a texture 1,1,1]
    #[arg(long, value_name = "R,G,B", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    albedo: Option<[f32; 3]>,
    /// What colours the mesh [default: lit]
    #[arg(long, value_enum)]
    shading: Option<ShadingWord>,
    /// Camera: eye and target, x,y,z,x,y,z in diagonals [default: the object fills 80 % of the picture]
    #[arg(long, value_name = "EYE,TARGET", value_parser = parse_eye_and_target, allow_hyphen_values = true)]
    camera: Option<[Vec3; 2]>,
    /// Size of the picture in pixels [default: 800x600]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Size>,
    /// Seed of the boundary's noise and of the particles [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Simulated time between two frames in seconds, 0 to 10 [default: 1/60]
    #[arg(long, value_name = "S", value_parser = parse_time_step, allow_negative_numbers = true)]
    time_step: Option<f64>,
    /// The simulation's frame that frame 0 shows, 0 to 100000 [default: 0]
    #[arg(long, value_name = "N")]
    first_frame: Option<u32>,
}

impl PaperArgs for BurningArgs {
    type Study = Setup;
    type Experiment = Experiments;
    type Own = Infallible;

    const ABOUT: &'static str =
        "Burning: heat, deformation, consumption and melting of meshes (Amarasinghe), pass by pass";
    const BENCHED: &'static str = "shell";
    const RENDERED: &'static str = "shell";

    /// The bunny, well alight.
    fn quick() -> Setup {
        let mut setup = Setup::default();
        setup.parameters.first_frame = 420;
        setup
    }

    fn preset_variant(&self) -> Option<Variant> {
        self.preset.map(|word| word.preset().variant())
    }

    fn resolve(&self) -> Result<Setup, Failure> {
        Ok(self.over(self.preset.map_or_else(Setup::default, |word| word.preset().setup())))
    }
}

impl BurningArgs {
    /// The preset that was named, or that of section 3.8.
    fn preset_or_default(&self) -> Setup {
        self.preset.unwrap_or(PresetWord::Results38).preset().setup()
    }

    /// What was typed over a setup's numbers.
    fn over(&self, mut setup: Setup) -> Setup {
        set(&mut setup.mesh, self.mesh.clone());
        set(&mut setup.stretch, self.stretch.map(Vec3::from));
        setup.triangles = self.triangles.or(setup.triangles);
        let p = &mut setup.parameters;
        p.levels = self.levels.or(p.levels);
        p.floor = self.floor.or(p.floor);
        if !self.source.is_empty() {
            p.sources = self.source.iter().map(|&s| Vec3::from(s)).collect();
        }
        set(&mut p.edge, self.edge);
        set(&mut p.psi, self.psi);
        set(&mut p.speed_per_s, self.speed);
        set(&mut p.width_of_areas, self.area_width);
        set(&mut p.flammability, self.flammability);
        set(&mut p.epsilon, self.epsilon);
        set(&mut p.beta, self.beta);
        set(&mut p.rho, self.rho);
        set(&mut p.phi, self.phi);
        set(&mut p.gamma, self.gamma);
        set(&mut p.spread, self.spread);
        set(&mut p.omega, self.omega);
        set(&mut p.chi, self.chi);
        set(&mut p.upsilon, self.upsilon);
        set(&mut p.retire_at, self.retire_at);
        set(&mut p.blocks, self.blocks);
        set(&mut p.active_limit, self.active_limit);
        set(&mut p.time_division, self.time_division);
        p.preload &= !self.no_preload;
        p.keep_connected &= !self.no_keep_connected;
        set(&mut p.fire, self.fire);
        set(&mut p.smoke, self.smoke);
        set(&mut p.particle_radius, self.particle_radius);
        set(&mut p.level_of_detail, self.lod.map(|LevelWord(level)| level));
        let material = |word| match word {
            MaterialWord::Plain => Material::Plain,
            MaterialWord::Wood => Material::Wood,
        };
        set(&mut p.material, self.material.map(material));
        if self.texture.is_some() {
            setup.texture.clone_from(&self.texture);
            p.albedo = Vec3::ONE;
        }
        set(&mut p.albedo, self.albedo.map(Vec3::from));
        let shading = |word| match word {
            ShadingWord::Lit => Shading::Lit,
            ShadingWord::Areas => Shading::Areas,
            ShadingWord::Blocks => Shading::Blocks,
            ShadingWord::Normals => Shading::Normals,
            ShadingWord::Wire => Shading::Wire,
        };
        set(&mut p.shading, self.shading.map(shading));
        p.camera = self.camera.map(|[eye, target]| seen_from(eye, target)).or(p.camera);
        if let Some(size) = self.size {
            (p.width, p.height) = (size.width, size.height);
        }
        set(&mut p.seed, self.seed);
        set(&mut p.time_step_s, self.time_step);
        set(&mut p.first_frame, self.first_frame);
        setup
    }
}

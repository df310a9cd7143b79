//! The paper's parameters under its own names, each declared once.

pub mod gas_number;
mod lists;
mod march;
pub mod or_off;
pub mod placed_object;
pub mod volume_file;
pub mod volumes;

use std::sync::Arc;

use glam::Vec3;

pub use lists::Lists;
pub use march::March;

use super::grid::{Filter, Grid};
use super::model::{DensityFunction, HenyeyGreenstein, Object, Shape, SolidTexture, Volume};
use crate::measure::parameter::{self, Cost, Extents, EyeAndTarget, Field, Parameter, Range};
use crate::measure::{ParameterError, components};
use crate::scene::{Camera, Light};
use crate::{choice, field, named, size_field};

named! {
    /// The ways of shadowing by the gas (section "Shadowing of the gas", figure 8).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Variant: crate::measure::Variant {
        /// The same scene without its volumes.
        NoVolume = "no-volume",
        /// Nothing is shadowed.
        None = "none",
        /// The gas shadows surfaces, by tracing, and not itself.
        Surfaces = "surfaces",
        /// The gas shadows surfaces and itself, by tracing.
        Traced = "traced",
        /// The gas shadows surfaces and itself, by the shadow table.
        Table = "table",
        /// As `Table`, with gas that is integrated in froxels: not the paper's.
        Froxel = "froxel",
    }
}

choice! {
    /// Place of a sample in its part of an increment along the viewer's ray.
    pub enum Jitter {
        /// By a hash of pixel and sample.
        Random = ("random", "The paper's: at random, alike from pixel to pixel"),
        /// At one place for each ray, by a mask of blue noise.
        BlueNoise = (
            "blue-noise",
            "At one place for each ray, by a mask of blue noise: far apart in neighbouring pixels, so that the grain is fine",
        ),
    }
}

impl Variant {
    /// The shadows are the table's.
    pub(super) fn has_table(self) -> bool {
        matches!(self, Variant::Table | Variant::Froxel)
    }
}

/// Most volumes and lights of a scene: the shaders keep one value for each in registers.
pub const MAX_VOLUMES: usize = 8;
pub const MAX_LIGHTS: usize = 4;

/// Every number of a configuration but the surfaces, in the ranges of [`Parameters::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// 0 to 8.
    pub volumes: Vec<Volume>,
    /// Those of files, which the volumes take their densities from.
    pub grids: Vec<Arc<Grid>>,
    /// Interpolation between their samples.
    pub filter: Filter,
    /// 1 to 4.
    pub lights: Vec<Light>,
    /// Light from all around, which also stands for higher orders of scattering in gases of high albedo; linear RGB, 0
    /// to 64.
    pub ambient: Vec3,
    /// Linear RGB, 0 to 64.
    pub background: Vec3,
    /// Its near and far plane are the paper's hither and yon.
    pub camera: Camera,
    /// Increments along the longest side of a volume, 1 to 100,000.
    pub steps: u32,
    /// Samples in each increment of a viewer's ray, 1 to 64.
    pub samples: u32,
    /// Their places.
    pub jitter: Jitter,
    /// The way of rays through the gas.
    pub march: March,
    /// Entries of the table of densities that rays read along each axis, 2 to 512; without, they ask the functions.
    pub density_cache: Option<u32>,
    /// Rays skip bricks in which one through the whole volume loses no more than this optical depth, at least 0; without,
    /// none.
    pub skip_empty: Option<f32>,
    /// Columns and rows from one pixel whose gas is marched to the next, 1 to 16; others take theirs from them where they
    /// can.
    pub volume_scale: u32,
    /// Bricks along each axis of a volume's box, 1 to 128.
    pub bricks: u32,
    /// Entries of the density and shadow tables along each axis, 2 to 512.
    pub table_size: u32,
    /// Columns, rows and slices of froxels, each 1 to 1024.
    pub froxels: [u32; 3],
    /// Octaves of turbulence go on while the scale exceeds it; 0.0001 to 1 texture units.
    pub pixel_size: f32,
    /// Density below which no shadow of the gas on itself is computed, at least 0.
    pub shadow_threshold: f32,
    /// Transparency below which the tracing of a pixel ends, 0 (never) to 1.
    pub early_end: f32,
    /// The scene's frame that frame 0 shows.
    pub first_frame: u32,
    /// Frames of the scene from one frame to the next; 0 holds the first.
    pub frame_step: u32,
    /// Of noise, jitter and the fog's random table.
    pub seed: u64,
    /// The way to the lists of fragments.
    pub lists: Lists,
    /// Footprints by a geometry stage, where the device has one; else by the vertex stage.
    pub geometry_stage: bool,
    /// Most bytes of a buffer of the lists, at least 4096: the picture is done in bands of rows whose lists fit.
    /// Without, or where it binds less, what the device binds.
    pub list_bytes: Option<u64>,
    /// Size of the picture in pixels.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
}

impl Default for Parameters {
    /// A box of turbulence of side 2 m around the origin.
    fn default() -> Self {
        Parameters {
            volumes: vec![default_volume()],
            grids: Vec::new(),
            filter: Filter::Trilinear,
            lights: vec![default_light()],
            ambient: Vec3::splat(0.1),
            background: Vec3::ZERO,
            camera: Camera {
                eye: Vec3::new(0.0, 1.0, 6.0),
                target: Vec3::ZERO,
                up: Vec3::Y,
                vertical_fov_rad: 0.6,
                near_m: 0.1,
                far_m: 100.0,
            },
            steps: 40,
            samples: 1,
            jitter: Jitter::Random,
            march: March::Steps,
            density_cache: None,
            skip_empty: None,
            volume_scale: 1,
            bricks: 16,
            table_size: 64,
            froxels: [90, 62, 64],
            pixel_size: 1.0 / 16.0,
            shadow_threshold: 0.0,
            early_end: 0.01,
            first_frame: 0,
            frame_step: 1,
            seed: 1,
            lists: Lists::Linked,
            geometry_stage: true,
            list_bytes: None,
            width: 360,
            height: 250,
        }
    }
}

/// The light of all scenes that say nothing else: at (3, 6, 3) m, with irradiance 1 at the origin.
pub fn default_light() -> Light {
    let position = Vec3::new(3.0, 6.0, 3.0);
    Light::Point { position, intensity: Vec3::splat(position.length_squared()) }
}

/// The phase function of all gases that say nothing else.
pub const DEFAULT_PHASE: [HenyeyGreenstein; 2] =
    [HenyeyGreenstein { weight: 0.8, g: 0.5 }, HenyeyGreenstein { weight: 0.2, g: -0.3 }];

/// A box of side 2 m with tau 4 / 2 m and albedo 0.3.
pub fn default_volume() -> Volume {
    Volume {
        shape: Shape::Box,
        center: Vec3::ZERO,
        half_extent_m: Vec3::ONE,
        falloff: 0.0,
        is_solid: false,
        texture: SolidTexture {
            function: DensityFunction::Turbulence,
            opaque: 1.0,
            power: 1.0,
            scale_per_m: 1.0,
            offset: Vec3::ZERO,
        },
        tau_per_m: 2.0,
        albedo: Vec3::splat(0.3),
        phase: DEFAULT_PHASE,
    }
}

fn is_color(color: Vec3, limit: f32) -> bool {
    color.to_array().iter().all(|c| (0.0..=limit).contains(c))
}

impl Parameters {
    /// The scene's frame that `number` shows.
    pub fn scene_frame(&self, number: u32) -> u32 {
        self.first_frame.saturating_add(self.frame_step.saturating_mul(number))
    }

    /// Octaves of turbulence, of scales 1, 1/2, 1/4, ...
    pub fn octaves(&self) -> u32 {
        let scales = std::iter::successors(Some(1.0_f32), |scale| Some(scale / 2.0));
        scales.take_while(|&scale| scale > self.pixel_size).count() as u32
    }

    /// The grid of each volume, where they are of files.
    pub fn volume_grids(&self) -> Option<Vec<Arc<Grid>>> {
        let grid = |volume: &Volume| match volume.texture.function {
            DensityFunction::Grid(index) => {
                Some(self.grids.get(index).cloned().unwrap_or_else(|| Arc::new(Grid::empty())))
            }
            _ => None,
        };
        let grids: Vec<_> = self.volumes.iter().filter_map(grid).collect();
        (!grids.is_empty()).then_some(grids)
    }

    /// Files have temperatures.
    pub(super) fn glows(&self) -> bool {
        self.grids.iter().any(|grid| !grid.glow.is_empty())
    }

    /// The shaders' name of what rays and tables take the volumes' densities from.
    pub(super) fn density_shader(&self) -> &'static str {
        if self.density_cache.is_some() { "cached" } else { self.density_source() }
    }

    /// The same of rays that march, with the way that they take through what is empty, and through one volume under one light
    /// or several of either.
    pub(super) fn ray_shader(&self) -> String {
        let empty = if self.skip_empty.is_some() { "skipped" } else { "kept" };
        format!("{}-{empty}-{}", self.density_shader(), self.count_shader())
    }

    /// The shaders' name of rays through one volume under one light, or several of either.
    pub(super) fn count_shader(&self) -> &'static str {
        if self.volumes.len() == 1 && self.lights.len() == 1 { "one" } else { "several" }
    }

    /// The optical depth that a ray through a volume may lose in its bricks; nothing where there are no bricks, as where no
    /// ray is marched.
    pub(super) fn brick_depth(&self, variant: Variant) -> Option<f32> {
        let of_delta = || (self.march == March::Delta).then_some(0.0);
        self.skip_empty.or_else(of_delta).filter(|_| variant != Variant::Froxel)
    }

    /// The shaders' name of what the volumes' densities are in the end.
    pub(super) fn density_source(&self) -> &'static str {
        match self.filter {
            _ if self.volume_grids().is_none() => "functions",
            Filter::Trilinear => "trilinear",
            Filter::Tricubic => "tricubic",
        }
    }

    /// Depths between which all gas lies, metres, as far as it is between the hither and the yon plane.
    pub fn gas_depths(&self) -> [f32; 2] {
        let Camera { eye, target, near_m, far_m, .. } = self.camera;
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        let [mut first, mut last] = [far_m, near_m];
        for volume in &self.volumes {
            let (middle, half) = ((volume.center - eye).dot(forward), volume.half_extent_m.dot(forward.abs()));
            first = first.min((middle - half).clamp(near_m, far_m));
            last = last.max((middle + half).clamp(near_m, far_m));
        }
        // None, or none that is seen: any depths do.
        if last > first * 1.000_1 { [first, last] } else { [near_m, 2.0 * near_m] }
    }

    /// Mixes the seed into the 32 bits that the lattice's hash takes.
    pub fn noise_seed(&self) -> u32 {
        (self.seed ^ (self.seed >> 32)) as u32
    }

    /// Every number that a user can set, once; those of the gases are in [`volumes::declared`].
    pub fn declared() -> Vec<Parameter<Parameters>> {
        vec![
            Parameter::new("steps", field!(Parameters.steps))
                .range(Range::from(1.0).to(100_000.0))
                .help("Steps along a volume's longest side")
                .section("Volume rendering")
                .default_text("the scene's, 40")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("volume-filter", field!(Parameters.filter))
                .group("Gases")
                .help("Of files: interpolation between samples")
                .cost(Cost::Pipelines)
                .requires("volume-file"),
            Parameter::new("samples", field!(Parameters.samples))
                .range(Range::from(1.0).to(64.0))
                .help("Samples in each increment along the viewer's ray, each of its own part; the paper's is one")
                .section("Volume rendering")
                .cost(Cost::Buffers),
            Parameter::new("jitter", field!(Parameters.jitter))
                .help("Place of a sample in its part")
                .section("Volume rendering")
                .cost(Cost::Buffers),
            Parameter::new("bricks", field!(Parameters.bricks))
                .range(Range::from(1.0).to(128.0))
                .help("Of `skip-empty` and `march` delta: bricks along each axis of the box around a volume")
                .section("Volume rendering")
                .cost(Cost::Buffers),
            Parameter::new("table", field!(Parameters.table_size))
                .range(Range::from(2.0).to(512.0))
                .help("Entries of the density and shadow tables along each axis")
                .section("Calculation of the shadow table")
                .default_text("the scene's, 64")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("froxels", FROXELS)
                .range(Range::from(1.0).to(1024.0))
                .placeholder("WxHxD")
                .help("Of variant froxel: columns and rows that the picture, and slices that its depth is cut into")
                .cost(Cost::Buffers),
            Parameter::new("pixel-size", field!(Parameters.pixel_size))
                .range(Range::from(1e-4).to(1.0))
                .help("Octaves of turbulence go on while their scale exceeds it")
                .default_text("the scene's"),
            Parameter::new("shadow-threshold", field!(Parameters.shadow_threshold))
                .range(Range::from(0.0))
                .help("Density below which no shadow of the gas on itself is computed")
                .section("Shadowing of the gas")
                .default_text("the scene's"),
            Parameter::new("early-end", field!(Parameters.early_end))
                .range(Range::from(0.0).to(1.0))
                .help("Transparency below which a pixel's tracing ends; 0 for never"),
            Parameter::new("ambient", field!(Parameters.ambient))
                .placeholder("R,G,B")
                .range(Range::from(0.0).to(64.0))
                .help("Ambient light, linear red, green, blue")
                .default_text("the scene's"),
            Parameter::new("first-frame", field!(Parameters.first_frame))
                .help("The scene's frame that frame 0 shows")
                .default_text("one in which there is gas")
                .everyday(),
            Parameter::new("frame-step", field!(Parameters.frame_step))
                .help("Frames of the scene from one frame to the next; 0 holds the first"),
            Parameter::new("geometry-stage", field!(Parameters.geometry_stage))
                .help("The triangles' footprints by a geometry stage, or in the vertex stage")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("list-bytes", field!(Parameters.list_bytes))
                .range(Range::from(4096.0))
                .help(
                    "Most bytes of a buffer of the A-buffer's lists: the picture is done in bands of rows whose lists \
                     fit",
                )
                .default_text("what the device binds")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("camera", CAMERA)
                .help("Camera: eye and target, x,y,z,x,y,z in metres")
                .default_text("the scene's")
                .unrecorded(),
            parameter::size(size_field!(Parameters)).default_text("the figure's"),
            Parameter::new("seed", field!(Parameters.seed))
                .help("Seed of noise and jitter")
                .cost(Cost::Buffers)
                .unrecorded(),
        ]
    }

    /// Checks every range, and what several numbers must be together.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        parameter::check(&Self::declared(), self)?;
        let volumes = self.volumes.len();
        ParameterError::check(volumes <= MAX_VOLUMES, "volume", volumes, "a scene has at most 8 volumes")?;
        let grids = self.volumes.iter().filter(|v| matches!(v.texture.function, DensityFunction::Grid(_))).count();
        let are_alike = grids == 0 || grids == volumes;
        ParameterError::check(are_alike, "volume", volumes, "are all of files or all of functions")?;
        let is_known = !self.glows() || self.density_cache.is_none();
        let problem = "has no place beside `volume-temperature`: a table of densities knows no temperatures";
        ParameterError::check(is_known, "density-cache", self.density_cache.unwrap_or(0), problem)?;
        let lights = self.lights.len();
        ParameterError::check((1..=MAX_LIGHTS).contains(&lights), "light", lights, "a scene has 1 to 4 lights")?;
        volumes::check(&self.volumes)?;
        let is_placed = self.march == March::Steps || self.jitter == Jitter::Random;
        ParameterError::check(is_placed, "jitter", "blue-noise", "has no place in `march` delta; give random")?;
        self.lights.iter().try_for_each(validate_light)?;
        let background = self.background;
        ParameterError::check(is_color(background, 64.0), "background", components(background), "must be 0 to 64")?;
        let (first, step) = (u64::from(self.first_frame), u64::from(self.frame_step));
        let is_late = first + 1000 > 16_000_000;
        let (name, value) = if is_late { ("first-frame", first) } else { ("frame-step", step) };
        let range = "leads too far; a scene has 16000000 frames, with a thousand steps from the first";
        ParameterError::check(first + step * 1000 <= 16_000_000, name, value, range)?;
        ParameterError::check_camera(&self.camera)
    }
}

const FROXELS: Field<Parameters, Extents<u32, 3>> =
    Field { get: |p| Extents(p.froxels), set: |p, froxels| p.froxels = froxels.0 };

const CAMERA: Field<Parameters, EyeAndTarget> = Field {
    get: |p| EyeAndTarget { eye: p.camera.eye, target: p.camera.target },
    set: |p, camera| (p.camera.eye, p.camera.target) = (camera.eye, camera.target),
};

/// Checks the numbers of a surface.
///
/// # Errors
/// The first outside its range.
pub fn validate_object(object: &Object) -> Result<(), ParameterError> {
    ParameterError::check((0.0..=1.0).contains(&object.opacity), "opacity", object.opacity, "must be 0 to 1")?;
    ParameterError::check(is_color(object.color, 1.0), "color", components(object.color), "must be 0 to 1")?;
    let vein_color = object.veins.map_or(Vec3::ZERO, |veins| veins.color);
    ParameterError::check(is_color(vein_color, 1.0), "color", components(vein_color), "must be 0 to 1")?;
    let textures = object.solid_textures().map(|&texture| Volume { texture, ..default_volume() });
    volumes::check(&textures.collect())
}

fn validate_light(light: &Light) -> Result<(), ParameterError> {
    let range = "must have an intensity of 0 to 1000000";
    match *light {
        Light::Parallel { direction, intensity } => {
            let is_good = direction.is_finite() && direction.normalize_or_zero() != Vec3::ZERO;
            ParameterError::check(is_good, "light", components(direction), "must be a direction")?;
            ParameterError::check(is_color(intensity, 1e6), "light", components(intensity), range)
        }
        Light::Point { position, intensity } => {
            ParameterError::check(
                position.is_finite(),
                "point-light",
                components(position),
                "must be a finite position",
            )?;
            ParameterError::check(is_color(intensity, 1e6), "point-light", components(intensity), range)
        }
    }
}

//! What a user can set, under the paper's own words.

use glam::Vec3;

use super::model::{DensityFunction, HenyeyGreenstein, Object, Shape, SolidTexture, Volume};
use crate::measure::{ParameterError, components};
use crate::scene::{Camera, Light};

/// How the gas is shadowed (section "Shadowing of the gas", figure 8).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variant {
    /// The same scene without its volumes.
    NoVolume,
    /// Nothing is shadowed.
    None,
    /// The gas shadows surfaces, by tracing, and not itself.
    Surfaces,
    /// The gas shadows surfaces and itself, by tracing.
    Traced,
    /// The gas shadows surfaces and itself, by the shadow table.
    Table,
}

impl crate::measure::Variant for Variant {
    const ALL: &'static [Variant] =
        &[Variant::NoVolume, Variant::None, Variant::Surfaces, Variant::Traced, Variant::Table];

    fn as_str(self) -> &'static str {
        match self {
            Variant::NoVolume => "no-volume",
            Variant::None => "none",
            Variant::Surfaces => "surfaces",
            Variant::Traced => "traced",
            Variant::Table => "table",
        }
    }
}

/// Most volumes and lights of a scene: the shaders keep one value for each in registers.
pub const MAX_VOLUMES: usize = 8;
pub const MAX_LIGHTS: usize = 4;

/// Every number of a configuration but the surfaces. [`Parameters::validate`] checks the ranges given here.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// 0 to 8.
    pub volumes: Vec<Volume>,
    /// 1 to 4.
    pub lights: Vec<Light>,
    /// Light from all around, which also stands for higher orders of scattering in gases of high albedo; linear RGB, 0 to 64.
    pub ambient: Vec3,
    /// Linear RGB, 0 to 64.
    pub background: Vec3,
    /// Its near and far plane are the paper's hither and yon.
    pub camera: Camera,
    /// Increments along the longest side of a volume, 1 to 100,000.
    pub steps: u32,
    /// Entries of the density and shadow tables along each axis, 2 to 512.
    pub table_size: u32,
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
    pub seed: u64,
    /// Whether a geometry stage makes the footprints, where the device has one.
    pub geometry_stage: bool,
    /// Most bytes of a buffer of the lists, at least 4096: the picture is done in bands of rows whose lists fit. Without, or
    /// where it binds less, what the device binds.
    pub list_bytes: Option<u64>,
    /// Size of the picture in pixels.
    pub width: u32,
    pub height: u32,
}

impl Default for Parameters {
    /// A box of turbulence of side 2 m around the origin.
    fn default() -> Self {
        Parameters {
            volumes: vec![default_volume()],
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
            table_size: 64,
            pixel_size: 1.0 / 16.0,
            shadow_threshold: 0.0,
            early_end: 0.01,
            first_frame: 0,
            frame_step: 1,
            seed: 1,
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

fn is_color(color: Vec3, most: f32) -> bool {
    color.to_array().iter().all(|c| (0.0..=most).contains(c))
}

impl Parameters {
    /// The scene's frame that `number` shows.
    pub fn scene_frame(&self, number: u32) -> u32 {
        self.first_frame.saturating_add(self.frame_step.saturating_mul(number))
    }

    /// Mixes the seed into the 32 bits that the lattice's hash takes.
    pub fn noise_seed(&self) -> u32 {
        (self.seed ^ (self.seed >> 32)) as u32
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        ParameterError::check((1..=100_000).contains(&self.steps), "--steps", self.steps, "must be 1 to 100000")?;
        ParameterError::check(
            (2..=512).contains(&self.table_size),
            "--table",
            self.table_size,
            "must be 2 to 512 entries",
        )?;
        let size = self.pixel_size;
        ParameterError::check((1e-4..=1.0).contains(&size), "--pixel-size", size, "must be 0.0001 to 1")?;
        let threshold = self.shadow_threshold;
        let is_good = threshold >= 0.0 && threshold.is_finite();
        ParameterError::check(is_good, "--shadow-threshold", threshold, "must be at least 0")?;
        ParameterError::check((0.0..=1.0).contains(&self.early_end), "--early-end", self.early_end, "must be 0 to 1")?;
        let volumes = self.volumes.len();
        ParameterError::check(volumes <= MAX_VOLUMES, "--volume", volumes, "a scene has at most 8 volumes")?;
        let lights = self.lights.len();
        ParameterError::check((1..=MAX_LIGHTS).contains(&lights), "--light", lights, "a scene has 1 to 4 lights")?;
        for volume in &self.volumes {
            validate_volume(volume)?;
        }
        for light in &self.lights {
            validate_light(light)?;
        }
        ParameterError::check(is_color(self.ambient, 64.0), "--ambient", components(self.ambient), "must be 0 to 64")?;
        ParameterError::check(
            is_color(self.background, 64.0),
            "--background",
            components(self.background),
            "must be 0 to 64",
        )?;
        let last = u64::from(self.first_frame) + u64::from(self.frame_step) * 1000;
        ParameterError::check(
            last <= 16_000_000,
            "--first-frame",
            self.first_frame,
            "is too late; a scene has 16000000 frames",
        )?;
        let list_bytes = self.list_bytes.unwrap_or(u64::MAX);
        ParameterError::check(list_bytes >= 4096, "--list-bytes", list_bytes, "must be at least 4096")?;
        ParameterError::check_size(self.width, self.height)?;
        ParameterError::check_camera(&self.camera)
    }
}

/// Checks the numbers of a surface.
///
/// # Errors
/// The first outside its range.
pub fn validate_object(object: &Object) -> Result<(), ParameterError> {
    ParameterError::check((0.0..=1.0).contains(&object.opacity), "--opacity", object.opacity, "must be 0 to 1")?;
    ParameterError::check(is_color(object.color, 1.0), "--color", components(object.color), "must be 0 to 1")?;
    object.gas.as_ref().map_or(Ok(()), validate_texture)
}

fn validate_volume(volume: &Volume) -> Result<(), ParameterError> {
    ParameterError::check(
        volume.center.is_finite(),
        "--volume",
        components(volume.center),
        "must have a finite centre",
    )?;
    let half = volume.half_extent_m;
    let is_good = half.to_array().iter().all(|h| (1e-4..=1e6).contains(h));
    ParameterError::check(is_good, "--volume", components(half), "must have half extents of 0.0001 to 1000000 metres")?;
    ParameterError::check((0.0..=1.0).contains(&volume.falloff), "--falloff", volume.falloff, "must be 0 to 1")?;
    if let Shape::Frustum { bottom, top } = volume.shape {
        let is_good = [bottom, top].iter().all(|r| (0.0..=1.0).contains(r)) && bottom.max(top) > 0.0;
        ParameterError::check(is_good, "--volume", format!("{bottom},{top}"), "must have radii of 0 to 1, not both 0")?;
    }
    let tau = volume.tau_per_m;
    ParameterError::check((0.0..=1e6).contains(&tau), "--tau", tau, "must be 0 to 1000000 per metre")?;
    ParameterError::check(is_color(volume.albedo, 1.0), "--albedo", components(volume.albedo), "must be 0 to 1")?;
    let [first, second] = volume.phase;
    let text = format!("{},{},{},{}", first.weight, first.g, second.weight, second.g);
    let is_good = volume.phase.iter().all(|p| p.weight >= 0.0 && p.g.abs() < 1.0)
        && (first.weight + second.weight - 1.0).abs() < 1e-3;
    ParameterError::check(
        is_good,
        "--phase",
        text,
        "must be weights of at least 0 that add up to 1, each with a g between -1 and 1",
    )?;
    validate_texture(&volume.texture)
}

fn validate_texture(texture: &SolidTexture) -> Result<(), ParameterError> {
    ParameterError::check((0.0..=1e6).contains(&texture.opaque), "--opaque", texture.opaque, "must be 0 to 1000000")?;
    let is_good = texture.power > 0.0 && texture.power <= 100.0;
    ParameterError::check(is_good, "--power", texture.power, "must be above 0 and at most 100")?;
    let scale = texture.scale_per_m;
    ParameterError::check(
        (1e-4..=1e4).contains(&scale),
        "--texture-scale",
        scale,
        "must be 0.0001 to 10000 per metre",
    )?;
    let is_good = texture.offset.to_array().iter().all(|o| o.abs() <= 1e4);
    ParameterError::check(is_good, "--texture-offset", components(texture.offset), "must be -10000 to 10000")?;
    match texture.function {
        DensityFunction::Constant | DensityFunction::Turbulence => Ok(()),
        DensityFunction::Clouds { frequency } => {
            ParameterError::check(frequency.abs() <= 1e4, "--frequency", frequency, "must be -10000 to 10000")
        }
        DensityFunction::Fog { swirl, front } => {
            let numbers = [front.x_m, front.per_frame_m, front.depth_m, front.turbulence_m, front.table_m];
            let text = numbers.map(|n| n.to_string()).join(",");
            let is_good = numbers.iter().all(|n| n.abs() <= 1e6) && front.depth_m > 0.0;
            let range = "must be -1000000 to 1000000 each, with a depth above 0";
            ParameterError::check(is_good, "--front", text, range)?;
            let full = front.full_frames;
            ParameterError::check((0.0..=1e6).contains(&full), "--full-fog", full, "must be 0 to 1000000 frames")?;
            validate_swirl(&swirl)
        }
        DensityFunction::Steam { swirl } => validate_swirl(&swirl),
        DensityFunction::Hypertexture { amplitude, softness } => {
            let is_good = (0.0..=100.0).contains(&amplitude);
            ParameterError::check(is_good, "--hypertexture", amplitude, "must move the surface by 0 to 100")?;
            ParameterError::check(
                softness > 0.0 && softness <= 1.0,
                "--hypertexture",
                softness,
                "must have a softness above 0 and at most 1",
            )
        }
    }
}

fn validate_swirl(swirl: &super::model::Swirl) -> Result<(), ParameterError> {
    let along = swirl.along_per_frame;
    ParameterError::check(along.abs() <= 1e4, "--down", along, "must be -10000 to 10000 texture units a frame")?;
    let frames = swirl.frames;
    ParameterError::check((0.0..=1e4).contains(&frames), "--swirl-frames", frames, "must be 0 to 10000")?;
    let [first, second] = swirl.ellipse;
    let is_good = first.abs() <= 1e4 && second.abs() <= 1e4;
    ParameterError::check(is_good, "--ellipse", format!("{first},{second}"), "must be -10000 to 10000 texture units")
}

fn validate_light(light: &Light) -> Result<(), ParameterError> {
    match *light {
        Light::Parallel { direction, intensity } => {
            let is_good = direction.is_finite() && direction.normalize_or_zero() != Vec3::ZERO;
            ParameterError::check(is_good, "--light", components(direction), "must be a direction")?;
            ParameterError::check(
                is_color(intensity, 1e6),
                "--light",
                components(intensity),
                "must have an intensity of 0 to 1000000",
            )
        }
        Light::Point { position, intensity } => {
            ParameterError::check(position.is_finite(), "--point-light", components(position), "must be a place")?;
            let range = "must have an intensity of 0 to 1000000";
            ParameterError::check(is_color(intensity, 1e6), "--point-light", components(intensity), range)
        }
    }
}

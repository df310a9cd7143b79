//! Numbers that a user can set, under the thesis's own words.

use std::f32::consts::PI;

use glam::Vec3;

pub use super::culled_map::CullSteps;
pub use super::planes::SmartPlacement;
use super::water_map::WaterMap;
use crate::measure::parameter::{self, Cost, Field, Parameter, Range};
use crate::measure::{ParameterError, components};
use crate::scene::{Camera, Light};
use crate::{choice, field, named, size_field};

named! {
    /// The methods that the thesis compares.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Variant: crate::measure::Variant {
        /// Section 5.2.2: one position map and one diffuse map, however many planes.
        LevelMap = "level-map",
        /// Section 5.2.3: planes only where a depth profile finds the receiver.
        LevelMapSmart = "level-map-smart",
        /// Section 6.1: the level map's picture, of those pairs of triangle and plane alone that may light it.
        Culled = "culled",
        /// Section 6.3: each triangle of the refined water once, where its light lands.
        Hit = "hit",
        /// Section 5.2.1, after Iwasaki et al.: a slice image for every plane.
        Volumetric = "volumetric",
        /// Section 3.2, after Iwasaki et al.: illumination volumes counted in the stencil buffer. It knows no occlusion.
        Stencil = "stencil",
    }
}

/// Smart slicing (section 4.7.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmartParameters {
    /// Depth levels of the profile, 1 to 65,536.
    pub levels: u32,
    /// Distribution of the planes over the sub-boxes.
    pub placement: SmartPlacement,
}

choice! {
    /// The places that the intensity of eq. 4-18 belongs to.
    pub enum IntensityRule {
        /// A water triangle, as the thesis prints it: constant over the triangle, but for angle and absorption.
        Face = ("face", "That of each water triangle, constant over it"),
        /// A vertex, by the triangles around it; interpolated between vertices. The flux is the same.
        Vertex = ("vertex", "That of each vertex by the triangles around it, interpolated"),
    }
}

/// The water's waves: a sum of sines with seeded directions and phases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveParameters {
    /// Number of waves, 0 (flat water) to 64.
    pub count: u32,
    /// Sum of their amplitudes in metres, at least 0.
    pub amplitude_m: f32,
    /// Longest wavelength in metres; the others are shorter, down to 2/5 of it.
    pub wavelength_m: f32,
}

impl WaveParameters {
    /// The steepest slope that the sum of the waves could reach.
    pub fn steepest_slope(&self) -> f32 {
        // The shortest wave is 2/5 of the longest.
        self.amplitude_m * 2.0 * PI / (0.4 * self.wavelength_m)
    }
}

/// Every number of a configuration, in the ranges of [`Parameters::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Reference (or sample) planes, 1 to 4096.
    pub planes: u32,
    /// Distance from the camera within which a receiver has all of them, metres; beyond, fewer in inverse proportion.
    pub planes_within_m: Option<f32>,
    /// Texels a side of the position, diffuse, caustics and slice maps, at least 1.
    pub map_size: u32,
    /// Triangles of the water's mesh, 2 to 20,000,000; rounded to a whole number of cells.
    pub water_triangles: u32,
    /// Position and diffuse map in one pass with two targets; in two passes without.
    pub mrt: bool,
    /// Smart slicing, section 4.7.2.
    pub smart: SmartParameters,
    /// Texels a side of the caustics map that are drawn and averaged for each of its texels, 1 to 64.
    pub coverage: u32,
    /// Places that the intensity of eq. 4-18 belongs to: triangles or vertices of the water.
    pub intensity: IntensityRule,
    /// Surfaces above one another that the variant `hit` lights, 1 to 4.
    pub layers: u32,
    /// Steps of the variant `culled`.
    pub cull: CullSteps,
    /// The variant `culled` takes the planes of smart slicing, placed on the device.
    pub culled_smart: bool,
    /// Receivers cast shadows on one another.
    pub shadows: bool,
    /// The water's surface reflects a part of the light.
    pub fresnel: bool,
    /// Refraction index of water against air, above 1 and at most 4.
    pub refraction_index: f32,
    /// Absorption K of eq. 4-17 per metre, 0 to 1,000,000.
    pub absorption_per_m: f32,
    /// Depth of the pool's floor below the water's level in metres, above 0.
    pub water_depth_m: f32,
    /// The water.
    pub waves: WaveParameters,
    /// A still surface in place of the waves: within 10 m of the water's level, slopes up to 10.
    pub water_map: Option<WaterMap>,
    /// Parallel and point lights, at least one.
    pub lights: Vec<Light>,
    /// Ambient light I_a, linear RGB, at least 0.
    pub ambient: Vec3,
    /// Time between two frames in seconds, at least 0.
    pub time_step_s: f32,
    /// Seed of the waves' directions and phases.
    pub seed: u64,
    /// The eye.
    pub camera: Camera,
    /// Rays of the picture in each pixel, 1 to 64.
    pub samples: u32,
    /// Size of the picture in pixels.
    pub width: u32,
    /// Pixels of the picture.
    pub height: u32,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            planes: 31,
            planes_within_m: None,
            map_size: 512,
            water_triangles: 10_000,
            mrt: true,
            smart: SmartParameters { levels: 100, placement: SmartPlacement::Fitted { epsilon_m: None } },
            coverage: 1,
            intensity: IntensityRule::Face,
            layers: 1,
            cull: CullSteps::EVERY,
            culled_smart: false,
            shadows: false,
            fresnel: false,
            refraction_index: 4.0 / 3.0,
            absorption_per_m: 0.1,
            water_depth_m: 3.0,
            waves: WaveParameters { count: 12, amplitude_m: 0.05, wavelength_m: 1.2 },
            water_map: None,
            lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::splat(1.0) }],
            ambient: Vec3::new(0.10, 0.13, 0.16),
            time_step_s: 1.0 / 30.0,
            seed: 1,
            camera: Parameters::camera_above(3.0),
            samples: 4,
            width: 800,
            height: 600,
        }
    }
}

choice! {
    /// Names of [`SmartPlacement`].
    enum Placement {
        Fitted = ("fitted", "Planes fitted into the sub-boxes of valid levels"),
        Kept = ("kept", "The uniform planes whose cell holds a texel"),
    }
}

const PLACEMENT: Field<Parameters, Placement> = Field {
    get: |p| match p.smart.placement {
        SmartPlacement::Fitted { .. } => Placement::Fitted,
        SmartPlacement::Kept => Placement::Kept,
    },
    set: |p, placement| match placement {
        Placement::Fitted => p.smart.placement = SmartPlacement::Fitted { epsilon_m: None },
        Placement::Kept => p.smart.placement = SmartPlacement::Kept,
    },
};

const EPSILON: Field<Parameters, Option<f32>> = Field {
    get: |p| match p.smart.placement {
        SmartPlacement::Fitted { epsilon_m } => epsilon_m,
        SmartPlacement::Kept => None,
    },
    set: |p, epsilon| {
        if let SmartPlacement::Fitted { epsilon_m } = &mut p.smart.placement {
            *epsilon_m = epsilon;
        }
    },
};

/// The steepest water whose rays and normals still mean something.
const STEEPEST: f32 = 10.0;

fn validate_map(map: &WaterMap) -> Result<(), ParameterError> {
    let (low, high) = map.heights().range_m();
    ParameterError::check(
        low >= -10.0 && high <= 10.0,
        "water-map",
        map.name(),
        &format!("its heights are {low} to {high} m; they must lie within 10 m of the water's level, y = 0"),
    )?;
    let slope = map.steepest_slope();
    ParameterError::check(
        slope <= STEEPEST,
        "water-map",
        map.name(),
        &format!("its slopes may reach {slope}; they must stay below 10: scale its heights down or its spacing up"),
    )
}

impl Parameters {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Parameters>> {
        vec![
            Parameter::new("planes", field!(Parameters.planes))
                .range(Range::from(1.0).to(4096.0))
                .help("Reference (sample) planes of each receiver")
                .section("4.2.1")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("planes-within", field!(Parameters.planes_within_m))
                .range(Range::above(0.0))
                .unit("metres")
                .help(
                    "Distance from the camera to the middle of a receiver within which it has all `planes`; one twice as far \
                     has half of them, by level-map and culled",
                )
                .section("6.1")
                .default_text("all planes at any distance")
                .cost(Cost::Buffers),
            Parameter::new("map-size", field!(Parameters.map_size))
                .range(Range::from(1.0))
                .unit("texel a side")
                .help("Position, caustics and slice maps")
                .section("4.2.2")
                .cost(Cost::Buffers),
            Parameter::new("water-triangles", field!(Parameters.water_triangles))
                .range(Range::from(2.0).to(20e6))
                .help("Triangles of the water's mesh, rounded to whole cells")
                .section("5.2")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("mrt", field!(Parameters.mrt))
                .help(
                    "Position and diffuse map in one pass with two targets (figure 5-6), or in two passes (figure 5-5)",
                )
                .section("5.2.2")
                .cost(Cost::Pipelines),
            Parameter::new("levels", field!(Parameters.smart.levels))
                .range(Range::from(1.0).to(65_536.0))
                .help("Depth levels of smart slicing's profile")
                .section("4.7.2")
                .cost(Cost::Buffers),
            Parameter::new("smart-placement", PLACEMENT)
                .help("Smart slicing: planes fitted into sub-boxes, or the uniform planes whose cell holds a texel")
                .section("4.7.2")
                .cost(Cost::Buffers),
            Parameter::new("epsilon", EPSILON)
                .range(Range::above(0.0))
                .unit("metres")
                .help("Acceptance threshold of smart slicing, no less than that of 4,096 planes")
                .section("eq. 4-22")
                .default_text("h / (2 (planes - 1)), as in table 5-4")
                .cost(Cost::Buffers),
            Parameter::new("coverage", field!(Parameters.coverage))
                .range(Range::from(1.0).to(64.0))
                .unit("texel a side")
                .help(
                    "Texels of the caustics map that are drawn and averaged for each one, by every variant that samples at \
                     texel centres; the thesis's is 1",
                )
                .section("4.5")
                .cost(Cost::Buffers),
            Parameter::new("intensity", field!(Parameters.intensity))
                .help("The intensity of light on a plane: of triangles, as the thesis prints it, or of vertices, interpolated")
                .section("eq. 4-18")
                .cost(Cost::Pipelines),
            Parameter::new("layers", field!(Parameters.layers))
                .range(Range::from(1.0).to(4.0))
                .help("Surfaces of a receiver above one another that the variant hit lights: what the light's box shows, and below")
                .section("6.3")
                .cost(Cost::Buffers),
            Parameter::new("cull", field!(Parameters.cull))
                .help("Steps by which the variant culled finds the pairs of triangle and plane to draw; its light is the same by all of them")
                .section("6.1")
                .cost(Cost::Buffers),
            Parameter::new("smart", field!(Parameters.culled_smart))
                .help("The variant culled takes the planes of smart slicing, placed on the device without a readback")
                .section("6.1")
                .cost(Cost::Buffers),
            Parameter::new("shadows", field!(Parameters.shadows))
                .help("Receivers cast shadows on one another and on the floor, but for the stencil method's; the thesis's do not")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("fresnel", field!(Parameters.fresnel))
                .help("The water's surface reflects a part of the light by Fresnel's equations; the thesis's reflects none"),
            Parameter::new("refraction-index", field!(Parameters.refraction_index))
                .range(Range::above(1.0).to(4.0))
                .help("Refraction index of water against air")
                .section("eq. 2-7")
                .cost(Cost::Buffers),
            Parameter::new("absorption", field!(Parameters.absorption_per_m))
                .range(Range::from(0.0).to(1e6))
                .unit("per metre")
                .help("Absorption K of the water")
                .section("eq. 4-17"),
            Parameter::new("water-depth", field!(Parameters.water_depth_m))
                .range(Range::above(0.0).to(1000.0))
                .unit("metres")
                .help("Depth of the pool")
                .cost(Cost::Buffers),
            Parameter::new("waves", field!(Parameters.waves.count))
                .range(Range::from(0.0).to(64.0))
                .help("Number of sine waves on the water, 0 for flat water")
                .cost(Cost::Buffers),
            Parameter::new("amplitude", field!(Parameters.waves.amplitude_m))
                .range(Range::from(0.0).to(10.0))
                .unit("metres")
                .help("Sum of the waves' amplitudes")
                .cost(Cost::Buffers),
            Parameter::new("wavelength", field!(Parameters.waves.wavelength_m))
                .range(Range::above(0.0).to(1000.0))
                .unit("metres")
                .help("Longest wavelength")
                .cost(Cost::Buffers),
            parameter::size(size_field!(Parameters)),
            Parameter::new("samples", field!(Parameters.samples))
                .range(Range::from(1.0).to(64.0))
                .help("Rays of the finished picture in each pixel; no benchmark contains them")
                .unrecorded(),
            Parameter::new("seed", field!(Parameters.seed))
                .help("Seed of the waves' directions and phases")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("time-step", field!(Parameters.time_step_s))
                .range(Range::from(0.0))
                .unit("seconds")
                .help("Simulated time between two frames")
                .default_text("1/30"),
        ]
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        parameter::check(&Self::declared(), self)?;
        let waves = self.waves;
        ParameterError::check(
            waves.steepest_slope() <= STEEPEST,
            "amplitude",
            waves.amplitude_m,
            "with this `wavelength` the waves are steeper than 10; lower one or raise the other",
        )?;
        if let Some(map) = &self.water_map {
            validate_map(map)?;
        }
        ParameterError::check(!self.lights.is_empty(), "light", "none", "at least one light is needed")?;
        for light in &self.lights {
            self.validate_light(light)?;
        }
        ParameterError::check_camera(&self.camera)
    }

    fn validate_light(&self, light: &Light) -> Result<(), ParameterError> {
        let (name, value) = match *light {
            Light::Parallel { direction, .. } => ("light", components(direction)),
            Light::Point { position, .. } => ("point-light", components(position)),
        };
        let error = |range: &str| Err(ParameterError { name, value: value.clone(), range: range.to_owned() });
        let intensity = match *light {
            Light::Parallel { direction, intensity } => {
                if !direction.is_finite() || direction.normalize_or_zero().y > -0.05 {
                    return error("must shine downwards, at least 3 degrees below the horizon");
                }
                intensity
            }
            Light::Point { position, intensity } => {
                if !position.is_finite() || position.y <= self.crest_m() {
                    return error("must lie above the water");
                }
                intensity
            }
        };
        // The maps hold half floats: a focus a thousand times as bright as this still fits.
        if intensity.is_finite() && intensity.min_element() >= 0.0 && intensity.max_element() <= 64.0 {
            Ok(())
        } else {
            error("must have an intensity of 0 to 64")
        }
    }

    /// True when the camera looks through the water's surface.
    pub fn is_seen_from_above(&self) -> bool {
        self.camera.eye.y > self.crest_m()
    }

    /// The water rises no higher above its level, metres.
    pub fn crest_m(&self) -> f32 {
        self.water_map.as_ref().map_or(self.waves.amplitude_m, |map| map.range_m().1.max(0.0))
    }

    /// The water is nowhere steeper.
    pub fn steepest_slope(&self) -> f32 {
        self.water_map.as_ref().map_or(self.waves.steepest_slope(), WaterMap::steepest_slope)
    }

    /// Planes of a receiver whose middle is at that place: all, or by its distance from the camera.
    pub fn planes_at(&self, middle: Vec3) -> u32 {
        let Some(within_m) = self.planes_within_m else { return self.planes };
        let fraction = f64::from(within_m) / f64::from(self.camera.eye.distance(middle));
        (f64::from(self.planes) * fraction.min(1.0)).ceil().max(1.0) as u32
    }

    /// Width over height of the picture.
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// The camera above the water of a pool of `depth_m`, looking down at its floor.
    pub fn camera_above(depth_m: f32) -> Camera {
        Camera {
            eye: Vec3::new(-1.7, 2.4, 3.6),
            target: Vec3::new(0.0, 0.5 - depth_m, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.65,
            near_m: 0.1,
            far_m: 100.0 + depth_m,
        }
    }

    /// The plain underwater view of a pool of `depth_m`.
    pub fn camera_below(depth_m: f32) -> Camera {
        Camera {
            eye: Vec3::new(-2.2, 2.1 - depth_m, 3.4),
            target: Vec3::new(0.0, 0.55 - depth_m, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.75,
            near_m: 0.1,
            far_m: 100.0,
        }
    }
}

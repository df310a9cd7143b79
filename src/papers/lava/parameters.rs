//! Numbers that a user can set, under the thesis's own words.

use glam::Vec3;

use super::blackbody::HOTTEST_K;
use super::cameras::{self, CAMERAS};
use super::color;
use super::culling::SplatCulling;
use super::deferred::SplatShading;
use super::sph;
use super::sph::parameters::{Flow, Simulation};
use super::splats::SplatShape;
use crate::measure::ParameterError;
use crate::measure::parameter::{self, Cost, Extents, Field, Parameter, Range, Value as _};
pub use crate::papers::tone::Tone;
use crate::scene::Camera;
use crate::{choice, field, named, size_field};

named! {
    /// The methods that are compared: the thesis's, and ours.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Variant: crate::measure::Variant {
        /// Chapters 4 to 8.
        Paper = "paper",
        /// Clusters, densities, accepted points and their sums on the device, without readbacks; ours.
        GpuDriven = "gpu-driven",
    }
}

choice! {
    /// Colour of the splats: the lava, or one of the parts that figures 4.2, 4.3, 6.3, 6.4 and 7.3 show.
    pub enum Shading {
        /// Colour times rock: the finished picture.
        Lava = ("lava", "Colour times rock: the finished picture"),
        /// The calculated colour alone (figures 4.3b and 7.3, left).
        Color = ("color", "The calculated colour alone"),
        /// The rock texture alone.
        Rock = ("rock", "The rock texture alone"),
        /// The normals of the surface as colours (figure 6.4).
        Normals = ("normals", "The normals of the surface as colours"),
        /// The heights of the surface as grey (figures 4.2c and 6.4).
        Heights = ("heights", "The heights of the surface as grey"),
        /// No surface: every particle as a point (figure 5.2).
        Particles = ("particles", "No surface: every particle as a point"),
    }
}

impl Shading {
    /// Its number in `lava/blending.frag`; particles are drawn over its picture.
    pub(super) fn mode(self) -> u32 {
        self as u32
    }
}

choice! {
    /// The height of the surface over a column of grid points.
    pub enum SurfaceKind {
        /// Eq. 6.3 over all accepted points.
        Mean = ("mean", "The thesis's: eq. 6.3 over all accepted points"),
        /// Eq. 6.3 over the highest accepted point of each column.
        Top = ("top", "Eq. 6.3 over the highest accepted point of each column"),
        /// The highest place where the density crosses rho.
        Crossing = ("crossing", "The highest place in each column where the density, linear between planes, is rho"),
    }
}

choice! {
    /// Drawing of the surface in stage three.
    pub enum SurfaceDraw {
        /// Splats, blended (chapter 7).
        Splats = ("splats", "The thesis's: splats, blended"),
        /// A ray for each pixel against the height field.
        March = ("march", "A ray for each pixel against the height field, without stair-steps and saw-teeth"),
    }
}

/// Every number of a configuration, in the ranges of [`Parameters::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Size of the simulation space along x (the flow), y (up) and z in metres, each above 0 and at most 1000.
    pub space_m: Vec3,
    /// Number of particles, 1 to 16,777,216.
    pub particles: u32,
    /// Effective radius h of a particle in metres, above 0, at most the shortest side of the space.
    pub radius_m: f32,
    /// Grid points along x, grid planes along y, grid points along z; each at least 1, 67,108,864 in all at most.
    pub density: [u32; 3],
    /// Density that a grid point must reach to be accepted, above 0; without one, the mean density.
    pub rho: Option<f32>,
    /// Height of the surface over a column of grid points.
    pub surface: SurfaceKind,
    /// Drawing of the surface; without one, the variant's own.
    pub surface_draw: Option<SurfaceDraw>,
    /// Splats along x and z, each at least 1, 16,777,216 in all at most.
    pub splats: [u32; 2],
    /// Radius of a splat in metres, above 0, at most the shortest side of the space.
    pub splat_radius_m: f32,
    /// Outline of a splat.
    pub splat_shape: SplatShape,
    /// Place of the colours of splats.
    pub splat_shading: SplatShading,
    /// Splats that are left out.
    pub culling: SplatCulling,
    /// Depth behind the nearest splat within which a fragment is blended, metres (eq. 7.1), above 0 and at most 1000.
    pub epsilon_m: f32,
    /// Distance from the borders in metres over which the height sinks to 0, 0 to 1000.
    pub border_m: f32,
    /// Motion of the particles.
    pub simulation: Simulation,
    /// The fluid of [`Simulation::Sph`].
    pub flow: Flow,
    /// Mean speed of the flow along x in metres per second, 0 to 1000.
    pub speed_m_s: f32,
    /// The constant orange of section 7.2 in the display's RGB, each 0 to 1000.
    pub color: Vec3,
    /// Black bodies' colours instead, by temperature.
    pub is_blackbody: bool,
    /// Temperatures at the floor and at the top of the space, kelvin, 1 to 10,000; [`TEMPERATURES_K`] without.
    pub temperatures_k: Option<[f32; 2]>,
    /// Factor of the colours of lava and objects, above 0 and at most 1000.
    pub exposure: f32,
    /// Factor of the daylight on objects, on a fluid and on its ground, 0 to 1000.
    pub daylight: f32,
    /// Share of the daylight that a fluid's skin mirrors, 0 to 1.
    pub gloss: f32,
    /// Tone mapping of values brighter than the display.
    pub tone: Tone,
    /// Side of the square that the rock texture covers once in metres, above 0 and at most 1000.
    pub rock_tile_m: f32,
    /// Colour of the splats.
    pub shading: Shading,
    /// Splats by a geometry stage, as in the thesis; as instanced quads without it.
    pub geometry_stage: bool,
    /// Time between two frames in seconds, 0 to 1000.
    pub time_step_s: f32,
    /// Seed of the particles.
    pub seed: u64,
    /// The viewer, metres.
    pub camera: Camera,
    /// Width of the picture in pixels, at least 1.
    pub width: u32,
    /// Height of the picture in pixels, at least 1.
    pub height: u32,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            space_m: Vec3::new(4.0, 1.0, 1.0),
            particles: 40_000,
            radius_m: 0.08,
            density: [100, 24, 24],
            rho: None,
            surface: SurfaceKind::Mean,
            surface_draw: None,
            splats: [600, 150],
            splat_radius_m: 0.020625,
            splat_shape: SplatShape::Disc,
            splat_shading: SplatShading::Gouraud,
            culling: SplatCulling::Off,
            epsilon_m: 0.05,
            border_m: 0.2,
            simulation: Simulation::Free,
            flow: Flow::default(),
            speed_m_s: 0.2,
            color: Vec3::new(2.5, 1.2, 0.28),
            is_blackbody: false,
            temperatures_k: None,
            exposure: 1.0,
            daylight: 1.0,
            gloss: 0.0,
            tone: Tone::Shoulder,
            rock_tile_m: 2.0,
            shading: Shading::Lava,
            geometry_stage: true,
            time_step_s: 1.0 / 30.0,
            seed: 1,
            camera: CAMERAS[0].1,
            width: 800,
            height: 600,
        }
    }
}

/// Eruption of a pahoehoe, 1,150 degrees Celsius (section 3.2), and the end of bright orange and dark red, 800 (section
/// 3.1): kelvin.
const TEMPERATURES_K: [f32; 2] = [1423.0, 1073.0];

const SPACE: Field<Parameters, Extents<f32, 3>> =
    Field { get: |p| Extents(p.space_m.to_array()), set: |p, space| p.space_m = Vec3::from(space.0) };
const DENSITY: Field<Parameters, Extents<u32, 3>> =
    Field { get: |p| Extents(p.density), set: |p, density| p.density = density.0 };
const SPLATS: Field<Parameters, Extents<u32, 2>> =
    Field { get: |p| Extents(p.splats), set: |p, splats| p.splats = splats.0 };

impl Parameters {
    /// The numbers of figures 5.1, 5.2 and 6.2.
    pub fn of_figure_6_2() -> Self {
        Parameters { particles: 65_536, radius_m: 0.1, density: [512, 32, 128], ..Parameters::default() }
    }

    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Parameters>> {
        let up_to_1000 = Range::above(0.0).to(1000.0);
        let flow = Flow::declared().into_iter().map(|p| p.inside(|s: &Self| &s.flow, |s| &mut s.flow));
        let numbers = vec![
            Parameter::new("space", SPACE)
                .placeholder("XxYxZ")
                .range(up_to_1000)
                .unit("metres")
                .help("Sides of the simulation space along x (the flow), y (up) and z")
                .section("5.1")
                .cost(Cost::Buffers),
            Parameter::new("particles", field!(Parameters.particles))
                .range(Range::from(1.0).to(16_777_216.0))
                .help("Number of particles")
                .section("5.1")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("radius", field!(Parameters.radius_m))
                .range(Range::above(0.0))
                .unit("metres")
                .help("Effective radius h of a particle, at most the shortest side of the space")
                .section("eq. 6.2")
                .cost(Cost::Buffers),
            Parameter::new("density", DENSITY)
                .placeholder("XxYxZ")
                .range(Range::from(1.0))
                .help("Grid points along x, grid planes along y, grid points along z; 67108864 in all at most")
                .section("6.1")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("rho", field!(Parameters.rho))
                .range(Range::above(0.0))
                .help("Density that a grid point must reach to be accepted")
                .section("6.2")
                .default_text("the particles' mean density")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("surface", field!(Parameters.surface))
                .help("Height of the surface over a column of grid points")
                .section("6.2")
                .cost(Cost::Buffers),
            Parameter::new("surface-draw", field!(Parameters.surface_draw))
                .help("Drawing of the surface")
                .section("7")
                .default_text("splats; in `gpu-driven` march")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("splats", SPLATS)
                .placeholder("XxZ")
                .range(Range::from(1.0))
                .help("Splats along x and z; 16777216 in all at most")
                .section("7.1")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("splat-radius", field!(Parameters.splat_radius_m))
                .range(Range::above(0.0))
                .unit("metres")
                .help("Radius of a splat, at most the shortest side of the space")
                .section("7.1"),
            Parameter::new("splat-shape", field!(Parameters.splat_shape)).help("Outline of a splat").section("9"),
            Parameter::new("splat-shading", field!(Parameters.splat_shading))
                .help("Splats' colours blended, or one for each pixel")
                .section("9")
                .cost(Cost::Pipelines),
            Parameter::new("culling", field!(Parameters.culling))
                .help("Splats that are left out without a change to the picture")
                .section("9")
                .cost(Cost::Pipelines),
            Parameter::new("epsilon", field!(Parameters.epsilon_m))
                .range(up_to_1000)
                .unit("metres")
                .help("Depth behind the nearest splat within which another one is blended")
                .section("eq. 7.1"),
            Parameter::new("border", field!(Parameters.border_m))
                .range(Range::from(0.0).to(1000.0))
                .unit("metres")
                .help("Distance from the borders over which the surface falls off")
                .section("6.4")
                .cost(Cost::Buffers),
            Parameter::new("simulation", field!(Parameters.simulation))
                .help("Motion of the particles")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("speed", field!(Parameters.speed_m_s))
                .range(Range::from(0.0).to(1000.0))
                .unit("metres per second")
                .help("Mean speed of the flow")
                .section("5.1")
                .cost(Cost::Buffers),
            Parameter::new("color", color::FIELD)
                .range(Range::from(0.0).to(1000.0))
                .help(
                    "The constant orange as the display takes it, red, green, blue; or a black body's, by temperature",
                )
                .section("7.2"),
            Parameter::new("temperatures", field!(Parameters.temperatures_k))
                .placeholder("FLOOR,TOP")
                .range(Range::from(1.0).to(f64::from(HOTTEST_K)))
                .unit("kelvin")
                .help("Temperatures of a black body's colour at the floor and at the top of the space, where particles carry none")
                .section("9")
                .default_text("1423,1073 with a black body's colour")
                .unrecorded(),
            Parameter::new("exposure", field!(Parameters.exposure))
                .range(up_to_1000)
                .help("Factor of the colours of lava and objects"),
            Parameter::new("daylight", field!(Parameters.daylight))
                .range(Range::from(0.0).to(1000.0))
                .help("Factor of the daylight on objects, on a fluid and on its ground: 1 is beside glowing lava as bright as dusk, 0 night"),
            Parameter::new("gloss", field!(Parameters.gloss))
                .range(Range::from(0.0).to(1.0))
                .help("With sph: share of the daylight that the skin of the lava mirrors: the glass of fresh pahoehoe")
                .section("3.2"),
            Parameter::new("tone", field!(Parameters.tone)).help("Tone mapping of values brighter than the display"),
            Parameter::new("rock-tile", field!(Parameters.rock_tile_m))
                .range(up_to_1000)
                .unit("metres")
                .help("Side of the square that the rock covers once")
                .section("7.2"),
            Parameter::new("shading", field!(Parameters.shading))
                .help("Colour of the splats, or the particles in their place")
                .cost(Cost::Pipelines),
            Parameter::new("geometry-stage", field!(Parameters.geometry_stage))
                .help("Splats by a geometry stage, as in the thesis, or as instanced quads")
                .section("7.1")
                .cost(Cost::Pipelines),
            Parameter::new("camera", cameras::FIELD)
                .help("Camera: fig-8.1, fig-8.2, fig-8.3, fig-8.4, or eye and target x,y,z,x,y,z in metres")
                .everyday(),
            parameter::size(size_field!(Parameters)),
            Parameter::new("seed", field!(Parameters.seed))
                .help("Seed of the particles")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("time-step", field!(Parameters.time_step_s))
                .range(Range::from(0.0).to(1000.0))
                .unit("seconds")
                .help("Simulated time between two frames")
                .default_text("1/30")
                .cost(Cost::Buffers),
        ];
        numbers.into_iter().chain(flow).collect()
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        parameter::check(&Self::declared(), self)?;
        let shortest = self.space_m.min_element();
        for (name, radius_m) in [("radius", self.radius_m), ("splat-radius", self.splat_radius_m)] {
            let range = format!("must be above 0 and at most {shortest} metres, the shortest side of the space");
            ParameterError::check(radius_m <= shortest, name, radius_m, &range)?;
        }
        let points = self.density.map(u64::from).into_iter().try_fold(1u64, u64::checked_mul);
        ParameterError::check(
            points.is_some_and(|points| points <= 67_108_864),
            "density",
            Extents(self.density).text(),
            "must have at most 67108864 grid points in all",
        )?;
        let rho = self.rho();
        let range = "must be above 0; the default is the mean density of the particles";
        ParameterError::check(rho > 0.0 && rho.is_finite(), "rho", rho, range)?;
        ParameterError::check(
            u64::from(self.splats[0]) * u64::from(self.splats[1]) <= 16_777_216,
            "splats",
            Extents(self.splats).text(),
            "must be at most 16777216 in all",
        )?;
        sph::check::check(self)?;
        ParameterError::check_camera(&self.camera)
    }

    /// Temperatures of free particles' colour at the floor and at the top of the space, kelvin.
    pub fn temperatures_k(&self) -> [f32; 2] {
        self.temperatures_k.unwrap_or(TEMPERATURES_K)
    }

    /// The hottest of a black body's colours, kelvin: what is exposed as it comes. A fluid's is its temperature at the start.
    pub fn hottest_k(&self) -> f32 {
        match self.simulation {
            Simulation::Free => self.temperatures_k().into_iter().fold(0.0, f32::max),
            Simulation::Sph => self.flow.heat.melt_k,
        }
    }

    /// Drawing of the surface in a variant.
    pub fn surface_draw(&self, variant: Variant) -> SurfaceDraw {
        self.surface_draw.unwrap_or(match variant {
            Variant::Paper => SurfaceDraw::Splats,
            Variant::GpuDriven => SurfaceDraw::March,
        })
    }

    /// The accepted density: the one given, or the mean of eq. 6.2 summed over particles that fill the space evenly,
    /// 4 pi N / V times the integral of F(r, h) r^2 from 0 to h, which is 0.14057 N h^2 / V. A fluid fills no space: half of
    /// the mean inside it, which is what a level surface has.
    pub fn rho(&self) -> f32 {
        self.rho.unwrap_or_else(|| {
            let (filled_m, factor) = match self.simulation {
                Simulation::Free => (self.space_m, 1.0),
                Simulation::Sph => (self.flow.block_m, 0.5),
            };
            let [x, y, z] = filled_m.as_dvec3().to_array();
            let h = f64::from(self.radius_m);
            // 405 / 187 times (1/3 - 22/45 + 17/63 - 4/81).
            let integral = 405.0 / 187.0 * (1.0 / 3.0 - 22.0 / 45.0 + 17.0 / 63.0 - 4.0 / 81.0);
            (factor * integral * f64::from(self.particles) * h * h / (x * y * z)) as f32
        })
    }

    /// Eq. 6.1: the size of a particle's point in grid points.
    pub fn point_size_px(&self) -> f32 {
        let [columns, _, rows] = self.density;
        let across = 2.0 * self.radius_m / self.space_m.x * columns as f32;
        let along = 2.0 * self.radius_m / self.space_m.z * rows as f32;
        across.max(along)
    }

    /// Clusters of four grid planes each; the last may hold fewer.
    pub fn clusters(&self) -> u32 {
        self.density[1].div_ceil(4)
    }

    /// Height of grid plane `j` in metres.
    pub fn plane_height_m(&self, j: u32) -> f32 {
        (j as f32 + 0.5) / self.density[1] as f32 * self.space_m.y
    }

    /// Width over height of the picture.
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

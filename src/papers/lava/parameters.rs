//! What a user can set, under the thesis's own words.

use glam::Vec3;

use crate::measure::{ParameterError, components};
use crate::scene::Camera;

/// The methods that are compared: the thesis has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variant {
    /// Chapters 4 to 8.
    Paper,
}

impl crate::measure::Variant for Variant {
    const ALL: &'static [Variant] = &[Variant::Paper];

    fn as_str(self) -> &'static str {
        "paper"
    }
}

/// A configuration that the thesis names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Preset {
    /// Chapter 8: figures 8.1 to 8.4, and the 20 frames a second.
    Results,
    /// Figures 5.1, 5.2 and 6.2: 65,536 particles, a finer grid.
    Fig62,
    /// Figure 8.5: `Results` with four splat sizes, of which the two smallest leave holes.
    Fig85,
}

impl Preset {
    pub const ALL: [Preset; 3] = [Preset::Results, Preset::Fig62, Preset::Fig85];

    pub fn as_str(self) -> &'static str {
        match self {
            Preset::Results => "results",
            Preset::Fig62 => "fig-6.2",
            Preset::Fig85 => "fig-8.5",
        }
    }

    /// Its configurations: four for figure 8.5, in the order of the figure, else one.
    pub fn configurations(self) -> Vec<Parameters> {
        match self {
            Preset::Results => vec![Parameters::default()],
            Preset::Fig62 => {
                vec![Parameters { particles: 65_536, radius_m: 0.1, density: [512, 32, 128], ..Parameters::default() }]
            }
            Preset::Fig85 => [0.001875, 0.004375, 0.008125, 0.020625]
                .map(|splat_radius_m| Parameters { splat_radius_m, ..Parameters::default() })
                .to_vec(),
        }
    }
}

/// What the splats are coloured by: the lava, or one of the parts that figures 4.2, 4.3, 6.3, 6.4 and 7.3 show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Colour times rock: the finished picture.
    Lava,
    /// The calculated colour alone (figures 4.3b and 7.3, left).
    Color,
    /// The rock texture alone.
    Rock,
    /// The normals of the surface as colours (figure 6.4).
    Normals,
    /// The heights of the surface as grey (figures 4.2c and 6.4).
    Heights,
    /// No surface: every particle as a point (figure 5.2).
    Particles,
}

impl Shading {
    pub const ALL: [Shading; 6] =
        [Shading::Lava, Shading::Color, Shading::Rock, Shading::Normals, Shading::Heights, Shading::Particles];

    pub fn as_str(self) -> &'static str {
        match self {
            Shading::Lava => "lava",
            Shading::Color => "color",
            Shading::Rock => "rock",
            Shading::Normals => "normals",
            Shading::Heights => "heights",
            Shading::Particles => "particles",
        }
    }

    /// As `lava/blending.frag` numbers it; particles are drawn over its picture.
    pub(super) fn mode(self) -> u32 {
        self as u32
    }
}

/// Every number of a configuration. [`Parameters::validate`] checks the ranges given here.
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
    /// Splats along x and z, each at least 1, 16,777,216 in all at most.
    pub splats: [u32; 2],
    /// Radius of a splat in metres, above 0, at most the shortest side of the space.
    pub splat_radius_m: f32,
    /// How far behind the nearest a fragment is blended in metres (eq. 7.1), above 0 and at most 1000.
    pub epsilon_m: f32,
    /// Distance from the borders in metres over which the height sinks to 0, 0 to 1000.
    pub border_m: f32,
    /// Mean speed of the flow along x in metres per second, 0 to 1000.
    pub speed_m_s: f32,
    /// The constant orange of section 7.2 in the display's RGB, each 0 to 1000.
    pub color: Vec3,
    /// Side of the square that the rock texture covers once in metres, above 0 and at most 1000.
    pub rock_tile_m: f32,
    pub shading: Shading,
    /// Splats by a geometry stage, as in the thesis; as instanced quads without it.
    pub geometry_stage: bool,
    /// Time between two frames in seconds, 0 to 1000.
    pub time_step_s: f32,
    pub seed: u64,
    pub camera: Camera,
    /// Size of the picture in pixels, at least 1 x 1.
    pub width: u32,
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
            splats: [600, 150],
            splat_radius_m: 0.020625,
            epsilon_m: 0.05,
            border_m: 0.2,
            speed_m_s: 0.2,
            color: Vec3::new(2.5, 1.2, 0.28),
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

/// Our cameras for the four views of chapter 8; the thesis prints no positions.
pub const CAMERAS: [(&str, Camera); 4] = [
    ("fig-8.1", camera(Vec3::new(-0.7, 3.1, 2.4), Vec3::new(1.65, 0.05, 0.5))),
    ("fig-8.2", camera(Vec3::new(2.0, 3.9, 2.2), Vec3::new(2.0, 0.2, 0.6))),
    ("fig-8.3", camera(Vec3::new(5.0, 2.2, 0.5), Vec3::new(3.0, 0.1, 0.5))),
    ("fig-8.4", camera(Vec3::new(1.4, 1.9, 1.2), Vec3::new(1.9, 0.3, 0.5))),
];

const fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, vertical_fov_rad: 0.75, near_m: 0.05, far_m: 20.0 }
}

/// Above 0 and at most `highest`; not for NaN.
fn is_positive(value: f32, highest: f32) -> bool {
    value > 0.0 && value <= highest
}

impl Parameters {
    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let space = self.space_m;
        let good = space.to_array().into_iter().all(|side| is_positive(side, 1000.0));
        let sides = space.to_array().map(|c| c.to_string()).join("x");
        ParameterError::check(good, "--space", sides, "each side must be above 0 and at most 1000 metres")?;
        let shortest = space.min_element();
        let within = format!("must be above 0 and at most {shortest} metres, the shortest side of the space");

        let good = (1..=16_777_216).contains(&self.particles);
        ParameterError::check(good, "--particles", self.particles, "must be 1 to 16777216")?;
        ParameterError::check(is_positive(self.radius_m, shortest), "--radius", self.radius_m, &within)?;
        let points = self.density.map(u64::from).into_iter().try_fold(1u64, u64::checked_mul);
        ParameterError::check(
            points.is_some_and(|points| (1..=67_108_864).contains(&points)),
            "--density",
            self.density.map(|n| n.to_string()).join("x"),
            "needs at least 1 grid point along x, y and z and at most 67108864 in all",
        )?;
        let rho = self.rho();
        let range = "must be above 0; the default is the mean density of the particles";
        ParameterError::check(is_positive(rho, f32::MAX), "--rho", rho, range)?;
        let splats = u64::from(self.splats[0]) * u64::from(self.splats[1]);
        ParameterError::check(
            (1..=16_777_216).contains(&splats),
            "--splats",
            self.splats.map(|n| n.to_string()).join("x"),
            "needs at least 1 splat along x and z and at most 16777216 in all",
        )?;
        ParameterError::check(
            is_positive(self.splat_radius_m, shortest),
            "--splat-radius",
            self.splat_radius_m,
            &within,
        )?;
        let metres = "must be above 0 and at most 1000 metres";
        ParameterError::check(is_positive(self.epsilon_m, 1000.0), "--epsilon", self.epsilon_m, metres)?;
        ParameterError::check(
            (0.0..=1000.0).contains(&self.border_m),
            "--border",
            self.border_m,
            "must be 0 to 1000 metres",
        )?;
        let good = (0.0..=1000.0).contains(&self.speed_m_s);
        ParameterError::check(good, "--speed", self.speed_m_s, "must be 0 to 1000 metres per second")?;
        let good = self.color.to_array().into_iter().all(|c| (0.0..=1000.0).contains(&c));
        ParameterError::check(
            good,
            "--color",
            components(self.color),
            "each of red, green and blue must be 0 to 1000",
        )?;
        ParameterError::check(is_positive(self.rock_tile_m, 1000.0), "--rock-tile", self.rock_tile_m, metres)?;
        let good = (0.0..=1000.0).contains(&self.time_step_s);
        ParameterError::check(good, "--time-step", self.time_step_s, "must be 0 to 1000 seconds")?;
        ParameterError::check_size(self.width, self.height)?;
        ParameterError::check_camera(&self.camera)
    }

    /// The accepted density: the one given, or the mean of eq. 6.2 summed over particles that fill the space evenly,
    /// 4 pi N / V times the integral of F(r, h) r^2 from 0 to h, which is 0.14057 N h^2 / V.
    pub fn rho(&self) -> f32 {
        self.rho.unwrap_or_else(|| {
            let [x, y, z] = self.space_m.as_dvec3().to_array();
            let h = f64::from(self.radius_m);
            // 405 / 187 times (1/3 - 22/45 + 17/63 - 4/81).
            let integral = 405.0 / 187.0 * (1.0 / 3.0 - 22.0 / 45.0 + 17.0 / 63.0 - 4.0 / 81.0);
            (integral * f64::from(self.particles) * h * h / (x * y * z)) as f32
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

//! What a user can set, under the dissertation's own words.

use std::sync::Arc;

use glam::Vec3;

use super::texture::Texture;
use crate::measure::ParameterError;
use crate::measure::components;
use crate::scene::Camera;

/// The methods, one a chapter, numbered as `burning/constants.glsl` does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variant {
    /// Chapter 3: a dense shell.
    Shell,
    /// Chapter 4: few triangles, refined where they burn.
    LowPoly,
    /// What chapter 4 is compared with: every triangle subdivided before the fire.
    FullySubdivided,
    /// Chapter 5: burns inward.
    Solid,
    /// Chapter 6: flows.
    Melting,
}

impl crate::measure::Variant for Variant {
    const ALL: &'static [Variant] =
        &[Variant::Shell, Variant::LowPoly, Variant::FullySubdivided, Variant::Solid, Variant::Melting];

    fn as_str(self) -> &'static str {
        match self {
            Variant::Shell => "shell",
            Variant::LowPoly => "low-poly",
            Variant::FullySubdivided => "fully-subdivided",
            Variant::Solid => "solid",
            Variant::Melting => "melting",
        }
    }
}

impl Variant {
    /// Whether the triangles are refined where they are about to burn: 4, and the larger triangles of 5 and 6.
    pub fn refines(self) -> bool {
        matches!(self, Variant::LowPoly | Variant::Solid | Variant::Melting)
    }

    /// Whether consumed triangles leave the drawn stream (3.5.4); a solid's and a melting object's stay.
    pub fn removes(self) -> bool {
        matches!(self, Variant::Shell | Variant::LowPoly | Variant::FullySubdivided)
    }
}

/// What the surface is made of, to the eye.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Material {
    /// The albedo alone.
    Plain,
    /// The albedo with the rings of a tree around a vertical axis.
    Wood,
}

impl Material {
    pub const ALL: [Material; 2] = [Material::Plain, Material::Wood];

    pub fn as_str(self) -> &'static str {
        match self {
            Material::Plain => "plain",
            Material::Wood => "wood",
        }
    }
}

/// The quantity that colours the mesh, numbered as `burning/view.glsl` does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Lit, charred and glowing: the finished picture.
    Lit,
    /// The areas of the heat boundary (figures 3.3, 4.3, 5.3, 5.4).
    Areas,
    /// The blocks (figure 3.5).
    Blocks,
    /// Normals as colours.
    Normals,
    /// Lit, with the edges of the drawn triangles (figures 4.2, 4.4).
    Wire,
}

impl Shading {
    pub const ALL: [Shading; 5] = [Shading::Lit, Shading::Areas, Shading::Blocks, Shading::Normals, Shading::Wire];

    pub fn as_str(self) -> &'static str {
        match self {
            Shading::Lit => "lit",
            Shading::Areas => "areas",
            Shading::Blocks => "blocks",
            Shading::Normals => "normals",
            Shading::Wire => "wire",
        }
    }
}

/// Ticks of the simulation in a second.
pub const TICKS_PER_S: f64 = 60.0;

/// Every number of a configuration. The object is scaled to a diagonal of 1, so lengths are shares of the diagonal.
/// [`Parameters::validate`] checks the ranges given here.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Subdivisions of a coarse triangle into 4^levels, 0 to 5; without, the variant's own (see [`Parameters::edge`]).
    pub levels: Option<u32>,
    /// `solid` and `melting` subdivide until no edge is longer, above 0 and at most 1.
    pub edge: f32,
    /// Where the fire starts, in the scaled object's space (base centred at the origin), at most 16; without, the lowest
    /// vertex, and for `melting` the highest.
    pub sources: Vec<Vec3>,
    /// psi of the boundary, above 0 and at most 100: the heat index of 3.3.
    pub psi: f32,
    /// Growth of the boundary's radius a second, above 0 and at most 10.
    pub speed_per_s: f32,
    /// w, width of an area of the boundary, above 0 and at most 1.
    pub width_of_areas: f32,
    /// L of table 3.1, an integer, 1 to 1,000,000.
    pub flammability: u32,
    /// epsilon of table 3.1, above 0 and below 1.
    pub epsilon: f32,
    /// beta of table 3.1, above 0 and below 1.
    pub beta: f32,
    /// rho of table 3.1, above 0 and below 1.
    pub rho: f32,
    /// phi of table 3.1, above 0 and below 1.
    pub phi: f32,
    /// gamma of eq. 4, above 0 and below 1.
    pub gamma: f32,
    /// x of 3.5.2: a neighbour's share of a block's rotation, above 0 and below 1.
    pub spread: f32,
    /// omega of table 6.1, above 0 and below 1.
    pub omega: f32,
    /// chi of table 6.1, 2 to 1000.
    pub chi: f32,
    /// upsilon of table 6.1, above 0 and below 1.
    pub upsilon: f32,
    /// Height that nothing melts below, -10 to 1; without, the object's base.
    pub floor: Option<f32>,
    /// Share of L at which a vertex of a solid leaves the deforming group (5.5), 0 (never) to below 1.
    pub retire_at: f32,
    /// Blocks along x, y and z, each 1 to 256, 1,048,576 in all at most.
    pub blocks: [u32; 3],
    /// The boundary halts while more vertices than this are active (3.7.1); 0 never halts it.
    pub active_limit: u32,
    /// Frames that one tick is spread over (3.7.2), 1 to 64.
    pub time_division: u32,
    /// Loads what never changes before the first frame (3.7.4), not in every frame.
    pub preload: bool,
    /// Keeps what holds a neighbouring block to the rest (3.5.4).
    pub keep_connected: bool,
    /// Most fire particles, 0 to 1,000,000.
    pub fire: u32,
    /// Most smoke particles, 0 to 1,000,000.
    pub smoke: u32,
    /// Radius of a particle, above 0 and at most 1.
    pub particle_radius: f32,
    /// Finest level that is drawn, 0 to 5; without, by the distance of the camera (4.5).
    pub level_of_detail: Option<u32>,
    pub material: Material,
    /// Covers the object in place of the material; the mesh must have texture coordinates.
    pub texture: Option<Arc<Texture>>,
    /// Linear RGB, 0 to 1; a factor of the texture.
    pub albedo: Vec3,
    pub shading: Shading,
    /// Without, the object fills 80 % of the picture's height.
    pub camera: Option<Camera>,
    /// Time between two frames in seconds, 0 to 10.
    pub time_step_s: f64,
    /// The simulation's frame that frame 0 shows, 0 to 100,000.
    pub first_frame: u32,
    pub seed: u64,
    /// Size of the picture in pixels, at least 1 x 1.
    pub width: u32,
    pub height: u32,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            levels: None,
            edge: 0.1,
            sources: Vec::new(),
            psi: 1.0,
            speed_per_s: 0.05,
            width_of_areas: 0.04,
            flammability: 60,
            epsilon: 0.1,
            beta: 0.05,
            rho: 0.5,
            phi: 0.5,
            gamma: 0.1,
            spread: 0.5,
            omega: 0.8,
            chi: 4.0,
            upsilon: 0.2,
            floor: None,
            retire_at: 0.0,
            blocks: [6, 7, 8],
            active_limit: 0,
            time_division: 1,
            preload: true,
            keep_connected: true,
            fire: 3000,
            smoke: 1800,
            particle_radius: 0.02,
            level_of_detail: None,
            material: Material::Wood,
            texture: None,
            albedo: Vec3::new(0.36, 0.17, 0.07),
            shading: Shading::Lit,
            camera: None,
            time_step_s: 1.0 / TICKS_PER_S,
            first_frame: 0,
            seed: 1,
            width: 800,
            height: 600,
        }
    }
}

impl Parameters {
    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let check = |is_good, name, value: &dyn ToString, range: &str| {
            ParameterError::check(is_good, name, value.to_string(), range)
        };
        // Table 3.1: the first is an integer, the rest are real numbers between zero and one.
        let flammability = self.flammability;
        check((1..=1_000_000).contains(&flammability), "--flammability", &flammability, "must be 1 to 1000000")?;
        let shares = [
            ("--epsilon", self.epsilon),
            ("--beta", self.beta),
            ("--rho", self.rho),
            ("--phi", self.phi),
            ("--gamma", self.gamma),
            ("--spread", self.spread),
            ("--omega", self.omega),
            ("--upsilon", self.upsilon),
        ];
        for (name, value) in shares {
            check(value > 0.0 && value < 1.0, name, &value, "must be above 0 and below 1")?;
        }
        check((2.0..=1000.0).contains(&self.chi), "--chi", &self.chi, "must be 2 to 1000")?;
        let positive = [
            ("--psi", self.psi, 100.0),
            ("--speed", self.speed_per_s, 10.0),
            ("--area-width", self.width_of_areas, 1.0),
            ("--edge", self.edge, 1.0),
            ("--particle-radius", self.particle_radius, 1.0),
        ];
        for (name, value, most) in positive {
            check(value > 0.0 && value <= most, name, &value, &format!("must be above 0 and at most {most}"))?;
        }
        let at = self.retire_at;
        check((0.0..1.0).contains(&at), "--retire-at", &at, "must be 0 to below 1")?;
        if let Some(floor) = self.floor {
            check((-10.0..=1.0).contains(&floor), "--floor", &floor, "must be -10 to 1")?;
        }
        for (name, level) in [("--levels", self.levels), ("--lod", self.level_of_detail)] {
            check(level.is_none_or(|l| l <= 5), name, &level.unwrap_or(0), "must be 0 to 5")?;
        }
        let sources = self.sources.len();
        check(sources <= 16, "--source", &sources, "there are at most 16 sources")?;
        for source in &self.sources {
            let is_good = source.to_array().iter().all(|c| c.abs() <= 1000.0);
            check(is_good, "--source", &components(*source), "each of x, y and z must be -1000 to 1000")?;
        }
        let blocks = self.blocks;
        let is_good = blocks.iter().all(|b| (1..=256).contains(b)) && blocks.iter().product::<u32>() <= 1 << 20;
        let text = blocks.map(|b| b.to_string()).join("x");
        check(is_good, "--blocks", &text, "must be 1 to 256 along x, y and z, and at most 1048576 in all")?;
        let division = self.time_division;
        check((1..=64).contains(&division), "--time-division", &division, "must be 1 to 64 frames")?;
        for (name, count) in [("--fire", self.fire), ("--smoke", self.smoke)] {
            check(count <= 1_000_000, name, &count, "must be 0 to 1000000 particles")?;
        }
        let is_color = self.albedo.to_array().iter().all(|c| (0.0..=1.0).contains(c));
        check(is_color, "--albedo", &components(self.albedo), "each of red, green and blue must be 0 to 1")?;
        let step = self.time_step_s;
        check((0.0..=10.0).contains(&step), "--time-step", &step, "must be 0 to 10 seconds")?;
        check(self.first_frame <= 100_000, "--first-frame", &self.first_frame, "must be 0 to 100000")?;
        ParameterError::check_size(self.width, self.height)?;
        self.camera.as_ref().map_or(Ok(()), ParameterError::check_camera)
    }

    /// Slices of ticks that are due after frame `number`, counted from the start of the simulation: one a tick without
    /// [`Parameters::time_division`], which makes each frame's share of a tick that much smaller.
    pub fn slices_due(&self, number: u32) -> u64 {
        let frames = f64::from(self.first_frame) + f64::from(number) + 1.0;
        // A step of a 60th, as typed, is a little short or long of a tick; no frame may miss its own for that.
        (frames * self.time_step_s * TICKS_PER_S + 1e-4) as u64
    }

    /// Slices that were due before frame 0.
    pub fn slices_before(&self) -> u64 {
        (f64::from(self.first_frame) * self.time_step_s * TICKS_PER_S + 1e-4) as u64
    }

    /// Mixes the seed into the 32 bits that the hashes take.
    pub fn noise_seed(&self) -> u32 {
        (self.seed ^ (self.seed >> 32)) as u32
    }

    /// Width over height of the picture.
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

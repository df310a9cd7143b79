//! The parameters, under the dissertation's own words.

use std::sync::Arc;

use glam::Vec3;

pub use super::choices::{Heat, Look, Material, Shading, SmokeAs};
use super::framing::seen_from;
use super::level_of_detail::LevelOfDetail;
use super::materials::Materials;
use super::texture::Texture;
use crate::measure::ParameterError;
use crate::measure::parameter::{self, Cost, Extents, EyeAndTarget, Field, Parameter, Range, Value};
use crate::papers::tone::Tone;
use crate::scene::Camera;
use crate::{field, named, size_field};

named! {
    /// The methods, one a chapter.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Variant: crate::measure::Variant {
        /// Chapter 3: a dense shell.
        Shell = "shell",
        /// Chapter 4: few triangles, refined where they burn.
        LowPoly = "low-poly",
        /// Chapter 4's baseline: every triangle subdivided before the fire.
        FullySubdivided = "fully-subdivided",
        /// Chapter 5: burns inward.
        Solid = "solid",
        /// Chapter 6: flows.
        Melting = "melting",
    }
}

impl Variant {
    /// True where the triangles are refined as they are about to burn: 4, and the larger triangles of 5 and 6.
    pub fn refines(self) -> bool {
        matches!(self, Variant::LowPoly | Variant::Solid | Variant::Melting)
    }

    /// True where consumed triangles leave the drawn stream (3.5.4); in the text a solid's and a melting object's stay.
    pub fn removes(self) -> bool {
        matches!(self, Variant::Shell | Variant::LowPoly | Variant::FullySubdivided)
    }
}

/// Ticks of the simulation in a second.
pub const TICKS_PER_S: f64 = 60.0;

/// Every number of a configuration, in the ranges of [`Parameters::declared`]. The object is scaled to a diagonal of 1,
/// which is the unit of length.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Subdivisions of a coarse triangle into 4^levels; without, the variant's own (see [`Parameters::edge`]).
    pub levels: Option<u32>,
    /// `solid` and `melting` subdivide until no edge is longer.
    pub edge: f32,
    /// Places of ignition in the scaled object's space (base centred at the origin), at most 16; without, the lowest
    /// vertex, and for `melting` the highest.
    pub sources: Vec<Vec3>,
    /// psi of the boundary: the heat index of 3.3.
    pub psi: f32,
    /// The way that heat takes from its sources; without, that of the look.
    pub heat: Option<Heat>,
    /// Heat along the surface comes so many times farther the way that flames lean, beside the one: upwards without wind.
    pub climb: f32,
    /// Wind, which carries flames and smoke, and with the flames the heat along the surface; diagonals a second.
    pub wind: Vec3,
    /// Growth of the boundary's radius a second.
    pub speed_per_s: f32,
    /// w, width of an area of the boundary.
    pub width_of_areas: f32,
    /// L of table 3.1, ticks.
    pub flammability: u32,
    /// epsilon of table 3.1.
    pub epsilon: f32,
    /// beta of table 3.1.
    pub beta: f32,
    /// rho of table 3.1.
    pub rho: f32,
    /// phi of table 3.1.
    pub phi: f32,
    /// gamma of eq. 4.
    pub gamma: f32,
    /// Blocks turn in random directions, not by what they lose (3.5.1).
    pub random_rotation: bool,
    /// x of 3.5.2: a neighbour's fraction of a block's rotation.
    pub spread: f32,
    /// omega of table 6.1.
    pub omega: f32,
    /// chi of table 6.1.
    pub chi: f32,
    /// upsilon of table 6.1.
    pub upsilon: f32,
    /// Height of the ground, which nothing melts below; without, the object's base.
    pub floor: Option<f32>,
    /// Fraction of L at which a vertex of a solid leaves the deforming group (5.5); 0 for never.
    pub retire_at: f32,
    /// Blocks along x, y and z, 1,048,576 in all at most.
    pub blocks: [u32; 3],
    /// The boundary halts while more vertices than this are active (3.7.1); 0 never halts it.
    pub active_limit: u32,
    /// Frames that one tick is spread over (3.7.2).
    pub time_division: u32,
    /// Loads what never changes before the first frame (3.7.4), not in every frame.
    pub preload: bool,
    /// Keeps what is consumed while something would come off (3.5.4), where parts do not fall.
    pub keep_connected: bool,
    /// The dissertation's look, or ours with all that goes beyond its text.
    pub look: Look,
    /// Lets parts that nothing holds fall, of the natural look.
    pub collapse: bool,
    /// Factor of how far what hangs by little bends, where parts fall; 0 for not at all.
    pub bending: f32,
    /// Lets what has burnt out of a solid leave as ash, of the natural look, as the rest does; in the text it stays.
    pub burn_away: bool,
    /// Draws the ground, of the natural look.
    pub ground: bool,
    /// Time after the fire in which wax loses its motion, of the natural look.
    pub setting_s: f32,
    /// Height of the puddle of what melts that evaporates in a second, of the natural look.
    pub evaporation_per_s: f32,
    /// Most fire particles.
    pub fire: u32,
    /// Most smoke particles.
    pub smoke: u32,
    /// Radius of a particle.
    pub particle_radius: f32,
    /// Factor of the light that the flames give, of the natural look.
    pub fire_light: f32,
    /// Pixels of the picture along a side of a pixel of the layer that holds fire and smoke, of the natural look.
    pub fire_scale: u32,
    /// The way that smoke is drawn, of the natural look.
    pub smoke_as: SmokeAs,
    /// Factor of the picture's light, of the natural look.
    pub exposure: f32,
    /// Fate of light that is brighter than the display, of the natural look.
    pub tone: Tone,
    /// Finest level that is drawn; without, by the distance of the camera (4.5).
    pub level_of_detail: Option<u32>,
    /// The surface's pattern, and what fire does to it; without, wood, and wax where it melts.
    pub material: Option<Material>,
    /// Covers the object in place of the material; the mesh must have texture coordinates.
    pub texture: Option<Arc<Texture>>,
    /// Materials of parts of the object, in place of the constants of table 3.1 and of the material.
    pub materials: Option<Arc<Materials>>,
    /// Linear RGB; a factor of the texture. Without, the material's own.
    pub albedo: Option<Vec3>,
    /// Behind the object, linear RGB.
    pub background: Vec3,
    /// The quantity that colours the mesh.
    pub shading: Shading,
    /// Without, the object fills 80 % of the picture's height.
    pub camera: Option<Camera>,
    /// Time between two frames in seconds.
    pub time_step_s: f64,
    /// The simulation's frame that frame 0 shows.
    pub first_frame: u32,
    /// Seed of the boundary's noise and of the particles.
    pub seed: u64,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Its height.
    pub height: u32,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            levels: None,
            edge: 0.1,
            sources: Vec::new(),
            psi: 1.0,
            heat: None,
            climb: 1.0,
            wind: Vec3::ZERO,
            speed_per_s: 0.05,
            width_of_areas: 0.04,
            flammability: 60,
            epsilon: 0.1,
            beta: 0.05,
            rho: 0.5,
            phi: 0.5,
            gamma: 0.1,
            random_rotation: false,
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
            look: Look::Natural,
            collapse: true,
            bending: 1.0,
            burn_away: true,
            ground: true,
            setting_s: 4.0,
            evaporation_per_s: 0.0,
            fire: 3000,
            smoke: 1800,
            particle_radius: 0.02,
            fire_light: 4.0,
            fire_scale: 2,
            smoke_as: SmokeAs::Particles,
            exposure: 1.0,
            tone: Tone::Shoulder,
            level_of_detail: None,
            material: None,
            texture: None,
            materials: None,
            albedo: None,
            background: Vec3::new(0.055, 0.06, 0.07),
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

const BLOCKS: Field<Parameters, Extents<u32, 3>> =
    Field { get: |p| Extents(p.blocks), set: |p, Extents(blocks)| p.blocks = blocks };

const LEVEL_OF_DETAIL: Field<Parameters, LevelOfDetail> =
    Field { get: |p| LevelOfDetail(p.level_of_detail), set: |p, level| p.level_of_detail = level.0 };

const CAMERA: Field<Parameters, Option<EyeAndTarget>> = Field {
    get: |p| p.camera.map(|camera| EyeAndTarget { eye: camera.eye, target: camera.target }),
    set: |p, place| p.camera = place.map(|place| seen_from(place.eye, place.target)),
};

/// Between zero and one, as most numbers of tables 3.1 and 6.1.
const FRACTION: Range = Range::above(0.0).below(1.0);
/// A length of at most a diagonal.
const LENGTH: Range = Range::above(0.0).to(1.0);
const LEVELS: Range = Range::from(0.0).to(5.0);
const PARTICLES: Range = Range::from(0.0).to(1e6);

const FACTOR: Range = Range::from(0.0).to(1e3);

const FIRE_SCALE: &str = "Draw fire and smoke in pixels of so many along a side";
const CLIMB: &str = "In the flames' direction heat travels 1 + this times as far";
const WIND: &str = "Wind, which flames and smoke drift with, and which leans the climbing heat";
const ACTIVE_LIMIT: &str = "Halt the boundary while more vertices are active; 0 never does";
const TIME_DIVISION: &str = "Frames over which each tick is spread";
const PRELOAD: &str = "Load what never changes before the first frame, or again in every frame";
const KEEP_CONNECTED: &str = "Keep what is burnt out while something would come off, or let it; off where parts fall";
const RANDOM_ROTATION: &str = "Turn blocks in random directions, not by where they lose their vertices";
const SETTING: &str = "melting: wax comes to rest in this time after the fire, of the natural look";
const BURN_AWAY: &str = "solid: let what has burnt out leave as ash, of the natural look, or stay as char";
const BENDING: &str = "Scale of bending of weakly attached parts before they fall; 0 for none";
const COLLAPSE: &str = "Let parts that nothing holds fall, of the natural look, or leave them in place";

/// A field of [`Parameters`].
macro_rules! p {
    ($field:ident) => {
        field!(Parameters.$field)
    };
}

/// A row of the table below. A change of the fire's numbers is one of all that has burnt: it starts anew.
fn row<T: Value>(
    name: &'static str,
    field: Field<Parameters, T>,
    range: Range,
    help: &'static str,
    section: &'static str,
) -> Parameter<Parameters> {
    Parameter::new(name, field).range(range).help(help).section(section).cost(Cost::Buffers)
}

impl Parameters {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Parameters>> {
        use Range as R;
        let any = Range::ANY;
        vec![
            row("levels", p!(levels), LEVELS, "Divide each triangle into 4^N", "4.4.1")
                .default_text("low-poly and fully-subdivided 5, shell 0, solid and melting by the longest edge"),
            row("edge", p!(edge), LENGTH, "solid and melting: divided until no edge is longer", "").unit("diagonals"),
            row(
                "source",
                p!(sources),
                R::from(-1e3).to(1e3),
                "Heat source in the scaled object's space, up to 16",
                "3.3",
            )
            .default_text("the lowest vertex, melting the highest"),
            row("psi", p!(psi), R::above(0.0).to(100.0), "Heat index of the squared distance", "3.3"),
            row("heat", p!(heat), any, "Way that heat takes from its sources", "3.3")
                .default_text("surface, with the dissertation's look air"),
            row("climb", p!(climb), R::from(0.0).to(100.0), CLIMB, ""),
            row("wind", p!(wind), R::from(-10.0).to(10.0), WIND, "").unit("diagonals a second").placeholder("X,Y,Z"),
            row("speed", p!(speed_per_s), R::above(0.0).to(10.0), "Growth of the boundary's radius", "3.3")
                .unit("diagonals a second"),
            row("area-width", p!(width_of_areas), LENGTH, "Width of an area of the boundary", "3.3").unit("diagonals"),
            row("flammability", p!(flammability), R::from(1.0).to(1e6), "L of a vertex", "table 3.1")
                .unit("ticks of combustion"),
            row("epsilon", p!(epsilon), FRACTION, "Meltability", "table 3.1"),
            row("beta", p!(beta), FRACTION, "Displacement scale", "table 3.1"),
            row("rho", p!(rho), FRACTION, "Material density", "table 3.1"),
            row("phi", p!(phi), FRACTION, "Bond strength", "table 3.1"),
            row("gamma", p!(gamma), FRACTION, "Rotation of blocks", "eq. 4"),
            row("random-rotation", p!(random_rotation), any, RANDOM_ROTATION, "3.5.1").cost(Cost::Pipelines),
            row("spread", p!(spread), FRACTION, "x, a block's share of its neighbours' rotation", "3.5.2"),
            row("omega", p!(omega), FRACTION, "melting: longest edge", "table 6.1").unit("mean edges"),
            row("chi", p!(chi), R::from(2.0).to(1e3), "melting: longest over shortest edge", "table 6.1"),
            row("upsilon", p!(upsilon), FRACTION, "melting: fraction of a violation folded in a tick", "table 6.1"),
            row("floor", p!(floor), R::from(-10.0).to(1.0), "Height of the ground; melting sinks no lower", "")
                .unit("diagonals")
                .default_text("the object's base"),
            row(
                "retire-at",
                p!(retire_at),
                R::from(0.0).below(1.0),
                "solid: fraction of L at which a vertex retires",
                "5.5",
            ),
            row("blocks", BLOCKS, R::from(1.0).to(256.0), "Blocks along x, y and z, 1048576 in all at most", "3.5.1")
                .placeholder("XxYxZ"),
            row("active-limit", p!(active_limit), any, ACTIVE_LIMIT, "3.7.1"),
            row("time-division", p!(time_division), R::from(1.0).to(64.0), TIME_DIVISION, "3.7.2").unit("frames"),
            row("preload", p!(preload), any, PRELOAD, "3.7.4"),
            row("keep-connected", p!(keep_connected), any, KEEP_CONNECTED, "3.5.4"),
            row("look", p!(look), any, "What is ours beside the text", "").cost(Cost::Pipelines),
            row("collapse", p!(collapse), any, COLLAPSE, "").cost(Cost::Pipelines),
            row("bending", p!(bending), FACTOR, BENDING, ""),
            row("burn-away", p!(burn_away), any, BURN_AWAY, "").cost(Cost::Pipelines),
            row("setting", p!(setting_s), R::above(0.0).to(1e4), SETTING, "").unit("seconds"),
            row(
                "evaporation",
                p!(evaporation_per_s),
                R::from(0.0).to(1.0),
                "melting: height of the puddle that evaporates, of the natural look",
                "",
            )
            .unit("diagonals a second"),
            row("ground", p!(ground), any, "Draw the ground, of the natural look", "").cost(Cost::Pipelines),
            row("fire", p!(fire), PARTICLES, "Most fire particles", "3.6").unit("particles"),
            row("smoke", p!(smoke), PARTICLES, "Most smoke particles", "3.6").unit("particles"),
            row("particle-radius", p!(particle_radius), LENGTH, "Radius of a particle", "").unit("diagonals"),
            row("fire-light", p!(fire_light), FACTOR, "Factor of the light of the flames, of the natural look", "")
                .cost(Cost::Constants),
            row("fire-scale", p!(fire_scale), R::from(1.0).to(8.0), FIRE_SCALE, "").unit("pixels"),
            row("smoke-as", p!(smoke_as), any, "The way that smoke is drawn, of the natural look", "")
                .cost(Cost::Pipelines),
            row("exposure", p!(exposure), FACTOR, "Factor of the picture's light, of the natural look", "")
                .cost(Cost::Constants),
            row("tone", p!(tone), any, "Tone mapping of values brighter than the display, of the natural look", "")
                .cost(Cost::Constants),
            row(
                "lod",
                LEVEL_OF_DETAIL,
                LEVELS,
                "Finest level that is drawn of a refined object; auto is by distance",
                "4.5",
            ),
            row("material", p!(material), any, "Material of the surface", "")
                .default_text("wood, melting wax")
                .cost(Cost::Pipelines)
                .everyday(),
            row("albedo", p!(albedo), R::from(0.0).to(1.0), "Linear red,green,blue; a factor of a texture", "")
                .placeholder("R,G,B")
                .default_text("0.36,0.17,0.07, of wax 0.8,0.66,0.4, with a texture 1,1,1"),
            row("background", p!(background), R::from(0.0).to(1.0), "Linear red,green,blue behind the object", "")
                .placeholder("R,G,B"),
            row("shading", p!(shading), any, "The quantity that colours the mesh", "").cost(Cost::Pipelines),
            row("camera", CAMERA, any, "Camera: eye and target, x,y,z,x,y,z", "")
                .unit("diagonals")
                .default_text("the object fills 80 % of the picture")
                .cost(Cost::Constants)
                .everyday(),
            parameter::size(size_field!(Parameters)),
            row("seed", p!(seed), any, "Seed of the boundary's noise and of the particles", "").unrecorded(),
            row("time-step", p!(time_step_s), R::from(0.0).to(10.0), "Simulated time between two frames", "")
                .unit("seconds")
                .default_text("1/60"),
            row("first-frame", p!(first_frame), R::from(0.0).to(1e5), "Frame of the simulation that frame 0 shows", "")
                .everyday(),
        ]
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        parameter::check(&Self::declared(), self)?;
        let sources = self.sources.len();
        ParameterError::check(sources <= 16, "source", sources, "there are at most 16 sources")?;
        let blocks = self.blocks.iter().product::<u32>();
        let text = Extents(self.blocks).text();
        ParameterError::check(blocks <= 1 << 20, "blocks", text, "must be at most 1048576 in all")?;
        self.camera.as_ref().map_or(Ok(()), ParameterError::check_camera)
    }

    /// Slices of ticks that are due after frame `number`, counted from the start of the simulation: one a tick without
    /// [`Parameters::time_division`], which makes each frame's part of a tick that much smaller.
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

//! The oracle of `burning`: chapters 3 to 6 in `f64`, written from the text. It has nothing in common with the shaders,
//! nor with the tables that they read.
//!
//! [`Tick::step`] advances a [`State`] by 1/60 s, pass by pass. Where rounding may decide otherwise than here, passes
//! answer how close their decisions were.

pub mod bending;
mod blocks;
pub mod boundary;
pub mod displacement;
pub mod falling;
pub mod fire_layer;
#[cfg(test)]
mod fixtures;
pub mod flames;
#[cfg(test)]
mod laws;
pub mod lights;
pub mod melting;
mod model;
mod normals;
pub mod refinement;
mod removal;
pub mod smoke;
pub mod solid;

use glam::DVec3;

pub use blocks::{Block, Grid};
pub use model::{Model, Node, scaled};

use super::{Look, Parameters, Variant};

/// Tables 3.1 and 6.1 and what else the text leaves to the designer. Lengths are in diagonals of the mesh at rest.
#[derive(Debug, Clone)]
pub struct Constants {
    /// L at the start.
    pub flammability: u32,
    /// Coefficient epsilon of table 3.1, of the internal deformation (3.4).
    pub epsilon: f64,
    /// Coefficient beta of table 3.1, of the internal deformation (3.4).
    pub beta: f64,
    /// Coefficient rho of table 3.1.
    pub rho: f64,
    /// Coefficient phi of table 3.1.
    pub phi: f64,
    /// Coefficient gamma of eq. 4.
    pub gamma: f64,
    /// Fraction of a block's own rotation that its neighbours take over.
    pub spread: f64,
    /// Coefficient omega of table 6.1, of melting.
    pub omega: f64,
    /// Coefficient chi of table 6.1, of melting.
    pub chi: f64,
    /// Coefficient upsilon of table 6.1, of melting.
    pub upsilon: f64,
    /// Growth of the boundary in a second.
    pub speed: f64,
    /// Width of an area of the boundary.
    pub width: f64,
    /// Ignition points.
    pub sources: Vec<DVec3>,
    /// R of each vertex.
    pub reaches: Vec<f64>,
    /// Height below which nothing melts.
    pub floor: f64,
    /// Height below which nothing is drawn of an object that stands on it, by the natural look.
    pub ground: Option<f64>,
    /// Active vertices above which the boundary waits; 0 is no limit (section 3.7.1).
    pub active_limit: u32,
    /// Triangles that are consumed stay as long as something would come off (3.5.4).
    pub keep_connected: bool,
    /// Signs of rotations are random (3.5.1).
    pub random_rotation: bool,
    /// Of what is random.
    pub seed: u32,
    /// Fraction of the flammability below which a vertex of a solid leaves the deforming group (section 5.5).
    pub retire_at: f64,
    /// Seconds after the fire in which wax sets, by the natural look.
    pub setting_s: Option<f64>,
}

impl Constants {
    /// The constants of a configuration, burning from `sources`.
    pub fn new(parameters: &Parameters, model: &Model, sources: &[DVec3], floor: f64) -> Self {
        let p = parameters;
        let psi = f64::from(p.psi);
        let reach = |at: &DVec3| boundary::least_reach(*at, sources, psi, boundary::theta(*at, p.noise_seed()));
        Constants {
            flammability: p.flammability,
            epsilon: p.epsilon.into(),
            beta: p.beta.into(),
            rho: p.rho.into(),
            phi: p.phi.into(),
            gamma: p.gamma.into(),
            spread: p.spread.into(),
            omega: p.omega.into(),
            chi: p.chi.into(),
            upsilon: p.upsilon.into(),
            speed: p.speed_per_s.into(),
            width: p.width_of_areas.into(),
            sources: sources.to_vec(),
            reaches: model.rest.iter().map(reach).collect(),
            floor,
            ground: (p.look == Look::Natural).then_some(floor),
            active_limit: p.active_limit,
            keep_connected: p.keep_connected,
            random_rotation: p.random_rotation,
            seed: p.noise_seed(),
            retire_at: p.retire_at.into(),
            setting_s: (p.look == Look::Natural).then_some(p.setting_s.into()),
        }
    }
}

/// All that a tick changes.
#[derive(Debug, Clone)]
pub struct State {
    /// Ticks since the start.
    pub tick: u32,
    /// Ticks in which the heat boundary has grown: all but those in which it waited for the active limit.
    pub growth_ticks: u32,
    /// Of the last heat boundary: what the active limit is held against.
    pub active_vertices: u32,
    /// Position of each vertex, in diagonals; deformed, but not rotated with its block.
    pub positions: Vec<DVec3>,
    /// Flammability left.
    pub left: Vec<u32>,
    /// Areas of the heat boundary.
    pub labels: Vec<u32>,
    /// True for each vertex that refinement has made.
    pub alive: Vec<bool>,
    /// Of the refinement pattern's nodes.
    pub statuses: Vec<i32>,
    /// Block of each vertex, an index into `blocks`.
    pub cells: Vec<usize>,
    /// Weight and this tick's events of each cell of the grid (3.5).
    pub blocks: Vec<Block>,
    /// Pitch, yaw and roll of each block, in radians.
    pub rotations: Vec<DVec3>,
    /// Displacement of the base point of each block as a guide since rest.
    pub guides: Vec<DVec3>,
    /// Displacement by which each vertex has followed the guides.
    pub flows: Vec<DVec3>,
    /// Position of each vertex after the rotation of its block, in diagonals.
    pub mapped: Vec<DVec3>,
    /// Of the finest triangles.
    pub removed: Vec<bool>,
    /// Of the finest triangles: the search for what hangs together does without it.
    pub left_out: Vec<bool>,
    /// Of the drawn vertices, like what follows.
    pub normals: Vec<DVec3>,
    /// Charring of each drawn vertex, 0 to 1.
    pub chars: Vec<f64>,
    /// Glow of each drawn vertex, 0 to 1.
    pub glows: Vec<f64>,
}

impl State {
    /// The mesh before it is lit.
    pub fn at_rest(tick: &Tick<'_>) -> Self {
        let (model, n, corners) = (tick.model, tick.model.rest.len(), tick.model.welds.len());
        let pattern = refinement::Pattern::new(model, &vec![refinement::status::INITIAL; model.nodes.len()]);
        let mut state = State {
            tick: 0,
            growth_ticks: 0,
            active_vertices: 0,
            positions: model.rest.clone(),
            left: vec![tick.constants.flammability; n],
            labels: vec![0; n],
            alive: if tick.variant.refines() { pattern.alive() } else { vec![true; n] },
            statuses: pattern.statuses(),
            cells: model.rest_cells.clone(),
            blocks: vec![Block::default(); model.grid.cells()],
            rotations: vec![DVec3::ZERO; model.grid.cells()],
            guides: vec![DVec3::ZERO; model.grid.cells()],
            flows: vec![DVec3::ZERO; n],
            mapped: model.rest.clone(),
            removed: vec![false; model.triangles.len()],
            left_out: vec![false; model.triangles.len()],
            normals: vec![DVec3::ZERO; corners],
            chars: vec![0.0; corners],
            glows: vec![0.0; corners],
        };
        tick.weigh(&state.clone(), &mut state);
        tick.shade(&mut state);
        state
    }

    /// Counts towards the weight of its block.
    pub fn is_live(&self, v: usize) -> bool {
        self.left[v] > 0 && self.alive[v]
    }
}

/// The inputs of a tick besides the state.
#[derive(Clone, Copy)]
pub struct Tick<'a> {
    /// Method by which the object burns.
    pub variant: Variant,
    /// The mesh at rest with its refinement pattern.
    pub model: &'a Model,
    /// Numbers that no tick changes.
    pub constants: &'a Constants,
}

impl Tick<'_> {
    /// Displaced and counted down: deformed, with something left; of a solid more than the fraction at which it retires
    /// (5.5).
    pub fn is_active(&self, state: &State, v: usize) -> bool {
        let retired = if self.variant == Variant::Solid { self.constants.retire_at } else { 0.0 };
        let is_left = f64::from(state.left[v]) > retired * f64::from(self.constants.flammability);
        state.labels[v] == boundary::area::DEFORMED && state.alive[v] && is_left
    }

    /// The state 1/60 s later.
    pub fn step(&self, before: &State) -> State {
        let mut state = before.clone();
        self.heat(&mut state);
        self.refine(&mut state);
        self.deform(&mut state);
        self.locate(&mut state);
        self.weigh(before, &mut state);
        self.rotate(&mut state);
        self.map(&mut state);
        self.remove(&mut state);
        self.shade(&mut state);
        state
    }
}

//! The lava at the start: a block at rest, or a pool of particles, each where it comes out of the vent.

use glam::Vec3;

use super::super::parameters::Parameters;
use super::super::start::Particles;
use super::Scale;
use super::bed::Bed;
use super::parameters::Flow;
use crate::scene::random::Random;

/// The particles in the order in which they come.
pub fn particles(parameters: &Parameters) -> Particles {
    let Flow { vent, heat, .. } = &parameters.flow;
    let positions = if vent.effusion_m3_s > 0.0 {
        vent.places(parameters, Scale::of(parameters).margin_m)
    } else {
        block(parameters)
    };
    let count = positions.len();
    Particles {
        positions,
        velocities: vec![Vec3::ZERO; count],
        temperatures_k: vec![heat.melt_k; count],
        bed: Bed::level(),
    }
}

/// Places of a block in the space's first corner, layer by layer from the floor: as a lattice, shaken by a
/// twentieth of its distance so that no symmetry lasts.
fn block(parameters: &Parameters) -> Vec<Vec3> {
    let block_m = parameters.flow.block_m;
    let spacing_m = parameters.flow.spacing_m(parameters.particles) as f32;
    let along = |side_m: f32| (side_m / spacing_m).round().clamp(1.0, parameters.particles as f32) as u32;
    let (columns, rows) = (along(block_m.x), along(block_m.z));
    // As many layers as hold all, spread over the block's height.
    let layers = parameters.particles.div_ceil(columns.saturating_mul(rows));
    let step_m = block_m / Vec3::new(columns as f32, layers as f32, rows as f32);
    let mut shake = Random::with_stream(parameters.seed, 2);
    let place = |number: u32| {
        let (column, rest) = (number % columns, number / columns);
        let at = Vec3::new(column as f32, (rest / rows) as f32, (rest % rows) as f32) + 0.5;
        let shaken = Vec3::from_array([(); 3].map(|()| shake.range(-0.05, 0.05))) * spacing_m;
        (at * step_m + shaken).clamp(Vec3::ZERO, parameters.space_m)
    };
    (0..parameters.particles).map(place).collect()
}

//! A block of lava at rest.

use glam::Vec3;

use super::super::parameters::Parameters;
use super::super::start::Particles;
use crate::scene::random::Random;

/// Particles of a block in the space's first corner, layer by layer from the floor, at rest: as a lattice, shaken by a
/// twentieth of its distance so that no symmetry lasts.
pub fn block(parameters: &Parameters) -> Particles {
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
    let positions: Vec<Vec3> = (0..parameters.particles).map(place).collect();
    Particles { velocities: vec![Vec3::ZERO; positions.len()], positions }
}

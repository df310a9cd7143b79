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
    let margin_m = Scale::of(parameters).margin_m;
    let mut positions = if vent.effusion_m3_s > 0.0 { vent.places(parameters, margin_m) } else { block(parameters) };
    // Off the walls by as much as every step keeps them: nearer, a wall would drag more than the viscosity's iterations take.
    let low_m = Vec3::splat(margin_m as f32).min(0.5 * parameters.space_m);
    for place in &mut positions {
        *place = place.clamp(low_m, parameters.space_m - low_m);
    }
    let count = positions.len();
    Particles {
        positions,
        velocities: vec![Vec3::ZERO; count],
        temperatures_k: vec![heat.melt_k; count],
        bed: Bed::level(),
    }
}

/// Places of a block in the corner at the origin, layer by layer from the floor: as a lattice, shaken by a
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
        at * step_m + shaken
    };
    (0..parameters.particles).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::super::vent::Vent;
    use super::*;
    use crate::papers::lava::Simulation;

    /// Also in a block much thinner than a particle, and out of a vent that touches two walls.
    #[test]
    fn no_particle_starts_nearer_to_a_wall_than_it_may_come() {
        let sph = Parameters { simulation: Simulation::Sph, particles: 300, ..Parameters::default() };
        let flow = |flow: Flow| Parameters { flow, ..sph.clone() };
        let vent = Vent { effusion_m3_s: 0.01, middle_m: [0.15, 0.15], radius_m: 0.15, ..Vent::default() };
        let thin = flow(Flow { block_m: Vec3::new(0.001, 1.0, 1.0), ..Flow::default() });
        let erupting = flow(Flow { vent, ..Flow::default() });
        for parameters in [sph.clone(), thin, erupting] {
            let margin = 0.999 * Scale::of(&parameters).margin_m as f32;
            for place in particles(&parameters).positions {
                assert!(place.min_element() >= margin, "{place} {margin}");
                assert!((parameters.space_m - place).min_element() >= margin, "{place} {margin}");
            }
        }
    }
}

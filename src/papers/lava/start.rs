//! The particles as they start.

use glam::{DVec2, Vec3};

use super::parameters::Parameters;
use super::sph;
use super::sph::bed::Bed;
use super::sph::parameters::Simulation;
use crate::scene::random::Random;

/// Positions in metres inside the simulation space, velocities in metres per second, and the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Particles {
    /// Metres.
    pub positions: Vec<Vec3>,
    /// As many as positions.
    pub velocities: Vec<Vec3>,
    /// Kelvin, as many as positions; none of particles that have no temperature.
    pub temperatures_k: Vec<f32>,
    /// Ground of a fluid.
    pub bed: Bed,
}

impl Particles {
    /// Uniform in the space. Along x half to one and a half times the mean speed, along y and z up to a quarter of it
    /// either way: the thesis gives no velocities.
    pub fn seeded(parameters: &Parameters) -> Self {
        let (mut places, mut motions) =
            (Random::with_stream(parameters.seed, 0), Random::with_stream(parameters.seed, 1));
        let speed = parameters.speed_m_s;
        let count = parameters.particles as usize;
        let mut particles = Particles {
            positions: Vec::with_capacity(count),
            velocities: Vec::with_capacity(count),
            temperatures_k: Vec::new(),
            bed: Bed::level(),
        };
        for _ in 0..count {
            let place = [(); 3].map(|()| places.unit());
            particles.positions.push(Vec3::from_array(place) * parameters.space_m);
            let mut across = || motions.range(-0.25, 0.25);
            let (y, z) = (across(), across());
            particles.velocities.push(speed * Vec3::new(motions.range(0.5, 1.5), y, z));
        }
        particles
    }

    /// As the simulation starts: free particles all over the space, a block of lava, or what
    /// will come out of a vent.
    pub fn of(parameters: &Parameters) -> Self {
        match parameters.simulation {
            Simulation::Free => Particles::seeded(parameters),
            Simulation::Sph => sph::start::particles(parameters),
        }
    }

    /// The same as high above a bed as they are above the floor, in a space that is high enough.
    pub fn over(mut self, bed: Bed) -> Self {
        for place in &mut self.positions {
            place.y += bed.at(DVec2::new(place.x.into(), place.z.into())).z as f32;
        }
        Particles { bed, ..self }
    }

    /// Width and height of a texture with a texel for each of `count` particles, as square as possible.
    pub fn texture_size(count: u32) -> (u32, u32) {
        let width = f64::from(count).sqrt().ceil().max(1.0) as u32;
        (width, count.div_ceil(width).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_fill_the_space_and_flow_along_x() {
        let parameters = Parameters { particles: 10_000, ..Parameters::default() };
        let particles = Particles::seeded(&parameters);
        let mean = particles.positions.iter().sum::<Vec3>() / 10_000.0;
        // The standard deviation of the mean is 0.3 % of a side.
        assert!((mean / parameters.space_m - 0.5).abs().max_element() < 0.015, "{mean}");
        let inside = |p: &Vec3| p.cmpge(Vec3::ZERO).all() && p.cmplt(parameters.space_m).all();
        assert!(particles.positions.iter().all(inside));
        assert!(particles.velocities.iter().all(|v| v.x > 0.0));
        assert_eq!(particles, Particles::seeded(&parameters));
        assert_ne!(particles, Particles::seeded(&Parameters { seed: 2, ..parameters }));
    }

    #[test]
    fn textures_hold_every_particle() {
        for count in [1, 2, 3, 4, 5, 99, 40_000, 65_536, 65_537, 1_000_000] {
            let (width, height) = Particles::texture_size(count);
            assert!(width * height >= count && width * (height - 1) < count, "{count}: {width} x {height}");
        }
        assert_eq!(Particles::texture_size(65_536), (256, 256));
    }
}

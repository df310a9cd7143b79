//! Work of the fluid's passes in turns of their loops, by which submissions are bounded.

use glam::DVec3;

use super::super::gpu_driven::Cells;
use super::super::parameters::Parameters;
use super::{Scale, chebyshev, neighbours};

/// Passes of one submission, at most: command buffers of more take long to make and much memory.
pub const MOST_PASSES: f64 = 16_384.0;
/// Passes of a step that look at no neighbours, those of the sort above all.
pub const OTHER_PASSES: f64 = 24.0;
/// Passes of a step that look at lists, beside iterations and corrections.
const LISTING: f64 = 5.0;

/// Work of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Particles that one without a list looks at: those of 27 cells, of its own volume each as long as they are at rest.
    pub walked: f64,
    /// Passes that look at lists.
    listing: f64,
}

impl Work {
    /// Of these parameters, by cells of this scale.
    pub fn of(parameters: &Parameters, scale: &Scale, cells: &Cells) -> Self {
        let sides = parameters.space_m.as_dvec3() / DVec3::from(cells.counts.map(f64::from));
        let walked = (27.0 * (sides / scale.spacing_m).element_product()).min(cells.particles.into());
        let iterations = chebyshev::needed(scale.stiffness * scale.stiffest);
        Work { walked, listing: iterations + 2.0 * f64::from(parameters.flow.corrections) + LISTING }
    }

    /// Of a pass over so many particles that looks at the cells around each.
    pub fn walks(&self, particles: u32) -> f64 {
        f64::from(particles) * self.walked
    }

    /// Of a pass over so many particles that looks at their lists.
    pub fn lists(&self, particles: u32) -> f64 {
        neighbours::looked_at(particles, self.walked)
    }

    /// Of a step of so many particles.
    pub fn step(&self, particles: u32) -> f64 {
        2.0 * self.walks(particles) + self.listing * self.lists(particles)
    }

    /// Passes of a step.
    pub fn passes(&self) -> f64 {
        self.listing + OTHER_PASSES
    }

    /// Steps of so many particles in a submission of at most so much work, and of [`MOST_PASSES`].
    pub fn steps_within(&self, most: f64, particles: u32) -> f64 {
        (most / self.step(particles)).min(MOST_PASSES / self.passes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::lava::{Flow, Simulation};

    /// Few particles of many passes as well as many particles.
    #[test]
    fn steps_of_a_submission_are_bounded_by_work_and_by_passes() {
        for (particles, corrections) in [(10, 100), (4000, 12), (1_000_000, 12)] {
            let flow = Flow { corrections, ..Flow::default() };
            let parameters = Parameters { simulation: Simulation::Sph, particles, flow, ..Parameters::default() };
            let scale = Scale::of(&parameters);
            let work = Work::of(&parameters, &scale, &scale.cells(&parameters, particles));
            let steps = work.steps_within(1e8, particles);
            assert!(steps * work.passes() <= MOST_PASSES * 1.000_001, "{particles}: {steps}");
            assert!(steps * work.step(particles) <= 1.000_001e8, "{particles}: {steps}");
            assert!(work.passes() > 2.0 * f64::from(corrections) && work.step(particles) > f64::from(particles));
        }
    }
}

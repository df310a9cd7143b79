//! Maps and rays for the tests.

use crate::papers::terrain::reference::{Grid, Ray, Terrain};
use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Uniform numbers.
pub(super) struct Dice(Pcg32);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        Dice(Pcg32::new(seed, 1))
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from_array([(); 3].map(|()| self.between(-1.0, 1.0)));
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// Heights between 0 and `range_m` on nodes 1 apart, from (0, 0).
pub(super) fn random_grid(size: [usize; 2], seed: u64, range_m: f64) -> Grid {
    let mut dice = Dice::new(seed);
    let heights = (0..size[0] * size[1]).map(|_| dice.between(0.0, range_m)).collect();
    Grid::new(size, heights, [0.0; 2], [1.0; 2]).unwrap()
}

/// A map of a function of (u, v).
pub(super) fn grid_of(size: [usize; 2], origin: [f64; 2], spacing: [f64; 2], f: impl Fn(f64, f64) -> f64) -> Grid {
    let place = |n: usize, axis: usize| origin[axis] + spacing[axis] * n as f64;
    let heights = (0..size[0] * size[1]).map(|n| f(place(n % size[0], 0), place(n / size[0], 1))).collect();
    Grid::new(size, heights, origin, spacing).unwrap()
}

/// The first of many even steps of `step_m` at which a point of the ray is solid.
pub(super) fn march(terrain: &Terrain, ray: &Ray, t_range: [f64; 2], step_m: f64) -> Option<f64> {
    let count = ((t_range[1] - t_range[0]) / step_m) as usize;
    (0..=count).map(|n| t_range[0] + step_m * n as f64).find(|&t| terrain.is_solid(ray.at(t)))
}

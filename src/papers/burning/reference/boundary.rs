//! Section 3.3: the irregular heat boundary and its areas (figures 3.3, 4.3, 5.3).

use std::f64::consts::PI;

use glam::DVec3;

use super::{State, Tick, Variant};

/// Fraction by which the sines carry the boundary in and out.
const AMPLITUDE: f64 = 0.3;
/// The delta that divides the angle, in place of the frame-dependent increment of the radius.
const DELTA: f64 = 0.25;
/// Wavelength of the angle's noise, in diagonals.
const WAVELENGTH: f64 = 1.0 / 8.0;
/// Ticks a second.
pub const RATE: f64 = 60.0;

/// The area of a vertex: each one lies within those of lower rank.
pub mod area {
    pub const OUTSIDE: u32 = 0;
    pub const VIRTUAL: u32 = 1;
    pub const INITIAL: u32 = 2;
    pub const READY: u32 = 3;
    pub const DEFORMED: u32 = 4;
}

/// The radius R at which the boundary reaches a point at a distance from the source: R^2 = psi d^2 (1 + a (sin(pi Theta
/// / delta) + sin(pi Theta)) / 2). `theta` lies in [0, 2).
pub fn reach(distance: f64, psi: f64, theta: f64) -> f64 {
    let waves = (PI * theta / DELTA).sin() + (PI * theta).sin();
    (psi * distance * distance * (1.0 + AMPLITUDE * waves / 2.0)).sqrt()
}

/// The least reach over all sources (chapter 7).
pub fn least_reach(point: DVec3, sources: &[DVec3], psi: f64, theta: f64) -> f64 {
    sources.iter().map(|source| reach(point.distance(*source), psi, theta)).fold(f64::INFINITY, f64::min)
}

/// The radii at which a boundary of width `width` and radius `radius` changes areas: virtual, initial, ready, deformed.
pub fn limits(radius: f64, width: f64) -> [f64; 4] {
    [radius + 2.0 * width, radius, radius - width, radius - 2.0 * width]
}

/// Area of a point: the number of limits that enclose it.
pub fn area_of(reach: f64, radius: f64, width: f64) -> u32 {
    limits(radius, width).into_iter().filter(|limit| reach <= *limit).count() as u32
}

/// The angle Theta in [0, 2): a value of its own for each corner of a lattice, faded along each axis in between.
pub fn theta(point: DVec3, seed: u32) -> f64 {
    let at = point / WAVELENGTH;
    let mut sum = 0.0;
    for corner in 0..8 {
        let (mut weight, mut hash) = (1.0, scrambled(seed));
        for axis in [2, 1, 0] {
            let low = at[axis].floor();
            let fade = |t: f64| t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t);
            let step = corner >> axis & 1;
            let nearness = fade(at[axis] - low);
            weight *= if step == 1 { nearness } else { 1.0 - nearness };
            hash = scrambled((low as i32 + step) as u32 ^ hash);
        }
        sum += weight * f64::from(hash) / 2f64.powi(32);
    }
    2.0 * sum
}

/// The integer hash that all of this program's noise is made of.
fn scrambled(mut h: u32) -> u32 {
    for (shift, factor) in [(16, 0x7feb_352d), (15, 0x846c_a68b)] {
        h = (h ^ (h >> shift)).wrapping_mul(factor);
    }
    h ^ (h >> 16)
}

impl Tick<'_> {
    /// The radius after so many ticks of growth, in diagonals.
    pub fn radius(&self, growth_ticks: u32) -> f64 {
        self.constants.speed * f64::from(growth_ticks) / RATE
    }

    /// Pass `heat-boundary`.
    pub fn heat(&self, state: &mut State) {
        let limit = self.constants.active_limit;
        state.tick += 1;
        if limit == 0 || state.active_vertices <= limit {
            state.growth_ticks += 1;
        }
        let radius = self.radius(state.growth_ticks);
        for (label, reach) in state.labels.iter_mut().zip(&self.constants.reaches) {
            *label = area_of(*reach, radius, self.constants.width);
            // Chapter 3 has no virtual area yet.
            if self.variant == Variant::Shell && *label == area::VIRTUAL {
                *label = area::OUTSIDE;
            }
        }
        state.active_vertices = (0..state.labels.len()).filter(|v| self.is_active(state, *v)).count() as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_boundary_is_a_sphere_with_waves() {
        for i in 0..1000 {
            let theta = f64::from(i) / 500.0;
            let r = reach(0.7, 1.0, theta);
            assert!(r * r >= 0.49 * 0.7 && r * r <= 0.49 * 1.3, "{theta}: {r}");
            assert!((reach(1.4, 1.0, theta) - 2.0 * r).abs() < 1e-12);
            assert!((reach(0.7, 4.0, theta) - 2.0 * r).abs() < 1e-12);
        }
        assert_eq!(reach(0.7, 1.0, 0.0), 0.7);
        assert_eq!(reach(0.0, 1.0, 0.3), 0.0);
    }

    #[test]
    fn areas_only_rise_as_the_radius_grows() {
        for i in 0..50 {
            let reach = f64::from(i) * 0.013;
            let areas: Vec<u32> = (0..400).map(|n| area_of(reach, f64::from(n) * 0.002, 0.04)).collect();
            assert!(areas.windows(2).all(|pair| pair[0] <= pair[1]) && areas[399] == area::DEFORMED);
        }
        let areas = [0.19, 0.17, 0.10, 0.05, 0.01].map(|reach| area_of(reach, 0.1, 0.04));
        assert_eq!(areas, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn the_angle_is_smooth_and_its_wavelength_is_an_eighth() {
        let line: Vec<f64> = (0..8000).map(|i| theta(DVec3::new(f64::from(i) / 1000.0, 0.25, -0.5), 7)).collect();
        assert!(line.iter().all(|t| (0.0..2.0).contains(t)));
        // Values of neighbouring corners are independent: the mean step of two uniform numbers in [0, 2) is 2 / 3.
        let steps = line.chunks(125).map(|c| (c[124] - c[0]).abs()).collect::<Vec<_>>();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        assert!((mean - 2.0 / 3.0).abs() < 0.15, "{mean}");
        // A quintic rises by 15 / 8 of the mean slope at most.
        let steepest = line.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(steepest < 2.0 * 15.0 / 8.0 / 125.0, "{steepest}");
        assert!(theta(DVec3::splat(0.31), 7) != theta(DVec3::splat(0.31), 8));
    }

    #[test]
    fn of_several_sources_the_nearest_counts() {
        let sources = [DVec3::ZERO, DVec3::X];
        let at = |x: f64| least_reach(DVec3::X * x, &sources, 1.0, 0.4);
        assert!((at(0.2) - at(0.8)).abs() < 1e-12 && at(0.2) < at(0.5));
        assert!((at(0.2) - reach(0.2, 1.0, 0.4)).abs() < 1e-12);
    }
}

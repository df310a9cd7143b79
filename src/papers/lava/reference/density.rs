//! Stage two, sections 6.1 and 6.2: densities at the grid points, and which are accepted.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// F(r, h) of eq. 6.2 as it is printed, with h to the first power.
pub fn density(r: f64, h: f64) -> f64 {
    if r > h {
        return 0.0;
    }
    let a = r / h;
    405.0 / (748.0 * PI * h) * (-4.0 / 9.0 * a.powi(6) + 17.0 / 9.0 * a.powi(4) - 22.0 / 9.0 * a.powi(2) + 1.0)
}

/// The grid of the densities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Sides of the simulation space, metres.
    pub space: DVec3,
    /// Points along x, y (planes) and z.
    pub points: [usize; 3],
}

impl Grid {
    pub fn new(space: Vec3, points: [u32; 3]) -> Self {
        Grid { space: space.as_dvec3(), points: points.map(|n| n as usize) }
    }

    /// Position of a grid point, metres: the middle of its cell.
    pub fn place(&self, index: [usize; 3]) -> DVec3 {
        let along = |axis: usize| (index[axis] as f64 + 0.5) / self.points[axis] as f64 * self.space[axis];
        DVec3::new(along(0), along(1), along(2))
    }

    /// Heights of the planes.
    pub fn planes(&self) -> Vec<f64> {
        (0..self.points[1]).map(|j| self.place([0, j, 0]).y).collect()
    }

    /// Every index: planes, in them rows along z, in them points along x.
    pub fn indices(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [x, y, z] = self.points;
        (0..y).flat_map(move |j| (0..z).flat_map(move |k| (0..x).map(move |i| [i, j, k])))
    }

    /// The density at every point in the order of [`Grid::indices`]: the sum over every particle.
    pub fn densities(&self, particles: &[DVec3], radius: f64) -> Vec<f64> {
        let at = |place: DVec3| particles.iter().map(|p| density(p.distance(place), radius)).sum();
        self.indices().map(|index| at(self.place(index))).collect()
    }

    /// The points whose density reaches `rho`.
    pub fn accepted(&self, densities: &[f64], rho: f64) -> Vec<DVec3> {
        self.indices().zip(densities).filter(|(_, d)| **d >= rho).map(|(index, _)| self.place(index)).collect()
    }

    /// The highest accepted point of each column that has one.
    pub fn tops(&self, densities: &[f64], rho: f64) -> Vec<DVec3> {
        self.highest(densities, rho).map(|[i, j, k]| self.place([i, j, k])).collect()
    }

    /// The highest place of each column at which the density, linear between planes, is `rho`; under the highest plane
    /// that plane, where its point is accepted.
    pub fn crossings(&self, densities: &[f64], rho: f64) -> Vec<DVec3> {
        let crossing = |[i, j, k]: [usize; 3]| {
            let below = self.place([i, j, k]);
            if j + 1 == self.points[1] {
                return below;
            }
            let (low, high) = (densities[self.at([i, j, k])], densities[self.at([i, j + 1, k])]);
            below.lerp(self.place([i, j + 1, k]), (rho - low) / (high - low))
        };
        self.highest(densities, rho).map(crossing).collect()
    }

    /// The highest accepted index of each column that has one, row by row.
    fn highest(&self, densities: &[f64], rho: f64) -> impl Iterator<Item = [usize; 3]> {
        let [x, y, z] = self.points;
        let columns = (0..z).flat_map(move |k| (0..x).map(move |i| (i, k)));
        columns
            .filter_map(move |(i, k)| (0..y).rev().map(|j| [i, j, k]).find(|index| densities[self.at(*index)] >= rho))
    }

    /// Place of an index in the order of [`Grid::indices`].
    pub fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        (j * self.points[2] + k) * self.points[0] + i
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_falls_from_its_peak_to_nothing_at_the_radius() {
        let h = 0.08;
        assert!((density(0.0, h) - 2.1543).abs() < 1e-4);
        assert!(density(h, h).abs() < 1e-14 && density(1.01 * h, h) == 0.0);
        let samples: Vec<f64> = (0..=100).map(|i| density(f64::from(i) / 100.0 * h, h)).collect();
        assert!(samples.windows(2).all(|w| w[0] > w[1]));
    }

    #[test]
    fn many_particles_have_the_mean_density() {
        // 0.14057 N h^2 / V is what rho defaults to: the integral over a sphere, here by shells.
        let h = 0.1;
        let shell = |i: i32| {
            let r = (f64::from(i) + 0.5) / 10_000.0 * h;
            4.0 * PI * r * r * density(r, h) * h / 10_000.0
        };
        let integral: f64 = (0..10_000).map(shell).sum();
        assert!((integral / (h * h) - 0.14057).abs() < 1e-5, "{integral}");
    }
}

//! The cells that particles are sorted into.

use glam::{DVec3, Vec3};

use super::super::parameters::Parameters;

/// Cells of the simulation space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cells {
    /// Along x, y and z; no side is shorter than a particle's radius where an axis has more than one.
    pub counts: [u32; 3],
    /// Particles that are sorted into them.
    pub particles: u32,
}

impl Cells {
    /// As small as the radius allows, and no more than there are particles.
    pub fn new(parameters: &Parameters, particles: u32) -> Self {
        Self::of_side(parameters.space_m, f64::from(parameters.radius_m), particles.max(1), particles)
    }

    /// Of sides no shorter than `least_m`, and at most so many, of a space in metres.
    pub fn of_side(space_m: Vec3, least_m: f64, most: u32, particles: u32) -> Self {
        /// Over the side, so that rounding adds no fourth cell to three.
        const MARGIN: f64 = 1.001;
        let space = space_m.as_dvec3();
        let mut side_m = MARGIN * least_m;
        loop {
            let counts = (space / side_m).floor().max(DVec3::ONE);
            if counts.x * counts.y * counts.z <= f64::from(most) {
                return Cells { counts: counts.to_array().map(|n| n as u32), particles };
            }
            // By a tenth more cells' worth.
            side_m *= 1.03;
        }
    }

    /// Number of them.
    pub fn count(&self) -> u32 {
        self.counts.iter().product()
    }

    /// Particles that a column of four planes looks at where they fill the space evenly: three by three columns of cells, over
    /// its own height and a radius to either side.
    pub fn seen(&self, parameters: &Parameters) -> f64 {
        let [across, _, along] = self.counts.map(|count| (3.0 / f64::from(count)).min(1.0));
        let height_m = f64::from(parameters.space_m.y);
        let seen_m = 4.0 * height_m / f64::from(parameters.density[1]) + 4.0 * f64::from(parameters.radius_m);
        f64::from(self.particles) * across * along * (seen_m / height_m).min(1.0)
    }

    /// Bits of the largest number of a cell.
    pub fn bits(&self) -> u32 {
        u32::BITS - (self.count() - 1).leading_zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_reach_a_radius_and_are_no_more_than_particles() {
        let default = Parameters::default();
        let cells = Cells::new(&default, default.particles);
        assert_eq!((cells.counts, cells.count(), cells.bits()), ([49, 12, 12], 7056, 13));
        let cases = [
            Parameters { radius_m: 1e-30, ..default.clone() },
            Parameters { radius_m: 1.0, ..default.clone() },
            Parameters { particles: 1, ..default.clone() },
            Parameters { space_m: Vec3::new(1000.0, 1e-3, 1e-3), radius_m: 1e-3, ..default.clone() },
            Parameters { particles: 16_777_216, radius_m: 1e-3, ..default },
        ];
        for parameters in cases {
            let cells = Cells::new(&parameters, parameters.particles);
            assert!(cells.count() <= parameters.particles && cells.count() >= 1, "{cells:?}");
            for (side_m, count) in parameters.space_m.to_array().into_iter().zip(cells.counts) {
                assert!(count == 1 || side_m / count as f32 >= parameters.radius_m, "{cells:?}");
            }
            assert!(cells.bits() <= 24 && (1u64 << cells.bits()) >= u64::from(cells.count()), "{cells:?}");
        }
    }
}

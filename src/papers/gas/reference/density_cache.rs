//! The table of a density's values, in double precision: a mean of all entries, by their distances along the three axes.

use glam::DVec3;

use super::density::inwardness;
use super::shadow_table::{entries, entry_position};
use crate::papers::gas::model::Volume;

/// Values of the density of one volume, before it fades, at entries on the box around it.
pub struct Values {
    volume: Volume,
    size: u32,
    values: Vec<f64>,
}

impl Values {
    /// `size` entries along each axis, by the density at points of the world.
    pub fn new(volume: &Volume, size: u32, density: impl Fn(DVec3) -> f64) -> Self {
        let values = entries(size).map(|entry| density(entry_position(volume, size, entry))).collect();
        Values { volume: *volume, size, values }
    }

    /// Tests whether it is that volume's.
    pub fn is_of(&self, volume: &Volume) -> bool {
        self.volume == *volume
    }

    /// All entries, x fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Tests whether points of the solid may be nearer to an entry than its neighbours along all three axes.
    pub fn is_needed(&self, entry: usize) -> bool {
        let n = self.size as usize;
        let at = glam::IVec3::new((entry % n) as i32, (entry / n % n) as i32, (entry / (n * n)) as i32);
        let (middle, spacing) = (entry_position(&self.volume, self.size, at), 2.0 / f64::from(self.size - 1));
        let reach = self.volume.half_extent_m.as_dvec3() * spacing;
        let offset = |i: i32| DVec3::new(f64::from(i % 9), f64::from(i / 9 % 9), f64::from(i / 81)) / 4.0 - 1.0;
        (0..729).any(|i| inwardness(&self.volume, middle + offset(i) * reach * 0.999) >= 0.0)
    }

    /// The value at a point of the world; beyond the box that of its nearest point.
    pub fn value(&self, world: DVec3) -> f64 {
        let last = f64::from(self.size - 1);
        let fraction = (world - self.volume.center.as_dvec3()) / self.volume.half_extent_m.as_dvec3() / 2.0 + 0.5;
        let at = (fraction * last).clamp(DVec3::ZERO, DVec3::splat(last));
        let near = |axis: usize| {
            let low = at[axis].floor().min(last - 1.0);
            [low, low + 1.0].map(|entry| (entry as usize, 1.0 - (at[axis] - entry).abs()))
        };
        let (n, mut sum) = (self.size as usize, 0.0);
        for (z, of_z) in near(2) {
            for (y, of_y) in near(1) {
                for (x, of_x) in near(0) {
                    sum += self.values[(z * n + y) * n + x] * of_x * of_y * of_z;
                }
            }
        }
        sum
    }
}

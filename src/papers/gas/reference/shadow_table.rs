//! The shadow table in double precision, in order of the entries' distance from the light.

use glam::{DVec3, IVec3};

use super::density::Medium;
use crate::papers::gas::model::Volume;
use crate::scene::Light;

/// Densities of the entries, x fastest.
pub fn density_table(medium: &Medium, volume: &Volume, size: u32) -> Vec<f64> {
    entries(size).map(|entry| medium.density(volume, place(volume, size, entry))).collect()
}

/// All entries, x fastest.
fn entries(size: u32) -> impl Iterator<Item = IVec3> {
    let n = size as i32;
    (0..n * n * n).map(move |i| IVec3::new(i % n, i / n % n, i / (n * n)))
}

/// Where an entry lies in the world.
pub fn place(volume: &Volume, size: u32, entry: IVec3) -> DVec3 {
    let share = entry.as_dvec3() / f64::from(size - 1) * 2.0 - 1.0;
    volume.center.as_dvec3() + share * volume.half_extent_m.as_dvec3()
}

/// The sums of density times step towards the light: every entry asks for those that its ray needs, and each is computed
/// once, so that none is read before it is finished.
pub fn shadow_table(densities: &[f64], volume: &Volume, light: &Light, size: u32) -> Vec<f64> {
    let mut table = Table { densities, volume, light, size, sums: vec![None; densities.len()] };
    // By their distance from the light, so that no question goes deep.
    let mut order: Vec<IVec3> = entries(size).collect();
    let distance = |entry: &IVec3| match *light {
        Light::Parallel { direction, .. } => place(volume, size, *entry).dot(direction.as_dvec3()),
        Light::Point { position, .. } => place(volume, size, *entry).distance_squared(position.as_dvec3()),
    };
    order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    order.into_iter().for_each(|entry| {
        table.sum(entry);
    });
    table.sums.into_iter().map(Option::unwrap_or_default).collect()
}

struct Table<'a> {
    densities: &'a [f64],
    volume: &'a Volume,
    light: &'a Light,
    size: u32,
    sums: Vec<Option<f64>>,
}

impl Table<'_> {
    fn sum(&mut self, entry: IVec3) -> f64 {
        let n = self.size as i32;
        let at = ((entry.z * n + entry.y) * n + entry.x) as usize;
        if let Some(known) = self.sums[at] {
            return known;
        }
        let sum = self.computed(entry, at);
        self.sums[at] = Some(sum);
        sum
    }

    fn computed(&mut self, entry: IVec3, at: usize) -> f64 {
        let n = self.size as i32;
        let spacing = self.volume.half_extent_m.as_dvec3() * 2.0 / f64::from(self.size - 1);
        let point = place(self.volume, self.size, entry);
        let (way, distance) = match *self.light {
            Light::Parallel { direction, .. } => (-direction.as_dvec3().normalize(), f64::INFINITY),
            Light::Point { position, .. } => {
                let way = position.as_dvec3() - point;
                (way.normalize_or_zero(), way.length())
            }
        };
        let leaves = |axis: usize| (entry[axis] == 0 && way[axis] < 0.0) || (entry[axis] == n - 1 && way[axis] > 0.0);
        if (0..3).any(leaves) {
            return 0.0;
        }
        // Metres to the planes of the neighbours, and the nearest of them.
        let to_plane = |axis: usize| if way[axis] == 0.0 { f64::INFINITY } else { spacing[axis] / way[axis].abs() };
        let step = (0..3).map(to_plane).fold(f64::INFINITY, f64::min);
        // Where both are equal but for rounding the light lies on the plane: directly as well.
        if distance <= step * (1.0 + 1e-9) {
            return self.densities[at] * distance;
        }
        let pierced = (entry.as_dvec3() + way * step / spacing).clamp(DVec3::ZERO, DVec3::splat(f64::from(n - 1)));
        // Rounding must not make a whole number of entries a little less or more.
        let pierced = DVec3::from(pierced.to_array().map(|c| if (c - c.round()).abs() < 1e-9 { c.round() } else { c }));
        let low = pierced.floor();
        let t = pierced - low;
        let mut sum = 0.0;
        for corner in 0..8 {
            let one = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
            let weight: f64 = (0..3).map(|a| if one[a] == 1 { t[a] } else { 1.0 - t[a] }).product();
            if weight > 0.0 {
                let near = low.as_ivec3() + one;
                let density = self.densities[((near.z * n + near.y) * n + near.x) as usize];
                sum += weight * (self.sum(near) + density * step);
            }
        }
        sum
    }
}

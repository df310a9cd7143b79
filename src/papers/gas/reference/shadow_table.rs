//! The shadow table in double precision, in order of the entries' distance from the light.

use glam::{DVec3, IVec3};

use super::density::Medium;
use super::rays::towards;
use crate::papers::gas::model::Volume;
use crate::papers::gas::parameters::Parameters;
use crate::scene::Light;

/// The tables of all volumes and lights of one scene frame, and how they are read.
pub struct ShadowTables<'a> {
    parameters: &'a Parameters,
    /// Of each volume, of each light.
    sums: Vec<Vec<Vec<f64>>>,
}

impl<'a> ShadowTables<'a> {
    /// Of scene frame `number`, with the parameters' entries a side.
    pub fn new(parameters: &'a Parameters, number: u32) -> Self {
        let (medium, size) = (Medium::new(parameters, number), parameters.table_size);
        let of_volume = |volume: &Volume| {
            let densities = density_table(&medium, volume, size);
            parameters.lights.iter().map(|light| shadow_table(&densities, volume, light, size)).collect()
        };
        ShadowTables { parameters, sums: parameters.volumes.iter().map(of_volume).collect() }
    }

    /// tau times the sums between a point and light `number`: the eight entries round the point, or round the point at
    /// which its ray to the light enters the table's box, interpolated.
    pub fn optical_depth(&self, point: DVec3, number: usize) -> f64 {
        let (direction, distance, _) = towards(&self.parameters.lights[number], point);
        let of_volume = |(volume, tables): (&Volume, &Vec<Vec<f64>>)| {
            let entered = entry_into_box(volume, point, direction).filter(|&at| at <= distance);
            let sum = entered.map_or(0.0, |at| self.interpolated(volume, &tables[number], point + direction * at));
            f64::from(volume.tau_per_m) * sum
        };
        self.parameters.volumes.iter().zip(&self.sums).map(of_volume).sum()
    }

    fn interpolated(&self, volume: &Volume, table: &[f64], point: DVec3) -> f64 {
        let last = f64::from(self.parameters.table_size - 1);
        let fraction = (point - volume.center.as_dvec3()) / volume.half_extent_m.as_dvec3() / 2.0 + 0.5;
        let at = (fraction * last).clamp(DVec3::ZERO, DVec3::splat(last));
        let low = at.floor().min(DVec3::splat(last - 1.0));
        let n = self.parameters.table_size as usize;
        let corner = |corner: usize| {
            let one = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3).map(|a| 1.0 - (at[a] - low[a] - one[a] as f64).abs()).product();
            let [x, y, z] = [0, 1, 2].map(|a| low[a] as usize + one[a]);
            weight * table[(z * n + y) * n + x]
        };
        (0..8).map(corner).sum()
    }
}

/// Ray parameter at which the ray of a point enters the box around the solid, metres, 0 from inside; nothing where the
/// ray misses it.
fn entry_into_box(volume: &Volume, point: DVec3, direction: DVec3) -> Option<f64> {
    let (center, half) = (volume.center.as_dvec3(), volume.half_extent_m.as_dvec3());
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (from, along) = (point[axis] - center[axis], direction[axis]);
        if along == 0.0 {
            if from.abs() > half[axis] {
                return None;
            }
        } else {
            enter = enter.max((-half[axis] * along.signum() - from) / along);
            leave = leave.min((half[axis] * along.signum() - from) / along);
        }
    }
    (enter <= leave).then_some(enter)
}

/// Densities of the entries, x fastest.
pub fn density_table(medium: &Medium, volume: &Volume, size: u32) -> Vec<f64> {
    entries(size).map(|entry| medium.density(volume, entry_position(volume, size, entry))).collect()
}

/// All entries, x fastest.
pub fn entries(size: u32) -> impl Iterator<Item = IVec3> {
    let n = size as i32;
    (0..n * n * n).map(move |i| IVec3::new(i % n, i / n % n, i / (n * n)))
}

/// The position of an entry in the world.
pub fn entry_position(volume: &Volume, size: u32, entry: IVec3) -> DVec3 {
    let fraction = entry.as_dvec3() / f64::from(size - 1) * 2.0 - 1.0;
    volume.center.as_dvec3() + fraction * volume.half_extent_m.as_dvec3()
}

/// The sums of density times step towards the light: every entry asks for those that its ray needs, and each is
/// computed once, so that none is read before it is finished.
pub fn shadow_table(densities: &[f64], volume: &Volume, light: &Light, size: u32) -> Vec<f64> {
    let mut table = Table { densities, volume, light, size, sums: vec![None; densities.len()] };
    // By their distance from the light, so that no question goes deep.
    let mut order: Vec<IVec3> = entries(size).collect();
    let distance = |entry: &IVec3| match *light {
        Light::Parallel { direction, .. } => entry_position(volume, size, *entry).dot(direction.as_dvec3()),
        Light::Point { position, .. } => entry_position(volume, size, *entry).distance_squared(position.as_dvec3()),
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
        let point = entry_position(self.volume, self.size, entry);
        let (direction, distance) = match *self.light {
            Light::Parallel { direction, .. } => (-direction.as_dvec3().normalize(), f64::INFINITY),
            Light::Point { position, .. } => {
                let direction = position.as_dvec3() - point;
                (direction.normalize_or_zero(), direction.length())
            }
        };
        let leaves = |axis: usize| {
            (entry[axis] == 0 && direction[axis] < 0.0) || (entry[axis] == n - 1 && direction[axis] > 0.0)
        };
        if (0..3).any(leaves) {
            return 0.0;
        }
        // Metres to the planes of the neighbours, and the nearest of them.
        let to_plane =
            |axis: usize| if direction[axis] == 0.0 { f64::INFINITY } else { spacing[axis] / direction[axis].abs() };
        let step = (0..3).map(to_plane).fold(f64::INFINITY, f64::min);
        // Where both are equal but for rounding the light lies on the plane: directly as well.
        if distance <= step * (1.0 + 1e-9) {
            return self.densities[at] * distance;
        }
        let pierced =
            (entry.as_dvec3() + direction * step / spacing).clamp(DVec3::ZERO, DVec3::splat(f64::from(n - 1)));
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

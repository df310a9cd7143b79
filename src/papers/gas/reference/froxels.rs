//! Gas that is integrated in froxels, in double precision: columns of slices, in each of which the gas is the same everywhere.

use std::f64::consts::PI;

use glam::DVec3;

use super::phase::phase;
use super::rays::{Gas, Rays, segment, towards};
use super::shadow_table::ShadowTables;
use crate::papers::gas::parameters::Parameters;

/// Gas of a froxel.
#[derive(Clone, Copy)]
struct Froxel {
    /// Per metre.
    extinction: f64,
    /// Light that an element sends to the eye, times the extinction.
    light: DVec3,
}

/// The froxels of one scene frame, under the shadow tables of the same size; of gases, without solids.
pub struct Froxels<'a> {
    parameters: &'a Parameters,
    rays: Rays<'a>,
    shadows: ShadowTables<'a>,
    /// Depths of the slices' borders.
    borders: Vec<f64>,
    /// Slices of each column, row by row.
    columns: Vec<Vec<Froxel>>,
}

impl<'a> Froxels<'a> {
    /// Of scene frame `number`.
    pub fn new(parameters: &'a Parameters, number: u32) -> Self {
        let (rays, shadows) = (Rays::new(parameters, number), ShadowTables::new(parameters, number));
        let mut froxels = Froxels { parameters, rays, shadows, borders: Vec::new(), columns: Vec::new() };
        froxels.borders = froxels.borders();
        let [columns, rows, _] = parameters.froxels;
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        froxels.columns = all.map(|column| froxels.column(column)).collect();
        froxels
    }

    /// Equal ratios from the first corner of the volumes' boxes to the last one.
    fn borders(&self) -> Vec<f64> {
        let camera = &self.parameters.camera;
        let forward = (camera.target - camera.eye).as_dvec3().normalize();
        let depths = self.parameters.volumes.iter().flat_map(|volume| {
            let corner = move |number: u32| {
                let side = |bit: u32| if number >> bit & 1 == 0 { -1.0 } else { 1.0 };
                volume.center.as_dvec3() + volume.half_extent_m.as_dvec3() * DVec3::new(side(0), side(1), side(2))
            };
            (0..8).map(move |number| (corner(number) - camera.eye.as_dvec3()).dot(forward))
        });
        let seen = depths.map(|depth| depth.clamp(camera.near_m.into(), camera.far_m.into()));
        let (first, last) = seen.fold((f64::INFINITY, 0.0_f64), |(low, high), depth| (low.min(depth), high.max(depth)));
        let slices = self.parameters.froxels[2];
        let ratio = (last / first).powf(1.0 / f64::from(slices));
        (0..=slices).map(|border| first * ratio.powi(border as i32)).collect()
    }

    /// The ray in the middle of a column, of depth 1.
    fn ray(&self, [column, row]: [u32; 2]) -> DVec3 {
        let [columns, rows, _] = self.parameters.froxels.map(f64::from);
        let (width, height) = (f64::from(self.parameters.width), f64::from(self.parameters.height));
        self.rays.direction((f64::from(column) + 0.5) * width / columns, (f64::from(row) + 0.5) * height / rows)
    }

    fn column(&self, column: [u32; 2]) -> Vec<Froxel> {
        let (ray, samples) = (self.ray(column), self.parameters.samples);
        let slice = |borders: &[f64]| {
            let depth = |i: u32| borders[0] + (borders[1] - borders[0]) * (f64::from(i) + 0.5) / f64::from(samples);
            let found = (0..samples).map(|i| self.sample(self.rays.eye() + ray * depth(i), ray.normalize()));
            let sum = found.fold((0.0, DVec3::ZERO), |sum, one| (sum.0 + one.extinction, sum.1 + one.light));
            Froxel { extinction: sum.0 / f64::from(samples), light: sum.1 / f64::from(samples) }
        };
        self.borders.windows(2).map(slice).collect()
    }

    fn sample(&self, point: DVec3, direction: DVec3) -> Froxel {
        let mut found = Froxel { extinction: 0.0, light: DVec3::ZERO };
        for volume in &self.parameters.volumes {
            let thickness = f64::from(volume.tau_per_m) * self.rays.medium.density(volume, point);
            let of_light = |(number, light)| {
                let (to_light, _, irradiance) = towards(light, point);
                let passed = (-self.shadows.optical_depth(point, number)).exp();
                irradiance * (passed * PI * phase(&volume.phase, to_light.dot(direction)))
            };
            let light: DVec3 = self.parameters.lights.iter().enumerate().map(of_light).sum();
            found.extinction += thickness;
            found.light += volume.albedo.as_dvec3() * (light + self.parameters.ambient.as_dvec3()) * thickness;
            found.light += (1.0 - volume.albedo.as_dvec3()) * self.rays.medium.glow(volume, point) * thickness;
        }
        found
    }

    /// Light and transparency of a column's gas before a depth.
    fn before(&self, column: [u32; 2], depth: f64) -> Gas {
        let mut gas = Gas { color: DVec3::ZERO, transparency: 1.0 };
        let scale = self.ray(column).length();
        let slices = &self.columns[(column[1] * self.parameters.froxels[0] + column[0]) as usize];
        for (froxel, borders) in slices.iter().zip(self.borders.windows(2)) {
            let length = (depth.min(borders[1]) - borders[0]).max(0.0) * scale;
            let passed = (-froxel.extinction * length).exp();
            if froxel.extinction > 0.0 {
                gas.color += froxel.light / froxel.extinction * (gas.transparency * (1.0 - passed));
            }
            gas.transparency *= passed;
        }
        gas
    }

    /// The mean of the columns round a pixel, by their distances from it.
    fn around(&self, pixel: [u32; 2], depth: f64) -> Gas {
        let [columns, rows, _] = self.parameters.froxels;
        let size = [(columns, self.parameters.width), (rows, self.parameters.height)];
        let weights = |axis: usize| {
            let (count, pixels) = size[axis];
            let at = (f64::from(pixel[axis]) + 0.5) * f64::from(count) / f64::from(pixels) - 0.5;
            let at = at.clamp(0.0, f64::from(count - 1));
            (0..count).map(move |index| (index, (1.0 - (at - f64::from(index)).abs()).max(0.0)))
        };
        let mut mean = Gas { color: DVec3::ZERO, transparency: 0.0 };
        for (row, of_row) in weights(1).filter(|(_, weight)| *weight > 0.0) {
            for (column, of_column) in weights(0).filter(|(_, weight)| *weight > 0.0) {
                let gas = self.before([column, row], depth);
                mean.color += gas.color * (of_row * of_column);
                mean.transparency += gas.transparency * of_row * of_column;
            }
        }
        mean
    }

    /// The gas of a pixel where its ray is in a volume, from the hither to the yon plane.
    pub fn pixel(&self, column: u32, row: u32) -> Gas {
        let ray = self.rays.direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let (scale, camera) = (ray.length(), &self.parameters.camera);
        let depth = |distance: f64| (distance / scale).clamp(camera.near_m.into(), camera.far_m.into());
        let segments = self.parameters.volumes.iter().filter_map(|v| segment(v, self.rays.eye(), ray / scale));
        let segments: Vec<[f64; 2]> = segments.map(|(from, to)| [depth(from), depth(to)]).collect();
        let mut cuts = segments.concat();
        cuts.sort_by(f64::total_cmp);
        let mut gas = Gas { color: DVec3::ZERO, transparency: 1.0 };
        for cut in cuts.windows(2) {
            let middle = f64::midpoint(cut[0], cut[1]);
            if segments.iter().any(|segment| segment[0] <= middle && middle <= segment[1]) {
                let [near, far] = [cut[0], cut[1]].map(|depth| self.around([column, row], depth));
                gas.color += (far.color - near.color) * (gas.transparency / near.transparency);
                gas.transparency *= far.transparency / near.transparency;
            }
        }
        gas
    }
}

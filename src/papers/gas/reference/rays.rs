//! A pixel's ray through the gas, and the rays to the lights, in double precision (sections "Volume rendering",
//! "Illumination of gaseous phenomena" and "Shadowing of the gas"). Surfaces do not occlude it.

use std::f64::consts::PI;

use glam::DVec3;

use super::density::{Medium, inwardness};
use super::noise::scramble;
use super::phase::phase;
use super::shadow_table::ShadowTables;
use crate::papers::gas::blue_noise;
use crate::papers::gas::model::Volume;
use crate::papers::gas::parameters::{Jitter, Parameters};
use crate::scene::Light;

/// Positions of the samples of a viewer's ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// One in each part of an increment, at the point that the numbers of frame and seed say (Monte Carlo).
    Random,
    /// So many in the middles of each increment's parts: the integral that the random ones estimate.
    Fine(u32),
}

/// The light of a ray at the eye.
#[derive(Debug, Clone, Copy)]
pub struct Gas {
    /// Premultiplied, linear RGB.
    pub color: DVec3,
    /// Of all gas on the ray, 0 to 1.
    pub transparency: f64,
}

/// The rays of one scene frame.
pub struct Rays<'a> {
    parameters: &'a Parameters,
    /// The densities of the frame.
    pub medium: Medium,
    number: u32,
    /// Ranks of the mask of blue noise; empty where samples lie at random.
    mask: Vec<u32>,
    /// Shadows inside the gas are read from; traced without.
    tables: Option<&'a ShadowTables<'a>>,
}

impl<'a> Rays<'a> {
    /// Of scene frame `number`.
    pub fn new(parameters: &'a Parameters, number: u32) -> Self {
        let mask = match parameters.jitter {
            Jitter::Random => Vec::new(),
            Jitter::BlueNoise => blue_noise::mask(parameters.seed),
        };
        Rays { parameters, medium: Medium::new(parameters, number), number, mask, tables: None }
    }

    /// The same, whose gas shadows itself by tables of the same scene frame (section "Calculation of the shadow table").
    pub fn shadowed_by(self, tables: &'a ShadowTables<'a>) -> Self {
        Rays { tables: Some(tables), ..self }
    }

    pub fn eye(&self) -> DVec3 {
        self.parameters.camera.eye.as_dvec3()
    }

    /// Direction through a point of the picture, pixels from its upper left corner; of depth 1.
    pub fn direction(&self, column: f64, row: f64) -> DVec3 {
        let camera = &self.parameters.camera;
        let forward = (camera.target.as_dvec3() - self.eye()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let (width, height) = (f64::from(self.parameters.width), f64::from(self.parameters.height));
        let pixel = (f64::from(camera.vertical_fov_rad) / 2.0).tan() / (height / 2.0);
        forward + (right * (column - width / 2.0) - up * (row - height / 2.0)) * pixel
    }

    /// The ray of a pixel through all volumes, from the hither to the yon plane. `are_shadowed`: whether the gas
    /// shadows itself.
    pub fn pixel(&self, column: u32, row: u32, are_shadowed: bool, sampling: Sampling) -> Gas {
        let ray = self.direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let scale = ray.length();
        let camera = &self.parameters.camera;
        let (near, far) = (f64::from(camera.near_m) * scale, f64::from(camera.far_m) * scale);
        let segments: Vec<Option<(f64, f64)>> = self
            .parameters
            .volumes
            .iter()
            .map(|v| segment(v, self.eye(), ray / scale).map(|(a, b)| (a.max(near), b.min(far))).filter(|(a, b)| a < b))
            .collect();
        let mut cuts: Vec<f64> = segments.iter().flatten().flat_map(|&(a, b)| [a, b]).collect();
        cuts.sort_by(f64::total_cmp);
        let mut march = March {
            rays: self,
            pixel: row * self.parameters.width + column,
            direction: ray / scale,
            are_shadowed,
            sampling,
            number: 0,
            gas: Gas { color: DVec3::ZERO, transparency: 1.0 },
        };
        for cut in cuts.windows(2) {
            let middle = (cut[0] + cut[1]) / 2.0;
            let is_in = |segment: &Option<(f64, f64)>| segment.is_some_and(|(a, b)| a <= middle && middle <= b);
            let inside: Vec<&Volume> =
                self.parameters.volumes.iter().zip(&segments).filter(|(_, s)| is_in(s)).map(|(v, _)| v).collect();
            if !inside.is_empty() && march.section(&inside, cut[0], cut[1]) {
                break;
            }
        }
        march.gas
    }

    /// tau times the density's integral from a point to a light, by the middles of each volume's steps divided by
    /// `finer`.
    pub fn optical_depth(&self, point: DVec3, light: &Light, finer: u32) -> f64 {
        let (direction, distance, _) = towards(light, point);
        let depth = |volume: &Volume| {
            let Some((a, b)) = segment(volume, point, direction) else { return 0.0 };
            let (a, b) = (a.max(0.0), b.min(distance));
            if a >= b {
                return 0.0;
            }
            let step = f64::from(volume.step_m(self.parameters.steps)) / f64::from(finer);
            let increments = ((b - a) / step).ceil() as u32;
            let part = |i: u32| {
                let from = f64::from(i) * step;
                let increment = step.min(b - a - from);
                self.medium.density(volume, point + direction * (a + from + increment / 2.0)) * increment
            };
            f64::from(volume.tau_per_m) * (0..increments).map(part).sum::<f64>()
        };
        self.parameters.volumes.iter().map(depth).sum()
    }
}

/// The march of one pixel.
struct March<'a> {
    rays: &'a Rays<'a>,
    pixel: u32,
    direction: DVec3,
    are_shadowed: bool,
    sampling: Sampling,
    /// Of the next increment.
    number: u32,
    gas: Gas,
}

impl March<'_> {
    /// Marches the gas between two cuts; true where the transparency left ends the tracing.
    fn section(&mut self, inside: &[&Volume], from: f64, to: f64) -> bool {
        let parameters = self.rays.parameters;
        let step = inside.iter().map(|v| f64::from(v.step_m(parameters.steps))).fold(f64::INFINITY, f64::min)
            / f64::from(parameters.samples);
        let early = f64::from(parameters.early_end);
        let early = if inside.iter().any(|v| v.is_solid) { early.max(0.01) } else { early };
        let increments = ((to - from) / step).ceil() as u32;
        for i in 0..increments {
            let start = f64::from(i) * step;
            let increment = step.min(to - from - start);
            match self.sampling {
                Sampling::Random => self.add(inside, from + start + increment * self.random(), increment),
                Sampling::Fine(parts) => {
                    let part = increment / f64::from(parts);
                    (0..parts).for_each(|k| self.add(inside, from + start + part * (f64::from(k) + 0.5), part));
                }
            }
            self.number += 1;
            if self.gas.transparency < early {
                return true;
            }
        }
        false
    }

    /// The device's number of this sample, 0 to 1: integers, so exact.
    fn random(&self) -> f64 {
        if !self.rays.mask.is_empty() {
            let (width, side) = (self.rays.parameters.width, blue_noise::SIDE as u32);
            let (column, row) = (self.pixel % width % side, self.pixel / width % side);
            let rank = self.rays.mask[(row * side + column) as usize];
            let moved = 0x9e37_79b9_u32.wrapping_mul(self.rays.number);
            return f64::from(((rank << 20) + 0x8_0000).wrapping_add(moved) >> 8) / 16_777_216.0;
        }
        let of_frame = scramble(self.rays.parameters.noise_seed().wrapping_add(self.rays.number));
        let h = scramble(self.pixel.wrapping_mul(0x9e37_79b9) ^ scramble(self.number ^ of_frame));
        f64::from(h >> 8) / 16_777_216.0
    }

    /// B += T albedo (1 - exp(-tau rho dt)) sum(I_i phase), for all volumes at once.
    fn add(&mut self, inside: &[&Volume], at: f64, increment: f64) {
        let point = self.rays.eye() + self.direction * at;
        let densities: Vec<f64> = inside.iter().map(|volume| self.rays.medium.density(volume, point)).collect();
        let densest = densities.iter().copied().fold(0.0, f64::max);
        let are_shadowed = self.are_shadowed && densest >= f64::from(self.rays.parameters.shadow_threshold);
        let (mut extinction, mut emission) = (0.0, DVec3::ZERO);
        for (volume, density) in inside.iter().zip(densities) {
            let thickness = f64::from(volume.tau_per_m) * density;
            extinction += thickness;
            if thickness > 0.0 {
                emission += volume.albedo.as_dvec3() * self.light(volume, point, are_shadowed) * thickness;
                emission += (1.0 - volume.albedo.as_dvec3()) * self.rays.medium.glow(volume, point) * thickness;
            }
        }
        if extinction > 0.0 {
            let passed = (-extinction * increment).exp();
            self.gas.color += emission / extinction * self.gas.transparency * (1.0 - passed);
            self.gas.transparency *= passed;
        }
    }

    /// The light that an element sends to the eye, for albedo 1: a gas by its phase function, a solid by its normal.
    fn light(&self, volume: &Volume, point: DVec3, are_shadowed: bool) -> DVec3 {
        let parameters = self.rays.parameters;
        let of_light = |(number, light): (usize, &Light)| {
            let (direction, _, irradiance) = towards(light, point);
            let depth = match self.rays.tables {
                _ if !are_shadowed => 0.0,
                None => self.rays.optical_depth(point, light, 1),
                Some(tables) => tables.optical_depth(point, number),
            };
            let response = if volume.is_solid {
                self.normal(volume, point).dot(direction).max(0.0)
            } else {
                PI * phase(&volume.phase, direction.dot(self.direction))
            };
            irradiance * (-depth).exp() * response
        };
        parameters.ambient.as_dvec3() + parameters.lights.iter().enumerate().map(of_light).sum::<DVec3>()
    }

    /// Direction in which the density falls the fastest, by central differences (Perlin and Hoffert).
    fn normal(&self, volume: &Volume, point: DVec3) -> DVec3 {
        let apart = 1e-4 * volume.half_extent_m.as_dvec3().max_element();
        let slope = |axis: DVec3| {
            let at = |side: f64| self.rays.medium.density(volume, point + axis * (side * apart));
            at(-1.0) - at(1.0)
        };
        let falling = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
        falling.normalize_or(-self.direction)
    }
}

/// Unit direction to a light, distance, and what falls onto a surface that faces it.
pub fn towards(light: &Light, point: DVec3) -> (DVec3, f64, DVec3) {
    match *light {
        Light::Parallel { direction, intensity } => {
            (-direction.as_dvec3().normalize(), f64::INFINITY, intensity.as_dvec3())
        }
        Light::Point { position, intensity } => {
            let direction = position.as_dvec3() - point;
            (direction.normalize_or_zero(), direction.length(), intensity.as_dvec3() / direction.length_squared())
        }
    }
}

/// The ray segment of a unit direction inside a solid: any point inside, and from there both ends by halving. It misses
/// segments shorter than a five-hundredth of the solid.
pub(super) fn segment(volume: &Volume, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    let radius = volume.half_extent_m.as_dvec3().length() * 1.001;
    let nearest = (volume.center.as_dvec3() - origin).dot(direction);
    let is_inside = |at: f64| inwardness(volume, origin + direction * at) >= 0.0;
    let parameter = |i: i32| nearest + radius * f64::from(i) / 500.0;
    let inside = (-500..=500).map(parameter).find(|&at| is_inside(at))?;
    let end = |mut outside: f64| {
        let mut inside = inside;
        for _ in 0..60 {
            let middle = (inside + outside) / 2.0;
            if is_inside(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    Some((end(nearest - radius), end(nearest + radius)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::gas::model::{DensityFunction, Shape, SolidTexture};
    use crate::papers::gas::parameters::default_volume;

    #[test]
    fn a_ball_is_as_thick_as_its_chord() {
        let texture = SolidTexture { function: DensityFunction::Constant, ..default_volume().texture };
        let ball = Volume { shape: Shape::Sphere, texture, ..default_volume() };
        for height in [0.0, 0.3, 0.9] {
            let (a, b) = segment(&ball, DVec3::new(-5.0, height, 0.0), DVec3::X).unwrap();
            let half = (1.0 - height * height).sqrt();
            assert!((a - 5.0 + half).abs() < 1e-9 && (b - 5.0 - half).abs() < 1e-9);
        }
        assert!(segment(&ball, DVec3::new(-5.0, 1.01, 0.0), DVec3::X).is_none());
        let parameters = Parameters { volumes: vec![ball], early_end: 0.0, ..Parameters::default() };
        let rays = Rays::new(&parameters, 0);
        let gas = rays.pixel(180, 125, false, Sampling::Random);
        let ray = rays.direction(180.5, 125.5).normalize();
        let (a, b) = segment(&ball, rays.eye(), ray).unwrap();
        assert!((gas.transparency - (-2.0 * (b - a)).exp()).abs() < 1e-9);
    }
}

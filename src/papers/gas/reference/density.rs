//! Densities at points of the world, in double precision, from the text's functions.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use super::density_cache::Values;
use super::grid;
use super::noise::{noise, turbulence};
use crate::papers::gas::blocks::{OFFSET_SIZE, offsets};
use crate::papers::gas::grid::{Filter, Grid};
use crate::papers::gas::model::{DensityFunction, Shape, SolidTexture, Swirl, Volume};
use crate::papers::gas::parameters::Parameters;

/// The dependences of a density beside its point.
pub struct Medium {
    seed: u32,
    offsets: [f32; OFFSET_SIZE],
    pixel_size: f64,
    frame: f64,
    grids: Vec<Arc<Grid>>,
    filter: Filter,
    /// The tables of values of all volumes; empty where the densities are asked for themselves.
    cached: Vec<Values>,
}

impl Medium {
    /// Of scene frame `number`.
    pub fn new(parameters: &Parameters, number: u32) -> Self {
        let mut medium = Medium {
            seed: parameters.noise_seed(),
            offsets: offsets(parameters.seed),
            pixel_size: f64::from(parameters.pixel_size),
            frame: f64::from(number),
            grids: parameters.grids.clone(),
            filter: parameters.filter,
            cached: Vec::new(),
        };
        if let Some(size) = parameters.density_cache {
            let values = |volume: &Volume| {
                Values::new(volume, size, |world| medium.texture_density(&volume.texture, Some(volume), world))
            };
            let cached = parameters.volumes.iter().map(values).collect();
            medium.cached = cached;
        }
        medium
    }

    pub fn noise(&self, p: DVec3) -> f64 {
        noise(p, self.seed)
    }

    pub fn turbulence(&self, p: DVec3) -> f64 {
        turbulence(p, self.pixel_size, self.seed)
    }

    /// The helix: theta = (frame mod SWIRL_FRAMES) 2 pi / SWIRL_FRAMES.
    fn ellipse(&self, swirl: Swirl) -> [f64; 2] {
        let frames = f64::from(swirl.frames);
        if frames <= 0.0 {
            return [0.0; 2];
        }
        let theta = self.frame.rem_euclid(frames) * TAU / frames;
        [f64::from(swirl.ellipse[0]) * theta.cos(), f64::from(swirl.ellipse[1]) * theta.sin()]
    }

    fn offset(&self, at: f64) -> f64 {
        let entry = |i: f64| f64::from(self.offsets[i.rem_euclid(OFFSET_SIZE as f64) as usize]);
        let (low, t) = (at.floor(), at - at.floor());
        entry(low) * (1.0 - t) + entry(low + 1.0) * t
    }

    /// The density function of `texture`; the solid of `volume` stands for what depends on it.
    pub fn texture_density(&self, texture: &SolidTexture, volume: Option<&Volume>, world: DVec3) -> f64 {
        let (center, half) =
            volume.map_or((DVec3::ZERO, DVec3::ONE), |v| (v.center.as_dvec3(), v.half_extent_m.as_dvec3()));
        let (opaque, power) = (f64::from(texture.opaque), f64::from(texture.power));
        let p = world * f64::from(texture.scale_per_m) + texture.offset.as_dvec3();
        match texture.function {
            DensityFunction::Constant => opaque,
            DensityFunction::Turbulence => (self.turbulence(p) * opaque).powf(power),
            DensityFunction::Clouds { frequency } => {
                let first = p + DVec3::X * self.noise(p);
                let second = first + DVec3::Y * self.noise(first);
                let wave = (self.turbulence(second) * f64::from(frequency)).sin();
                let transparency = 1.0 - ((wave + 1.0) / 2.0).max(0.0).powf(power);
                opaque * (1.0 - transparency)
            }
            DensityFunction::Fog { swirl, front } => {
                let disturbance = self.turbulence(p);
                let edge = f64::from(front.x_m)
                    + f64::from(front.per_frame_m) * self.frame
                    + f64::from(front.turbulence_m) * disturbance
                    + f64::from(front.table_m) * self.offset(p.z);
                if world.x > edge {
                    return 0.0;
                }
                let point = p + DVec3::new(2.0 + disturbance, 0.5 + disturbance, -2.0 - disturbance);
                let [y, z] = self.ellipse(swirl);
                let direction = point + DVec3::new(-self.frame * f64::from(swirl.along_per_frame), y, z);
                let full = f64::from(front.full_frames);
                let factor = if full > 0.0 { (self.frame / full).min(1.0) } else { 1.0 };
                let thickness = ((edge - world.x) / f64::from(front.depth_m)).clamp(0.0, 1.0);
                (self.turbulence(direction) * opaque * factor).powf(power) * thickness
            }
            DensityFunction::Steam { swirl } => {
                let [x, z] = self.ellipse(swirl);
                let fallen = self.frame * f64::from(swirl.along_per_frame);
                let point = p + DVec3::splat(self.turbulence(p)) + DVec3::new(x, -fallen, z);
                let height = (world.y - (center.y - half.y)) / (2.0 * half.y);
                (self.turbulence(point) * opaque).powf(power) * (1.0 - height).clamp(0.0, 1.0)
            }
            DensityFunction::Grid(index) => {
                let value = |grid: &Arc<Grid>| grid::value(grid, self.filter, world - center).clamp(0.0, 1.0);
                (self.grids.get(index).map_or(0.0, value) * opaque).powf(power)
            }
            DensityFunction::Hypertexture { amplitude, softness } => {
                let radius = ((world - center) / half).length() * (1.0 + f64::from(amplitude) * self.turbulence(p));
                opaque * ((1.0 - radius) / f64::from(softness)).clamp(0.0, 1.0)
            }
        }
    }

    /// The light of a file's temperature, linear RGB.
    pub fn glow(&self, volume: &Volume, world: DVec3) -> DVec3 {
        match volume.texture.function {
            DensityFunction::Grid(index) => {
                let from_middle = world - volume.center.as_dvec3();
                self.grids.get(index).map_or(DVec3::ZERO, |grid| grid::glow(grid, from_middle))
            }
            _ => DVec3::ZERO,
        }
    }

    /// Density inside the solid, faded towards its boundary; of a hypertexture solid -ln(1 - density).
    pub fn density(&self, volume: &Volume, world: DVec3) -> f64 {
        let inside = inwardness(volume, world);
        if inside < 0.0 {
            return 0.0;
        }
        let falloff = f64::from(volume.falloff);
        let t = if falloff > 0.0 { (inside / falloff).min(1.0) } else { 1.0 };
        let value = match self.cached.iter().find(|values| values.is_of(volume)) {
            Some(values) => values.value(world),
            None => self.texture_density(&volume.texture, Some(volume), world),
        };
        let density = value * t * t * (3.0 - 2.0 * t);
        if volume.is_solid { -(1.0 - density.clamp(0.0, 0.9999)).ln() } else { density }
    }

    /// tau times the integral of the density from `from` to `to`, by the middles of `count` parts.
    pub fn optical_depth(&self, volume: &Volume, from: DVec3, to: DVec3, count: u32) -> f64 {
        let part = (to - from) / f64::from(count);
        let sum: f64 = (0..count).map(|i| self.density(volume, from + part * (f64::from(i) + 0.5))).sum();
        f64::from(volume.tau_per_m) * sum * part.length()
    }
}

/// Depth of a point inside the solid: 0 on its boundary, 1 in its middle, negative outside.
pub fn inwardness(volume: &Volume, world: DVec3) -> f64 {
    let q = (world - volume.center.as_dvec3()) / volume.half_extent_m.as_dvec3();
    let around = q.x.hypot(q.z);
    match volume.shape {
        Shape::Box => (1.0 - q.abs()).min_element(),
        Shape::Sphere => 1.0 - q.length(),
        Shape::Cylinder => (1.0 - q.y.abs()).min(1.0 - around),
        Shape::Frustum { bottom, top } => {
            let fraction = ((q.y + 1.0) / 2.0).clamp(0.0, 1.0);
            let radius = f64::from(bottom) * (1.0 - fraction) + f64::from(top) * fraction;
            (1.0 - q.y.abs()).min(radius - around)
        }
    }
}

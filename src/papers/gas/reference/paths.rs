//! Light that gas scatters any number of times, by paths from the eye in double precision, whose mean is the integral. The paper
//! scatters once and leaves the rest to its ambient light, which here comes from all around and is scattered as well.
//! Surfaces take no part in it.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::bounds::Bounds;
use super::phase::{phase, turned};
use super::rays::{Rays, segment, towards};
use crate::papers::gas::model::Volume;
use crate::papers::gas::parameters::{MAX_VOLUMES, Parameters};
use crate::scene::Light;
use crate::scene::random::Random;

/// Parts of a pixel's ray between two borders of volumes: its transparency is a sum over their middles, and the first scattering
/// is in one of these.
const PARTS: u32 = 256;
/// Scatterings after which a path goes on by lot.
const CERTAIN: u32 = 3;
/// Scatterings of a path after which it has no end.
pub const MOST_SCATTERINGS: u32 = 100_000;

/// The gas of a pixel, in two estimates that are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scattered {
    /// Light of the gas, premultiplied, linear RGB.
    pub all: [DVec3; 2],
    /// The part of it that was scattered once, and the light that hot gas itself sends to the eye.
    pub once: [DVec3; 2],
    /// Of all gas on the pixel's ray, 0 to 1.
    pub transparency: f64,
}

/// Paths through the gas of one scene frame.
pub struct Paths<'a> {
    parameters: &'a Parameters,
    rays: Rays<'a>,
    bounds: Bounds,
}

/// A place in the gas, with the extinctions of the volumes there.
#[derive(Clone, Copy)]
struct Place {
    point: DVec3,
    /// tau density of each volume, per metre.
    thickness: [f64; MAX_VOLUMES],
    /// Their sum.
    extinction: f64,
}

/// A part of a pixel's ray.
struct Part {
    middle: Place,
    /// The fraction of light that all parts up to its end stop.
    stopped: f64,
}

impl<'a> Paths<'a> {
    /// Of scene frame `number`.
    pub fn new(parameters: &'a Parameters, number: u32) -> Self {
        let mut paths = Paths { parameters, rays: Rays::new(parameters, number), bounds: Bounds::default() };
        paths.bounds = Bounds::new(&parameters.volumes, |point| paths.place(point).extinction);
        paths
    }

    /// The pixels of a row, by that many paths in each half; nothing where a path has no end.
    pub fn row(&self, row: u32, paths: u32) -> Option<Vec<Scattered>> {
        let width = self.parameters.width;
        (row * width..(row + 1) * width).into_par_iter().map(|pixel| self.pixel(pixel, paths)).collect()
    }

    /// A pixel, numbered row by row.
    fn pixel(&self, pixel: u32, paths: u32) -> Option<Scattered> {
        let (column, row) = (pixel % self.parameters.width, pixel / self.parameters.width);
        let ray = self.rays.direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let parts = self.parts(ray);
        let stopped = parts.last().map_or(0.0, |part| part.stopped);
        let halves = [DVec3::ZERO; 2];
        let mut scattered = Scattered { all: halves, once: halves, transparency: 1.0 - stopped };
        for (half, (all, once)) in (0..).zip(scattered.all.iter_mut().zip(&mut scattered.once)) {
            if parts.is_empty() {
                continue;
            }
            let mut random = Numbers::new(self.parameters.seed, 2 * u64::from(pixel) + half);
            // The first three numbers of each path lie in strata of their own.
            let strata = [random.shuffled(paths), random.shuffled(paths)];
            for number in 0..paths {
                let mut within = |stratum: u32| (f64::from(stratum) + random.unit()) / f64::from(paths);
                let depth = within(number) * stopped;
                let turn = [within(strata[0][number as usize]), within(strata[1][number as usize])];
                let part = parts.partition_point(|part| part.stopped <= depth).min(parts.len() - 1);
                let light = self.walk(parts[part].middle, ray.normalize(), turn, &mut random)?;
                *once += light[0] * (stopped / f64::from(paths));
                *all += light[1] * (stopped / f64::from(paths));
            }
        }
        Some(scattered)
    }

    fn place(&self, point: DVec3) -> Place {
        let mut place = Place { point, thickness: [0.0; MAX_VOLUMES], extinction: 0.0 };
        for (volume, thickness) in self.parameters.volumes.iter().zip(&mut place.thickness) {
            *thickness = f64::from(volume.tau_per_m) * self.rays.medium.density(volume, point);
            place.extinction += *thickness;
        }
        place
    }

    /// The parts of a pixel's ray in which there is gas, from the hither to the yon plane.
    fn parts(&self, ray: DVec3) -> Vec<Part> {
        let (scale, camera) = (ray.length(), &self.parameters.camera);
        let (near, far) = (f64::from(camera.near_m) * scale, f64::from(camera.far_m) * scale);
        let (eye, direction) = (self.rays.eye(), ray / scale);
        let segments = self.parameters.volumes.iter().filter_map(|volume| segment(volume, eye, direction));
        let mut cuts: Vec<f64> = segments.flat_map(|(from, to)| [from.clamp(near, far), to.clamp(near, far)]).collect();
        cuts.sort_by(f64::total_cmp);
        let (mut parts, mut depth) = (Vec::new(), 0.0);
        for cut in cuts.windows(2) {
            let length = (cut[1] - cut[0]) / f64::from(PARTS);
            for part in 0..if length > 0.0 { PARTS } else { 0 } {
                let middle = self.place(eye + direction * (cut[0] + length * (f64::from(part) + 0.5)));
                depth += middle.extinction * length;
                if middle.extinction * length > 0.0 {
                    parts.push(Part { middle, stopped: -(-depth).exp_m1() });
                }
            }
        }
        parts
    }

    /// The light that a path brings from its first scattering on, of which `direction` leads away from the eye: what was
    /// scattered once, and all. `turn` says how the first one turns it.
    fn walk(&self, first: Place, direction: DVec3, turn: [f64; 2], random: &mut Numbers) -> Option<[DVec3; 2]> {
        let (mut place, mut direction, mut turn) = (first, direction, turn);
        let (mut weight, mut once, mut all) = (DVec3::ONE, DVec3::ZERO, DVec3::ZERO);
        for order in 1..=MOST_SCATTERINGS {
            let volume = self.met(&place, random);
            all += weight * (1.0 - volume.albedo.as_dvec3()) * self.rays.medium.glow(volume, place.point);
            weight *= volume.albedo.as_dvec3();
            all += weight * self.lit(volume, place.point, direction, random);
            if order == 1 {
                once = all;
            }
            if order > CERTAIN {
                let goes_on = weight.abs().max_element().min(1.0);
                if random.unit() >= goes_on {
                    return Some([once, all]);
                }
                weight /= goes_on;
            }
            let (onwards, factor) = turned(&volume.phase, direction, turn);
            let (met, drawn) = self.flight(place.point, onwards, random);
            weight *= factor * drawn;
            let Some(met) = met else {
                let around = weight * self.parameters.ambient.as_dvec3();
                return Some([if order == 1 { once + around } else { once }, all + around]);
            };
            (place, direction, turn) = (met, onwards, [random.unit(), random.unit()]);
        }
        None
    }

    /// The volume of which a particle is met, by its share of the extinction.
    fn met(&self, place: &Place, random: &mut Numbers) -> &Volume {
        let volumes = &self.parameters.volumes;
        let mut left = if volumes.len() > 1 { random.unit() * place.extinction } else { 0.0 };
        let found = place.thickness.iter().take(volumes.len()).position(|thickness| {
            left -= thickness;
            left < 0.0
        });
        // Of rounding alone none is found: then it is the last that is there.
        let last = place.thickness.iter().rposition(|&thickness| thickness > 0.0);
        &volumes[found.or(last).unwrap_or(0)]
    }

    /// The light of all lights that is scattered from a point into the direction against `direction`, for albedo 1.
    fn lit(&self, volume: &Volume, point: DVec3, direction: DVec3, random: &mut Numbers) -> DVec3 {
        let of_light = |light: &Light| {
            let (to_light, distance, irradiance) = towards(light, point);
            let passed = self.passed(point, to_light, distance, random);
            irradiance * (passed * PI * phase(&volume.phase, to_light.dot(direction)))
        };
        self.parameters.lights.iter().map(of_light).sum()
    }

    /// The next particle on a path, or nothing where it leaves the gas, and the factor of its weight: particles are drawn by the
    /// bounds, and where a bound is exceeded, weights make up for it (M. Galtier and others, 2013).
    fn flight(&self, from: DVec3, direction: DVec3, random: &mut Numbers) -> (Option<Place>, f64) {
        let mut weight = 1.0;
        let mut path = self.bounds.path(from, direction, f64::INFINITY);
        while let Some((at, bound)) = path.particle(|| random.unit()) {
            let place = self.place(from + direction * at);
            let fictitious = bound - place.extinction;
            let real = place.extinction / (place.extinction + fictitious.abs());
            if random.unit() < real {
                return (Some(place), weight * place.extinction / (bound * real));
            }
            weight *= fictitious / (bound * (1.0 - real));
        }
        (None, weight)
    }

    /// The fraction of light that passes a distance, by ratio tracking.
    fn passed(&self, from: DVec3, direction: DVec3, distance_m: f64, random: &mut Numbers) -> f64 {
        let mut passed = 1.0;
        let mut path = self.bounds.path(from, direction, distance_m);
        while let Some((at, bound)) = path.particle(|| random.unit()) {
            passed *= 1.0 - self.place(from + direction * at).extinction / bound;
        }
        passed
    }
}

/// Random numbers of a half of a pixel.
struct Numbers(Random);

impl Numbers {
    fn new(seed: u64, half: u64) -> Self {
        // G. Steele's and others' SplitMix, so that neighbours have nothing in common.
        let mut mixed = seed.wrapping_add(half.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Numbers(Random::with_stream(mixed ^ (mixed >> 31), half))
    }

    /// A multiple of 2^-53 in [0, 1).
    fn unit(&mut self) -> f64 {
        let bits = (u64::from(self.0.next_u32()) << 32) | u64::from(self.0.next_u32());
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The numbers below `count` in any order.
    fn shuffled(&mut self, count: u32) -> Vec<u32> {
        let mut numbers: Vec<u32> = (0..count).collect();
        for last in (1..numbers.len()).rev() {
            numbers.swap(last, (self.unit() * (last + 1) as f64) as usize);
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_are_each_taken_once_and_halves_differ() {
        let mut one = Numbers::new(1, 0);
        let mut shuffled = one.shuffled(50);
        assert_ne!(shuffled, Numbers::new(1, 1).shuffled(50));
        shuffled.sort_unstable();
        assert!(shuffled.into_iter().eq(0..50));
        let mean = (0..10_000).map(|_| one.unit()).sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.015, "{mean}");
    }
}

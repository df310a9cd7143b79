//! The distance of a ray from a silhouette, where rounding may decide either way.

use crate::papers::terrain::reference::path::{Path, place_over};
use crate::papers::terrain::reference::search::Search;
use crate::papers::terrain::reference::{Grid, Hit, Place, Ray, Terrain};
use std::f64::consts::TAU;

/// Even steps of a piece at which it is sampled.
const STEPS: usize = 8;
/// Halvings towards the hit, at which the depth behind it is sampled.
const HALVINGS: i32 = 24;
/// Golden section steps: each keeps 0.618 of the stretch.
const REFINEMENTS: usize = 40;

/// The least clearances of a ray, in cells, to leave out rays whose hit hangs on a hair. Found by sampling, so they are
/// estimates; infinite where nothing is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// From the start of the ray to the solid's boundary, on either side.
    pub start_cells: f64,
    /// The ray's least distance from the solid before its hit, or altogether.
    pub before_cells: f64,
    /// Its depth in the solid behind its hit before it comes out again.
    pub after_cells: f64,
}

/// Something near a ray: a map or the base.
struct Neighbour<'a> {
    terrain: &'a Terrain,
    ray: &'a Ray,
    map: &'a Grid,
    cell_m: f64,
}

impl Terrain {
    /// The clearances of a ray over `t_range`, whose first hit is `hit`.
    pub fn clearance(&self, ray: &Ray, t_range: [f64; 2], hit: Option<&Hit>) -> Clearance {
        let end = hit.map_or(t_range[1], |hit| hit.t);
        let cells = self.maps.iter().map(|map| self.cell_m(map));
        let smallest_m = cells.reduce(f64::min).unwrap_or(1.0);
        let start = self.base.place(ray.at(t_range[0])).h / smallest_m;
        let mut found = Clearance { start_cells: start, before_cells: f64::INFINITY, after_cells: f64::INFINITY };
        for (number, map) in self.maps.iter().enumerate() {
            let near = Neighbour { terrain: self, ray, map, cell_m: self.cell_m(map) };
            found.start_cells = found.start_cells.min(near.outside_cells(t_range[0]));
            found.before_cells = found.before_cells.min(near.least_pass(t_range[0], end));
            if let Some(hit) = hit
                && hit.map == Some(number)
            {
                found.after_cells = near.depth_behind(hit.t, t_range[1]);
            }
        }
        found.start_cells = found.start_cells.abs();
        // The height over a convex base has one lowest point on a line: half way between entry and exit, or outside.
        let lowest = self.lowest_over_base(ray).filter(|t| t_range[0] < *t);
        let depth = lowest.map(|t| self.base.place(ray.at(t)).h / smallest_m);
        if hit.is_some_and(|hit| hit.map.is_none()) {
            found.after_cells = depth.map_or(f64::INFINITY, |d| -d);
        } else if let (Some(t), Some(depth)) = (lowest, depth)
            && t < end
        {
            found.before_cells = found.before_cells.min(depth);
        }
        found
    }

    /// The place at which a line is nearest to a curved base, or deepest in it, as far as rays that graze it are concerned.
    fn lowest_over_base(&self, ray: &Ray) -> Option<f64> {
        let [enter, leave] = self.base.shell(0.0, ray.origin, ray.direction).or_else(|| {
            let reach = ray.origin.length();
            self.base.shell(reach, ray.origin, ray.direction)
        })?;
        if !enter.is_finite() || !leave.is_finite() {
            return None;
        }
        Some(least(|t| self.base.place(ray.at(t)).h, enter, leave).0)
    }
}

impl Neighbour<'_> {
    /// About the distance to the map's solid, below 0 in it: the larger of the distance from its rectangle and the
    /// height over its surface, the latter shortened where the surface is steep.
    fn outside_cells(&self, t: f64) -> f64 {
        let terrain = self.terrain;
        let place = place_over(terrain.base, self.map, self.ray.at(t));
        let end = self.map.end();
        let beside = |axis: usize| {
            let half = (end[axis] - self.map.origin[axis]) / 2.0;
            let mut from_middle = place.uv[axis] - self.map.origin[axis] - half;
            if axis == 0 && self.map.closes {
                return f64::NEG_INFINITY;
            }
            if axis == 0 && terrain.base.is_periodic() {
                from_middle -= TAU * (from_middle / TAU).round();
                if half * 2.0 > TAU * (1.0 - 1e-9) {
                    return f64::NEG_INFINITY;
                }
            }
            (from_middle.abs() - half) / self.map.spacing[axis]
        };
        let sample = self.map.interpolate(terrain.interpolation, place.uv);
        let height = sample.height_m - terrain.base_level_m;
        let scales = terrain.base.frame(Place { uv: place.uv, h: height }).scales;
        let steep = (sample.gradient[0] / scales[0]).hypot(sample.gradient[1] / scales[1]);
        let steep = if steep.is_finite() { steep } else { 0.0 };
        let above = (place.h - height) / (self.cell_m * steep.hypot(1.0));
        above.max(beside(0)).max(beside(1))
    }

    /// Distances at which the ray is sampled: those of pieces over cells that it passes high above are left out.
    fn samples(&self, from: f64, to: f64) -> Vec<f64> {
        let Some(reach) = self.terrain.reach(self.map, self.ray, [from, to]) else {
            return Vec::new();
        };
        let path = Path { base: self.terrain.base, grid: self.map, ray: *self.ray };
        let mut samples = Vec::new();
        for piece in path.pieces(reach) {
            let is_high = piece.cell.is_some_and(|cell| {
                let search = Search::new(&path, self.terrain.interpolation, self.terrain.base_level_m, cell);
                search.is_above(piece.from, piece.to, self.cell_m)
            });
            let steps = if is_high { 1 } else { STEPS };
            samples.extend((0..steps).map(|n| piece.from + (piece.to - piece.from) * n as f64 / steps as f64));
        }
        samples.extend(reach.iter().filter(|t| t.is_finite()));
        samples.sort_by(f64::total_cmp);
        samples
    }

    /// The least of the lowest points between `from` and `to`, ends excluded.
    fn least_pass(&self, from: f64, to: f64) -> f64 {
        let samples: Vec<(f64, f64)> = self.samples(from, to).into_iter().map(|t| (t, self.outside_cells(t))).collect();
        let is_low = |three: &&[(f64, f64)]| three[1].1 <= three[0].1 && three[1].1 <= three[2].1;
        let lows = samples.windows(3).filter(is_low);
        // The last samples fall to the hit, where rounding can make a low point of the descent's foot.
        let lows = lows.filter(|three| three[1].1 > 0.0);
        let refined = lows.map(|three| least(|t| self.outside_cells(t), three[0].0, three[2].0));
        refined.filter(|(t, _)| *t < to).map(|(_, low)| low.max(0.0)).fold(f64::INFINITY, f64::min)
    }

    /// The depth that the ray reaches in the solid from `hit` on.
    fn depth_behind(&self, hit: f64, to: f64) -> f64 {
        let mut samples = self.samples(hit, to);
        let first = samples.iter().copied().find(|t| *t > hit).unwrap_or(hit);
        samples.extend((0..HALVINGS).map(|k| hit + (first - hit) * 0.5_f64.powi(k)));
        samples.sort_by(f64::total_cmp);
        let depths = samples.into_iter().map(|t| -self.outside_cells(t));
        depths.skip_while(|depth| *depth <= 0.0).take_while(|depth| *depth > 0.0).fold(0.0, f64::max)
    }
}

/// Golden section: the argument and the value of a function's low point between two arguments.
fn least(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..REFINEMENTS {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let middle = (low + high) / 2.0;
    (middle, f(middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::reference::fixtures::{Dice, grid_of, random_grid};
    use crate::papers::terrain::reference::{Base, Interpolation, Part};
    use glam::DVec3;

    const FAR: [f64; 2] = [0.0, f64::INFINITY];

    fn clearance(terrain: &Terrain, ray: &Ray) -> (Option<Hit>, Clearance) {
        let hit = terrain.first_hit(ray, FAR);
        let clearance = terrain.clearance(ray, FAR, hit.as_ref());
        (hit, clearance)
    }

    #[test]
    fn passing_a_ridge_and_piercing_its_crest_are_measured() {
        // Sides of slope 1: a crest of height 4 at u = 5; a level ray at height y passes it at (y - 4) / sqrt(2).
        let ridge = |u: f64, _: f64| 4.0 - (u - 5.0).abs();
        let map = grid_of([11, 4], [0.0; 2], [1.0; 2], ridge);
        let terrain = Terrain::new(Base::Plane, Interpolation::Bilinear, vec![map], Some(-10.0));
        let level = |y: f64| Ray::new(DVec3::new(-30.0, y + 10.0, 1.5), DVec3::X);
        let (hit, above) = clearance(&terrain, &level(4.01));
        assert!(hit.is_none() && (above.before_cells - 0.01 / 2.0_f64.sqrt()).abs() < 1e-6, "{above:?}");
        assert_eq!(above.after_cells, f64::INFINITY);
        let (hit, below) = clearance(&terrain, &level(3.99));
        assert_eq!(hit.unwrap().part, Part::Surface);
        assert!(below.before_cells.is_infinite() && below.after_cells < 0.01, "{below:?}");
        let (_, deep) = clearance(&terrain, &level(2.0));
        assert!(deep.after_cells > 0.5 && deep.before_cells.is_infinite(), "{deep:?}");
        let (_, outside) = clearance(&terrain, &Ray::new(DVec3::new(-30.0, 8.0, 3.02), DVec3::X));
        assert!((outside.before_cells - 0.02).abs() < 1e-6, "{outside:?}");
    }

    #[test]
    fn a_grazed_cylinder_and_a_start_near_the_surface_are_measured() {
        let base = Base::Cylinder { radius_m: 5.0 };
        let map = grid_of([3, 3], [0.0, 0.0], [0.1, 0.5], |_, _| 0.0);
        let terrain = Terrain::new(base, Interpolation::Bilinear, vec![map], Some(0.0));
        let graze = |x: f64| Ray::new(DVec3::new(x, -3.0, 20.0), -DVec3::Z);
        let (hit, passed) = clearance(&terrain, &graze(-5.01));
        assert!(hit.is_none() && (passed.before_cells - 0.02).abs() < 1e-6, "{passed:?}");
        let (hit, grazed) = clearance(&terrain, &graze(-4.99));
        assert!(hit.is_some() && (grazed.after_cells - 0.02).abs() < 1e-6, "{grazed:?}");
        let (_, near) = clearance(&terrain, &Ray::new(DVec3::new(-5.05, -3.0, 0.0), -DVec3::X));
        assert!((near.start_cells - 0.1).abs() < 1e-9, "{near:?}");
    }

    #[test]
    fn a_ray_moved_by_less_than_its_clearance_keeps_its_hit() {
        let mut dice = Dice::new(9);
        let mut kept = 0;
        for seed in 0..8 {
            let terrain =
                Terrain::new(Base::Plane, Interpolation::Bilinear, vec![random_grid([8, 8], seed, 3.0)], Some(0.0));
            for _ in 0..250 {
                let from = DVec3::new(3.5, 1.5, 3.5) + dice.direction() * 12.0;
                let to = DVec3::new(dice.between(0.0, 7.0), dice.between(0.0, 3.0), dice.between(0.0, 7.0));
                let ray = Ray::new(from, to - from);
                let (hit, clear) = clearance(&terrain, &ray);
                if clear.start_cells.min(clear.before_cells).min(clear.after_cells) < 1e-2 {
                    continue;
                }
                let moved = Ray { origin: ray.origin + dice.direction() * 1e-3, ..ray };
                let again = terrain.first_hit(&moved, FAR);
                assert_eq!(hit.is_some(), again.is_some());
                if let (Some(a), Some(b)) = (hit, again) {
                    assert!((a.t - b.t).abs() < 0.25, "{a:?} {b:?} {clear:?}");
                }
                kept += 1;
            }
        }
        assert!(kept > 1500, "{kept}");
    }
}

//! The oracle's verdict on the device's hits: first hits or not.
//!
//! Single precision moves a ray by a hair, so a hit is judged backwards: the place that the device gives must be on the
//! surface that it names, and the ray must not have been in the solid before; both to a thousandth of a cell. Where the
//! oracle's own hit is elsewhere nevertheless, the ray passed within that thousandth of a silhouette, and is counted.

use fumarole::papers::terrain::reference::{Grid, Hit as Expected, Part, Place, Ray, Terrain};
use fumarole::papers::terrain::{Hit, NO_DEPTH, Rays, Surface};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

use super::drawing::Drawing;
use super::world::World;

const FAR: [f64; 2] = [0.0, f64::INFINITY];

/// The oracle's ray through one pixel.
struct OracleRay {
    ray: Ray,
    /// Metres along the ray for a metre of depth.
    stretch: f64,
    expected: Option<Expected>,
}

/// The oracle's picture.
pub struct Judge<'a> {
    world: &'a World,
    oracle_rays: Vec<OracleRay>,
    tolerance_m: f64,
}

/// The tally of a picture.
#[derive(Debug, Default, Clone)]
pub struct Tally {
    pub rays: usize,
    /// Of them, those that ended elsewhere within a hair of a silhouette.
    pub elsewhere: usize,
    /// Sky, base, surface, wall, inside.
    pub seen: [usize; 5],
    /// The largest distance from the surface that was named, cells.
    pub residual_cells: f64,
    /// The faults of the first few rays that had one.
    pub wrong: Vec<String>,
    /// The hits of those rays that ended elsewhere.
    pub hairs: Vec<String>,
}

impl Tally {
    pub fn add(&mut self, other: Tally) {
        self.rays += other.rays;
        self.elsewhere += other.elsewhere;
        for (sum, seen) in self.seen.iter_mut().zip(other.seen) {
            *sum += seen;
        }
        self.residual_cells = self.residual_cells.max(other.residual_cells);
        self.wrong.extend(other.wrong);
        self.hairs.extend(other.hairs);
    }
}

impl<'a> Judge<'a> {
    /// `tolerance_cells` is a thousandth, or what single precision leaves at a great distance.
    pub fn new(world: &'a World, rays: &Rays, (width, height): (u32, u32), tolerance_cells: f64) -> Self {
        let oracle = |pixel: u32| {
            let (x, y) = (f64::from(pixel % width), f64::from(pixel / width));
            let direction = rays.corner + x * rays.across + y * rays.down;
            let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
            OracleRay { ray, stretch: direction.length(), expected: world.terrain.first_hit(&ray, FAR) }
        };
        let oracle_rays = (0..width * height).into_par_iter().map(oracle).collect();
        Judge { world, oracle_rays, tolerance_m: tolerance_cells * world.cell_m() }
    }

    pub fn tally(&self, drawing: &Drawing) -> Tally {
        assert_eq!(self.oracle_rays.len(), drawing.hits.len());
        let pixels = self.oracle_rays.par_iter().zip(&drawing.hits).zip(&drawing.normals).enumerate();
        let one = |(pixel, ((oracle, hit), normal)): (usize, ((&OracleRay, &Hit), &[f32; 4]))| {
            let mut tally = Tally { rays: 1, ..Tally::default() };
            tally.seen[kind(hit.surface)] = 1;
            let expected = oracle.expected.map(|e| (e.part, e.map, e.t / oracle.stretch));
            let say = |what: &str| format!("pixel {pixel}: {what}; {hit:?} where the oracle has {expected:?}");
            match self.verdict(oracle, hit, *normal) {
                Ok((true, residual_m)) => tally.residual_cells = residual_m / self.world.cell_m(),
                Ok((false, _)) => {
                    tally.elsewhere = 1;
                    tally.hairs.push(say("elsewhere"));
                }
                Err(reason) => tally.wrong.push(say(&reason)),
            }
            tally
        };
        let sum = |mut a: Tally, b: Tally| {
            a.add(b);
            a
        };
        pixels.map(one).reduce(Tally::default, sum)
    }

    /// True of the oracle's own hit, with the distance from the surface that it names; the reason why it is no hit.
    fn verdict(&self, oracle: &OracleRay, hit: &Hit, normal: [f32; 4]) -> Result<(bool, f64), String> {
        let terrain = &self.world.terrain;
        if hit.surface == Surface::Sky {
            if hit.depth_m != NO_DEPTH {
                return Err("a sky with a depth".to_owned());
            }
            self.assert_free(oracle, f64::INFINITY)?;
            return Ok((oracle.expected.is_none(), 0.0));
        }
        let t = f64::from(hit.depth_m) * oracle.stretch;
        let point = oracle.ray.at(t);
        let map = terrain.maps.get(hit.map as usize).ok_or("no such map")?;
        // At the seam of a whole turn the device's own side counts.
        let repeated = if map.closes { 2.0 } else { 0.0 };
        let toward = map.origin[0] + (f64::from(hit.place[0]) - repeated) * map.spacing[0];
        let around = Around::new(terrain, map, point, toward, self.tolerance_m);
        // A camera below the base is in the ground, and the device calls that the base.
        let is_start = hit.depth_m == 0.0;
        // Where a whole turn meets itself at another height, device and oracle call the cliff between a surface.
        let is_whole_turn = terrain.base.is_periodic() && map.end()[0] - map.origin[0] > TAU * (1.0 - 1e-6);
        let is_seam =
            is_whole_turn && !map.closes && around.beside_m[0].abs() <= self.tolerance_m && around.above_m < 0.0;
        let residual_m = match hit.surface {
            Surface::Sky | Surface::Base if is_start => around.h.max(0.0),
            Surface::Sky | Surface::Base => around.h.abs(),
            Surface::Terrain if is_seam => around.wall_residual_m(0),
            Surface::Terrain => around.above_m.abs().max(around.beside_m[0]).max(around.beside_m[1]),
            Surface::WallWest | Surface::WallEast => around.wall_residual_m(0),
            Surface::WallNorth | Surface::WallSouth => around.wall_residual_m(1),
            Surface::Inside if is_start => around.outside_m().max(0.0),
            Surface::Inside => return Err("inside, but not at the start".to_owned()),
        };
        if residual_m > self.tolerance_m || around.h < -self.tolerance_m && !is_start {
            return Err(format!("{:.2e} of a cell off the surface", residual_m / self.world.cell_m()));
        }
        self.assert_free(oracle, t)?;
        let is_same = oracle.expected.is_some_and(|expected| self.is_same(oracle, &expected, hit, t));
        if is_same && !is_seam && hit.surface != Surface::Inside && !is_start {
            self.assert_normal(oracle, hit, map, &around, normal)?;
        }
        Ok((is_same, residual_m))
    }

    /// True where a hit that stands the test is on the oracle's surface, and no farther along the ray than the angle explains.
    fn is_same(&self, oracle: &OracleRay, expected: &Expected, hit: &Hit, t: f64) -> bool {
        let is_start = hit.depth_m == 0.0;
        let is_part = match expected.part {
            Part::Inside => is_start,
            Part::Surface => hit.surface == Surface::Terrain && expected.map == Some(hit.map as usize),
            Part::Wall => kind(hit.surface) == 3 && expected.map == Some(hit.map as usize),
            Part::Base => hit.surface == Surface::Base,
        };
        let cosine = expected.normal.dot(oracle.ray.direction).abs().max(1e-2);
        is_part && (t - expected.t).abs() <= 2.0 * self.tolerance_m / cosine
    }

    /// The ray is nowhere before `end` deeper in the solid than the tolerance.
    fn assert_free(&self, oracle: &OracleRay, end: f64) -> Result<(), String> {
        let terrain = &self.world.terrain;
        let mut next = oracle.expected.map(|hit| hit.t);
        while let Some(mut t) = next.filter(|t| *t < end) {
            loop {
                let depth_m = self.depth_m(oracle.ray.at(t));
                if depth_m > self.tolerance_m {
                    let cells = depth_m / self.world.cell_m();
                    return Err(format!("{cells:.2e} of a cell deep in the solid {t} m along it"));
                }
                t += 0.5 * self.tolerance_m;
                if t >= end {
                    return Ok(());
                }
                if !terrain.is_solid(oracle.ray.at(t)) {
                    break;
                }
            }
            next = terrain.first_hit(&oracle.ray, [t, end]).map(|hit| hit.t);
        }
        Ok(())
    }

    fn depth_m(&self, point: DVec3) -> f64 {
        let terrain = &self.world.terrain;
        let in_map = terrain.maps.iter().map(|map| {
            let middle = (map.origin[0] + map.end()[0]) / 2.0;
            -Around::new(terrain, map, point, middle, self.tolerance_m).outside_m()
        });
        in_map.fold(-terrain.base.place(point).h, f64::max)
    }

    /// The device's normal is the interpolated surface's within the tolerance around the place; its fourth number is the
    /// height of the surface above the base.
    fn assert_normal(
        &self,
        oracle: &OracleRay,
        hit: &Hit,
        map: &Grid,
        around: &Around,
        normal: [f32; 4],
    ) -> Result<(), String> {
        let terrain = &self.world.terrain;
        let [x, y, z, height_m] = normal;
        let found = self.world.turned(Vec3::new(x, y, z).as_dvec3());
        let is_wall = kind(hit.surface) == 3;
        let steepness = around.steepness;
        if !is_wall && (f64::from(height_m) - around.h).abs() > self.tolerance_m * steepness {
            return Err(format!("its height is {height_m} m and not {} m", around.h));
        }
        let expected: Vec<DVec3> = match (hit.surface, oracle.expected) {
            (Surface::Terrain, _) => around.places.iter().map(|&uv| terrain.surface_normal(map, uv)).collect(),
            (_, Some(expected)) => vec![expected.normal],
            _ => vec![],
        };
        let Some(first) = expected.first() else { return Ok(()) };
        let spread = expected.iter().map(|n| n.distance(*first)).fold(0.0, f64::max);
        if found.distance(*first) > spread + 1e-3 {
            return Err(format!("its normal is {found} and not {first}"));
        }
        Ok(())
    }
}

/// Sky, base, surface, wall, inside.
fn kind(surface: Surface) -> usize {
    match surface {
        Surface::Sky => 0,
        Surface::Base => 1,
        Surface::Terrain => 2,
        Surface::WallWest | Surface::WallEast | Surface::WallNorth | Surface::WallSouth => 3,
        Surface::Inside => 4,
    }
}

/// The place of a point beside a map.
struct Around {
    /// Above the base, metres.
    h: f64,
    /// Above the interpolated surface, metres square to it.
    above_m: f64,
    /// Metres of height for a metre square to the surface.
    steepness: f64,
    /// Beyond the map's edges along u and v; below 0 between them.
    beside_m: [f64; 2],
    /// The point's (u, v) and four around it, as far as the tolerance reaches.
    places: [[f64; 2]; 5],
}

impl Around {
    /// Of the turns about the axis, that of the angle next to `toward` is taken.
    fn new(terrain: &Terrain, map: &Grid, point: DVec3, toward: f64, tolerance_m: f64) -> Self {
        let place = terrain.base.place(point);
        let middle = [0, 1].map(|axis| (map.origin[axis] + map.end()[axis]) / 2.0);
        let mut uv = place.uv;
        if terrain.base.is_periodic() {
            uv[0] -= TAU * ((uv[0] - toward) / TAU).round();
        }
        if map.closes {
            uv[0] = map.origin[0] + (uv[0] - map.origin[0]).rem_euclid(TAU);
        }
        let scales = terrain.base.frame(Place { uv, h: place.h.max(0.0) }).scales;
        let beside_m = [0, 1].map(|axis| {
            let half = (map.end()[axis] - map.origin[axis]) / 2.0;
            if axis == 0 && map.closes {
                return f64::NEG_INFINITY;
            }
            ((uv[axis] - middle[axis]).abs() - half) * scales[axis]
        });
        let step = scales.map(|scale| tolerance_m / scale);
        let corners = [(0.0, 0.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let places = corners.map(|(u, v)| [uv[0] + u * step[0], uv[1] + v * step[1]]);
        let samples = places.map(|uv| map.interpolate(terrain.interpolation, uv));
        let steep = samples.map(|s| (s.gradient[0] / scales[0]).hypot(s.gradient[1] / scales[1]));
        let steepest = steep.into_iter().fold(0.0, f64::max);
        let above = place.h - (samples[0].height_m - terrain.base_level_m);
        let steepness = steepest.hypot(1.0);
        Around { h: place.h, above_m: above / steepness, steepness, beside_m, places }
    }

    /// Outside the map's solid, or how deep in it as a negative number.
    fn outside_m(&self) -> f64 {
        self.above_m.max(self.beside_m[0]).max(self.beside_m[1])
    }

    fn wall_residual_m(&self, axis: usize) -> f64 {
        self.beside_m[axis].abs().max(self.beside_m[1 - axis]).max(self.above_m)
    }
}

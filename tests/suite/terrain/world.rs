//! Maps over a base, for the device and for the oracle, and cameras that look at them.

use std::f64::consts::TAU;
use std::sync::Arc;

use fumarole::papers::terrain::reference::{self, Grid, Place};
use fumarole::papers::terrain::{Base, Interpolation, Lod, MapInput, Normals, Parameters, Placement, View};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap, Samples};
use glam::{DQuat, DVec2, DVec3, Vec2Swizzles, Vec3};

/// The input of both.
pub struct World {
    pub name: String,
    pub base: Base,
    pub interpolation: Interpolation,
    pub base_level_m: Option<f32>,
    pub maps: Vec<MapInput>,
    /// Of the only map, about the world's origin.
    yaw_rad: f64,
    /// The same for the oracle.
    pub terrain: reference::Terrain,
}

impl World {
    pub fn new(
        name: impl Into<String>,
        base: Base,
        interpolation: Interpolation,
        base_level_m: Option<f32>,
        maps: Vec<MapInput>,
    ) -> Self {
        let yaw_rad = maps[0].placement.yaw_rad;
        assert!(yaw_rad == 0.0 || (maps.len() == 1 && maps[0].placement.center_m == DVec2::ZERO));
        let level_m = base_level_m.map(f64::from);
        let grids = maps.iter().map(|input| grid(base, input)).collect();
        let between = match interpolation {
            Interpolation::Bilinear => reference::Interpolation::Bilinear,
            Interpolation::Bicubic => reference::Interpolation::Bicubic,
        };
        let terrain = reference::Terrain::new(oracle_base(base), between, grids, level_m);
        World { name: name.into(), base, interpolation, base_level_m, maps, yaw_rad, terrain }
    }

    /// One map in the middle of the world.
    pub fn alone(name: &str, base: Base, interpolation: Interpolation, level_m: Option<f32>, map: HeightMap) -> Self {
        let input = MapInput { map: Arc::new(map), placement: Placement::default() };
        World::new(name, base, interpolation, level_m, vec![input])
    }

    pub fn parameters(&self, camera: Camera, (width, height): (u32, u32)) -> Parameters {
        let (base, interpolation, base_level_m) = (self.base, self.interpolation, self.base_level_m);
        let view = View::Camera(camera);
        let (lod, normals) = (Lod::Exact, Normals::Surface);
        Parameters { lod, normals, base, interpolation, base_level_m, view, width, height, ..Parameters::default() }
    }

    /// A direction of the world (east, up, south at its origin) as the oracle has it, whose curved bases turn about y. On a
    /// cylinder this is a reflection, which changes no distance.
    pub fn turned(&self, v: DVec3) -> DVec3 {
        match self.base {
            Base::Plane => DQuat::from_rotation_y(-self.yaw_rad) * v,
            Base::Cylinder { .. } => DVec3::new(v.y, v.z, -v.x),
            Base::Ellipsoid { .. } => DVec3::new(v.y, -v.z, -v.x),
        }
    }

    /// A point of the world as the oracle has it.
    pub fn moved(&self, point: DVec3) -> DVec3 {
        self.turned(point + DVec3::Y * radius_m(self.base))
    }

    /// The world's point at a fraction of the first map's sides, at a height above the base.
    pub fn point(&self, fraction: DVec2, h: f64) -> DVec3 {
        let p = self.terrain.base.point(Place { uv: self.uv(fraction), h });
        let back = match self.base {
            Base::Plane => DQuat::from_rotation_y(self.yaw_rad) * p,
            Base::Cylinder { .. } => DVec3::new(-p.z, p.x, p.y),
            Base::Ellipsoid { .. } => DVec3::new(-p.z, p.x, -p.y),
        };
        back - DVec3::Y * radius_m(self.base)
    }

    fn uv(&self, fraction: DVec2) -> [f64; 2] {
        let map = &self.terrain.maps[0];
        [0, 1].map(|axis| map.origin[axis] + fraction[axis] * (map.end()[axis] - map.origin[axis]))
    }

    /// The first map's height above the base at a fraction of its sides.
    pub fn height_m(&self, fraction: DVec2) -> f64 {
        self.terrain.height_above_base(&self.terrain.maps[0], self.uv(fraction)).max(0.0)
    }

    /// The side of the smallest cell, metres.
    pub fn cell_m(&self) -> f64 {
        self.terrain.maps.iter().map(|map| self.terrain.cell_m(map)).fold(f64::INFINITY, f64::min)
    }

    /// The first map's longer side, metres.
    pub fn side_m(&self) -> f64 {
        let map = &self.terrain.maps[0];
        self.terrain.cell_m(map) * map.size[0].max(map.size[1]) as f64
    }

    /// The highest that the first map's surface can be above the base, metres.
    pub fn top_m(&self) -> f64 {
        let map = &self.terrain.maps[0];
        (map.ceiling_m(self.terrain.interpolation) - self.terrain.base_level_m).max(0.0)
    }

    /// A camera of a kind, placed by chance.
    pub fn camera(&self, stand: Stand, random: &mut Random) -> Camera {
        let fraction =
            |random: &mut Random, low, high| DVec2::new(random.range(low, high).into(), random.range(low, high).into());
        let inside = fraction(random, 0.1, 0.9);
        let aim = fraction(random, 0.2, 0.8);
        let (cell_m, side_m) = (self.cell_m(), self.side_m());
        let top_m = self.top_m();
        let aimed = self.point(aim, self.height_m(aim));
        let part = f64::from(random.range(0.2, 0.8));
        let mut fov_rad = random.range(0.6, 1.4);
        let (eye, target) = match stand {
            Stand::Above => (self.point(fraction(random, -0.2, 1.2), top_m + part * side_m), aimed),
            Stand::Beside => {
                let outside = DVec2::new(-0.1 - 0.3 * part, f64::from(random.range(0.0, 1.0)));
                let outside = if random.unit() < 0.5 { outside } else { DVec2::ONE - outside.yx() };
                (self.point(outside, part * top_m + 0.3 * cell_m), self.point(aim, 0.7 * self.height_m(aim)))
            }
            Stand::Hovering => (self.point(inside, self.height_m(inside) + 0.3 * cell_m), aimed),
            Stand::On => (self.point(inside, self.height_m(inside)), aimed),
            Stand::Under => (self.point(inside, part * self.height_m(inside) - 0.01 * cell_m), aimed),
            Stand::Down => {
                let eye = self.point(inside, top_m + part * side_m);
                (eye, self.point(inside, -top_m - cell_m))
            }
            Stand::Seam => {
                let edge = DVec2::new(f64::from(random.range(0.99, 1.01)), aim.y);
                (self.point(edge, top_m + 6.0 * part * cell_m), self.point(DVec2::new(1.0, 0.5), 0.5 * top_m))
            }
            Stand::Up => {
                let h = self.height_m(inside) + 0.3 * cell_m;
                (self.point(inside, h), self.point(inside, h + top_m + cell_m))
            }
            Stand::Far(sides) => {
                let away_m = sides * side_m;
                fov_rad = (1.2 / sides) as f32;
                let direction = DVec3::new(0.4 + part, 0.3 * part + 0.1, 1.1 - part).normalize();
                (aimed + direction * away_m, aimed)
            }
        };
        Camera {
            eye: eye.as_vec3(),
            target: target.as_vec3(),
            up: Vec3::Y,
            vertical_fov_rad: fov_rad,
            near_m: (1e-3 * cell_m) as f32,
            far_m: (1e4 * side_m) as f32,
        }
    }
}

/// The place of a camera.
#[derive(Debug, Clone, Copy)]
pub enum Stand {
    Above,
    /// Beyond an edge, lower than the summit.
    Beside,
    /// A third of a cell above the surface.
    Hovering,
    /// On the surface, as near as single precision comes.
    On,
    Under,
    /// Straight down.
    Down,
    /// From near the surface straight up.
    Up,
    /// Low over the map's eastern edge, where one that goes once round closes.
    Seam,
    /// That many times the map's side away.
    Far(f64),
}

fn oracle_base(base: Base) -> reference::Base {
    match base {
        Base::Plane => reference::Base::Plane,
        Base::Cylinder { radius_m } => reference::Base::Cylinder { radius_m: radius_m.into() },
        Base::Ellipsoid { equatorial_m, polar_m } => {
            reference::Base::Ellipsoid { equatorial_m: equatorial_m.into(), polar_m: polar_m.into() }
        }
    }
}

/// From the axis to the world's origin.
fn radius_m(base: Base) -> f64 {
    match base {
        Base::Plane => 0.0,
        Base::Cylinder { radius_m } => radius_m.into(),
        Base::Ellipsoid { equatorial_m, .. } => equatorial_m.into(),
    }
}

/// A map in the coordinates of its base; rows run south, latitudes north.
fn grid(base: Base, input: &MapInput) -> Grid {
    let map = &input.map;
    let (columns, rows) = (map.width() as usize, map.height() as usize);
    let heights: Vec<f64> = match map.samples() {
        Samples::Steps { values, origin_m, step_m } => {
            values.iter().map(|&v| f64::from(*origin_m) + f64::from(*step_m) * f64::from(v)).collect()
        }
        Samples::Float(heights) => heights.iter().copied().map(f64::from).collect(),
    };
    let (center_m, spacing_m) = (input.placement.center_m, map.spacing_m());
    let half = DVec2::new((columns - 1) as f64, (rows - 1) as f64) / 2.0;
    let grid = |heights, center: DVec2, spacing: DVec2| {
        let origin = center - half * spacing;
        let grid = Grid::new([columns, rows], heights, origin.to_array(), spacing.to_array()).unwrap();
        let is_whole = base != Base::Plane && (columns as f64 * spacing.x - TAU).abs() < 1e-6;
        if is_whole { grid.closed() } else { grid }
    };
    match base {
        Base::Plane => grid(heights, center_m, spacing_m),
        Base::Cylinder { radius_m } => {
            let turn = DVec2::new(f64::from(radius_m), 1.0);
            grid(heights, center_m / turn, spacing_m / turn)
        }
        Base::Ellipsoid { equatorial_m, polar_m } => {
            let (a, b) = (f64::from(equatorial_m), f64::from(polar_m));
            // Radii of curvature across the meridian and along it.
            let radii = |latitude: f64| {
                let shape = (a * latitude.cos()).powi(2) + (b * latitude.sin()).powi(2);
                DVec2::new(a * a / shape.sqrt(), (a * b).powi(2) / (shape * shape.sqrt()))
            };
            let center = center_m * DVec2::new(1.0, -1.0) / radii(0.0);
            let metres = radii(center.y) * DVec2::new(center.y.cos(), 1.0);
            let northward = heights.chunks_exact(columns).rev().flatten().copied().collect();
            grid(northward, center, spacing_m / metres)
        }
    }
}

/// The kind of a map's heights.
#[derive(Debug, Clone, Copy)]
pub enum Relief {
    /// Every sample by chance.
    Noise,
    /// Waves longer than cells.
    Waves,
    /// Flat steps.
    Terraces,
}

/// A map by chance whose heights span `amplitude_cells`, in steps or floats.
pub fn random_map(random: &mut Random, relief: Relief, (width, height): (u32, u32), amplitude_cells: f32) -> HeightMap {
    let spacing_m = f64::from(random.range(0.5, 40.0));
    let aspect = f64::from(random.range(0.7, 1.4));
    let amplitude_m = amplitude_cells * spacing_m as f32;
    let waves: Vec<[f32; 3]> =
        (0..5).map(|_| [random.range(0.05, 0.9), random.range(-0.9, 0.9), random.range(0.0, 6.3)]).collect();
    let mut fraction = |column: u32, row: u32| {
        let wave = |[u, v, phase]: &[f32; 3]| (u * column as f32 + v * row as f32 + phase).sin();
        let smooth = 0.5 + 0.1 * waves.iter().map(wave).sum::<f32>();
        match relief {
            Relief::Noise => random.unit(),
            Relief::Waves => smooth,
            Relief::Terraces => (smooth * 6.0).floor() / 6.0,
        }
    };
    let shares: Vec<f32> =
        (0..height).flat_map(|row| (0..width).map(move |column| (column, row))).map(|(c, r)| fraction(c, r)).collect();
    let origin_m = random.range(-2000.0, 4000.0).round();
    let samples = if random.unit() < 0.5 {
        let values = shares.iter().map(|s| (s * 60_000.0) as u16 + 2000).collect();
        Samples::Steps { values, origin_m, step_m: amplitude_m / 60_000.0 }
    } else {
        Samples::Float(shares.iter().map(|s| s * amplitude_m + 10.0).collect())
    };
    let spacing = DVec2::new(spacing_m, spacing_m * aspect);
    HeightMap::new(width, height, samples).unwrap().with_spacing_m(spacing).unwrap()
}

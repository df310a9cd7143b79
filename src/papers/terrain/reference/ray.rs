//! The terrain and the first hit of a ray with it (sections 2 and 3), cell by cell.

use crate::papers::terrain::reference::path::{Path, place_over};
use crate::papers::terrain::reference::search::Search;
use crate::papers::terrain::reference::{Base, Grid, Interpolation, Place};
use glam::DVec3;
use std::f64::consts::TAU;

/// A hit on the base this near below a map's, as a share of the distance, is the map's: the two surfaces coincide.
const SAME_DISTANCE: f64 = 1e-12;

/// A ray in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// In metres.
    pub origin: DVec3,
    /// Of length 1.
    pub direction: DVec3,
}

impl Ray {
    /// From `origin` along `direction`, of any length but 0.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Ray { origin, direction: direction.normalize() }
    }

    /// The point `t` metres along the ray.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A base surface and the maps over it, united.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    /// The base surface.
    pub base: Base,
    /// Between the nodes of every map.
    pub interpolation: Interpolation,
    /// The height that lies on the base, in metres.
    pub base_level_m: f64,
    /// The maps, each within one turn about the axis and, on an ellipsoid, between the poles.
    pub maps: Vec<Grid>,
}

/// The hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The ray starts in the solid.
    Inside,
    /// A map's interpolated surface.
    Surface,
    /// A map's edge.
    Wall,
    /// The base surface.
    Base,
}

/// The first point of a ray in the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in metres.
    pub t: f64,
    /// In the world, in metres.
    pub point: DVec3,
    /// Map coordinates and height above the base.
    pub place: Place,
    /// Unit normal out of the solid; of the interpolated surface, where a map was hit from above.
    pub normal: DVec3,
    /// The surface that was hit.
    pub part: Part,
    /// The map's number; `None` for the base alone.
    pub map: Option<usize>,
}

impl Terrain {
    /// A terrain; without a base level, the lowest node of all maps lies on the base.
    pub fn new(base: Base, interpolation: Interpolation, maps: Vec<Grid>, base_level_m: Option<f64>) -> Self {
        let lowest = maps.iter().map(|map| map.range_m()[0]).fold(f64::INFINITY, f64::min);
        let lowest = if maps.is_empty() { 0.0 } else { lowest };
        Terrain { base, interpolation, base_level_m: base_level_m.unwrap_or(lowest), maps }
    }

    /// Height of a map's surface above the base, clamped to the map's rectangle.
    pub fn height_above_base(&self, map: &Grid, uv: [f64; 2]) -> f64 {
        map.interpolate(self.interpolation, uv).height_m - self.base_level_m
    }

    /// True of a point in the solid, its boundary included.
    pub fn is_solid(&self, point: DVec3) -> bool {
        self.base.place(point).h <= 0.0 || self.map_around(point).is_some()
    }

    /// The first map whose solid contains the point.
    fn map_around(&self, point: DVec3) -> Option<usize> {
        self.maps.iter().position(|map| {
            let place = place_over(self.base, map, point);
            map.contains(place.uv) && place.h <= self.height_above_base(map, place.uv)
        })
    }

    /// The first hit of a ray between the distances `t_range`; the second may be infinite.
    pub fn first_hit(&self, ray: &Ray, t_range: [f64; 2]) -> Option<Hit> {
        let start = ray.at(t_range[0]);
        if self.is_solid(start) {
            return Some(self.hit(ray, t_range[0], Part::Inside, self.map_around(start)));
        }
        let base = self.base_distance(ray, t_range);
        let end = base.map_or(t_range[1], |t| t * (1.0 + SAME_DISTANCE.copysign(t)));
        let mut nearest: Option<(f64, Part, usize)> = None;
        for (number, map) in self.maps.iter().enumerate() {
            let found = self.first_on_map(map, ray, [t_range[0], end]);
            if let Some((t, part)) = found
                && nearest.is_none_or(|n| t < n.0)
            {
                nearest = Some((t, part, number));
            }
        }
        match (nearest, base) {
            (Some((t, part, map)), _) => Some(self.hit(ray, t, part, Some(map))),
            (None, Some(t)) => Some(self.hit(ray, t, Part::Base, None)),
            (None, None) => None,
        }
    }

    /// The t at which a ray from outside enters the base.
    pub(super) fn base_distance(&self, ray: &Ray, t_range: [f64; 2]) -> Option<f64> {
        let [enter, _] = self.base.shell(0.0, ray.origin, ray.direction)?;
        (t_range[0] <= enter && enter <= t_range[1]).then_some(enter)
    }

    /// The part of `t_range` in which the ray is no higher than a cell above the map's highest place.
    pub(super) fn reach(&self, map: &Grid, ray: &Ray, t_range: [f64; 2]) -> Option<[f64; 2]> {
        let top = map.ceiling_m(self.interpolation) - self.base_level_m;
        if top < 0.0 {
            return None;
        }
        let [enter, leave] = self.base.shell(top + self.cell_m(map), ray.origin, ray.direction)?;
        let reach = [enter.max(t_range[0]), leave.min(t_range[1])];
        (reach[0] < reach[1]).then_some(reach)
    }

    /// The shorter side of a map's middle cell, in metres on the base.
    pub fn cell_m(&self, map: &Grid) -> f64 {
        let uv = [0, 1].map(|axis| (map.origin[axis] + map.end()[axis]) / 2.0);
        let scales = self.base.frame(Place { uv, h: 0.0 }).scales;
        (scales[0] * map.spacing[0]).min(scales[1] * map.spacing[1])
    }

    fn first_on_map(&self, map: &Grid, ray: &Ray, t_range: [f64; 2]) -> Option<(f64, Part)> {
        let reach = self.reach(map, ray, t_range)?;
        let path = Path { base: self.base, grid: map, ray: *ray };
        let mut was_outside = true;
        for piece in path.pieces(reach) {
            let Some(cell) = piece.cell else {
                was_outside = true;
                continue;
            };
            let search = Search::new(&path, self.interpolation, self.base_level_m, cell);
            if let Some(t) = search.first_root(piece.from, piece.to) {
                let part = if was_outside && t == piece.from { Part::Wall } else { Part::Surface };
                return Some((t, part));
            }
            was_outside = false;
        }
        None
    }

    fn hit(&self, ray: &Ray, t: f64, part: Part, map: Option<usize>) -> Hit {
        let point = ray.at(t);
        let grid = map.and_then(|number| self.maps.get(number));
        let Some(grid) = grid else {
            let place = self.base.place(point);
            return Hit { t, point, place, normal: self.base.frame(place).normal, part, map: None };
        };
        let place = place_over(self.base, grid, point);
        let normal = match part {
            Part::Wall => self.wall_normal(grid, place),
            _ => self.surface_normal(grid, place.uv),
        };
        Hit { t, point, place, normal, part, map }
    }

    /// The unit normal of the map's surface F = P + n h at (u, v): F_u x F_v, outward.
    pub fn surface_normal(&self, map: &Grid, uv: [f64; 2]) -> DVec3 {
        self.normal_of(map, uv, map.interpolate(self.interpolation, uv).gradient)
    }

    /// The unit normal of a surface through the map's at (u, v) that has the interpolated gradients of the nodes.
    pub fn normal_between_nodes(&self, map: &Grid, uv: [f64; 2]) -> DVec3 {
        self.normal_of(map, uv, map.gradient_between_nodes(uv))
    }

    fn normal_of(&self, map: &Grid, uv: [f64; 2], gradient: [f64; 2]) -> DVec3 {
        let frame = self.base.frame(Place { uv, h: self.height_above_base(map, uv) });
        let slope = |axis: usize| gradient[axis] / frame.scales[axis];
        let steep = |axis: usize| if frame.scales[axis] == 0.0 { 0.0 } else { slope(axis) };
        (frame.normal - frame.axes[0] * steep(0) - frame.axes[1] * steep(1)).normalize()
    }

    /// Out of the map's nearest edge.
    fn wall_normal(&self, map: &Grid, place: Place) -> DVec3 {
        let axes = self.base.frame(place).axes;
        let side = |axis: usize, edge: f64, outward: f64| {
            let mut distance = place.uv[axis] - edge;
            if axis == 0 && self.base.is_periodic() {
                distance -= TAU * (distance / TAU).round();
            }
            (distance.abs() / map.spacing[axis], axes[axis] * outward)
        };
        let axes = if map.closes { 1..2 } else { 0..2 };
        let sides = axes.map(|axis| [side(axis, map.origin[axis], -1.0), side(axis, map.end()[axis], 1.0)]);
        let nearest = sides.flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(DVec3::ZERO, |(_, normal)| normal)
    }
}

//! A ray over one map, cut where it crosses the lines of the grid.

use crate::papers::terrain::reference::base::across_m;
use crate::papers::terrain::reference::ray::Ray;
use crate::papers::terrain::reference::{Base, Grid, Place};
use glam::DVec3;
use std::f64::consts::TAU;

/// A ray over a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<'a> {
    /// Base surface that the heights are added to.
    pub(super) base: Base,
    /// Heights of the map.
    pub(super) grid: &'a Grid,
    /// The ray, in metres.
    pub(super) ray: Ray,
}

/// A part of a ray between two crossings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Distance along the ray at which it begins, metres.
    pub(super) from: f64,
    /// Distance along the ray at which it ends, metres.
    pub(super) to: f64,
    /// The one cell below it; `None` outside the map.
    pub(super) cell: Option<[usize; 2]>,
}

impl Path<'_> {
    /// The place at distance `t`.
    pub(super) fn place(&self, t: f64) -> Place {
        place_over(self.base, self.grid, self.ray.at(t))
    }

    /// The pieces of the ray within `range`, in order.
    pub(super) fn pieces(&self, range: [f64; 2]) -> Vec<Piece> {
        let mut cuts = self.crossings();
        cuts.retain(|t| range[0] < *t && *t < range[1]);
        cuts.extend(range.iter().filter(|t| t.is_finite()));
        cuts.sort_by(f64::total_cmp);
        let piece = |ends: &[f64]| {
            let [from, to] = [ends[0], ends[1]];
            let uv = self.place((from + to) / 2.0).uv;
            (from < to).then(|| Piece { from, to, cell: self.grid.contains(uv).then(|| self.grid.cell(uv)) })
        };
        cuts.windows(2).filter_map(piece).collect()
    }

    /// In cells from the first node of `cell`, the turn next to the cell taken, and the height above the base.
    pub(super) fn local(&self, t: f64, cell: [usize; 2]) -> ([f64; 2], f64) {
        let place = self.base.place(self.ray.at(t));
        let local = [0, 1].map(|axis| {
            let corner = self.grid.origin[axis] + self.grid.spacing[axis] * cell[axis] as f64;
            let mut distance = place.uv[axis] - corner;
            if axis == 0 && self.base.is_periodic() {
                let from_middle = distance - self.grid.spacing[0] / 2.0;
                distance -= TAU * (from_middle / TAU).round();
            }
            distance / self.grid.spacing[axis]
        });
        (local, place.h)
    }

    /// Every distance, in no order, at which the ray crosses a line of the grid or passes the axis; more do no harm.
    fn crossings(&self) -> Vec<f64> {
        let Ray { origin, direction } = self.ray;
        let line = |axis: usize, i: usize| self.grid.origin[axis] + self.grid.spacing[axis] * i as f64;
        let columns = (0..self.grid.size[0]).map(|i| line(0, i));
        let rows = (0..self.grid.size[1]).map(|j| line(1, j));
        let level = |at: f64, from: f64, along: f64| (at - from) / along;
        let mut cuts: Vec<f64> = match self.base {
            Base::Plane => columns.map(|u| level(u, origin.x, direction.x)).collect(),
            Base::Ellipsoid { .. } | Base::Cylinder { .. } => columns
                .map(|u| {
                    let east = DVec3::new(-u.sin(), 0.0, -u.cos());
                    -origin.dot(east) / direction.dot(east)
                })
                .chain([self.nearest_to_axis()])
                .collect(),
        };
        match self.base {
            Base::Plane => cuts.extend(rows.map(|v| level(v, origin.z, direction.z))),
            Base::Cylinder { .. } => cuts.extend(rows.map(|v| level(v, origin.y, direction.y))),
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let flattened = 1.0 - (polar_m / equatorial_m).powi(2);
                cuts.extend(rows.flat_map(|latitude| self.parallels(latitude, flattened, equatorial_m, polar_m)));
            }
        }
        cuts
    }

    fn nearest_to_axis(&self) -> f64 {
        let Ray { origin, direction } = self.ray;
        let across = direction.x.powi(2) + direction.z.powi(2);
        -(origin.x * direction.x + origin.z * direction.z) / across
    }

    /// Normals of one latitude form a cone about the axis: ρ² sin² = (y - apex)² cos².
    fn parallels(&self, latitude: f64, flattened: f64, equatorial_m: f64, polar_m: f64) -> [f64; 2] {
        let (sin, cos) = latitude.sin_cos();
        let across = across_m(equatorial_m, polar_m, sin * sin);
        let o = self.ray.origin + DVec3::Y * (across * flattened * sin);
        let d = self.ray.direction;
        let a = (d.x * d.x + d.z * d.z) * sin * sin - d.y * d.y * cos * cos;
        let b = (o.x * d.x + o.z * d.z) * sin * sin - o.y * d.y * cos * cos;
        let c = (o.x * o.x + o.z * o.z) * sin * sin - o.y * o.y * cos * cos;
        let q = -(b + b.signum() * (b * b - a * c).sqrt());
        [q / a, c / q]
    }
}

/// The place of a point, its angle in the turn that starts at the map's first column.
pub(super) fn place_over(base: Base, grid: &Grid, point: DVec3) -> Place {
    let mut place = base.place(point);
    if base.is_periodic() {
        place.uv[0] = grid.origin[0] + (place.uv[0] - grid.origin[0]).rem_euclid(TAU);
    }
    place
}

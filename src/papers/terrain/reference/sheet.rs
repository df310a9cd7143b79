//! The faces of a map's solid, as sheets over a square of parameters, and bounds of their distance to a point.

use crate::papers::terrain::reference::base::{across_m, along_m};
use crate::papers::terrain::reference::grid::Patch;
use crate::papers::terrain::reference::interval::Interval;
use crate::papers::terrain::reference::{Base, Grid, Part, Place, Terrain};
use glam::DVec3;

type Vector = [Interval; 3];
const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

/// The top of a cell, or the wall below one of its sides. Parameters (p, q) are 0..1.
pub(super) struct Sheet<'a> {
    base: Base,
    map: &'a Grid,
    cell: [usize; 2],
    patch: Patch,
    /// The axis that the wall stands across and its place on it, 0 or 1; p runs along the other, q from the base up.
    wall: Option<(usize, f64)>,
}

/// A part of a sheet seen from a point.
pub(super) struct View {
    /// The sheet at the square's middle.
    pub(super) point: DVec3,
    /// From there.
    pub(super) distance_m: f64,
    /// From anywhere in the square.
    pub(super) at_least_m: f64,
}

/// Every face of a map's solid above the base.
pub(super) fn sheets<'a>(terrain: &Terrain, map: &'a Grid) -> impl Iterator<Item = (Part, Sheet<'a>)> {
    let (base, interpolation, level_m) = (terrain.base, terrain.interpolation, terrain.base_level_m);
    let [columns, rows] = map.cells();
    let cells = (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]));
    cells.flat_map(move |cell| {
        let first_axis = usize::from(map.closes);
        let sides = (first_axis..2).flat_map(move |axis| {
            let first = (cell[axis] == 0).then_some(Some((axis, 0.0)));
            let last = (cell[axis] == map.cells()[axis] - 1).then_some(Some((axis, 1.0)));
            first.into_iter().chain(last)
        });
        [None].into_iter().chain(sides).map(move |wall| {
            let part = if wall.is_some() { Part::Wall } else { Part::Surface };
            (part, Sheet { base, map, cell, patch: Patch::new(map, interpolation, cell, level_m), wall })
        })
    })
}

impl Sheet<'_> {
    pub(super) fn whole(&self) -> [Interval; 2] {
        [Interval { low: 0.0, high: 1.0 }; 2]
    }

    /// The sheet's middle and the least distance, by the mean value theorem for the squared distance.
    pub(super) fn view(&self, square: &[Interval; 2], center: DVec3) -> View {
        let middle = square.map(Interval::center);
        let radius = square.map(Interval::radius);
        let point = self.point(middle);
        let apart = point - center;
        let along = self.derivatives(square);
        let reach = |i: usize| radius[0] * along[0][i].magnitude() + radius[1] * along[1][i].magnitude();
        let apart_anywhere: Vector = [0, 1, 2].map(|i| Interval::around(apart[i], reach(i)));
        let box_squared: f64 = apart_anywhere.iter().map(|side| side.square().low).sum();
        let change = |n: usize| dot(apart_anywhere, along[n]).magnitude() * 2.0 * radius[n];
        let mean_squared = apart.length_squared() - change(0) - change(1);
        View { point, distance_m: apart.length(), at_least_m: box_squared.max(mean_squared).max(0.0).sqrt() }
    }

    /// In the cell: u, v and the fraction of the height.
    fn local<T: Copy>(&self, [p, q]: [T; 2], number: impl Fn(f64) -> T) -> ([T; 2], T) {
        match self.wall {
            None => ([p, q], number(1.0)),
            Some((0, side)) => ([number(side), p], q),
            Some((_, side)) => ([p, number(side)], q),
        }
    }

    fn point(&self, parameters: [f64; 2]) -> DVec3 {
        let ([u, v], fraction) = self.local(parameters, |x| x);
        let at = |axis: usize, x: f64| self.map.origin[axis] + self.map.spacing[axis] * (self.cell[axis] as f64 + x);
        self.base.point(Place { uv: [at(0, u), at(1, v)], h: fraction * self.patch.height(u, v) })
    }

    /// Bounds of the derivatives of F = P + n h along p and q.
    fn derivatives(&self, square: &[Interval; 2]) -> [Vector; 2] {
        let ([u, v], fraction) = self.local(*square, Interval::point);
        let slopes = self.patch.slopes(u, v);
        let swing = slopes[0].magnitude() * u.radius() + slopes[1].magnitude() * v.radius();
        let height = Interval::around(self.patch.height(u.center(), v.center()), swing);
        let (normal, tangents) = self.tangents(u, v, height * fraction);
        let along_axis = |axis: usize| {
            let climb = scale(normal, slopes[axis] * fraction);
            add(scale(tangents[axis], Interval::point(self.map.spacing[axis])), climb)
        };
        match self.wall {
            None => [along_axis(0), along_axis(1)],
            Some((across, _)) => [along_axis(1 - across), scale(normal, height)],
        }
    }

    /// Bounds of the base's normal and of F_u and F_v at a fixed height, each for a unit of u or v.
    fn tangents(&self, u: Interval, v: Interval, height: Interval) -> (Vector, [Vector; 2]) {
        let angle = |axis: usize, x: Interval| {
            let first = self.map.origin[axis] + self.map.spacing[axis] * self.cell[axis] as f64;
            x * self.map.spacing[axis] + Interval::point(first)
        };
        let one = Interval::point(1.0);
        let [longitude, latitude] = [angle(0, u), angle(1, v)];
        let out = [longitude.cos(), ZERO, -longitude.sin()];
        let east = [-longitude.sin(), ZERO, -longitude.cos()];
        match self.base {
            Base::Plane => ([ZERO, one, ZERO], [[one, ZERO, ZERO], [ZERO, ZERO, one]]),
            Base::Cylinder { radius_m } => (out, [scale(east, Interval::point(radius_m) + height), [ZERO, one, ZERO]]),
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let squared = latitude.sin().square();
                let over = |f: fn(f64, f64, f64) -> f64| {
                    let at = |s: f64| f(equatorial_m, polar_m, s);
                    Interval::between(at(squared.low), at(squared.high)) + height
                };
                let normal = add(scale(out, latitude.cos()), [ZERO, latitude.sin(), ZERO]);
                let north = add(scale(out, -latitude.sin()), [ZERO, latitude.cos(), ZERO]);
                (normal, [scale(east, over(across_m) * latitude.cos()), scale(north, over(along_m))])
            }
        }
    }
}

fn scale(vector: Vector, factor: Interval) -> Vector {
    vector.map(|x| x * factor)
}

fn add(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn dot(a: Vector, b: Vector) -> Interval {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

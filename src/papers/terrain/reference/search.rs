//! The first root of h - height(u, v) on a piece of a ray above one cell: no root before it is missed.

use crate::papers::terrain::reference::base::along_m;
use crate::papers::terrain::reference::grid::Patch;
use crate::papers::terrain::reference::interval::Interval;
use crate::papers::terrain::reference::path::Path;
use crate::papers::terrain::reference::polynomial;
use crate::papers::terrain::reference::{Base, Interpolation};

/// A piece this short, in cells, is decided at its ends: twice the rounding of a point at an Earth's radius from the
/// origin on a map of metres.
const SHORTEST_CELLS: f64 = 1e-9;

/// A ray above one cell.
pub(super) struct Search<'a> {
    path: &'a Path<'a>,
    cell: [usize; 2],
    patch: Patch,
}

/// Lower bound of g = h - height over a stretch, and bounds of its change.
struct Bounds {
    least: f64,
    slope: Interval,
}

impl<'a> Search<'a> {
    pub(super) fn new(path: &'a Path<'a>, interpolation: Interpolation, base_level_m: f64, cell: [usize; 2]) -> Self {
        Search { path, cell, patch: Patch::new(path.grid, interpolation, cell, base_level_m) }
    }

    /// The first distance in `from..=to` at which the ray is in the map's solid.
    pub(super) fn first_root(&self, from: f64, to: f64) -> Option<f64> {
        if self.is_above(from, to, 0.0) {
            return None;
        }
        match self.path.base {
            Base::Plane => self.first_root_over_plane(from, to),
            Base::Ellipsoid { .. } | Base::Cylinder { .. } => self.first_root_by_intervals(from, to),
        }
    }

    /// True where the ray stays `margin_m` above every height of the cell.
    pub(super) fn is_above(&self, from: f64, to: f64, margin_m: f64) -> bool {
        self.lowest(from, to) - margin_m > self.patch.bounds().high
    }

    /// A bound of h below: along a line, the height above a convex body is convex, so its tangent lies below it.
    fn lowest(&self, from: f64, to: f64) -> f64 {
        let middle = (from + to) / 2.0;
        self.path.base.place(self.path.ray.at(middle)).h - self.climb(middle).abs() * (to - from) / 2.0
    }

    /// The derivative of h along the ray.
    fn climb(&self, t: f64) -> f64 {
        let place = self.path.base.place(self.path.ray.at(t));
        self.path.base.frame(place).normal.dot(self.path.ray.direction)
    }

    /// h - height: above 0 outside the solid.
    fn gap(&self, t: f64) -> f64 {
        let ([u, v], h) = self.path.local(t, self.cell);
        h - self.patch.height(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0))
    }

    /// u, v and h are linear along the ray, so the gap is a polynomial of degree 2 or 6 in s = (t - from) / (to - from).
    fn first_root_over_plane(&self, from: f64, to: f64) -> Option<f64> {
        let (first, first_h) = self.path.local(from, self.cell);
        let (last, last_h) = self.path.local(to, self.cell);
        let line = |a: f64, b: f64| vec![a, b - a];
        let [u, v] = [line(first[0], last[0]), line(first[1], last[1])];
        let in_v = |row: &[f64; 4]| horner(row[..=self.patch.degree].iter().map(|&c| vec![c]), &v);
        let rows = self.patch.factors[..=self.patch.degree].iter().map(in_v);
        let height = horner(rows.collect::<Vec<_>>().into_iter(), &u);
        let mut gap: Vec<f64> = height.iter().map(|c| -c).collect();
        gap[0] += first_h;
        gap[1] += last_h - first_h;
        let s = polynomial::first_root(&gap)?;
        Some(if s == 0.0 { from } else { from + s * (to - from) })
    }

    /// Halves the piece, the nearer half first, until a part has no root, or the gap falls all along it.
    pub(super) fn first_root_by_intervals(&self, from: f64, to: f64) -> Option<f64> {
        if self.gap(from) <= 0.0 {
            return Some(from);
        }
        let scales = self.path.base.frame(self.path.place((from + to) / 2.0)).scales;
        let cell_m = (scales[0] * self.path.grid.spacing[0]).min(scales[1] * self.path.grid.spacing[1]);
        let shortest = (cell_m * SHORTEST_CELLS).max(4.0 * f64::EPSILON * from.abs().max(to.abs()));
        let mut stack = vec![[from, to]];
        while let Some([near, far]) = stack.pop() {
            let bounds = self.bounds(near, far);
            if bounds.least > 0.0 || bounds.slope.low >= 0.0 {
                continue;
            }
            if bounds.slope.high <= 0.0 || far - near <= shortest {
                if self.gap(far) <= 0.0 {
                    return Some(self.bisect(near, far));
                }
                continue;
            }
            let middle = (near + far) / 2.0;
            stack.push([middle, far]);
            stack.push([near, middle]);
        }
        None
    }

    /// The gap is above 0 at `near` and not at `far`.
    fn bisect(&self, mut near: f64, mut far: f64) -> f64 {
        loop {
            let middle = (near + far) / 2.0;
            if middle <= near || middle >= far {
                return far;
            }
            if self.gap(middle) <= 0.0 {
                far = middle;
            } else {
                near = middle;
            }
        }
    }

    /// By the mean value theorem from the middle of the stretch.
    fn bounds(&self, near: f64, far: f64) -> Bounds {
        let middle = (near + far) / 2.0;
        let radius = (far - near) / 2.0;
        let base = self.path.base;
        let ray = &self.path.ray;
        let [first, last] = [near, far].map(|t| self.path.local(t, self.cell).0);
        // Seen from the axis a point on a line turns one way; lengths along the axis are linear.
        let u = Interval::between(first[0], last[0]).clamp(0.0, 1.0);
        let v = Interval::between(first[1], last[1]);
        let v = match base {
            Base::Ellipsoid { equatorial_m, polar_m } => {
                // The latitude changes at most by 1 / (least radius of curvature), so it rests between two tents.
                let least = (polar_m.powi(2) / equatorial_m).min(equatorial_m.powi(2) / polar_m);
                Interval::around(v.center(), radius / least / self.path.grid.spacing[1])
            }
            Base::Plane | Base::Cylinder { .. } => v,
        };
        let v = v.clamp(0.0, 1.0);
        let climb = Interval::between(self.climb(near), self.climb(far));
        let [along_u, along_v] = self.patch.slopes(u, v);
        let [turn, travel] = match base {
            Base::Plane => [ray.direction.x, ray.direction.z].map(Interval::point),
            Base::Cylinder { .. } => [self.turn(near, far), Interval::point(ray.direction.y)],
            Base::Ellipsoid { equatorial_m, polar_m } => {
                [self.turn(near, far), self.northward(u, v, middle, radius, [equatorial_m, polar_m])]
            }
        };
        let spacing = self.path.grid.spacing;
        let rise = along_u * turn * (1.0 / spacing[0]) + along_v * travel * (1.0 / spacing[1]);
        let slope = climb - rise;
        Bounds { least: self.gap(middle) - radius * slope.magnitude(), slope }
    }

    /// The angle's derivative along the ray: its moment about the axis over the squared distance from the axis.
    fn turn(&self, near: f64, far: f64) -> Interval {
        let [o, d] = [self.path.ray.origin, self.path.ray.direction];
        let moment = o.z * d.x - o.x * d.z;
        if moment == 0.0 {
            return Interval::point(0.0);
        }
        let square = |t: f64| (o.x + d.x * t).powi(2) + (o.z + d.z * t).powi(2);
        let across = d.x * d.x + d.z * d.z;
        let nearest = if across > 0.0 { -(o.x * d.x + o.z * d.z) / across } else { near };
        let least = square(nearest.clamp(near, far));
        Interval::point(moment).over(Interval { low: least, high: square(near).max(square(far)) })
    }

    /// The latitude's derivative along the ray: its share along the meridian over the meridian's radius there.
    fn northward(&self, u: Interval, v: Interval, middle: f64, radius: f64, [a, b]: [f64; 2]) -> Interval {
        let grid = self.path.grid;
        let angle = |axis: usize, local: Interval| {
            let first = grid.origin[axis] + grid.spacing[axis] * self.cell[axis] as f64;
            local * grid.spacing[axis] + Interval::point(first)
        };
        let [longitude, latitude] = [angle(0, u), angle(1, v)];
        let d = self.path.ray.direction;
        let out = longitude.cos() * d.x - longitude.sin() * d.z;
        let north = latitude.cos() * d.y - latitude.sin() * out;
        let squared = latitude.sin().square();
        let meridian = Interval::between(along_m(a, b, squared.low), along_m(a, b, squared.high));
        let height = Interval::around(self.path.place(middle).h, radius);
        north.over(meridian + height)
    }
}

/// A polynomial whose factors are polynomials, at a polynomial.
fn horner(factors: impl DoubleEndedIterator<Item = Vec<f64>>, at: &[f64]) -> Vec<f64> {
    factors.rev().fold(Vec::new(), |sum, factor| {
        let mut next = vec![0.0; (sum.len() + at.len()).saturating_sub(1).max(factor.len())];
        for (i, s) in sum.iter().enumerate() {
            for (j, a) in at.iter().enumerate() {
                next[i + j] += s * a;
            }
        }
        for (n, f) in next.iter_mut().zip(&factor) {
            *n += f;
        }
        next
    })
}

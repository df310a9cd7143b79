//! The base surfaces P and the places over them: F = P + n h (eq. 5, 6).

use glam::{DVec2, DVec3};

/// A base surface. Curved ones turn about the y axis, their centre at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// y = 0, up is +y: u = x, v = z, h = y (T with its lost row, eq. 10).
    Plane,
    /// Of revolution: u is the longitude, v the geodetic latitude.
    Ellipsoid {
        /// Half axis along x and z, in metres.
        equatorial_m: f64,
        /// Half axis along y, in metres.
        polar_m: f64,
    },
    /// u is the angle, v the length along the axis.
    Cylinder {
        /// In metres.
        radius_m: f64,
    },
}

/// A place over a base surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Map coordinates: metres or radians, as the base has it.
    pub uv: [f64; 2],
    /// Height along the base's normal, in metres.
    pub h: f64,
}

/// The directions at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Unit normal of the base.
    pub normal: DVec3,
    /// Unit directions of growing u and v; square to the normal and to each other.
    pub axes: [DVec3; 2],
    /// Metres for each unit of u and v at the place's height.
    pub scales: [f64; 2],
}

impl Base {
    /// True where u is an angle, equal to itself after a full turn.
    pub fn is_periodic(&self) -> bool {
        !matches!(self, Base::Plane)
    }

    /// The point at a place: F = P + n h.
    pub fn point(&self, place: Place) -> DVec3 {
        let [u, v] = place.uv;
        let around = DVec3::new(u.cos(), 0.0, -u.sin());
        match *self {
            Base::Plane => DVec3::new(u, place.h, v),
            Base::Cylinder { radius_m } => around * (radius_m + place.h) + DVec3::Y * v,
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let across = across_m(equatorial_m, polar_m, v.sin().powi(2));
                let flattened = (polar_m / equatorial_m).powi(2);
                around * ((across + place.h) * v.cos()) + DVec3::Y * ((across * flattened + place.h) * v.sin())
            }
        }
    }

    /// The place of a point; below a curved base down to its centres of curvature. On the axis the angle is 0.
    pub fn place(&self, point: DVec3) -> Place {
        let angle = (-point.z).atan2(point.x);
        let out = point.x.hypot(point.z);
        match *self {
            Base::Plane => Place { uv: [point.x, point.z], h: point.y },
            Base::Cylinder { radius_m } => Place { uv: [angle, point.y], h: out - radius_m },
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let (latitude, h) = above_ellipse(equatorial_m, polar_m, DVec2::new(out, point.y));
                Place { uv: [angle, latitude], h }
            }
        }
    }

    /// The directions and scales at a place.
    pub fn frame(&self, place: Place) -> Frame {
        let [u, v] = place.uv;
        let east = DVec3::new(-u.sin(), 0.0, -u.cos());
        let out = DVec3::new(u.cos(), 0.0, -u.sin());
        match *self {
            Base::Plane => Frame { normal: DVec3::Y, axes: [DVec3::X, DVec3::Z], scales: [1.0, 1.0] },
            Base::Cylinder { radius_m } => {
                Frame { normal: out, axes: [east, DVec3::Y], scales: [radius_m + place.h, 1.0] }
            }
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let along = along_m(equatorial_m, polar_m, v.sin().powi(2)) + place.h;
                let across = (across_m(equatorial_m, polar_m, v.sin().powi(2)) + place.h) * v.cos();
                let normal = out * v.cos() + DVec3::Y * v.sin();
                let north = DVec3::Y * v.cos() - out * v.sin();
                Frame { normal, axes: [east, north], scales: [across, along] }
            }
        }
    }

    /// The distances along a ray at which it enters and leaves a body that contains all places with h up to `h_m`, which
    /// is exact for h = 0 and on planes and cylinders. Infinite where the body is; `None` when the ray misses it.
    pub(super) fn shell(&self, h_m: f64, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let scaled = |v: DVec3| match *self {
            Base::Plane => v,
            Base::Cylinder { radius_m } => DVec3::new(v.x, 0.0, v.z) / (radius_m + h_m),
            Base::Ellipsoid { equatorial_m, polar_m } => {
                // The surface at height h reaches beyond the ellipsoid with half axes longer by h, but not beyond this.
                let grown = 1.0 + h_m / equatorial_m.min(polar_m);
                v / (DVec3::new(equatorial_m, polar_m, equatorial_m) * grown)
            }
        };
        if let Base::Plane = self {
            let [height, climb] = [origin.y - h_m, direction.y];
            return match climb {
                0.0 => (height <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]),
                climb if climb < 0.0 => Some([-height / climb, f64::INFINITY]),
                climb => Some([f64::NEG_INFINITY, -height / climb]),
            };
        }
        let [o, d] = [scaled(origin), scaled(direction)];
        let square = d.length_squared();
        if square == 0.0 {
            return (o.length_squared() <= 1.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        // Half way through, and half of the way inside.
        let middle = -o.dot(d) / square;
        let inside = (1.0 - (o + d * middle).length_squared()) / square;
        (inside >= 0.0).then(|| [middle - inside.sqrt(), middle + inside.sqrt()])
    }
}

/// The prime vertical radius of curvature, across the meridian, from the squared sine of the latitude.
pub(super) fn across_m(equatorial_m: f64, polar_m: f64, sin_squared: f64) -> f64 {
    let square = equatorial_m.powi(2) * (1.0 - sin_squared) + polar_m.powi(2) * sin_squared;
    equatorial_m.powi(2) / square.sqrt()
}

/// The meridional radius of curvature, from the squared sine of the latitude.
pub(super) fn along_m(equatorial_m: f64, polar_m: f64, sin_squared: f64) -> f64 {
    let square = equatorial_m.powi(2) * (1.0 - sin_squared) + polar_m.powi(2) * sin_squared;
    (equatorial_m * polar_m).powi(2) / (square * square.sqrt())
}

/// Geodetic latitude and height over the ellipse of a meridian, of the point (distance from the axis, y). The foot Q of
/// the point satisfies P = Q + s (Qx/a², Qy/b²); s is the largest root of a function that falls and is convex, so
/// Newton's steps from its left never pass it.
fn above_ellipse(a: f64, b: f64, point: DVec2) -> (f64, f64) {
    let squares = DVec2::new(a * a, b * b);
    let distance = point.abs();
    let mut s = (a * distance.x - squares.x).max(b * distance.y - squares.y);
    let outward = |s: f64| distance / (squares + DVec2::splat(s));
    for _ in 0..100 {
        let normal = outward(s);
        let terms = normal * normal * squares;
        let slope = -2.0 * (terms / (squares + DVec2::splat(s))).element_sum();
        let step = (terms.element_sum() - 1.0) / slope;
        let next = s - step;
        if !next.is_finite() || next <= s {
            break;
        }
        s = next;
    }
    let normal = outward(s);
    let latitude = normal.y.atan2(normal.x) * if point.y < 0.0 { -1.0 } else { 1.0 };
    (latitude, s * normal.length())
}

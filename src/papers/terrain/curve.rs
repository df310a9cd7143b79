//! Curved bases around one map: an ellipsoid of revolution or a cylinder.

use glam::{DMat4, DVec2, DVec3, DVec4};

/// The base around the middle of a map. Points are metres from the middle: east, off the axis, along the axis; the axis of an
/// ellipsoid points north, that of a cylinder south.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// A cylinder, or else an ellipsoid.
    pub is_cylinder: bool,
    /// Semi-major axis, or radius.
    pub a: f64,
    /// 1 - (b / a)^2 for a polar semi-axis b.
    pub squared_eccentricity: f64,
    /// Of the middle.
    pub latitude_rad: f64,
    /// Distance of the middle from the axis, and along it from the centre.
    pub off_m: f64,
    /// Distance of the middle along the axis from the centre.
    pub along_m: f64,
    /// The middle in nodes.
    pub middle: DVec2,
    /// Nodes for a radian of longitude, and for a radian of latitude (a metre along the cylinder). Rows count southwards.
    pub steps: DVec2,
    /// Smallest radius of curvature.
    pub smallest_radius_m: f64,
    /// The largest change of a meridian's radius of curvature over a radian, as a fraction of it.
    pub bend: f64,
    /// The map's highest point above the base.
    reach_m: f64,
}

/// A quadric around the axis: squares off and along the axis, linear terms off and along it, constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadric {
    /// Factors of the squared coordinates, off the axis and along it.
    pub squares: DVec2,
    /// Half of the linear factors, off the axis and along it.
    pub linear: DVec2,
    /// The value in the middle.
    pub constant: f64,
}

impl Curve {
    /// Radii of curvature of an ellipsoid of semi-axes `a` and `b`: across the meridian and along it.
    pub fn radii(a: f64, b: f64, latitude_rad: f64) -> (f64, f64) {
        let e2 = 1.0 - (b / a).powi(2);
        let shape = 1.0 - e2 * latitude_rad.sin().powi(2);
        (a / shape.sqrt(), a * (1.0 - e2) / (shape * shape.sqrt()))
    }

    pub fn cylinder(radius_m: f64, spacing_m: DVec2, middle: DVec2, reach_m: f64) -> Self {
        Curve {
            is_cylinder: true,
            a: radius_m,
            squared_eccentricity: 0.0,
            latitude_rad: 0.0,
            off_m: radius_m,
            along_m: 0.0,
            middle,
            steps: DVec2::new(radius_m / spacing_m.x, 1.0 / spacing_m.y),
            smallest_radius_m: radius_m,
            bend: 0.0,
            reach_m,
        }
    }

    pub fn ellipsoid(a: f64, b: f64, latitude_rad: f64, step_rad: DVec2, middle: DVec2, reach_m: f64) -> Self {
        let e2 = 1.0 - (b / a).powi(2);
        let (across, _) = Self::radii(a, b, latitude_rad);
        // d ln M / d latitude = 3 e^2 sin cos / (1 - e^2 sin^2), largest where the slope of it changes: bounded by its parts.
        let bend = 1.5 * e2.abs() / (1.0 - e2.max(0.0));
        Curve {
            is_cylinder: false,
            a,
            squared_eccentricity: e2,
            latitude_rad,
            off_m: across * latitude_rad.cos(),
            along_m: across * (1.0 - e2) * latitude_rad.sin(),
            middle,
            steps: DVec2::new(1.0 / step_rad.x, -1.0 / step_rad.y),
            smallest_radius_m: (b * b / a).min(a * a / b).min(a),
            bend,
            reach_m,
        }
    }

    /// The centre: of a cylinder the point of the axis beside the middle.
    pub fn center(&self) -> DVec3 {
        DVec3::new(0.0, -self.off_m, -self.along_m)
    }

    /// Off the axis, and of an ellipsoid along it.
    pub fn radii_m(&self) -> DVec2 {
        DVec2::new(self.a, self.b())
    }

    fn b(&self) -> f64 {
        self.a * (1.0 - self.squared_eccentricity).sqrt()
    }

    /// Metres between columns and rows in the middle.
    pub fn spacing_m(&self) -> DVec2 {
        let (_, along) = Self::radii(self.a, self.b(), self.latitude_rad);
        DVec2::new(self.off_m, if self.is_cylinder { 1.0 } else { along }) / self.steps.abs()
    }

    /// This frame to the ellipsoid's own: centre, prime meridian, north.
    pub fn frame(&self, longitude_rad: f64) -> DMat4 {
        let (s, c) = longitude_rad.sin_cos();
        let (east, off) = (DVec3::new(-s, c, 0.0), DVec3::new(c, s, 0.0));
        let middle = self.off_m * off + self.along_m * DVec3::Z;
        DMat4::from_cols(east.extend(0.0), off.extend(0.0), DVec4::Z, middle.extend(1.0))
    }

    /// East, up and south to this frame.
    pub fn tangent(&self) -> DMat4 {
        let (s, c) = self.latitude_rad.sin_cos();
        DMat4::from_cols(DVec4::X, DVec4::new(0.0, c, s, 0.0), DVec4::new(0.0, s, -c, 0.0), DVec4::W)
    }

    /// F = P + n h (eq. 6) over a place in nodes.
    pub fn point(&self, place: DVec2, height_m: f64) -> DVec3 {
        let moved = (place - self.middle) / self.steps;
        let (s, c) = moved.x.sin_cos();
        if self.is_cylinder {
            let radius = self.a + height_m;
            return DVec3::new(radius * s, radius * c - self.off_m, moved.y);
        }
        let latitude = self.latitude_rad + moved.y;
        let (across, _) = Self::radii(self.a, self.b(), latitude);
        let off = (across + height_m) * latitude.cos();
        let along = (across * (1.0 - self.squared_eccentricity) + height_m) * latitude.sin();
        DVec3::new(off * s, off * c - self.off_m, along - self.along_m)
    }

    /// The place in nodes of a point that is not below the base, and its height above it: Newton's method for the foot of the
    /// normal.
    pub fn place(&self, point: DVec3) -> (DVec2, f64) {
        let off = point.y + self.off_m;
        let longitude = point.x.atan2(off);
        let radius = point.x.hypot(off);
        let (along, height_m) = if self.is_cylinder {
            (point.z, radius - self.a)
        } else {
            let (latitude, height_m) = self.above_meridian(DVec2::new(radius, point.z + self.along_m));
            (latitude - self.latitude_rad, height_m)
        };
        (self.middle + DVec2::new(longitude, along) * self.steps, height_m)
    }

    /// Latitude and height of a point in the plane of a meridian: off the axis, along it.
    fn above_meridian(&self, point: DVec2) -> (f64, f64) {
        let e2 = self.squared_eccentricity;
        let mut latitude = point.y.atan2(point.x * (1.0 - e2));
        let mut height_m = 0.0;
        for _ in 0..32 {
            let (s, c) = latitude.sin_cos();
            let (across, along) = Self::radii(self.a, self.b(), latitude);
            let apart = point - DVec2::new(across * c, across * (1.0 - e2) * s);
            height_m = apart.dot(DVec2::new(c, s));
            let turn = apart.dot(DVec2::new(-s, c)) / (along + height_m).max(1e-6 * along);
            latitude += turn;
            if turn.abs() < 1e-16 {
                break;
            }
        }
        (latitude, height_m)
    }

    /// East, and away from the axis, at a longitude in nodes.
    fn around(&self, column: f64) -> (DVec3, DVec3) {
        let (s, c) = ((column - self.middle.x) / self.steps.x).sin_cos();
        (DVec3::new(c, -s, 0.0), DVec3::new(s, c, 0.0))
    }

    /// The derivatives of [`Curve::point`] along u, v and h, for a node and for a metre.
    pub fn axes(&self, place: DVec2, height_m: f64) -> [DVec3; 3] {
        let (east, away) = self.around(place.x);
        if self.is_cylinder {
            return [east * ((self.a + height_m) / self.steps.x), DVec3::Z / self.steps.y, away];
        }
        let latitude = self.latitude_rad + (place.y - self.middle.y) / self.steps.y;
        let (s, c) = latitude.sin_cos();
        let (across, along) = Self::radii(self.a, self.b(), latitude);
        let north = c * DVec3::Z - s * away;
        let up = s * DVec3::Z + c * away;
        [east * ((across + height_m) * c / self.steps.x), north * ((along + height_m) / self.steps.y), up]
    }

    /// Half of what the second derivatives of [`Curve::point`] can add up to: a turn by x and y radians around radii of
    /// curvature that change along the meridian, while the height changes by `rise_m`.
    pub fn bend_m(&self, reach: DVec2, rise_m: f64, height_m: f64) -> f64 {
        let DVec2 { x, y } = (reach / self.steps).abs();
        if self.is_cylinder {
            return 0.5 * (self.a + height_m) * x * x + x * rise_m;
        }
        let largest_m = self.a.max(self.a * self.a / self.b()).max(self.b() * self.b() / self.a);
        let radius_m = largest_m + height_m;
        0.5 * (radius_m * (x + y).powi(2) + self.bend * largest_m * y * y) + (x + y) * rise_m
    }

    /// The nearest point to one of those below a column: its half-plane ends at the axis.
    pub fn foot_on_column(&self, column: f64, point: DVec3) -> DVec3 {
        let (_, away) = self.around(column);
        let from_axis = point + DVec3::Y * self.off_m;
        away * from_axis.dot(away).max(0.0) + DVec3::new(0.0, -self.off_m, point.z)
    }

    /// The nearest point to one of those above and below a row: on a cylinder they form a plane, on an ellipsoid a cone.
    pub fn foot_on_row(&self, row: f64, point: DVec3) -> DVec3 {
        let (place, _) = self.place(point);
        let foot = DVec2::new(place.x, row);
        let on_base = self.point(foot, 0.0);
        if self.is_cylinder {
            return DVec3::new(point.x, point.y, on_base.z);
        }
        let [_, _, up] = self.axes(foot, 0.0);
        on_base + up * (point - on_base).dot(up)
    }

    /// The base itself; near it the quadric is about the height in metres.
    pub fn ground(&self) -> Quadric {
        self.quadric(0.0)
    }

    /// A surface that the map does not rise above.
    pub fn shell(&self) -> Quadric {
        // Around a curve of constant height an ellipsoid fits whose axes grow by that height, stretched by the flattening.
        let stretch = if self.is_cylinder { 1.0 } else { self.a.max(self.b()) / self.a.min(self.b()) };
        self.quadric(self.reach_m * stretch * (1.0 + 1e-6) + self.a * 1e-7)
    }

    fn quadric(&self, grown_m: f64) -> Quadric {
        let square = |axis: f64| self.a / (2.0 * (axis + grown_m).powi(2));
        let squares = DVec2::new(square(self.a), if self.is_cylinder { 0.0 } else { square(self.b()) });
        let place = DVec2::new(self.off_m, self.along_m);
        Quadric {
            squares,
            linear: squares * place,
            constant: if grown_m == 0.0 { 0.0 } else { (squares * place * place).element_sum() - self.a / 2.0 },
        }
    }
}

use glam::DVec2;

/// Semi-major axis of the WGS84 ellipsoid, metres.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// Flattening of the WGS84 ellipsoid.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Placement of a map in longitude and latitude. North and east are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geographic {
    /// Longitude of the first column's samples, degrees.
    pub west_deg: f64,
    /// Latitude of the first row's samples, degrees.
    pub north_deg: f64,
    /// Degrees from one column east to the next, and from one row south to the next, both positive.
    pub step_deg: DVec2,
}

impl Geographic {
    /// Metres between columns (x) and rows (y) on the WGS84 ellipsoid, at the middle latitude of a map of `rows` rows.
    pub fn spacing_m(&self, rows: u32) -> DVec2 {
        let middle_deg = self.north_deg - self.step_deg.y * f64::from(rows.saturating_sub(1)) / 2.0;
        let (sine, cosine) = middle_deg.to_radians().sin_cos();
        let eccentricity_squared = FLATTENING * (2.0 - FLATTENING);
        let shape = 1.0 - eccentricity_squared * sine * sine;
        // Radii of curvature: of the prime vertical, and of the meridian.
        let prime_vertical_m = SEMI_MAJOR_M / shape.sqrt();
        let meridian_m = SEMI_MAJOR_M * (1.0 - eccentricity_squared) / (shape * shape.sqrt());
        DVec2::new(prime_vertical_m * cosine, meridian_m) * self.step_deg.map(f64::to_radians)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_as_long_as_on_the_ellipsoid() {
        // Metres of one degree of longitude and latitude on WGS84, from tables.
        for (latitude_deg, expected_m) in
            [(0.0, [111_320.0, 110_574.0]), (45.0, [78_847.0, 111_132.0]), (-60.0, [55_800.0, 111_412.0])]
        {
            let place =
                Geographic { west_deg: 7.0, north_deg: latitude_deg + 0.05, step_deg: DVec2::splat(0.1 / 100.0) };
            let degree_m = place.spacing_m(101) * 1_000.0;
            assert!((degree_m - DVec2::from(expected_m)).abs().max_element() < 1.0, "{latitude_deg}: {degree_m}");
        }
    }
}

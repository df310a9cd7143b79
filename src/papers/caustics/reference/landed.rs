//! Light where it lands (section 6.3): the flux of triangles over the texels that they cover.

use glam::DVec2;

use super::flux::{area, clip};

/// A triangle of water where its three rays land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandedTriangle {
    /// Places in texels of the map, from its first corner.
    pub corners: [DVec2; 3],
    /// Light that it brings to the map, as the I_c of one texel.
    pub light: f64,
    /// I_c at each corner, negative where the light is turned over, 0 where it is not known.
    pub intensities: [f64; 3],
}

/// Greatest rise of the light of a triangle from texel to texel along x and y together, of its mean.
const MOST_RISE: f64 = 0.15;

impl LandedTriangle {
    /// Rise of the light from texel to texel, of its mean: of the linear function that has the corners' intensities, as far as all of
    /// them are known and of one sign.
    fn rise(&self) -> DVec2 {
        let [a, b, c] = self.intensities;
        let [p, q, r] = self.corners;
        let mean = (a + b + c) / 3.0;
        let (to_q, to_r) = (q - p, r - p);
        let is_known = [a, b, c].iter().all(|light| light * mean > 0.0);
        if !is_known || to_q.perp_dot(to_r).abs() < 1e-3 {
            return DVec2::ZERO;
        }
        let (to_b, to_c) = (b / mean - a / mean, c / mean - a / mean);
        // The gradient g with g . (q - p) = b - a and g . (r - p) = c - a.
        let rise = DVec2::new(to_b * to_r.y - to_c * to_q.y, to_c * to_q.x - to_b * to_r.x) / to_q.perp_dot(to_r);
        rise / (rise.abs().element_sum() / MOST_RISE).max(1.0)
    }
}

/// Each triangle's light over the area that it covers, linear between its corners, row by row of a map of `resolution` texels a side.
/// One without an area lands in its middle.
pub fn landed_map(triangles: impl IntoIterator<Item = LandedTriangle>, resolution: usize) -> Vec<f64> {
    let mut map = vec![0.0; resolution * resolution];
    for triangle in triangles {
        let LandedTriangle { corners, light, .. } = triangle;
        let (whole, rise) = (area(&corners), triangle.rise());
        let low = corners.iter().copied().reduce(DVec2::min).unwrap_or_default();
        let high = corners.iter().copied().reduce(DVec2::max).unwrap_or_default();
        let inside = |value: f64| value.floor().clamp(0.0, resolution as f64 - 1.0) as usize;
        if high.min_element() < 0.0 || low.max_element() >= resolution as f64 {
            continue;
        }
        let middle = corners.iter().sum::<DVec2>() / 3.0;
        for (column, row) in
            (inside(low.y)..=inside(high.y)).flat_map(|row| (inside(low.x)..=inside(high.x)).map(move |c| (c, row)))
        {
            let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let fraction = if whole > 1e-12 {
                let part = clip(&corners.map(|p| p - center), DVec2::splat(0.5));
                let of_mean = 1.0 + rise.dot(center + centroid(&part) - middle);
                area(&part) / whole * of_mean
            } else {
                f64::from(u8::from((middle - center).abs().max_element() <= 0.5))
            };
            map[row * resolution + column] += light * fraction;
        }
    }
    map
}

/// The middle of a convex polygon's area; zero where it has none.
fn centroid(polygon: &[DVec2]) -> DVec2 {
    let next = polygon.iter().cycle().skip(1);
    let sums = polygon.iter().zip(next).map(|(p, q)| (p.perp_dot(*q), *p + *q));
    let (double_area, moment) =
        sums.fold((0.0, DVec2::ZERO), |(areas, moments), (area, sum)| (areas + area, moments + sum * area));
    if double_area == 0.0 { DVec2::ZERO } else { moment / (3.0 * double_area) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: [f64; 3] = [1.0; 3];

    #[test]
    fn a_triangle_is_shared_out_by_area() {
        let corners = [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(0.0, 2.0)];
        let map = landed_map([LandedTriangle { corners, light: 8.0, intensities: EVEN }], 4);
        assert_eq!([map[0], map[1], map[4], map[5]], [4.0, 2.0, 2.0, 0.0]);
        assert_eq!(map.iter().sum::<f64>(), 8.0);
        let off = corners.map(|p| p - DVec2::X);
        let map = landed_map([LandedTriangle { corners: off, light: 8.0, intensities: EVEN }], 4);
        assert_eq!([map[0], map[4]], [2.0, 0.0]);
    }

    /// Light of 1 + 0.05 x: the texels of a triangle that covers them whole have that of their middles, and its sum is its own.
    #[test]
    fn light_is_linear_between_corners() {
        let corners = [DVec2::ZERO, DVec2::new(16.0, 0.0), DVec2::new(0.0, 16.0)];
        let intensities = corners.map(|p| 1.0 + 0.05 * p.x);
        let light = 128.0 * intensities.iter().sum::<f64>() / 3.0;
        let map = landed_map([LandedTriangle { corners, light, intensities }], 16);
        assert!((map[0] - 1.025).abs() < 1e-12 && (map[9] - 1.475).abs() < 1e-12, "{} {}", map[0], map[9]);
        assert!((map.iter().sum::<f64>() - light).abs() < 1e-9);
        // Where a corner is turned over, and where one is not known, it is the same everywhere.
        for other in [-1.0, 0.0] {
            let map = landed_map([LandedTriangle { corners, light, intensities: [1.0, 1.5, other] }], 16);
            assert!((map[0] - light / 128.0).abs() < 1e-12 && (map[9] - map[0]).abs() < 1e-12);
        }
        // By no more than MOST_RISE.
        let map = landed_map([LandedTriangle { corners, light: 128.0, intensities: [1.0, 100.0, 1.0] }], 16);
        assert!((map[1] - map[0] - MOST_RISE).abs() < 1e-12);
    }

    #[test]
    fn a_point_keeps_its_light() {
        let corners = [DVec2::new(1.5, 2.5); 3];
        let map = landed_map([LandedTriangle { corners, light: 3.0, intensities: EVEN }], 4);
        assert_eq!(map[2 * 4 + 1], 3.0);
    }
}

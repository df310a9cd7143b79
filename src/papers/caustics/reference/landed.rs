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
}

/// Each triangle's light spread evenly over the area that it covers, row by row of a map of `resolution` texels a side.
/// One without an area lands in its middle.
pub fn landed_map(triangles: impl IntoIterator<Item = LandedTriangle>, resolution: usize) -> Vec<f64> {
    let mut map = vec![0.0; resolution * resolution];
    for LandedTriangle { corners, light } in triangles {
        let whole = area(&corners);
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
            let share = if whole > 1e-12 {
                area(&clip(&corners.map(|p| p - center), DVec2::splat(0.5))) / whole
            } else {
                f64::from(u8::from((middle - center).abs().max_element() <= 0.5))
            };
            map[row * resolution + column] += light * share;
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_shared_out_by_area() {
        let corners = [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(0.0, 2.0)];
        let map = landed_map([LandedTriangle { corners, light: 8.0 }], 4);
        assert_eq!([map[0], map[1], map[4], map[5]], [4.0, 2.0, 2.0, 0.0]);
        assert_eq!(map.iter().sum::<f64>(), 8.0);
        let off = corners.map(|p| p - DVec2::X);
        let map = landed_map([LandedTriangle { corners: off, light: 8.0 }], 4);
        assert_eq!([map[0], map[4]], [2.0, 0.0]);
    }

    #[test]
    fn a_point_keeps_its_light() {
        let corners = [DVec2::new(1.5, 2.5); 3];
        assert_eq!(landed_map([LandedTriangle { corners, light: 3.0 }], 4)[2 * 4 + 1], 3.0);
    }
}

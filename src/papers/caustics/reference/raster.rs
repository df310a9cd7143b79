//! Exact point sampling of triangles at texel positions.

use glam::DVec2;

/// A triangle in texels with a positive area and finite corners.
pub(super) struct TexelTriangle {
    /// Corners in the order that makes the area positive.
    corners: [DVec2; 3],
    /// Index in `corners` of each of the caller's corners.
    order: [usize; 3],
    double_area: f64,
}

impl TexelTriangle {
    /// `None` where the triangle has no area or a corner is not finite.
    pub(super) fn new(corners: [DVec2; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let double_area = (b - a).perp_dot(c - a);
        if double_area > 0.0 && double_area.is_finite() {
            Some(Self { corners, order: [0, 1, 2], double_area })
        } else if double_area < 0.0 && double_area.is_finite() {
            Some(Self { corners: [a, c, b], order: [0, 2, 1], double_area: -double_area })
        } else {
            None
        }
    }

    /// Barycentric weights of the caller's corners where the triangle covers `point`. Of two triangles on either side
    /// of an edge exactly one covers a point on it.
    pub(super) fn weights(&self, point: DVec2) -> Option<[f64; 3]> {
        let [a, b, c] = self.corners;
        let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| (edge(p, q, point), precedes(p, q)));
        sides
            .iter()
            .all(|&(side, owns_edge)| side > 0.0 || (side == 0.0 && owns_edge))
            .then(|| self.order.map(|i| sides[i].0 / self.double_area))
    }

    /// Distance from `point` to the nearest edge, in texels.
    pub(super) fn distance_to_edge(&self, point: DVec2) -> f64 {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)]
            .map(|(p, q)| {
                let along = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
                (p + (q - p) * along).distance(point)
            })
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    /// Smallest height of the triangle, in texels.
    pub(super) fn altitude(&self) -> f64 {
        let [a, b, c] = self.corners;
        self.double_area / a.distance(b).max(b.distance(c)).max(c.distance(a))
    }

    /// The texels of a square map whose centres lie within one texel of the triangle's bounds: index and centre.
    pub(super) fn texels(&self, resolution: usize) -> impl Iterator<Item = (usize, DVec2)> {
        let low = self.corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let high = self.corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        // A cast from float saturates, so bounds outside the map clamp to it.
        let first = |x: f64| (x - 1.5).ceil() as usize;
        let end = move |x: f64| ((x + 1.5).floor() as usize).min(resolution);
        let (rows, columns) = (first(low.y)..end(high.y), first(low.x)..end(high.x));
        rows.flat_map(move |row| columns.clone().map(move |column| (row, column))).map(move |(row, column)| {
            let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            (row * resolution + column, center)
        })
    }
}

/// Twice the signed area of (p, q, point); exactly opposite for (q, p, point), so that neighbours agree on a shared
/// edge.
fn edge(p: DVec2, q: DVec2, point: DVec2) -> f64 {
    if precedes(p, q) { (q - p).perp_dot(point - p) } else { -((p - q).perp_dot(point - q)) }
}

fn precedes(p: DVec2, q: DVec2) -> bool {
    (p.x, p.y) < (q.x, q.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fan_covers_every_texel_of_its_square_exactly_once() {
        let resolution = 9;
        let rim = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(DVec2::from);
        for hub in [DVec2::splat(4.5), DVec2::new(2.5, 6.5), DVec2::new(3.3, 3.1)] {
            let mut covered = vec![0; resolution * resolution];
            for i in 0..4 {
                let fan = TexelTriangle::new([hub, rim[(i + 1) % 4], rim[i]]).unwrap();
                for (texel, center) in fan.texels(resolution) {
                    covered[texel] += u32::from(fan.weights(center).is_some());
                }
            }
            assert_eq!(covered, vec![1; resolution * resolution]);
        }
    }

    #[test]
    fn weights_follow_the_callers_order_in_both_windings() {
        let corners = [(1.0, 1.0), (7.0, 2.0), (3.0, 8.0)].map(DVec2::from);
        let point = DVec2::new(3.5, 3.5);
        for order in [[0, 1, 2], [0, 2, 1], [2, 1, 0]] {
            let corners = order.map(|i| corners[i]);
            let triangle = TexelTriangle::new(corners).unwrap();
            let weights = triangle.weights(point).unwrap();
            let rebuilt: DVec2 = (0..3).map(|i| corners[i] * weights[i]).sum();
            assert!((rebuilt - point).length() < 1e-12);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn triangles_without_area_or_number_are_refused() {
        let [a, b] = [DVec2::ZERO, DVec2::ONE];
        assert!(TexelTriangle::new([a, b, b * 2.0]).is_none());
        assert!(TexelTriangle::new([a, b, DVec2::new(f64::NAN, 0.0)]).is_none());
        assert!(TexelTriangle::new([a, b, DVec2::new(f64::INFINITY, 0.0)]).is_none());
    }

    #[test]
    fn distances_to_edges_and_heights_are_euclidean() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)].map(DVec2::from);
        let triangle = TexelTriangle::new(corners).unwrap();
        assert!((triangle.altitude() - 2.4).abs() < 1e-12);
        assert!((triangle.distance_to_edge(DVec2::new(1.0, 0.25)) - 0.25).abs() < 1e-12);
        assert!((triangle.distance_to_edge(DVec2::new(7.0, -4.0)) - 5.0).abs() < 1e-12);
    }
}

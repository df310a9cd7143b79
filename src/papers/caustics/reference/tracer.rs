//! Rays and triangles: the first that a ray meets, by a tree of boxes.

use glam::DVec3;

/// Triangles of a leaf, at the most.
const LEAF: usize = 4;
/// By which a ray may miss a triangle's edge, of the triangle: two neighbours leave no gap.
const EDGE: f64 = 1e-12;

/// Triangles, ready for rays.
#[derive(Clone, Debug)]
pub struct Tracer {
    /// With their places in the caller's list, as the leaves hold them.
    triangles: Vec<([DVec3; 3], usize)>,
    /// The first is the root.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// First triangle of a leaf, or the first of two nodes side by side.
    first: usize,
    /// Triangles; none of a node with nodes under it.
    count: usize,
}

impl Tracer {
    /// Splits at the middle triangle along the longest side of the middles' box.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let mut tracer = Tracer {
            triangles: triangles.iter().enumerate().map(|(index, &corners)| (corners, index)).collect(),
            nodes: vec![Node { low: DVec3::ZERO, high: DVec3::ZERO, first: 0, count: 0 }],
        };
        tracer.split(0, 0, triangles.len());
        tracer
    }

    fn split(&mut self, node: usize, from: usize, to: usize) {
        let middle = |corners: &[DVec3; 3]| corners.iter().sum::<DVec3>() / 3.0;
        let list = &mut self.triangles[from..to];
        let bounds = |points: &mut dyn Iterator<Item = DVec3>| {
            let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            points.fold(none, |(low, high), p| (low.min(p), high.max(p)))
        };
        let (low, high) = bounds(&mut list.iter().flat_map(|(corners, _)| *corners));
        self.nodes[node] = Node { low, high, first: from, count: list.len() };
        if list.len() <= LEAF {
            return;
        }
        let (least, greatest) = bounds(&mut list.iter().map(|(corners, _)| middle(corners)));
        let axis = (greatest - least).max_position();
        let half = list.len() / 2;
        list.select_nth_unstable_by(half, |(a, _), (b, _)| middle(a)[axis].total_cmp(&middle(b)[axis]));
        let first = self.nodes.len();
        self.nodes.extend([self.nodes[node]; 2]);
        (self.nodes[node].first, self.nodes[node].count) = (first, 0);
        self.split(first, from, from + half);
        self.split(first + 1, from + half, to);
    }

    /// Distance to the first triangle that a ray meets farther away than `beyond`, in lengths of `ray`, and its place in the
    /// list that the tracer was made of.
    pub fn first_hit(&self, origin: DVec3, ray: DVec3, beyond: f64) -> Option<(f64, usize)> {
        let mut nearest: Option<(f64, usize)> = None;
        // Finite, so that a ray within a face's plane gives no NaN.
        let inverse = ray.to_array().map(|along| if along.abs() < 1e-300 { 1e300 } else { 1.0 / along });
        let inverse = DVec3::from_array(inverse);
        let mut waiting = [0usize; 64];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let node = &self.nodes[waiting[count]];
            let (one, other) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            let enters = one.min(other).max_element().max(beyond);
            let leaves = one.max(other).min_element().min(nearest.map_or(f64::INFINITY, |(distance, _)| distance));
            if enters > leaves + EDGE * leaves.abs() {
                continue;
            }
            if node.count == 0 && !self.triangles.is_empty() {
                // Halved lists of fewer than 2^32 triangles are 32 deep.
                waiting[count] = node.first;
                waiting[count + 1] = node.first + 1;
                count += 2;
                continue;
            }
            for (corners, index) in &self.triangles[node.first..node.first + node.count] {
                let farthest = nearest.map_or(f64::INFINITY, |(distance, _)| distance);
                if let Some(distance) = meets(corners, origin, ray).filter(|d| (beyond..farthest).contains(d)) {
                    nearest = Some((distance, *index));
                }
            }
        }
        nearest
    }
}

/// Distance at which a ray meets a triangle's plane inside it, by Möller and Trumbore.
fn meets([a, b, c]: &[DVec3; 3], origin: DVec3, ray: DVec3) -> Option<f64> {
    let (ab, ac, from_a) = (*b - *a, *c - *a, origin - *a);
    let normal = ray.cross(ac);
    let determinant = ab.dot(normal);
    let (at_b, turned) = (from_a.dot(normal) / determinant, from_a.cross(ab));
    let at_c = ray.dot(turned) / determinant;
    let is_inside = at_b >= -EDGE && at_c >= -EDGE && at_b + at_c <= 1.0 + EDGE;
    is_inside.then(|| ac.dot(turned) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;

    #[test]
    fn the_tree_finds_what_a_look_at_every_triangle_finds() {
        let mut random = Random::new(7);
        let mut point = || DVec3::from_array([0; 3].map(|_| f64::from(random.unit()) - 0.5));
        let triangles: Vec<[DVec3; 3]> = (0..500)
            .map(|_| {
                let at = point() * 4.0;
                [at, at + point() * 0.5, at + point() * 0.5]
            })
            .collect();
        let tracer = Tracer::new(&triangles);
        let mut hits = 0;
        for _ in 0..2000 {
            let (origin, ray) = (point() * 6.0, point().normalize());
            let each = triangles.iter().enumerate().filter_map(|(i, t)| Some((meets(t, origin, ray)?, i)));
            let expected = each.filter(|(d, _)| *d >= 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(tracer.first_hit(origin, ray, 0.0), expected);
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 100, "{hits}");
        assert_eq!(Tracer::new(&[]).first_hit(DVec3::ZERO, DVec3::Y, 0.0), None);
    }

    #[test]
    fn a_ray_along_an_axis_through_an_edge_passes_nothing() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Z, DVec3::X + DVec3::Z];
        let square = [[corners[0], corners[1], corners[2]], [corners[2], corners[1], corners[3]]];
        let tracer = Tracer::new(&square);
        for at in [DVec3::new(0.5, 1.0, 0.5), DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.25, 1.0, 0.75)] {
            assert_eq!(tracer.first_hit(at, DVec3::NEG_Y, 0.0).map(|(distance, _)| distance), Some(1.0), "{at}");
        }
        assert_eq!(tracer.first_hit(DVec3::new(0.5, 1.0, 0.5), DVec3::Y, 0.0), None);
    }
}

//! The illumination volumes around a point, and the light that they bring there.
//!
//! A side of a volume is the ruled surface between two neighbouring rays. Drawn it is two triangles, cut along the
//! diagonal from the first of the two water vertices, by number, down to the bottom of the other. Both are followed here:
//! between the side and its cut a point has the light of the neighbouring volume, continued beyond its own edge.

use fumarole::papers::caustics::reference::{IlluminationVolume, intensity, intersection_triangle};
use fumarole::papers::caustics::water::{Grid, LEVEL_M};
use glam::{DVec2, DVec3};

use crate::oracle::Oracle;

/// How far below the receiver the prisms end, as a share of its depth along V.
const BELOW: f64 = 0.1;
/// How far outside its triangle a volume still lights what is inside its prism, as a share of the triangle.
const SLACK: f64 = 0.25;

pub struct Prisms<'a> {
    oracle: &'a Oracle,
    /// Whether each side's diagonal starts at the side's first corner.
    from_first: Vec<[bool; 3]>,
    /// Of all prisms, in box space.
    bottom_m: f64,
}

/// What lights a point: I_c under a light of unit intensity.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    /// Over the prisms that contain the point.
    pub of_prisms: f64,
    /// Over the volumes themselves.
    pub of_volumes: f64,
    /// Whether the point lies so near to a prism's side that rounding decides.
    pub is_at_side: bool,
}

impl<'a> Prisms<'a> {
    pub fn of(oracle: &'a Oracle, grid: &Grid) -> Self {
        let indices = grid.indices();
        assert_eq!(indices.len(), 3 * oracle.volumes.len(), "a volume for every triangle");
        let order = |corners: &[u32]| [0, 1, 2].map(|i| corners[i] < corners[(i + 1) % 3]);
        let middle = grid.center();
        let level_m = oracle.receiver.to_box(DVec3::new(middle.x, LEVEL_M, middle.y)).y;
        Prisms {
            oracle,
            from_first: indices.chunks_exact(3).map(order).collect(),
            bottom_m: oracle.lowest_m - BELOW * (level_m - oracle.lowest_m),
        }
    }

    /// At a point of box space.
    pub fn light_at(&self, point: DVec3, band_m: f64) -> Sum {
        let place = DVec2::new(point.x, point.z);
        let mut sum = Sum::default();
        for (volume, from_first) in self.oracle.volumes.iter().zip(&self.from_first) {
            let Some(hit) = intersection_triangle(volume, &self.oracle.receiver, point.y) else {
                continue;
            };
            let corners = hit.corners.map(|p| DVec2::new(p.x, p.z));
            let outline = self.outline(volume, *from_first, point.y, corners);
            let reach_m = outline.iter().map(|p| p.distance(corners[0])).fold(0.0, f64::max);
            if place.distance(corners[0]) > reach_m + band_m {
                continue;
            }
            let Some(at_corners) = intensity(volume, &hit, self.oracle.medium.absorption_per_m) else {
                continue;
            };
            let weights = barycentric(place, corners);
            let least = weights.into_iter().fold(1.0, f64::min);
            let here: f64 = at_corners.iter().zip(weights).map(|(at, weight)| at * weight).sum();
            let outside_m = signed_distance(place, &outline);
            sum.is_at_side |= outside_m.abs() < band_m;
            sum.of_prisms += if outside_m < 0.0 && least >= -SLACK { here } else { 0.0 };
            sum.of_volumes += if least >= 0.0 { here } else { 0.0 };
        }
        sum
    }

    /// The section of a prism at a height: its corners, and between each two the point of the diagonal.
    fn outline(&self, volume: &IlluminationVolume, from_first: [bool; 3], y: f64, corners: [DVec2; 3]) -> [DVec2; 6] {
        let receiver = &self.oracle.receiver;
        let top = volume.vertices.map(|p| receiver.to_box(p));
        let bottom = std::array::from_fn::<_, 3, _>(|i| {
            let ray = receiver.direction_to_box(volume.refracted[i]);
            top[i] + ray * ((self.bottom_m - top[i].y) / ray.y)
        });
        let diagonal = |a: usize| {
            let b = (a + 1) % 3;
            let (from, to) = if from_first[a] { (top[a], bottom[b]) } else { (top[b], bottom[a]) };
            let point = from.lerp(to, (y - from.y) / (to.y - from.y));
            DVec2::new(point.x, point.z)
        };
        [corners[0], diagonal(0), corners[1], diagonal(1), corners[2], diagonal(2)]
    }
}

/// From a polygon's outline; negative where it winds around the point, folded over or not.
fn signed_distance<const N: usize>(point: DVec2, corners: &[DVec2; N]) -> f64 {
    let mut distance = f64::INFINITY;
    let mut winding = 0;
    for i in 0..N {
        let (a, b) = (corners[i], corners[(i + 1) % N]);
        let share = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        distance = distance.min(point.distance(a.lerp(b, share)));
        let crosses = (a.y > point.y) != (b.y > point.y);
        if crosses && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y) {
            winding += if a.y < b.y { 1 } else { -1 };
        }
    }
    if winding == 0 { distance } else { -distance }
}

fn barycentric(point: DVec2, [a, b, c]: [DVec2; 3]) -> [f64; 3] {
    let twice_area = (b - a).perp_dot(c - a);
    let (share_b, share_c) = ((point - a).perp_dot(c - a) / twice_area, (b - a).perp_dot(point - a) / twice_area);
    [1.0 - share_b - share_c, share_b, share_c]
}

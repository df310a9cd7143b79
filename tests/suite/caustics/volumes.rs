//! The illumination volumes around a point, and the light that they bring there.

use fumarole::papers::caustics::reference::{intensity, intersection_triangle};
use glam::{DVec2, DVec3};

use super::oracle::Oracle;

/// Light at a point.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    /// I_c under a light of unit intensity, over the volumes that contain the point.
    pub intensity: f64,
    /// True where the point lies so near to a volume's side that rounding decides.
    pub is_at_side: bool,
}

/// At a point of box space, `band_m` being how near is at a side.
pub fn light_at(oracle: &Oracle, point: DVec3, band_m: f64) -> Sum {
    let place = DVec2::new(point.x, point.z);
    let mut sum = Sum::default();
    for volume in &oracle.volumes {
        let Some(hit) = intersection_triangle(volume, &oracle.receiver, point.y) else {
            continue;
        };
        let corners = hit.corners.map(|p| DVec2::new(p.x, p.z));
        let reach_m = corners.iter().map(|p| p.distance(corners[0])).fold(0.0, f64::max);
        if place.distance(corners[0]) > reach_m + band_m {
            continue;
        }
        let sides = [0, 1, 2].map(|i| distance_to_segment(place, corners[i], corners[(i + 1) % 3]));
        sum.is_at_side |= sides.into_iter().fold(f64::INFINITY, f64::min) < band_m;
        let weights = barycentric(place, corners);
        if weights.iter().all(|&weight| weight >= 0.0)
            && let Some(at_corners) = intensity(volume, &hit, oracle.medium.absorption_per_m)
        {
            sum.intensity += at_corners.iter().zip(weights).map(|(at, weight)| at * weight).sum::<f64>();
        }
    }
    sum
}

fn distance_to_segment(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let fraction = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    point.distance(a.lerp(b, fraction))
}

fn barycentric(point: DVec2, [a, b, c]: [DVec2; 3]) -> [f64; 3] {
    let twice_area = (b - a).perp_dot(c - a);
    let (weight_b, weight_c) = ((point - a).perp_dot(c - a) / twice_area, (b - a).perp_dot(point - a) / twice_area);
    [1.0 - weight_b - weight_c, weight_b, weight_c]
}

//! Stage three, chapter 7: what one pixel sees of the splats.

use glam::{DMat4, DVec2, DVec3};

use super::surface::{Surface, gaussian};
use crate::scene::Camera;

/// The display's share of an exposed value: clipped at 1, or from 0.6 on approaching 1 with a slope that begins at 1.
pub fn toned(value: f64, has_shoulder: bool) -> f64 {
    let beyond = (value - 0.6) / 0.4;
    if !has_shoulder {
        value.min(1.0)
    } else if beyond < 0.0 {
        value
    } else {
        1.0 - 0.4 * (-beyond).exp()
    }
}

/// A flat, round splat.
#[derive(Debug, Clone, Copy)]
struct Splat {
    center: DVec3,
    normal: DVec3,
}

/// Splats of one radius under a camera.
pub struct Splats {
    splats: Vec<Splat>,
    radius: f64,
    epsilon: f64,
    eye: DVec3,
    forward: DVec3,
    to_world: DMat4,
    size: DVec2,
}

/// Result of blending in a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// Eye-space depth of the nearest splat.
    pub depth: f64,
    /// Sum of weighted values, sum of weights (eq. 7.2).
    pub sums: [f64; 2],
    /// Sum of weighted eye-space depths.
    pub depths: f64,
    /// Splats that lie epsilon or more behind.
    pub hidden: u32,
    /// Rounding may decide otherwise whether some splat counts.
    pub is_close_call: bool,
}

/// Relative distance to a splat's rim, or to epsilon, within which a device's precision may decide either way: vertices
/// are snapped to 1/256 of a pixel.
const CLOSE: f64 = 1e-3;
/// Cosine between ray and normal below which that snapping moves a point far across its splat.
const EDGE_ON: f64 = 0.05;

impl Splats {
    /// `counts` splats spread evenly over `surface`, seen by `camera` in a picture of `width` x `height` pixels.
    pub fn new(
        surface: &Surface,
        counts: [u32; 2],
        radius: f64,
        epsilon: f64,
        camera: &Camera,
        [width, height]: [u32; 2],
    ) -> Self {
        let along = |i: u32, count: u32, side: f64| (f64::from(i) + 0.5) / f64::from(count) * side;
        let mut splats = Vec::new();
        for k in 0..counts[1] {
            for i in 0..counts[0] {
                let (x, z) = (along(i, counts[0], surface.space.x), along(k, counts[1], surface.space.z));
                let (height, normal) = surface.at(x, z);
                splats.push(Splat { center: DVec3::new(x, height, z), normal });
            }
        }
        let aspect = width as f32 / height as f32;
        let view_projection = camera.projection(aspect).as_dmat4() * camera.view().as_dmat4();
        Splats {
            splats,
            radius,
            epsilon,
            eye: camera.eye.as_dvec3(),
            forward: (camera.target - camera.eye).as_dvec3().normalize(),
            to_world: view_projection.inverse(),
            size: DVec2::new(f64::from(width), f64::from(height)),
        }
    }

    /// The pixel at `column` and `row`, of a value that `value` gives for a splat's centre; `None` where none is seen.
    pub fn pixel(&self, column: u32, row: u32, value: impl Fn(DVec3) -> f64) -> Option<Pixel> {
        let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / self.size * 2.0 - 1.0;
        let through = self.to_world.project_point3(at.extend(0.5));
        let ray = (through - self.eye).normalize();
        let mut seen = Vec::new();
        let mut is_close_call = false;
        for splat in &self.splats {
            let facing = ray.dot(splat.normal);
            let along = (splat.center - self.eye).dot(splat.normal) / facing;
            let point = self.eye + ray * along;
            let ratio = point.distance(splat.center) / self.radius;
            if !(along > 0.0 && ratio < 1.5) {
                continue;
            }
            is_close_call |= facing.abs() < EDGE_ON || (ratio - 1.0).abs() < CLOSE / facing.abs();
            if ratio <= 1.0 {
                seen.push(((point - self.eye).dot(self.forward), gaussian(ratio), value(splat.center)));
            }
        }
        let depth = seen.iter().map(|s| s.0).reduce(f64::min)?;
        let (mut sums, mut depths, mut hidden) = ([0.0; 2], 0.0, 0);
        for (d, weight, value) in seen {
            let behind = d - depth;
            is_close_call |= (behind - self.epsilon).abs() < CLOSE * self.radius / EDGE_ON;
            // Eq. 7.1: o = depth + epsilon.
            if d < depth + self.epsilon {
                sums[0] += weight * value;
                sums[1] += weight;
                depths += weight * d;
            } else {
                hidden += 1;
            }
        }
        Some(Pixel { depth, sums, depths, hidden, is_close_call })
    }
}

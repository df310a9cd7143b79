//! Solid textures of surfaces, in double precision: their mean over a pixel.

use glam::DVec3;

use super::rays::Rays;
use crate::papers::gas::model::SolidTexture;

/// The mean over a pixel of a texture on the plane through three points, each value cut off at 0 and 1, by `side` x `side` rays; of
/// one ray it is the value in the pixel's middle. The plane is before the eye in all of the pixel.
pub fn mean_over_pixel(
    rays: &Rays<'_>,
    texture: &SolidTexture,
    plane: [DVec3; 3],
    [column, row]: [u32; 2],
    side: u32,
) -> f64 {
    let [a, b, c] = plane;
    let normal = (b - a).cross(c - a);
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let value = |i: u32| {
        let ray = rays.direction(f64::from(column) + place(i % side), f64::from(row) + place(i / side));
        let point = rays.eye() + ray * (normal.dot(a - rays.eye()) / normal.dot(ray));
        rays.medium.texture_density(texture, None, point).clamp(0.0, 1.0)
    };
    (0..side * side).map(value).sum::<f64>() / f64::from(side * side)
}

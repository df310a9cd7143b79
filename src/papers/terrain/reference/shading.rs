//! Illumination: Lambert's law and a ray towards the sun.

use crate::papers::terrain::reference::{Hit, Ray, Terrain};
use glam::DVec3;

/// max(0, n·s), of the unit normal and the unit direction towards the sun.
pub fn lambert(normal: DVec3, to_sun: DVec3) -> f64 {
    normal.dot(to_sun).max(0.0)
}

/// Whether the sun is seen from a hit: a ray that starts `bias_m` above it along its normal meets no solid.
pub fn is_lit(terrain: &Terrain, hit: &Hit, to_sun: DVec3, bias_m: f64) -> bool {
    let ray = Ray::new(hit.point + hit.normal * bias_m, to_sun);
    hit.normal.dot(to_sun) > 0.0 && terrain.first_hit(&ray, [0.0, f64::INFINITY]).is_none()
}

//! Illumination: Lambert's law and a ray towards the sun.

use crate::papers::terrain::reference::{Ray, Terrain};
use glam::DVec3;

/// max(0, n·s), of the unit normal and the unit direction towards the sun.
pub fn lambert(normal: DVec3, to_sun: DVec3) -> f64 {
    normal.dot(to_sun).max(0.0)
}

/// True where no map stands between a place and the sun.
pub fn is_lit(terrain: &Terrain, place: DVec3, to_sun: DVec3) -> bool {
    let hit = terrain.first_hit(&Ray::new(place, to_sun), [0.0, f64::INFINITY]);
    hit.is_none_or(|hit| hit.map.is_none())
}

//! Places over a curved base in single precision, as `shaders/terrain/geodesy.glsl` has them.

use glam::{Vec2, Vec3};

use super::blocks::{CYLINDER, TerrainBlock};

pub fn is_cylinder(terrain: &TerrainBlock) -> bool {
    terrain.base_kind == CYLINDER
}

/// The map's coordinates, u, v and h, of a point in metres from the map's middle on the base; `side` is that of the half-plane
/// behind the axis that longitudes are counted to.
pub fn map_coordinates(terrain: &TerrainBlock, point: Vec3, side: f32) -> Vec3 {
    let (off_m, middle) = (terrain.axis_distance_m, terrain.middle_node);
    let off = off_m + point.y;
    let radius = Vec2::new(point.x, off).length();
    let mut longitude = point.x.atan2(off);
    if off < 0.0 {
        longitude = if side < 0.0 { -longitude.abs() } else { longitude.abs() };
    }
    let grown = if off > 0.0 { point.y + point.x * point.x / (radius + off) } else { radius - off_m };
    let (along, height_m) = if is_cylinder(terrain) { (point.z, grown) } else { geodetic(terrain, grown, point.z) };
    Vec3::new(
        middle.x + longitude * terrain.nodes_per_unit.x,
        middle.y + along * terrain.nodes_per_unit.y,
        terrain.base_height + height_m / terrain.height_unit_m,
    )
}

/// An ellipse's point at a latitude that differs by `delta` from the map's middle: sine and cosine of the latitude; how the
/// point lies to the middle's, off and along the axis; radii of curvature across the meridian and along it. Written in
/// differences, so that nothing of a planet's size cancels.
pub struct Meridian {
    /// Of the latitude.
    pub sine: f32,
    /// Of the latitude.
    pub cosine: f32,
    off: f32,
    along: f32,
    /// Radius of curvature across the meridian, metres.
    pub across: f32,
    /// Radius of curvature along the meridian, metres.
    pub radius: f32,
}

pub fn meridian(terrain: &TerrainBlock, delta: f32) -> Meridian {
    let TerrainBlock { semi_major_m: a, squared_eccentricity: e2, sine_latitude: s0, cosine_latitude: c0, .. } =
        *terrain;
    let (sh, ch) = (0.5 * delta).sin_cos();
    let ds = 2.0 * sh * (c0 * ch - s0 * sh);
    let dc = -2.0 * sh * (s0 * ch + c0 * sh);
    let (s, c) = (s0 + ds, c0 + dc);
    let w0 = (1.0 - e2 * s0 * s0).sqrt();
    let w = (1.0 - e2 * s * s).sqrt();
    let n = a / w;
    let dn = a * e2 * ds * (s + s0) / ((w0 + w) * w * w0);
    Meridian {
        sine: s,
        cosine: c,
        off: n * dc + dn * c0,
        along: (1.0 - e2) * (n * ds + dn * s0),
        across: n,
        radius: a * (1.0 - e2) / (w * w * w),
    }
}

/// Latitude as a difference from the map's middle, and height, of a point in the plane of a meridian: Newton's method for the
/// foot of the normal.
fn geodetic(terrain: &TerrainBlock, off: f32, along: f32) -> (f32, f32) {
    let TerrainBlock { semi_major_m: a, squared_eccentricity: e2, sine_latitude: s0, cosine_latitude: c0, .. } =
        *terrain;
    let n0 = a / (1.0 - e2 * s0 * s0).sqrt();
    let mut delta = (n0 * (1.0 - e2) * s0 + along).atan2((terrain.axis_distance_m + off) * (1.0 - e2)) - s0.atan2(c0);
    let mut height_m = 0.0;
    for _ in 0..4 {
        let foot = meridian(terrain, delta);
        let (r, w) = (off - foot.off, along - foot.along);
        height_m = r * foot.cosine + w * foot.sine;
        delta += (w * foot.cosine - r * foot.sine) / (foot.radius + height_m).max(1e-6 * foot.radius);
    }
    (delta, height_m)
}

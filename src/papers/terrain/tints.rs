//! Drapes that are drawn of the terrain itself, as `shaders/terrain/drape-*.glsl` have them: lines of equal height, colours by slope and by
//! height.

use glam::{Vec2, Vec3, Vec4};

use super::blocks::{CYLINDER, LightBlock, PLANE};
use super::drape::Draping;

const INK: Vec3 = Vec3::new(0.08, 0.045, 0.02);
/// Every fifth line is a wide one.
const LINE_PX: f32 = 1.0;
const WIDE_LINE_PX: f32 = 2.0;
/// Terrain on which lines are farther apart lies on none, however near its height is to one's.
const MOST_APART_PX: f32 = 1e4;

/// At 0, 15, 30, 45 and 60 degrees, linear: level, grassy, loose, rocky, sheer.
const SLOPES: [Vec3; 5] = [
    Vec3::new(0.42, 0.45, 0.40),
    Vec3::new(0.28, 0.40, 0.12),
    Vec3::new(0.52, 0.36, 0.04),
    Vec3::new(0.50, 0.07, 0.03),
    Vec3::new(0.16, 0.02, 0.16),
];

/// Of atlases: blue below 0 m, then green, yellow, brown and white, linear.
const HYPSOMETRIC: [(f32, Vec3); 10] = [
    (-6000.0, Vec3::new(0.01, 0.03, 0.12)),
    (-200.0, Vec3::new(0.05, 0.16, 0.35)),
    (0.0, Vec3::new(0.18, 0.35, 0.46)),
    (0.0, Vec3::new(0.10, 0.26, 0.10)),
    (200.0, Vec3::new(0.22, 0.34, 0.11)),
    (500.0, Vec3::new(0.44, 0.41, 0.17)),
    (1000.0, Vec3::new(0.38, 0.25, 0.09)),
    (2000.0, Vec3::new(0.24, 0.12, 0.05)),
    (3500.0, Vec3::new(0.32, 0.26, 0.24)),
    (5000.0, Vec3::new(0.56, 0.56, 0.57)),
];

/// The terrain's colour under such a drape; `facing` is the normal and the height over the base.
pub fn tinted(
    light: &LightBlock,
    draping: Draping,
    albedo: Vec3,
    (direction, depth_m): (Vec3, f32),
    facing: Vec4,
) -> Vec3 {
    let normal = facing.truncate();
    let up = || up_at(light, light.eye + depth_m * direction, facing.w);
    let height_m = facing.w - light.zero_m;
    match draping {
        Draping::WholeMap | Draping::Placed { .. } => albedo,
        Draping::Contours { interval_m } => {
            let rise_m = rise_per_pixel(light, (direction, depth_m), normal, up());
            let narrow = line(height_m, interval_m, LINE_PX, rise_m);
            let wide = line(height_m, 5.0 * interval_m, WIDE_LINE_PX, rise_m);
            albedo.lerp(INK, 0.75 * narrow.max(wide))
        }
        Draping::Slope => slope_tint(normal, up()),
        Draping::Hypsometric { scale } => hypsometric_tint(height_m / scale),
    }
}

/// The base's normal below a point of the world `height_m` over it.
pub fn up_at(light: &LightBlock, point: Vec3, height_m: f32) -> Vec3 {
    if light.base_kind == PLANE {
        return Vec3::Y;
    }
    let from_center = point - light.base_center;
    let along = from_center.dot(light.base_axis);
    let across = from_center - along * light.base_axis;
    let radius = across.length().max(1e-20);
    let mut up = Vec2::new(radius, 0.0);
    if light.base_kind != CYLINDER {
        // The point is (N + h) cos, (N b^2 / a^2 + h) sin of the latitude, whose radius of curvature N changes little with it.
        let squares = light.base_radii * light.base_radii;
        up = Vec2::new(radius, along) / squares;
        for _ in 0..4 {
            up = up.normalize();
            let n = squares.x / squares.dot(up * up).sqrt();
            up = Vec2::new(radius, along) / (Vec2::new(n, n * squares.y / squares.x) + height_m);
        }
    }
    (up.x / radius * across + up.y * light.base_axis).normalize()
}

/// The change of the height from a pixel to the next, metres: the next ray meets the plane of the surface in another place.
fn rise_per_pixel(light: &LightBlock, (direction, depth_m): (Vec3, f32), normal: Vec3, up: Vec3) -> f32 {
    // A normal between the nodes may point away from the eye.
    let towards = normal.dot(direction).min(-1e-4);
    let moved = |step: Vec3| step - direction * (normal.dot(step) / towards);
    depth_m * Vec2::new(up.dot(moved(light.right_step)), up.dot(moved(light.down_step))).length()
}

/// The share of a pixel that a line covers. Lines closer than 2 pixels are left out, those 4 apart are drawn in full.
fn line(height_m: f32, interval_m: f32, width_px: f32, rise_m: f32) -> f32 {
    let rise_m = rise_m.max(1e-20);
    let apart_px = interval_m / rise_m;
    let off_px = (height_m - interval_m * (height_m / interval_m + 0.5).floor()).abs() / rise_m;
    let line = (0.5 * width_px + 0.5 - off_px).clamp(0.0, 1.0) * (0.5 * apart_px - 1.0).clamp(0.0, 1.0);
    if apart_px < MOST_APART_PX { line } else { 0.0 }
}

fn slope_tint(normal: Vec3, up: Vec3) -> Vec3 {
    let angle = normal.cross(up).length().atan2(normal.dot(up)).to_degrees();
    let place = (angle / 15.0).clamp(0.0, 4.0);
    let below = (place as usize).min(3);
    SLOPES[below].lerp(SLOPES[below + 1], place - below as f32)
}

fn hypsometric_tint(height_m: f32) -> Vec3 {
    let above = HYPSOMETRIC.partition_point(|(stop_m, _)| *stop_m <= height_m);
    let ends = (above.checked_sub(1).map(|below| HYPSOMETRIC[below]), HYPSOMETRIC.get(above));
    match ends {
        (Some((low_m, low)), Some((high_m, high))) => low.lerp(*high, (height_m - low_m) / (high_m - low_m)),
        (Some((_, tint)), None) => tint,
        (None, _) => HYPSOMETRIC[0].1,
    }
}

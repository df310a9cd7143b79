//! Normal and illumination of a pixel on the processor, as `shaders/terrain/normal.glsl` and `illumination.glsl` have them.

use glam::{Vec2, Vec3, Vec4};

use super::blocks::{LandBlock, LightBlock};
use super::hit::{Hit, Surface};
use super::pyramid::Texel;
use super::relief::Field;

/// Hypsometric tints, linear: meadow, forest, heath, rock, ash, and the pale summit.
const TINTS: [Vec3; 6] = [
    Vec3::new(0.22, 0.30, 0.10),
    Vec3::new(0.10, 0.20, 0.06),
    Vec3::new(0.24, 0.20, 0.10),
    Vec3::new(0.25, 0.17, 0.11),
    Vec3::new(0.30, 0.26, 0.23),
    Vec3::new(0.62, 0.60, 0.58),
];
const ROCK: Vec3 = Vec3::new(0.20, 0.17, 0.15);
const BASE_TINT: Vec3 = Vec3::new(0.17, 0.22, 0.12);
const ZENITH: Vec3 = Vec3::new(0.16, 0.34, 0.68);
const SUNLIGHT: Vec3 = Vec3::new(2.6, 2.45, 2.2);
const SKYLIGHT: Vec3 = Vec3::new(0.8, 0.95, 1.2);

/// The normal of the surface that was met, in the world, and the height above the base in metres.
pub fn normal_of<T: Texel>(land: &LandBlock, field: Field<'_, T>, direction: Vec3, hit: &Hit) -> Vec4 {
    let unit_m = land.bounds[3];
    let spacing_m = Vec2::new(land.margin[2], land.margin[3]);
    let normal = match hit.surface {
        Surface::Sky | Surface::Base => Vec3::Y,
        Surface::Terrain => {
            let cell = field.cell(hit.shift as i32, Vec2::from_array(hit.place));
            let slope = cell.slope() * ((-(hit.shift as f32)).exp2() * unit_m) / spacing_m;
            Vec3::new(-slope.x, 1.0, -slope.y)
        }
        Surface::WallWest => Vec3::NEG_X,
        Surface::WallEast => Vec3::X,
        Surface::WallNorth => Vec3::NEG_Z,
        Surface::WallSouth => Vec3::Z,
        Surface::Inside => -Vec3::new(direction.x * spacing_m.x, direction.z * unit_m, direction.y * spacing_m.y),
    };
    let normal = normal.normalize();
    let [cosine, sine, ..] = land.turn;
    let turned = Vec3::new(cosine * normal.x - sine * normal.z, normal.y, sine * normal.x + cosine * normal.z);
    let above_base_m = match hit.surface {
        Surface::Sky => 0.0,
        _ => (land.eye[2] + hit.depth_m * direction.z - land.bounds[2]) * unit_m,
    };
    turned.extend(above_base_m)
}

/// The colour of a pixel, 8-bit sRGB: Lambert's law under the sun and the sky, the ground's colour by height, haze by distance.
pub fn color_of(light: &LightBlock, (x, y): (u32, u32), hit: &Hit, facing: Vec4) -> [u8; 4] {
    let row = |v: &[f32; 4]| Vec3::from_slice(v);
    let direction = row(&light.corner) + x as f32 * row(&light.across) + y as f32 * row(&light.down);
    let normal = facing.truncate();
    let haze = row(&light.haze);
    let color = match hit.surface {
        Surface::Sky => haze.lerp(ZENITH, direction.normalize().y.clamp(0.0, 1.0).sqrt()),
        surface => {
            let [low, high, ..] = light.range;
            let share = (facing.w - low) / (high - low).max(1e-6);
            let lit = normal.dot(row(&light.sun)).max(0.0);
            let open = light.sun[3] * (0.5 + 0.5 * normal.y);
            let seen = ground(surface, normal, share) * (SUNLIGHT * lit + SKYLIGHT * open);
            haze.lerp(seen, (-light.haze[3] * hit.depth_m * direction.length()).exp())
        }
    };
    let [r, g, b] = color.to_array().map(encode);
    [r, g, b, 255]
}

fn ground(surface: Surface, normal: Vec3, share: f32) -> Vec3 {
    let place = share.clamp(0.0, 1.0) * 5.0;
    let below = (place as usize).min(4);
    let tint = match surface {
        Surface::Base => BASE_TINT,
        _ => TINTS[below].lerp(TINTS[below + 1], place - below as f32),
    };
    // Nothing grows on a cliff.
    let flat = ((normal.y - 0.45) / 0.3).clamp(0.0, 1.0);
    ROCK.lerp(tint, flat * flat * (3.0 - 2.0 * flat))
}

fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

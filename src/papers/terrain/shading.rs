//! Normal and illumination of a pixel on the processor, as `shaders/terrain/normal.glsl` and `illumination.glsl` have them.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4};

use super::blocks::{LandBlock, LightBlock};
use super::caster::Caster;
use super::drape::Drape;
use super::hit::{Hit, Surface};
use super::pyramid::Texel;
use super::surface;
use super::way::meridian;

/// Hypsometric tints, linear: meadow, forest, heath, rock, ash, and the pale summit.
const TINTS: [Vec3; 6] = [
    Vec3::new(0.22, 0.30, 0.10),
    Vec3::new(0.10, 0.20, 0.06),
    Vec3::new(0.24, 0.20, 0.10),
    Vec3::new(0.25, 0.17, 0.11),
    Vec3::new(0.30, 0.26, 0.23),
    Vec3::new(0.55, 0.53, 0.51),
];
const ROCK: Vec3 = Vec3::new(0.20, 0.17, 0.15);
const BASE_TINT: Vec3 = Vec3::new(0.17, 0.22, 0.12);
const ZENITH: Vec3 = Vec3::new(0.16, 0.34, 0.68);
const SUNLIGHT: Vec3 = Vec3::new(2.0, 1.88, 1.7);
const SKYLIGHT: Vec3 = Vec3::new(0.55, 0.68, 0.9);

/// East, up and south where the map is at `place`, as directions of the map's frame, and metres between nodes there.
struct Local {
    east: Vec3,
    up: Vec3,
    south: Vec3,
    spacing_m: Vec2,
}

impl Local {
    fn at(land: &LandBlock, place: Vec2, height_m: f32) -> Self {
        let [off_m, middle_u, middle_v, _] = land.middle;
        let steps = Vec2::from_slice(&land.steps);
        let (s, c) = ((place.x - middle_u) / steps.x).sin_cos();
        let east = Vec3::new(c, -s, 0.0);
        match land.form[3] {
            0 => Local {
                east: Vec3::X,
                up: Vec3::Y,
                south: Vec3::Z,
                spacing_m: Vec2::new(land.margin[2], land.margin[3]),
            },
            1 => Local {
                east,
                up: Vec3::new(s, c, 0.0),
                south: Vec3::Z,
                spacing_m: Vec2::new((off_m + height_m) / steps.x, 1.0 / steps.y.abs()),
            },
            _ => {
                let foot = meridian(land, (place.y - middle_v) / steps.y);
                let radii = Vec2::new((foot.across + height_m) * foot.cosine.max(1e-6), foot.radius + height_m);
                Local {
                    east,
                    up: Vec3::new(foot.cosine * s, foot.cosine * c, foot.sine),
                    south: Vec3::new(foot.sine * s, foot.sine * c, -foot.cosine),
                    spacing_m: radii / steps.abs(),
                }
            }
        }
    }
}

/// The normal of the surface that was met, in the world, and the height above the base in metres.
pub fn normal_of<T: Texel>(caster: &Caster<'_, T>, direction: Vec3, hit: &Hit) -> Vec4 {
    let (land, field, shift) = (caster.land, &caster.field, hit.shift as i32);
    let [_, _, base, unit_m] = land.bounds;
    let place = Vec2::from_array(hit.place);
    let height_m = (surface::height(field, caster.interpolation, shift, place) - base) * unit_m;
    let local = Local::at(land, place, height_m);
    let normal = match hit.surface {
        Surface::Sky | Surface::Base => local.up,
        Surface::Terrain => {
            let slope = surface::slope(field, caster.interpolation, shift, place);
            let slope = slope * ((-shift as f32).exp2() * unit_m) / local.spacing_m;
            local.up - slope.x * local.east - slope.y * local.south
        }
        Surface::WallWest => -local.east,
        Surface::WallEast => local.east,
        Surface::WallNorth => -local.south,
        Surface::WallSouth => local.south,
        Surface::Inside if land.form[3] != 0 => -direction,
        Surface::Inside => -(direction * Vec3::new(land.margin[2], land.margin[3], unit_m)).xzy(),
    };
    let axes = [&land.east, &land.up, &land.south].map(|axis| Vec3::from_slice(axis));
    let turned = normal.x * axes[0] + normal.y * axes[1] + normal.z * axes[2];
    let above_m = if matches!(hit.surface, Surface::Sky | Surface::Base) { 0.0 } else { height_m };
    turned.normalize().extend(above_m)
}

/// The colour of a pixel, 8-bit sRGB: Lambert's law under the sun and the sky, the ground's colour by height or from a draped
/// picture, haze by distance. `sunlit` is 0 in the shadow and 1 outside.
pub fn color_of(
    light: &LightBlock,
    drape: Option<&Drape>,
    (x, y): (u32, u32),
    hit: &Hit,
    facing: Vec4,
    sunlit: f32,
) -> [u8; 4] {
    let row = |v: &[f32; 4]| Vec3::from_slice(v);
    let direction = row(&light.corner) + x as f32 * row(&light.across) + y as f32 * row(&light.down);
    let normal = facing.truncate();
    let haze = row(&light.haze);
    let color = if hit.surface == Surface::Sky {
        haze.lerp(ZENITH, direction.normalize().y.clamp(0.0, 1.0).sqrt())
    } else {
        let [low, high, ..] = light.range;
        let share = (facing.w - low) / (high - low).max(1e-6);
        let [columns, rows, _, first] = light.drape;
        let albedo = match drape {
            Some(drape) if hit.surface == Surface::Terrain && hit.map == 0 => {
                drape.color((Vec2::from_array(hit.place) - Vec2::new(first, 0.0)) / Vec2::new(columns, rows))
            }
            _ => ground(hit.surface, normal, share),
        };
        let lit = sunlit * normal.dot(row(&light.sun)).max(0.0);
        let open = light.sun[3] * (0.5 + 0.5 * normal.y);
        let seen = albedo * (SUNLIGHT * lit + SKYLIGHT * open);
        haze.lerp(seen, (-light.haze[3] * hit.depth_m * direction.length()).exp())
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

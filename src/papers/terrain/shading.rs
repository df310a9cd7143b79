//! Normal and illumination of a pixel on the processor, as `shaders/terrain/normal.glsl` and `illumination.glsl` have them.

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4};

use super::blocks::{CYLINDER, LightBlock, PLANE, TerrainBlock};
use super::caster::Caster;
use super::drape::Drape;
use super::hit::{Hit, Surface};
use super::interpolation;
use super::pyramid::Texel;
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
    fn at(terrain: &TerrainBlock, place: Vec2, height_m: f32) -> Self {
        let (off_m, steps) = (terrain.axis_distance_m, terrain.nodes_per_unit);
        let (s, c) = ((place.x - terrain.middle_node.x) / steps.x).sin_cos();
        let east = Vec3::new(c, -s, 0.0);
        match terrain.base_kind {
            PLANE => Local { east: Vec3::X, up: Vec3::Y, south: Vec3::Z, spacing_m: terrain.spacing_m },
            CYLINDER => Local {
                east,
                up: Vec3::new(s, c, 0.0),
                south: Vec3::Z,
                spacing_m: Vec2::new((off_m + height_m) / steps.x, 1.0 / steps.y.abs()),
            },
            _ => {
                let foot = meridian(terrain, (place.y - terrain.middle_node.y) / steps.y);
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
    let (terrain, field, shift) = (caster.terrain, &caster.field, hit.shift as i32);
    let unit_m = terrain.height_unit_m;
    let place = Vec2::from_array(hit.place);
    let height_m = (interpolation::height(field, caster.interpolation, shift, place) - terrain.base_height) * unit_m;
    let local = Local::at(terrain, place, height_m);
    let normal = match hit.surface {
        Surface::Sky | Surface::Base => local.up,
        Surface::Terrain => {
            let slope = interpolation::slope(field, caster.interpolation, shift, place);
            let slope = slope * ((-shift as f32).exp2() * unit_m) / local.spacing_m;
            local.up - slope.x * local.east - slope.y * local.south
        }
        Surface::WallWest => -local.east,
        Surface::WallEast => local.east,
        Surface::WallNorth => -local.south,
        Surface::WallSouth => local.south,
        Surface::Inside if terrain.base_kind != PLANE => -direction,
        Surface::Inside => -(direction * terrain.spacing_m.extend(unit_m)).xzy(),
    };
    let turned = normal.x * terrain.east + normal.y * terrain.up + normal.z * terrain.south;
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
    let direction = light.corner_direction + x as f32 * light.right_step + y as f32 * light.down_step;
    let normal = facing.truncate();
    let haze = light.haze_color;
    let color = if hit.surface == Surface::Sky {
        haze.lerp(ZENITH, direction.normalize().y.clamp(0.0, 1.0).sqrt())
    } else {
        let share = (facing.w - light.lowest_m) / (light.highest_m - light.lowest_m).max(1e-6);
        let albedo = match drape {
            Some(drape) if hit.surface == Surface::Terrain && hit.map == 0 => drape
                .color((Vec2::from_array(hit.place) - Vec2::new(light.drape_first_column, 0.0)) / light.drape_cells),
            _ => ground(hit.surface, normal, share),
        };
        let lit = sunlit * normal.dot(light.to_sun).max(0.0);
        let open = light.sky_strength * (0.5 + 0.5 * normal.y);
        let seen = albedo * (SUNLIGHT * lit + SKYLIGHT * open);
        haze.lerp(seen, (-light.extinction_per_m * hit.depth_m * direction.length()).exp())
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

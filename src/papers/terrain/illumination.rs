//! The pass `illumination` (section 4) of one pixel: Lambert's law under the sun and the sky, the ground's colour by height or
//! from what is draped over it, haze by distance. The paper names the pass and no model of light.

use std::sync::Arc;

use ash::vk;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::blocks::LightBlock;
use super::drape::{Drape, Draping};
use super::geometric_transformation::SceneView;
use super::hit::{Hit, Surface};
use super::host::HostPass;
use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::stage::{Build, PixelPass};
use super::tints::{tinted, up_at};
use crate::gpu::bindings::Resource;
use crate::gpu::{Error, Frame, ImageView, Load, PassInfo};

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

/// The pass on the device. Its target is the picture.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn illumination(
    build: &Build<'_>,
    scene: &DeviceScene,
    [depth, normal, shadow]: [&Arc<ImageView>; 3],
) -> Result<PixelPass, Error> {
    let target = build.image("picture", vk::Format::R8G8B8A8_UNORM)?;
    let resources: [(_, Resource); 4] = [
        ("light", (&scene.light).into()),
        ("depth", depth.into()),
        ("normal", normal.into()),
        ("shadow", shadow.into()),
    ];
    let picture: [(_, Resource); 1] = [("drape", (&scene.drape).into())];
    let (program, others) = match scene.draping {
        None | Some(Draping::WholeMap | Draping::Placed { .. }) => ("illumination-picture", &picture[..]),
        Some(Draping::Contours { .. }) => ("illumination-contours", &[][..]),
        Some(Draping::Slope) => ("illumination-slope", &[][..]),
        Some(Draping::Hypsometric { .. }) => ("illumination-hypsometric", &[][..]),
    };
    let resources = [&resources[..], others].concat();
    let pass = build.pass(("illumination", "4"), program, (&target, Load::Discard), &resources)?;
    Ok(PixelPass { stage: build.stage, passes: vec![pass], target })
}

/// The pass on the processor.
pub struct HostIllumination {
    pass: HostPass<[u8; 4]>,
    drape: Option<Drape>,
}

impl HostIllumination {
    pub fn new(parameters: &Parameters, drape: Option<&Drape>) -> Self {
        let info = PassInfo::host("illumination", "4", &["light", "depth", "normal"], &["picture"]);
        HostIllumination { pass: HostPass::new(info, parameters, [0; 4]), drape: drape.cloned() }
    }

    /// The picture, 8-bit sRGB; `sunlit` is empty where no shadows are thrown.
    pub fn record(
        &mut self,
        frame: &mut Frame<'_>,
        view: &SceneView,
        (hits, normals, sunlit): (&[Hit], &[Vec4], &[f32]),
    ) -> &[[u8; 4]] {
        let HostIllumination { pass: HostPass { info, width, values }, drape } = self;
        let width = *width as usize;
        frame.host(info, || {
            values.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
                for (x, color) in row.iter_mut().enumerate() {
                    let index = y * width + x;
                    let sunlit = sunlit.get(index).copied().unwrap_or(1.0);
                    let pixel = (x as u32, y as u32);
                    *color = color_of(&view.light, drape.as_ref(), pixel, &hits[index], normals[index], sunlit);
                }
            });
        });
        values
    }
}

/// The colour of a pixel, 8-bit sRGB: Lambert's law under the sun and the sky, the ground's colour by height or from what is
/// draped over it, haze by distance. `sunlit` is 0 in the shadow and 1 outside.
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
        let height = (facing.w - light.lowest_m) / (light.highest_m - light.lowest_m).max(1e-6);
        let up = up_at(light, light.eye + hit.depth_m * direction, facing.w);
        let upright = normal.dot(up);
        let albedo = albedo_at(hit.surface, upright, height);
        let draped = drape.filter(|_| hit.surface == Surface::Terrain).and_then(|drape| match drape.draping() {
            Draping::WholeMap | Draping::Placed { .. } if hit.map > 0 => None,
            Draping::WholeMap | Draping::Placed { .. } => {
                drape.color(light.drape_fraction(Vec2::from_array(hit.place)))
            }
            draping => Some(tinted(light, draping, albedo, (direction, hit.depth_m), facing)),
        });
        let albedo = draped.unwrap_or(albedo);
        let lit = sunlit * normal.dot(light.to_sun).max(0.0);
        let open = light.sky_strength * (0.5 + 0.5 * upright);
        let seen = albedo * (SUNLIGHT * lit + SKYLIGHT * open);
        haze.lerp(seen, (-light.extinction_per_m * hit.depth_m * direction.length()).exp())
    };
    let [r, g, b] = color.to_array().map(encode);
    [r, g, b, 255]
}

/// Of the ground at a height of 0 to 1 from the lowest to the highest; `upright` is the cosine of its angle with the base.
fn albedo_at(surface: Surface, upright: f32, height: f32) -> Vec3 {
    let place = height.clamp(0.0, 1.0) * 5.0;
    let below = (place as usize).min(4);
    let tint = match surface {
        Surface::Base => BASE_TINT,
        _ => TINTS[below].lerp(TINTS[below + 1], place - below as f32),
    };
    // Nothing grows on a cliff.
    let flat = ((upright - 0.45) / 0.3).clamp(0.0, 1.0);
    ROCK.lerp(tint, flat * flat * (3.0 - 2.0 * flat))
}

fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

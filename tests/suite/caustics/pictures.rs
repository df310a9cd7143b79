//! The final picture: closed forms of its colours, and goldens.

use std::path::Path;

use fumarole::image::golden::{self, Tolerance};
use fumarole::image::srgb;
use fumarole::measure::Variant as _;
use fumarole::papers::caustics::{Parameters, Variant};
use fumarole::scene::{Camera, Light};
use glam::Vec3;

use super::drawing::Drawing;
use super::scene::{FLAT, OBLIQUE, OVERHEAD, floor, parameters, teapot};
use crate::common::gpu_test;

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

#[test]
fn the_pictures_are_the_golden_ones() {
    gpu_test(|device| {
        let below = parameters(OBLIQUE);
        let above = Parameters { camera: Parameters::camera_above(below.water_depth_m), ..below.clone() };
        let views = Variant::ALL.iter().map(|&variant| ("below", &below, variant));
        let through_water = [Variant::LevelMap, Variant::Volumetric].map(|variant| ("above", &above, variant));
        for (view, parameters, variant) in views.into_iter().chain(through_water) {
            let drawing = Drawing::of(device, variant, parameters, &[teapot(), floor()]);
            let file = format!("tests/golden/caustics-{view}-{}.png", variant.as_str());
            let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
            let output_dir = Path::new(env!("CARGO_TARGET_TMPDIR"));
            if let Err(error) = golden::check(&drawing.picture, &golden, TOLERANCE, output_dir) {
                panic!("{error}");
            }
        }
    });
}

/// A camera that looks straight down at the floor, which fills the picture.
fn down_from(height_m: f32) -> Camera {
    Camera { eye: Vec3::Y * height_m, target: Vec3::NEG_Y * 3.0, vertical_fov_rad: 0.1, ..parameters(OVERHEAD).camera }
}

fn assert_all_pixels(drawing: &Drawing, color: Vec3) {
    let expected = color.to_array().map(srgb::encode8);
    for pixel in drawing.picture.pixels().chunks_exact(4) {
        let off = (0..3).map(|i| pixel[i].abs_diff(expected[i])).max();
        assert!(off <= Some(1), "{pixel:?} instead of {expected:?}");
    }
}

/// Two overhead lights on a floor under flat and clear water: I_c is 1, so that the colour of eq. 4-20 is the albedo
/// times the sum of the lights and the ambient light, which counts once.
#[test]
fn the_cast_adds_the_lights_and_the_ambient_light_once() {
    gpu_test(|device| {
        let overhead = |intensity| Light::Parallel { direction: Vec3::NEG_Y, intensity };
        let (warm, cool, ambient) = (Vec3::new(0.4, 0.2, 0.1), Vec3::new(0.1, 0.2, 0.5), Vec3::new(0.05, 0.1, 0.2));
        for &variant in Variant::ALL {
            let parameters = Parameters {
                waves: FLAT,
                absorption_per_m: 0.0,
                lights: vec![overhead(warm), overhead(cool)],
                ambient,
                camera: down_from(-1.0),
                ..parameters(OVERHEAD)
            };
            let drawing = Drawing::of(device, variant, &parameters, &[floor()]);
            assert_all_pixels(&drawing, floor().albedo * (warm + cool + ambient));
        }
    });
}

/// Straight down through flat and clear water: Fresnel's reflectance is ((n - 1) / (n + 1))^2 everywhere, of the sky's
/// colour at the zenith.
#[test]
fn the_view_from_above_mixes_the_floor_with_the_mirrored_zenith() {
    gpu_test(|device| {
        let ambient = Vec3::splat(0.1);
        let parameters = Parameters {
            waves: FLAT,
            absorption_per_m: 0.0,
            lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::splat(0.5) }],
            ambient,
            camera: down_from(4.0),
            ..parameters(OVERHEAD)
        };
        let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[floor()]);
        let n = parameters.refraction_index;
        let reflectance = ((n - 1.0) / (n + 1.0)).powi(2);
        let zenith = Vec3::new(0.18, 0.36, 0.70);
        let seen = floor().albedo * (Vec3::splat(0.5) + ambient);
        assert_all_pixels(&drawing, seen.lerp(zenith, reflectance));
    });
}

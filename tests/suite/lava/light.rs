//! The lava's light on what lies beside it.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::lava::reference::{encoded, light};
use fumarole::papers::lava::{Lava, Parameters, Particles, Rock, Shading, SurfaceKind, Tone, Variant};
use fumarole::scene::{Camera, shapes};
use glam::{DVec3, Mat4, Vec3};

use super::fluid::{flowing, list};
use super::scene::{draw, shaders, texels};
use crate::common::gpu_test;

fn hot() -> Parameters {
    Parameters {
        is_blackbody: true,
        surface: SurfaceKind::Crossing,
        density: [40, 16, 24],
        radius_m: 0.15,
        border_m: 0.0,
        ..flowing()
    }
}

/// With a ball 0.3 m across, and particles as hot as that.
fn with_ball(device: &Arc<Device>, parameters: &Parameters, middle: Vec3, kelvin: f32) -> Lava {
    let sphere = shapes::sphere(48, 48);
    let scale = 0.3 / sphere.bounds().diagonal().max_element();
    let ball = sphere.transformed(&(Mat4::from_translation(middle) * Mat4::from_scale(Vec3::splat(scale))));
    let mut particles = Particles::of(parameters);
    particles.temperatures_k.fill(kelvin);
    Lava::new(&shaders(device), "test", Variant::GpuDriven, parameters, &particles, Rock::built_in(), &[ball]).unwrap()
}

/// A diffuse surface's light from a small one that shines, over what it would be in a sky as bright all over.
fn of_a_column(way: DVec3, [facing, normal]: [DVec3; 2], area: f64) -> f64 {
    let squared = way.length_squared();
    let seen = way.dot(normal).max(0.0) * (-way.dot(facing)).max(0.0) / squared;
    seen * area / (std::f64::consts::PI * squared)
}

/// At some places the lamps give as much light as all columns of the surface do that have lava.
#[test]
fn lamps_shine_as_the_surface_does() {
    gpu_test(|device| {
        let parameters = hot();
        let mut lava = with_ball(device, &parameters, Vec3::new(1.2, 0.7, 0.6), 1423.0);
        draw(device, &mut lava, 6);
        let floats: Vec<f32> = list(device, &lava.lava_light.as_ref().unwrap().lamps);
        let lamps: Vec<[f64; 12]> = floats.as_chunks::<12>().0.iter().map(|lamp| lamp.map(f64::from)).collect();
        assert_eq!(lamps[0][7] as usize, lamps.len());
        let surface: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
        let heat: Vec<[f32; 4]> = texels(device, &lava.surface_temperature.as_ref().unwrap().temperatures);
        let column_m = DVec3::new(2.0 / 40.0, 0.0, 1.2 / 24.0);
        // Red of the hottest is the brightest primary.
        let hottest = light(1423.0)[0];
        let spacing = parameters.flow.spacing_m(600);
        for (place, normal) in [
            (DVec3::new(0.4, 1.4, 0.4), DVec3::NEG_Y),
            (DVec3::new(1.5, 0.5, 0.5), DVec3::NEG_X),
            (DVec3::new(0.9, 0.9, 0.9), DVec3::new(-1.0, -1.0, -1.0).normalize()),
        ] {
            let mut expected = 0.0;
            for (at, (texel, heat)) in surface.iter().zip(&heat).enumerate() {
                let [x, y, z, height] = texel.map(f64::from);
                if height <= 0.25 * spacing {
                    continue;
                }
                let middle = DVec3::new((at % 40) as f64 + 0.5, 0.0, (at / 40) as f64 + 0.5) * column_m;
                let area = column_m.x * column_m.z / y.max(0.05);
                let glow = light(f64::from(heat[0]))[0] / hottest;
                let way = middle.with_y(height) - place;
                expected += glow * of_a_column(way, [DVec3::new(x, y, z), normal], area);
            }
            let of_lamp = |lamp: &[f64; 12]| {
                let way = DVec3::new(lamp[0], lamp[1], lamp[2]) - place;
                lamp[8] * of_a_column(way, [DVec3::new(lamp[4], lamp[5], lamp[6]), normal], lamp[3])
            };
            let found: f64 = lamps.iter().filter(|lamp| lamp[3] > 0.0).map(of_lamp).sum();
            println!("{place}: {found} {expected}");
            assert!(expected > 0.003 && (found / expected - 1.0).abs() < 0.3, "{place}: {found} {expected}");
        }
    });
}

/// Of more columns than a lamp looks at one by one, those at the far end count too.
#[test]
fn lamps_of_many_columns_stand_for_all_of_them() {
    gpu_test(|device| {
        let parameters = Parameters { density: [8320, 8, 8], ..hot() };
        let mut particles = Particles::of(&parameters);
        for place in &mut particles.positions {
            place.x += 1.4;
        }
        let rock = Rock::built_in();
        let mut lava =
            Lava::new(&shaders(device), "test", Variant::GpuDriven, &parameters, &particles, rock, &[]).unwrap();
        draw(device, &mut lava, 0);
        let floats: Vec<f32> = list(device, &lava.lava_light.as_ref().unwrap().lamps);
        let lamps = floats.as_chunks::<12>().0;
        assert_eq!(lamps.len(), 32);
        // What a lamp covers, seen from above.
        let found: f64 = lamps.iter().map(|lamp| f64::from(lamp[3]) * f64::from(lamp[5])).sum();
        let surface: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
        let least = 0.25 * parameters.flow.spacing_m(600);
        let covered = surface.iter().filter(|texel| f64::from(texel[3]) > least);
        let column = 2.0 / 8320.0 * 1.2 / 8.0;
        let expected: f64 = covered.map(|texel| column * f64::from(texel[1] / texel[1].max(0.05))).sum();
        println!("{found} {expected}");
        assert!(expected > 0.1 && (found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    });
}

/// A ball over hot lava is orange below and grey above; over lava that has gone cold it is grey all over.
#[test]
fn a_ball_over_lava_is_lit_from_below() {
    gpu_test(|device| {
        let redness = |melt_k: f32| {
            let parameters = Parameters {
                shading: Shading::Lava,
                camera: Camera {
                    eye: Vec3::new(0.4, 0.75, 2.2),
                    target: Vec3::new(0.4, 0.75, 0.4),
                    vertical_fov_rad: 0.3,
                    ..flowing().camera
                },
                ..hot()
            };
            let mut lava = with_ball(device, &parameters, Vec3::new(0.4, 0.75, 0.4), melt_k);
            draw(device, &mut lava, 0);
            let pixels: Vec<[u8; 4]> = texels(device, &lava.splatting.normalisation.picture);
            // The ball reaches from a quarter to three quarters of the middle column.
            let (width, height) = (parameters.width as usize, parameters.height as usize);
            let of = |row: usize| {
                let [red, _, blue, _] = pixels[row * width + width / 2];
                f64::from(red) / f64::from(blue.max(1))
            };
            let (upper, lower) = (of(height / 3), of(height * 7 / 10));
            println!("{melt_k} K: {upper} above, {lower} below");
            (upper, lower)
        };
        let (hot, cold) = (redness(1423.0), redness(700.0));
        assert!(hot.1 > 1.5 * hot.0 && hot.1 > 1.3 * cold.1, "{hot:?} {cold:?}");
    });
}

/// Twice the exposure is twice the light of ground and objects, as of the lava: they are exposed before they are encoded.
#[test]
fn exposure_is_of_light() {
    gpu_test(|device| {
        let of = |exposure: f32| {
            let parameters = Parameters { exposure, tone: Tone::Clip, ..hot() };
            let mut lava = with_ball(device, &parameters, Vec3::new(1.4, 0.7, 0.6), 1423.0);
            draw(device, &mut lava, 0);
            let sums: Vec<[f32; 4]> = texels(device, &lava.splatting.sums);
            (texels::<[u8; 4]>(device, &lava.splatting.normalisation.picture), sums)
        };
        let ((once, sums), (twice, _)) = (of(1.0), of(2.0));
        let mut compared = 0;
        for (at, (one, two)) in once.iter().zip(&twice).enumerate().filter(|&(at, _)| sums[at][3] == 0.0) {
            for axis in 0..3 {
                let [one, two] = [one, two].map(|pixel| f64::from(pixel[axis]));
                if one < 20.0 || two > 254.0 {
                    continue;
                }
                let decoded = |byte: f64| ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
                // To half a step of either byte.
                let [low, high] = [one - 0.6, one + 0.6].map(|byte| 255.0 * encoded(2.0 * decoded(byte)));
                assert!(two > low - 0.6 && two < high + 0.6, "{at}: {one} {two}");
                compared += 1;
            }
        }
        assert!(compared > 3000, "{compared}");
    });
}

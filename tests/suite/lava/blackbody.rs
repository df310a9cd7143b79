//! Black bodies' colours on the device, by splats and by rays.

use fumarole::papers::lava::reference::{encoded, light, toned};
use fumarole::papers::lava::{Parameters, Rock, Shading, SurfaceDraw, Tone};
use fumarole::scene::Camera;
use glam::Vec3;

use super::scene::{parameters, texels};
use super::splatting::{low_camera, ridge, stage};
use crate::common::gpu_test;

/// One height is one temperature: every lit pixel is its black body's, as the oracle integrates it.
#[test]
fn a_level_sheet_has_the_colour_of_its_temperature() {
    gpu_test(|device| {
        let cases = [
            ([1423.0, 1073.0], Shading::Color, 1.0, Tone::Shoulder, SurfaceDraw::Splats),
            ([1423.0, 1073.0], Shading::Color, 1.0, Tone::Shoulder, SurfaceDraw::March),
            ([1423.0, 1073.0], Shading::Lava, 4.0, Tone::Clip, SurfaceDraw::March),
            ([900.0, 2600.0], Shading::Color, 30.0, Tone::Shoulder, SurfaceDraw::March),
            ([10_000.0, 6000.0], Shading::Color, 0.5, Tone::Clip, SurfaceDraw::March),
            ([1.0, 1.0], Shading::Color, 1000.0, Tone::Shoulder, SurfaceDraw::March),
        ];
        let texel = [200, 100, 50];
        let rock = Rock { width: 2, height: 2, texels: vec![[texel[0], texel[1], texel[2], 255]; 4] };
        for (temperatures_k, shading, exposure, tone, draw) in cases {
            let parameters = Parameters {
                is_blackbody: true,
                temperatures_k: Some(temperatures_k),
                shading,
                exposure,
                tone,
                surface_draw: Some(draw),
                // From above: no wall is seen, which has the temperatures of all heights.
                camera: Camera { eye: Vec3::new(1.0, 3.0, 0.7), target: Vec3::new(1.0, 0.0, 0.6), ..low_camera() },
                splat_radius_m: 0.05,
                ..parameters()
            };
            let mut surface = ridge(&parameters);
            surface.heights.fill(0.25);
            let stage = stage(device, &parameters, &surface, &rock);
            let [floor, top] = temperatures_k.map(f64::from);
            let brightest = light(floor.max(top)).into_iter().fold(1e-30, f64::max);
            let mut expected = light(floor + 0.25 * (top - floor)).map(|value| (value / brightest).max(0.0));
            if shading == Shading::Lava {
                for (value, texel) in expected.iter_mut().zip(texel) {
                    let texel = f64::from(texel) / 255.0;
                    // The display's decoding, which the oracle's encoding undoes.
                    let decoded = ((texel + 0.055) / 1.055).powf(2.4);
                    assert!((encoded(decoded) - texel).abs() < 1e-12);
                    *value *= decoded;
                }
            }
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let picture: Vec<[u8; 4]> = texels(device, &stage.normalisation.picture);
            let mut drawn = 0;
            for (sums, pixel) in sums.iter().zip(&picture) {
                if sums[3] == 0.0 {
                    continue;
                }
                for axis in 0..3 {
                    let found = f64::from(sums[axis] / sums[3]);
                    // The matrix of the shader's table has seven digits, the table an entry every 2.4 K.
                    assert!((found - expected[axis]).abs() < 2e-3 * expected[0] + 1e-6, "{found} {expected:?}");
                    let shown = encoded(toned(found * f64::from(exposure), tone == Tone::Shoulder));
                    assert!((f64::from(pixel[axis]) - 255.0 * shown).abs() < 0.6, "{pixel:?} {shown}");
                }
                drawn += 1;
            }
            assert!(drawn > 2000, "{temperatures_k:?}: {drawn}");
        }
    });
}

/// From 1,000 to 10,000 K nothing that is exposed as it comes clips with the shoulder.
#[test]
fn nothing_clips_by_default() {
    gpu_test(|device| {
        for kelvin in [1000.0, 1423.0, 3000.0, 6504.0, 10_000.0] {
            let parameters = Parameters {
                is_blackbody: true,
                temperatures_k: Some([kelvin, 0.8 * kelvin]),
                surface_draw: Some(SurfaceDraw::March),
                shading: Shading::Color,
                camera: low_camera(),
                ..parameters()
            };
            let stage = stage(device, &parameters, &ridge(&parameters), Rock::built_in());
            let picture: Vec<[u8; 4]> = texels(device, &stage.normalisation.picture);
            let brightest = picture.iter().flat_map(|p| p[..3].to_vec()).max().unwrap();
            assert!((200..255).contains(&brightest), "{kelvin} K: {brightest}");
        }
    });
}

//! Stage three against the oracle, pixel by pixel.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::transfer::upload_rows;
use fumarole::gpu::{Device, Image, ImageDesc, ImageView, Mode, Recorder};
use fumarole::papers::lava::reference::{Splats, Surface, toned};
use fumarole::papers::lava::{
    Parameters, Rock, Shading, Sheet, SplatShape, Splatting, SurfaceDraw, Tone, Variant, depth_range_m,
};
use fumarole::scene::Camera;
use glam::{DVec3, Vec3};

use super::scene::{parameters, shaders, texels};
use crate::common::gpu_test;

/// A ridge in front of a plateau, seen from low down: it hides a part of the plateau and crosses its outline.
pub(super) fn ridge(parameters: &Parameters) -> Surface {
    let (columns, rows) = (24, 20);
    let space = parameters.space_m.as_dvec3();
    let (mut heights, mut normals) = (Vec::new(), Vec::new());
    for k in 0..rows {
        for i in 0..columns {
            let (x, z) = (f64::from(i) / f64::from(columns), f64::from(k) / f64::from(rows));
            let ridge = 0.8 * (-((z - 0.75) / 0.08).powi(2)).exp() * (0.4 + 0.6 * x);
            heights.push(ridge + 0.45 * (1.0 - z).powi(2));
            normals.push(DVec3::new(-0.2 * x, 1.0, if z > 0.75 { 0.8 } else { -0.6 * z }).normalize());
        }
    }
    // As the texture holds them.
    let heights = heights.into_iter().map(|h| f64::from(h as f32)).collect();
    let normals = normals.into_iter().map(|n: DVec3| n.as_vec3().as_dvec3()).collect();
    Surface { space, columns: columns as usize, rows: rows as usize, heights, normals }
}

/// The surface as a texture of normals and heights.
fn texture(device: &Arc<Device>, surface: &Surface) -> Arc<ImageView> {
    let (width, height) = (surface.columns as u32, surface.rows as u32);
    let desc = ImageDesc::new_2d("surface", vk::Format::R32G32B32A32_SFLOAT, width, height);
    let view = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED)).unwrap().view().unwrap();
    let texels = surface.normals.iter().zip(&surface.heights).map(|(n, h)| n.extend(*h).as_vec4().to_array());
    let texels: Vec<[f32; 4]> = texels.collect();
    let bytes: &[u8] = bytemuck::cast_slice(&texels);
    upload_rows(device, &view, (width, height), |first_row, rows| {
        let at = first_row as usize * 16 * surface.columns;
        rows.copy_from_slice(&bytes[at..at + rows.len()]);
    })
    .unwrap();
    view
}

/// It, of free particles.
fn sheet(normal_height: &Arc<ImageView>) -> Sheet<'_> {
    Sheet { normal_height, fluid: None }
}

pub(super) fn low_camera() -> Camera {
    Camera {
        eye: Vec3::new(1.1, 1.0, 2.8),
        target: Vec3::new(1.0, 0.35, 0.5),
        vertical_fov_rad: 0.7,
        ..Parameters::default().camera
    }
}

pub(super) fn stage(device: &Arc<Device>, parameters: &Parameters, surface: &Surface, rock: &Rock) -> Splatting {
    parameters.validate().unwrap();
    let texture = texture(device, surface);
    let instanced = !parameters.geometry_stage;
    let draw = parameters.surface_draw(Variant::Paper);
    let splatting =
        Splatting::new(&shaders(device), "test", parameters, sheet(&texture), rock, instanced, draw).unwrap();
    let mut recorder = Recorder::new(device).unwrap();
    recorder.run(Mode::Plain, |frame| splatting.record(frame, 0.0)).unwrap();
    splatting
}

/// Two sheets, one behind the other: what lies less than epsilon behind the nearest is blended, nothing else.
#[test]
fn the_front_blends_and_the_back_does_not() {
    gpu_test(|device| {
        for (epsilon_m, geometry_stage) in [(0.05, true), (0.05, false), (0.4, true)] {
            let parameters = Parameters {
                shading: Shading::Heights,
                camera: low_camera(),
                epsilon_m,
                geometry_stage,
                splats: [50, 40],
                width: 320,
                height: 240,
                ..parameters()
            };
            let surface = ridge(&parameters);
            let stage = stage(device, &parameters, &surface, Rock::built_in());
            let size = [parameters.width, parameters.height];
            let radius = f64::from(parameters.splat_radius_m);
            let camera = &parameters.camera;
            let splats = Splats::new(&surface, parameters.splats, radius, f64::from(epsilon_m), camera, size);
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let depths: Vec<f32> = texels(device, &stage.depth);
            let range_m = f64::from(depth_range_m(&parameters));
            let (mut drawn, mut hiding, mut close_calls, mut off) = (0, 0, 0, 0);
            // Every eleventh: the oracle asks every splat.
            for (at, (found, depth)) in sums.iter().zip(&depths).enumerate().step_by(11) {
                let (column, row) = (at as u32 % size[0], at as u32 / size[0]);
                let height_fraction = |center: DVec3| center.y / surface.space.y;
                let Some(pixel) = splats.pixel(column, row, height_fraction) else {
                    // A rim just outside the pixel's centre may be drawn all the same, with the least weight.
                    assert!(found[3] <= 0.012, "{column} {row}: {found:?}");
                    continue;
                };
                if pixel.is_close_call {
                    close_calls += 1;
                    continue;
                }
                drawn += 1;
                hiding += u32::from(pixel.hidden > 0);
                let depth_off_m = (f64::from(*depth) * range_m - pixel.depth - f64::from(epsilon_m)).abs();
                let apart = (f64::from(found[0]) - pixel.sums[0]).abs() + (f64::from(found[3]) - pixel.sums[1]).abs();
                let relative = apart / pixel.sums[1].max(0.1);
                // Devices interpolate coarsely across splats that they see from the side.
                assert!(relative < 0.02 && depth_off_m < 1e-3, "{column} {row}: {found:?} {depth} {pixel:?}");
                off += u32::from(relative > 1e-3 || depth_off_m > 1e-4);
            }
            assert!(off * 50 < drawn, "{off} of {drawn} pixels are off by more than rounding");
            println!("epsilon {epsilon_m}: {drawn} pixels, {hiding} with hidden splats, {close_calls} left out");
            assert!(drawn > 1000 && hiding > 100 && close_calls * 3 < drawn, "{drawn} {hiding} {close_calls}");
        }
    });
}

/// Eq. 7.2 is a weighted mean: of one colour it is that colour, wherever anything was drawn; the display's tone follows.
#[test]
fn a_constant_colour_comes_out_constant() {
    gpu_test(|device| {
        let rock = Rock { width: 2, height: 2, texels: vec![[200, 100, 50, 255]; 4] };
        for (shading, space_y, exposure, tone) in [
            // The rock alone is shown as it is.
            (Shading::Rock, 1.0, 0.3, Tone::Shoulder),
            (Shading::Color, 1.0, 1.0, Tone::Clip),
            (Shading::Color, 1.0, 0.7, Tone::Shoulder),
            (Shading::Lava, 0.5, 2.0, Tone::Shoulder),
            (Shading::Lava, 2.0, 1.0, Tone::Clip),
        ] {
            let parameters = Parameters {
                shading,
                exposure,
                tone,
                camera: low_camera(),
                space_m: Vec3::new(2.0, space_y, 1.2),
                splat_radius_m: 0.03,
                ..parameters()
            };
            let mut surface = ridge(&parameters);
            if shading != Shading::Rock {
                // The colour depends on the height, as a part of the space's.
                surface.heights.fill(0.25);
            }
            let stage = stage(device, &parameters, &surface, &rock);
            let texel = Vec3::new(200.0, 100.0, 50.0) / 255.0;
            let color = parameters.color * (1.0 - 0.25 / space_y);
            let expected = match shading {
                Shading::Rock => texel,
                Shading::Color => color,
                _ => color * texel,
            };
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let picture: Vec<[u8; 4]> = texels(device, &stage.normalisation.picture);
            let mut drawn = 0;
            for (sums, pixel) in sums.iter().zip(&picture) {
                if sums[3] == 0.0 {
                    assert_eq!(*pixel, [0, 0, 0, 255]);
                    continue;
                }
                drawn += 1;
                let found = Vec3::from_slice(sums) / sums[3];
                assert!((found / expected - 1.0).abs().max_element() < 1e-5, "{found} {expected}");
                let shown = |value: f32| match shading {
                    Shading::Rock => f64::from(value),
                    _ => toned(f64::from(value * exposure), tone == Tone::Shoulder),
                };
                let bytes = (255.0 * DVec3::from_array(expected.to_array().map(shown))).as_vec3();
                let off = (Vec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into()) - bytes).abs();
                assert!(off.max_element() < 0.51, "{pixel:?} {bytes}");
            }
            assert!(drawn > 2000, "{drawn}");
        }
    });
}

/// The rock repeats without a seam and drifts with the lava.
#[test]
fn the_rock_is_read_at_the_splats_centre_and_drifts() {
    gpu_test(|device| {
        let parameters = Parameters {
            shading: Shading::Rock,
            splats: [1, 1],
            splat_radius_m: 0.4,
            rock_tile_m: 0.7,
            ..parameters()
        };
        let rock = Rock {
            width: 3,
            height: 2,
            texels: [
                [10, 40, 0, 255],
                [90, 0, 0, 255],
                [250, 0, 0, 255],
                [30, 200, 0, 255],
                [50, 0, 0, 255],
                [70, 9, 0, 255],
            ]
            .to_vec(),
        };
        let mut surface = ridge(&parameters);
        surface.heights.fill(0.0);
        let texture = texture(device, &surface);
        let stage =
            Splatting::new(&shaders(device), "test", &parameters, sheet(&texture), &rock, false, SurfaceDraw::Splats)
                .unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        // The one splat's centre is the middle of the space.
        for drift_m in [0.0, 0.1, 0.29, 0.5] {
            recorder.run(Mode::Plain, |frame| stage.record(frame, drift_m)).unwrap();
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let drawn = sums.iter().find(|s| s[3] > 0.1).unwrap();
            let at = |place: f64, count: f64| (place / 0.7).rem_euclid(1.0) * count - 0.5;
            let (u, v) = (at(1.0 - f64::from(drift_m), 3.0), at(0.6, 2.0));
            let texel = |i: f64, k: f64| {
                let index = k.rem_euclid(2.0) as usize * 3 + i.rem_euclid(3.0) as usize;
                let [r, g, ..] = rock.texels[index];
                [f64::from(r) / 255.0, f64::from(g) / 255.0]
            };
            let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
            for channel in [0, 1] {
                let row = |k: f64| mix(texel(u.floor(), k)[channel], texel(u.floor() + 1.0, k)[channel], u - u.floor());
                let expected = mix(row(v.floor()), row(v.floor() + 1.0), v - v.floor());
                let found = f64::from(drawn[channel] / drawn[3]);
                // Filters may have as few as eight bits of fraction.
                assert!((found - expected).abs() < 0.01, "drift {drift_m}: {found} {expected}");
            }
        }
    });
}

/// A hill as steep as 60 degrees, with its own normals.
fn hill(parameters: &Parameters) -> Surface {
    let (columns, rows) = (100usize, 60usize);
    let space = parameters.space_m.as_dvec3();
    let (mut heights, mut normals) = (Vec::new(), Vec::new());
    for k in 0..rows {
        for i in 0..columns {
            let x = (i as f64 + 0.5) / columns as f64 * space.x - 1.0;
            let z = (k as f64 + 0.5) / rows as f64 * space.z - 0.6;
            // 0.6 exp(-(x^2 + z^2) / 0.09).
            let height = 0.6 * (-(x * x + z * z) / 0.09).exp();
            heights.push(f64::from(height as f32));
            let slopes = DVec3::new(2.0 * x / 0.09 * height, 1.0, 2.0 * z / 0.09 * height);
            normals.push(slopes.normalize().as_vec3().as_dvec3());
        }
    }
    Surface { space, columns, rows, heights, normals }
}

/// Pixels at which a ray meets the sheet well inside its outline and a picture of splats shows what lies farther, or nothing: metres from
/// the eye, row by row, 200 a row.
fn gaps(rays: &[f64], splats: &[f64]) -> usize {
    let rows = rays.len() as i64 / 200;
    let is_inside = |at: usize| {
        let (x, y) = (at as i64 % 200, at as i64 / 200);
        let mut around = (-2..=2).flat_map(|down| (-2..=2).map(move |across| (x + across, y + down)));
        around.all(|(x, y)| {
            (0..200).contains(&x) && (0..rows).contains(&y) && (rays[(y * 200 + x) as usize] - rays[at]).abs() < 0.15
        })
    };
    (0..rays.len()).filter(|&at| splats[at] > rays[at] + 0.08 && is_inside(at)).count()
}

/// From 40 cameras outside, all around and from low down to far above.
#[test]
fn fitted_splats_leave_no_gap_from_any_side() {
    gpu_test(|device| {
        let mut of = [
            (SplatShape::Disc, SurfaceDraw::March),
            (SplatShape::Fitted, SurfaceDraw::Splats),
            (SplatShape::Disc, SurfaceDraw::Splats),
        ]
        .map(|(shape, draw)| {
            let parameters = Parameters {
                shading: Shading::Heights,
                splat_shape: shape,
                surface_draw: Some(draw),
                // A radius of 0.8 distances: the least that covers a plain is 0.71.
                splats: [50, 30],
                splat_radius_m: 0.032,
                width: 200,
                height: 150,
                camera: low_camera(),
                ..parameters()
            };
            (stage(device, &parameters, &hill(&parameters), Rock::built_in()), parameters)
        });
        let mut recorder = Recorder::new(device).unwrap();
        let (mut seen, mut of_fitted, mut of_discs) = (0, 0, 0);
        for turn in 0..8 {
            for up in [0.5f32, 0.9, 1.6, 2.8, 4.5] {
                let (sine, cosine) = (f64::from(turn) * std::f64::consts::TAU / 8.0).sin_cos();
                let eye = Vec3::new(1.0 + 2.4 * cosine as f32, up, 0.6 + 2.4 * sine as f32);
                let camera = Camera { eye, target: Vec3::new(1.0, 0.3, 0.6), ..low_camera() };
                let [rays, fitted, discs] = of.each_mut().map(|(stage, parameters)| {
                    parameters.camera = camera;
                    stage.set_drawn(parameters, Rock::built_in()).unwrap();
                    recorder.run(Mode::Plain, |frame| stage.record(frame, 0.0)).unwrap();
                    let range_m = f64::from(depth_range_m(parameters));
                    let depths: Vec<f32> = texels(device, &stage.depth);
                    depths.iter().map(|depth| range_m * f64::from(*depth)).collect::<Vec<f64>>()
                });
                let none_m = 0.9999 * f64::from(depth_range_m(&of[0].1));
                seen += rays.iter().filter(|&&ray| ray < none_m).count();
                of_fitted += gaps(&rays, &fitted);
                of_discs += gaps(&rays, &discs);
            }
        }
        println!("gaps of {seen} pixels: {of_fitted}, of discs {of_discs}");
        assert!(seen > 100_000 && of_fitted == 0 && of_discs > 40, "{seen} {of_fitted} {of_discs}");
    });
}

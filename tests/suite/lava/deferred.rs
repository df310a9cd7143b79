//! Deferred shading of splats: accumulated normals and depths against the oracle, and the pixels that follow from them.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Paper;
use fumarole::papers::lava::reference::Splats;
use fumarole::papers::lava::{Lava, Parameters, Particles, Rock, Shading, SplatShading, Variant};
use glam::DVec3;

use super::march::direction;
use super::pictures::reduced;
use super::scene::{draw, lava, parameters, texels};
use super::splatting::{low_camera, ridge, stage};
use crate::common::{gpu_test, shaders_by};

fn deferred() -> Parameters {
    Parameters { splat_shading: SplatShading::Deferred, camera: low_camera(), width: 320, height: 240, ..parameters() }
}

/// Normals and depths of the splats within epsilon of the nearest, each times its Gaussian.
#[test]
fn normals_and_depths_of_splats_are_accumulated() {
    gpu_test(|device| {
        for geometry_stage in [true, false] {
            let parameters = Parameters { geometry_stage, splats: [50, 40], ..deferred() };
            let surface = ridge(&parameters);
            let stage = stage(device, &parameters, &surface, Rock::built_in());
            let blended = stage.deferred().unwrap();
            let normals: Vec<[f32; 4]> = texels(device, &blended.normals);
            let depths: Vec<[f32; 4]> = texels(device, &blended.depths);
            let size = [parameters.width, parameters.height];
            let radius = f64::from(parameters.splat_radius_m);
            let epsilon = f64::from(parameters.epsilon_m);
            let splats = Splats::new(&surface, parameters.splats, radius, epsilon, &parameters.camera, size);
            let (mut drawn, mut hiding, mut close_calls, mut off) = (0, 0, 0, 0);
            for (at, (found, depth)) in normals.iter().zip(&depths).enumerate().step_by(29) {
                let (column, row) = (at as u32 % size[0], at as u32 / size[0]);
                let along =
                    |axis: usize| splats.pixel(column, row, |center| surface.at(center.x, center.z).1.to_array()[axis]);
                let (Some(x), Some(y), Some(z)) = (along(0), along(1), along(2)) else {
                    // A rim just outside the pixel's centre may be drawn all the same, with the least weight.
                    assert!(found[3] <= 0.012, "{column} {row}: {found:?}");
                    continue;
                };
                if x.is_close_call {
                    close_calls += 1;
                    continue;
                }
                drawn += 1;
                hiding += u32::from(x.hidden > 0);
                let expected = [x.sums[0], y.sums[0], z.sums[0], x.sums[1]];
                let apart: f64 = found.iter().zip(expected).map(|(f, e)| (f64::from(*f) - e).abs()).sum();
                // The depths are about 3 m.
                let apart = (apart + (f64::from(depth[0]) - x.depths).abs() / 3.0) / x.sums[1].max(0.1);
                // Devices interpolate coarsely across splats that they see from the side.
                assert!(apart < 0.03, "{column} {row}: {found:?} {depth:?} {expected:?} {}", x.depths);
                off += u32::from(apart > 2e-3);
            }
            println!("{drawn} pixels, {hiding} with hidden splats, {off} off, {close_calls} left out");
            assert!(
                drawn > 300 && hiding > 25 && close_calls * 3 < drawn && off * 50 < drawn,
                "{drawn} {hiding} {off}"
            );
        }
    });
}

/// A rock that grows linearly along both sides.
fn ramp() -> Rock {
    let texels = (0..64u8).flat_map(|row| (0..64u8).map(move |column| [4 * column, 4 * row, 0, 255])).collect();
    Rock { width: 64, height: 64, texels }
}

/// Height, normal and rock are those of the place that the ray of the pixel reaches at its accumulated depth.
#[test]
fn a_pixel_is_shaded_at_its_own_place() {
    gpu_test(|device| {
        for shading in [Shading::Heights, Shading::Normals, Shading::Rock] {
            // The rock does not repeat within the space.
            let parameters = Parameters { shading, rock_tile_m: 4.0, ..deferred() };
            let stage = stage(device, &parameters, &ridge(&parameters), &ramp());
            let blended = stage.deferred().unwrap();
            let normals: Vec<[f32; 4]> = texels(device, &blended.normals);
            let depths: Vec<[f32; 4]> = texels(device, &blended.depths);
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let mut drawn = 0;
            for (at, (sum, found)) in normals.iter().zip(&sums).enumerate() {
                if sum[3] == 0.0 {
                    assert_eq!(*found, [0.0; 4], "pixel {at}");
                    continue;
                }
                let normal = DVec3::new(sum[0].into(), sum[1].into(), sum[2].into()).normalize();
                let depth = f64::from(depths[at][0]) / f64::from(sum[3]);
                let place = parameters.camera.eye.as_dvec3() + direction(&parameters, at) * depth;
                // Four of 255 a texel, from the middle of the first on.
                let rock = |along: f64| 4.0 * (along / 4.0 * 64.0 - 0.5) / 255.0;
                let expected = match shading {
                    Shading::Heights => DVec3::splat(place.y / f64::from(parameters.space_m.y)),
                    Shading::Normals => 0.5 + 0.5 * normal,
                    _ => DVec3::new(rock(place.x), rock(place.z), 0.0),
                };
                // A pixel at the edge of the rock reaches over it.
                if shading == Shading::Rock && place.x.min(place.z) < 0.15 {
                    continue;
                }
                drawn += 1;
                let off = DVec3::new(found[0].into(), found[1].into(), found[2].into()).distance(expected);
                assert!(found[3] == 1.0 && off < 0.01, "{shading:?}, pixel {at}: {found:?} {expected}");
            }
            assert!(drawn > 5000, "{drawn}");
        }
    });
}

/// Differences of neighbours in a picture's rows, in all.
fn differences(device: &Arc<Device>, parameters: &Parameters) -> f64 {
    let mut lava = lava(device, parameters);
    draw(device, &mut lava, 0);
    let pixels: Vec<[u8; 4]> = texels(device, lava.picture());
    let rows = pixels.chunks_exact(parameters.width as usize);
    rows.flat_map(|row| row.windows(2)).map(|pair| f64::from(pair[0][0].abs_diff(pair[1][0]))).sum()
}

/// Chapter 9's wish: blending the splats' colours blurs the rock, shading each pixel does not.
#[test]
fn the_rock_is_not_blurred() {
    gpu_test(|device| {
        let of =
            |splat_shading| differences(device, &Parameters { splat_shading, shading: Shading::Rock, ..reduced() });
        let (blurred, sharp) = (of(SplatShading::Gouraud), of(SplatShading::Deferred));
        println!("differences of neighbours: {blurred} blended, {sharp} deferred");
        assert!(sharp > 1.3 * blurred, "{blurred} {sharp}");
    });
}

#[test]
fn both_compilers_shade_alike() {
    gpu_test(|device| {
        let pictures = [Compiler::Glslang, Compiler::Naga].map(|compiler| {
            let parameters =
                Parameters { geometry_stage: false, splat_shading: SplatShading::Deferred, ..parameters() };
            let shaders = shaders_by(device, compiler);
            let particles = Particles::seeded(&parameters);
            let mut lava =
                Lava::new(&shaders, "test", Variant::Paper, &parameters, &particles, Rock::built_in(), &[]).unwrap();
            let sample = draw(device, &mut lava, 1);
            let names: Vec<_> = sample.passes.iter().map(|pass| pass.info.name).collect();
            assert_eq!(names[names.len() - 4..], ["visibility", "blending", "deferred", "normalisation"]);
            texels::<u8>(device, lava.picture())
        });
        let off = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(off <= 8, "{off} values differ");
    });
}

//! Closed forms and conservation laws that the maps must meet, whatever the oracle says.

use std::slice::from_ref;

use fumarole::papers::caustics::reference::{flat_water_intensity, flux_in_map, flux_reaching_box};
use fumarole::papers::caustics::water::waves;
use fumarole::papers::caustics::{Parameters, Variant, WaveParameters};
use fumarole::scene::Light;
use glam::DVec3;

use super::drawing::Drawing;
use super::oracle::Oracle;
use super::scene::{FLAT, OBLIQUE, OVERHEAD, bowl, floor, parameters, sphere, teapot, tilted_plane};
use crate::common::gpu_test;

/// Single precision places a point of the water to 1e-7 m, and a texel is 1/64 m: each of two derivatives is good to
/// about 1e-5.
const ROUNDING: f64 = 3e-5;

fn calm(light: Light, absorption_per_m: f32) -> Parameters {
    Parameters { waves: FLAT, absorption_per_m, ..parameters(light) }
}

/// Under flat and clear water I_c is one number wherever there is a receiver: a texel that two planes accept would have
/// it twice, one that no plane accepts would be dark.
#[test]
fn flat_clear_water_lights_every_texel_alike_and_once() {
    gpu_test(|device| {
        for (light, planes) in [OVERHEAD, OBLIQUE].into_iter().flat_map(|l| [1, 2, 9, 101].map(|planes| (l, planes))) {
            for receiver in [floor(), tilted_plane(), bowl(), sphere(), teapot()] {
                let parameters = Parameters { planes, ..calm(light, 0.0) };
                let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
                let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
                let direction = oracle.light.direction_at(DVec3::ZERO);
                let everywhere = flat_water_intensity(direction, oracle.medium, 0.0).unwrap();
                let heights = drawing.target("position-map");
                for (texel, &found) in drawing.target("caustics-map").iter().enumerate() {
                    let expected = if heights[texel] < -1e29 { 0.0 } else { everywhere };
                    let case = &receiver.mesh.name;
                    assert!(
                        (f64::from(found) - expected).abs() < ROUNDING,
                        "{case}, texel {texel}: {found} {expected}"
                    );
                }
            }
        }
    });
}

/// The lowest plane is the one that the water's footprint leaves first.
#[test]
fn the_water_covers_every_texel_of_the_lowest_plane() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE] {
            let parameters = calm(light, 0.0);
            let drawing = Drawing::of(device, Variant::Volumetric, &parameters, &[sphere()]);
            let oracle = Oracle::of(&parameters, &light, &sphere(), &drawing.grid);
            let expected = flat_water_intensity(oracle.light.direction_at(DVec3::ZERO), oracle.medium, 0.0).unwrap();
            let lowest_plane = drawing.target("caustics-map");
            assert!(lowest_plane.iter().all(|&found| (f64::from(found) - expected).abs() < ROUNDING));
        }
    });
}

#[test]
fn flat_murky_water_absorbs_along_the_refracted_ray() {
    gpu_test(|device| {
        for (light, absorption) in [OVERHEAD, OBLIQUE].into_iter().flat_map(|l| [0.1, 0.5].map(|k| (l, k))) {
            let parameters = Parameters { planes: 61, ..calm(light, absorption) };
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[floor()]);
            let oracle = Oracle::of(&parameters, &light, &floor(), &drawing.grid);
            let v = oracle.receiver.v;
            let distance_m = f64::from(parameters.water_depth_m) / v.y;
            let expected =
                flat_water_intensity(oracle.light.direction_at(DVec3::ZERO), oracle.medium, distance_m).unwrap();
            // Overhead the floor lies at the centre of its cell, and d is one number. Otherwise the plane lies up to
            // half a cell from it, and within a triangle, where the exponential is interpolated, d varies.
            let (half_cell_m, variation_m) = if light == OVERHEAD {
                (0.0, 0.0)
            } else {
                let half_cell_m = oracle.receiver.height / f64::from(2 * parameters.planes);
                (half_cell_m, drawing.grid.cell.length() * (1.0 - v.y * v.y).sqrt())
            };
            let k = f64::from(absorption);
            let tolerance = (k * half_cell_m).exp_m1() + (k * variation_m).powi(2) / 8.0 + ROUNDING;
            let heights = drawing.target("position-map");
            let lit = drawing.target("caustics-map").iter().zip(heights).filter(|&(_, &height)| height > -1e29);
            for (&found, _) in lit {
                let off = (f64::from(found) / expected - 1.0).abs();
                assert!(off < tolerance, "{found} instead of {expected}, more than {tolerance} off");
            }
        }
    });
}

#[test]
fn before_the_focus_the_map_holds_the_flux_through_the_water() {
    gpu_test(|device| {
        for seed in 1..=4 {
            let gentle = WaveParameters { count: 6, amplitude_m: 0.038, wavelength_m: 3.0 };
            let parameters = Parameters { waves: gentle, seed, ..calm(OVERHEAD, 0.0) };
            assert!(parameters.steepest_slope() <= 0.2);
            // A crest of curvature A k^2 focuses n / ((n - 1) A k^2) below it.
            let n = f64::from(parameters.refraction_index);
            let curvature: f64 = waves(&parameters).iter().map(|w| w.amplitude_m * w.vector.length_squared()).sum();
            let deepest_m = f64::from(parameters.water_depth_m + gentle.amplitude_m);
            assert!(n / ((n - 1.0) * curvature) > deepest_m);

            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[floor()]);
            let oracle = Oracle::of(&parameters, &OVERHEAD, &floor(), &drawing.grid);
            let intensity: Vec<f64> = drawing.target("caustics-map").iter().copied().map(f64::from).collect();
            let cos_refracted = oracle.caustics_map().cos_refracted;
            let recorded_m2 = flux_in_map(&intensity, &cos_refracted, &oracle.receiver);
            let reaching_m2 = flux_reaching_box(&oracle.volumes, &oracle.receiver, 0.0);
            let off = recorded_m2 / reaching_m2 - 1.0;
            println!("seed {seed}: {recorded_m2:.5} of {reaching_m2:.5} m2, {:+.3} %", 100.0 * off);
            assert!(off.abs() < 0.01);
            assert!(intensity.iter().any(|&i| i > 1.1) && intensity.iter().any(|&i| i < 0.9), "the water is flat");
        }
    });
}

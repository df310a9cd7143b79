//! Water in the shape of a height map: its surface and light against the oracle, its picture against that of the waves
//! it is sampled from, and a lens whose focus is known.

use std::slice::from_ref;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::image::compare;
use fumarole::measure::Variant as _;
use fumarole::papers::caustics::reference::{spherical_cap_focus, spherical_cap_vertex};
use fumarole::papers::caustics::water::{LEVEL_M, waves};
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant, WaterMap, WaveParameters};
use fumarole::scene::{Camera, HeightMap, Light, Samples, shapes};
use glam::{DVec2, DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::{Drawing, FRAME};
use super::level_map::assert_meets;
use super::oracle::Oracle;
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, bowl, floor, parameters, sphere, teapot};
use crate::common::gpu_test;

/// Samples of `height` over `size` nodes around a middle, `spacing_m` apart.
fn map(size: UVec2, spacing_m: DVec2, height: impl Fn(DVec2) -> f64) -> WaterMap {
    let last = DVec2::new(f64::from(size.x - 1), f64::from(size.y - 1));
    let samples = (0..size.y).flat_map(|row| (0..size.x).map(move |column| (column, row)));
    let heights = samples
        .map(|(column, row)| (DVec2::new(f64::from(column), f64::from(row)) - last / 2.0) * spacing_m)
        .map(|place| height(place) as f32)
        .collect();
    let map = HeightMap::new(size.x, size.y, Samples::Float(heights)).unwrap();
    WaterMap::new("test", Arc::new(map.with_spacing_m(spacing_m).unwrap()))
}

/// Unlike along its two sides, smaller than the water's mesh, and of an even and an odd number of samples.
fn uneven() -> WaterMap {
    map(UVec2::new(40, 27), DVec2::new(0.06, 0.08), |p| {
        0.02 * (4.0 * p.x + 1.0).sin() * (3.0 * p.y).cos() + 0.01 * (7.0 * p.y - 2.0 * p.x).sin() + 0.005 * p.x
    })
}

fn under(water_map: WaterMap, parameters: Parameters) -> Parameters {
    Parameters { water_map: Some(water_map), ..parameters }
}

#[test]
fn the_water_is_the_surface_through_the_samples() {
    gpu_test(|device| {
        for compiler in [Compiler::Glslang, Compiler::Naga] {
            let parameters = under(uneven(), parameters(OVERHEAD));
            let drawing = Drawing::compiled_by(compiler, device, Variant::LevelMap, &parameters, &[sphere()]);
            let oracle = Oracle::of(&parameters, &OVERHEAD, &sphere(), &drawing.grid);
            let extent_m = parameters.water_map.as_ref().unwrap().extent_m();
            assert!(extent_m.cmplt(drawing.grid.extent_m()).all(), "the mesh does not reach beyond the map");
            let (mut lowest_m, mut highest_m) = (f64::INFINITY, f64::NEG_INFINITY);
            for (vertex, expected) in drawing.target("water").chunks_exact(8).zip(&oracle.water) {
                let (position, normal) =
                    (Vec3::from_slice(vertex).as_dvec3(), Vec3::from_slice(&vertex[4..]).as_dvec3());
                assert!(position.distance(expected.position) < 1e-6, "{position}: {expected:?}");
                assert!(normal.distance(expected.normal) < 2e-6, "{normal}: {expected:?}");
                (lowest_m, highest_m) = (lowest_m.min(position.y), highest_m.max(position.y));
            }
            assert!(lowest_m < -0.02 && highest_m > 0.02, "{lowest_m} {highest_m}");
        }
    });
}

#[test]
fn the_caustics_map_under_a_height_map_meets_the_oracle() {
    gpu_test(|device| {
        for (light, receiver) in
            [OVERHEAD, OBLIQUE, POINT].into_iter().flat_map(|l| [teapot(), bowl()].map(|receiver| (l, receiver)))
        {
            let parameters = under(uneven(), parameters(light));
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let case = format!("{} under {light:?}", receiver.mesh.name);
            assert_meets(drawing.target("caustics-map"), &oracle.caustics_map(), &case);
        }
    });
}

/// The waves of `parameters` as they stand in the frame that is drawn, 3 cm apart.
fn sampled_waves(parameters: &Parameters) -> WaterMap {
    let time_s = f64::from(FRAME) * f64::from(parameters.time_step_s);
    let waves = waves(parameters);
    map(UVec2::splat(401), DVec2::splat(0.03), |place| {
        waves
            .iter()
            .map(|w| w.amplitude_m * (w.vector.dot(place) - w.angular_frequency * time_s + w.phase_rad).sin())
            .sum()
    })
}

/// A map samples the waves where they stand still: every method draws the waves' picture, from below and through the
/// surface, by either compiler.
#[test]
fn a_map_of_the_waves_gives_the_waves_picture() {
    gpu_test(|device| {
        let swell = WaveParameters { count: 6, amplitude_m: 0.06, wavelength_m: 2.0 };
        // The mesh's extent follows the steepest slope that the surface may have, so that its triangles differ: fine
        // ones.
        let below = Parameters { waves: swell, water_triangles: 4000, ..parameters(OBLIQUE) };
        let above = Parameters { camera: Parameters::camera_above(below.water_depth_m), ..below.clone() };
        let receivers = [teapot(), floor()];
        for ((view, parameters), &variant) in [("below", below), ("above", above)]
            .into_iter()
            .flat_map(|v| Variant::ALL.iter().map(move |n| (v.clone(), n)))
        {
            let by_waves = Drawing::of(device, variant, &parameters, &receivers);
            let still = under(sampled_waves(&parameters), parameters.clone());
            let by_map = Drawing::of(device, variant, &still, &receivers);
            let waves = Oracle::of(&parameters, &OBLIQUE, &floor(), &by_map.grid).water;
            for (vertex, wave) in by_map.target("water").chunks_exact(8).zip(&waves) {
                assert!(Vec3::from_slice(vertex).as_dvec3().distance(wave.position) < 1e-5, "{wave:?}");
                assert!(Vec3::from_slice(&vertex[4..]).as_dvec3().distance(wave.normal) < 1e-4, "{wave:?}");
            }
            // Flat water, which no method may take for the waves.
            let flat = Parameters { waves: FLAT, ..parameters.clone() };
            let flat = Drawing::of(device, variant, &flat, &receivers);
            let from_flat = compare(&by_waves.picture, &flat.picture, None).unwrap().mean;
            by_map.assert_finite();
            let difference = compare(&by_waves.picture, &by_map.picture, None).unwrap();
            println!("{} from {view}: {difference:?}, {from_flat} from flat", variant.as_str());
            assert!(difference.mean <= 0.35 * from_flat, "{} from {view}: {difference:?}", variant.as_str());
            let naga = Drawing::compiled_by(Compiler::Naga, device, variant, &still, &receivers);
            assert!(compare(&naga.picture, &by_map.picture, None).unwrap().mean <= 0.01);
        }
    });
}

#[test]
fn a_height_map_stands_still() {
    gpu_test(|device| {
        let still = under(uneven(), parameters(OBLIQUE));
        let [first, later] = [0.0, 1.0].map(|time_step_s| {
            let parameters = Parameters { time_step_s, ..still.clone() };
            Drawing::of(device, Variant::LevelMap, &parameters, &[teapot()]).picture
        });
        assert_eq!(first, later);
    });
}

/// Straight down through flat and clear water the floor has one colour, however high the water stands.
#[test]
fn the_floor_is_seen_through_water_high_above_its_level() {
    gpu_test(|device| {
        let camera = Camera {
            eye: Vec3::Y * 6.0,
            target: Vec3::NEG_Y * 3.0,
            vertical_fov_rad: 0.1,
            ..parameters(OVERHEAD).camera
        };
        let calm = Parameters { waves: FLAT, absorption_per_m: 0.0, camera, ..parameters(OVERHEAD) };
        let high = under(map(UVec2::splat(2), DVec2::ONE, |_| 2.5), calm.clone());
        let [calm, high] = [calm, high].map(|p| Drawing::of(device, Variant::LevelMap, &p, &[floor()]).picture);
        let difference = compare(&calm, &high, None).unwrap();
        assert!(difference.max < 0.5, "{difference:?}");
    });
}

/// Root of the mean square distance from the axis of the light on a plane `depth_m` below the water's level, metres.
fn spot_radius_m(device: &Arc<Device>, lens: &WaterMap, depth_m: f64) -> f64 {
    const SIDE_M: f32 = 0.1;
    let mesh = shapes::plane(Vec2::splat(SIDE_M), UVec2::ONE);
    let place = Mat4::from_translation(Vec3::NEG_Y * depth_m as f32);
    let receiver = ReceiverInput { mesh: mesh.transformed(&place), albedo: Vec3::ONE };
    let parameters = Parameters {
        planes: 1,
        map_size: 200,
        water_triangles: 80_000,
        water_depth_m: 6.0,
        absorption_per_m: 0.0,
        ..under(lens.clone(), parameters(OVERHEAD))
    };
    let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[receiver]);
    let (mut flux, mut moment) = (0.0, 0.0);
    for (texel, &intensity) in drawing.target("caustics-map").iter().enumerate() {
        let place = DVec2::new((texel % 200) as f64, (texel / 200) as f64) - 99.5;
        flux += f64::from(intensity);
        moment += f64::from(intensity) * place.length_squared();
    }
    (moment / flux).sqrt() * f64::from(SIDE_M) / 200.0
}

/// A spherical cap of radius R focuses rays near its axis n R / (n - 1) = 4 R below its vertex. By Snell's law those
/// that enter at this lens's rim, 0.15 R from the axis, meet it 0.6 % nearer; so the light is narrowest up to that much
/// above the focus. Before and behind it the light is a cone, whose tip two planes tell.
#[test]
fn a_spherical_cap_focuses_four_radii_below_its_vertex() {
    gpu_test(|device| {
        let (radius_m, aperture_m) = (1.0f64, 0.15f64);
        let rim_m = (radius_m * radius_m - aperture_m * aperture_m).sqrt();
        let lens = map(UVec2::splat(401), DVec2::splat(1e-3), |place| {
            if place.length() >= aperture_m {
                return 0.0;
            }
            let vertex = spherical_cap_vertex(radius_m, DVec3::Y * radius_m, place.x, place.y).unwrap();
            vertex.position.y - rim_m
        });
        let vertex_m = LEVEL_M + radius_m - rim_m;
        let focus_m = spherical_cap_focus(radius_m, f64::from(parameters(OVERHEAD).refraction_index));
        assert!((focus_m - 4.0 * radius_m).abs() < 1e-5);
        let radii_m = |of_focus: [f64; 4]| of_focus.map(|s| spot_radius_m(device, &lens, s * focus_m - vertex_m));
        let (before, behind) = ([0.8, 0.85, 0.9, 0.95], [1.05, 1.1, 1.15, 1.2]);
        let (converging_m, diverging_m) = (radii_m(before), radii_m(behind));
        assert!(converging_m.iter().rev().is_sorted() && diverging_m.is_sorted(), "{converging_m:?} {diverging_m:?}");
        for (i, (near, far)) in before.into_iter().zip(behind.into_iter().rev()).enumerate() {
            let (near_m, far_m) = (converging_m[i], diverging_m[3 - i]);
            let tip = (near * far_m + far * near_m) / (near_m + far_m);
            println!("between {near} and {far} of 4 R the light is narrowest at {tip:.4}");
            assert!((0.99..=1.0).contains(&tip), "{near} {far}: {tip}");
        }
    });
}

#[test]
fn a_map_beyond_its_range_is_refused_with_its_name() {
    let refused = |map: WaterMap, light: Light| under(map, parameters(light)).validate().unwrap_err().to_string();
    let high = map(UVec2::splat(3), DVec2::ONE, |_| 195.0);
    let error = refused(high, OVERHEAD);
    assert!(error.starts_with("water-map test: its heights are 195 to 195 m"), "{error}");
    let steep = map(UVec2::splat(3), DVec2::splat(0.01), |p| 20.0 * p.x);
    let error = refused(steep, OVERHEAD);
    assert!(error.starts_with("water-map test: its slopes may reach"), "{error}");
    let low_light = Light::Point { position: Vec3::new(0.0, 0.5, 0.0), intensity: Vec3::ONE };
    let error = refused(map(UVec2::splat(3), DVec2::ONE, |_| 1.0), low_light);
    assert_eq!(error, "point-light 0,0.5,0: must lie above the water");
    assert_eq!(under(uneven(), parameters(OVERHEAD)).validate(), Ok(()));
}

/// A parabola of second derivative 2 along either axis, and waves by their closed form: what folds light.
#[test]
fn a_map_is_as_bent_as_what_it_samples() {
    let along_x = map(UVec2::new(100, 90), DVec2::new(0.1, 5.0), |p| p.x * p.x);
    let along_z = map(UVec2::new(90, 100), DVec2::new(5.0, 0.1), |p| p.y * p.y);
    for curvature in [along_x, along_z].map(|parabola| parabola.mean_curvature()) {
        // None beyond the outermost samples.
        assert!((curvature - 2.0).abs() < 0.05, "{curvature}");
    }
    let parameters = Parameters::default();
    let waves = waves(&parameters);
    let height = |p: DVec2| waves.iter().map(|w| w.amplitude_m * (w.vector.dot(p) + w.phase_rad).sin()).sum::<f64>();
    let sampled = map(UVec2::splat(500), DVec2::splat(0.03), height).mean_curvature();
    let ratio = sampled / parameters.mean_curvature();
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

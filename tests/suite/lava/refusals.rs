//! Refusals of the paper.

use fumarole::gpu::Error;
use fumarole::measure::study::Study;
use fumarole::papers::lava::{Lava, Parameters, Particles, Rock, Simulation, Variant, setup::Setup};
use fumarole::scene::Camera;
use glam::Vec3;

use super::scene::{parameters, shaders};
use crate::common::gpu_test;

#[test]
fn parameters_outside_their_range_are_named() {
    let good = parameters();
    assert_eq!(good.validate(), Ok(()));
    for preset in Setup::presets() {
        assert_eq!((preset.setup)().parameters.validate(), Ok(()), "{}", preset.name);
    }
    let nan = f32::NAN;
    let cases = [
        ("space", Parameters { space_m: Vec3::new(4.0, 0.0, 1.0), ..good.clone() }),
        ("space", Parameters { space_m: Vec3::new(4.0, nan, 1.0), ..good.clone() }),
        ("particles", Parameters { particles: 0, ..good.clone() }),
        ("radius", Parameters { radius_m: 0.0, ..good.clone() }),
        ("radius", Parameters { radius_m: 1.01, ..good.clone() }),
        ("radius", Parameters { radius_m: nan, ..good.clone() }),
        ("density", Parameters { density: [0, 4, 4], ..good.clone() }),
        ("density", Parameters { density: [u32::MAX; 3], ..good.clone() }),
        ("rho", Parameters { rho: Some(0.0), ..good.clone() }),
        ("rho", Parameters { rho: Some(nan), ..good.clone() }),
        ("rho", Parameters { rho: Some(f32::INFINITY), ..good.clone() }),
        ("splats", Parameters { splats: [0, 150], ..good.clone() }),
        ("splats", Parameters { splats: [u32::MAX; 2], ..good.clone() }),
        ("splat-radius", Parameters { splat_radius_m: -0.1, ..good.clone() }),
        ("epsilon", Parameters { epsilon_m: 0.0, ..good.clone() }),
        ("border", Parameters { border_m: nan, ..good.clone() }),
        ("speed", Parameters { speed_m_s: -1.0, ..good.clone() }),
        ("color", Parameters { color: Vec3::new(1.0, nan, 0.0), ..good.clone() }),
        ("temperatures", Parameters { temperatures_k: Some([0.0, 1000.0]), ..good.clone() }),
        ("temperatures", Parameters { temperatures_k: Some([1000.0, 10_001.0]), ..good.clone() }),
        ("temperatures", Parameters { temperatures_k: Some([nan, 1000.0]), ..good.clone() }),
        ("rock-tile", Parameters { rock_tile_m: 0.0, ..good.clone() }),
        ("time-step", Parameters { time_step_s: f32::INFINITY, ..good.clone() }),
        ("size", Parameters { width: 0, ..good.clone() }),
        ("camera", Parameters { camera: Camera { eye: Vec3::NAN, ..good.camera }, ..good.clone() }),
    ];
    for (name, parameters) in cases {
        let error = parameters.validate().expect_err(name);
        assert_eq!(error.name, name, "{error}");
    }
}

/// A constant colour has no temperature.
#[test]
fn temperatures_without_a_black_body_are_refused() {
    let of = |is_blackbody| {
        let parameters = Parameters { temperatures_k: Some([1300.0, 1000.0]), is_blackbody, ..parameters() };
        Setup { parameters, ..Setup::default() }.check().map_err(|error| error.to_string())
    };
    assert_eq!(of(true), Ok(()));
    let error = of(false).unwrap_err();
    assert!(error.contains("temperatures") && error.contains("blackbody"), "{error}");
    let parameters = Parameters {
        temperatures_k: Some([1300.0, 1000.0]),
        is_blackbody: true,
        simulation: Simulation::Sph,
        ..Parameters::default()
    };
    let error = Setup { parameters, ..Setup::default() }.check().unwrap_err().to_string();
    assert!(error.contains("temperatures") && error.contains("melt-temperature"), "{error}");
}

#[test]
fn rocks_that_are_no_textures_are_refused() {
    let rock = |width, height, count| Rock { width, height, texels: vec![[0; 4]; count] };
    assert_eq!(rock(2, 3, 6).validate(), Ok(()));
    for bad in [rock(1, 1, 1), rock(0, 0, 0), rock(1, 64, 64), rock(5000, 2, 10_000), rock(4, 4, 15)] {
        let error = bad.validate().unwrap_err().to_string();
        assert!(error.starts_with("rock ") && error.contains("2 to 4096"), "{error}");
    }
}

/// Eq. 6.1 beyond the device's point size would be clamped in silence.
#[test]
fn points_larger_than_the_devices_are_refused_with_both_figures() {
    gpu_test(|device| {
        let limit = device.physical().limits.point_size_range[1];
        // A point is wider than all columns, few enough of which any device's images have.
        let columns = (limit / 2.0) as u32 + 50;
        let parameters =
            Parameters { space_m: Vec3::ONE, radius_m: 1.0, density: [columns, 4, 8], particles: 4, ..parameters() };
        parameters.validate().unwrap();
        let particles = Particles::seeded(&parameters);
        let error = Lava::new(&shaders(device), "test", Variant::Paper, &parameters, &particles, Rock::built_in(), &[])
            .err()
            .unwrap();
        assert!(matches!(error, Error::Limit { .. }));
        let message = error.to_string();
        let size = parameters.point_size_px().ceil().to_string();
        assert!(message.contains(&size) && message.contains(&limit.to_string()), "{message}");
        assert!(message.contains("density") && message.contains("eq. 6.1"), "{message}");
    });
}

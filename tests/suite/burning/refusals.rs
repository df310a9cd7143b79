//! Numbers outside their ranges are named.

use fumarole::papers::burning::Parameters;
use glam::Vec3;

#[test]
fn bad_numbers_are_named() {
    let default = Parameters::default;
    assert_eq!(default().validate(), Ok(()));
    let mut cases = vec![
        (Parameters { flammability: 0, ..default() }, "flammability"),
        (Parameters { chi: 1.5, ..default() }, "chi"),
        (Parameters { psi: 0.0, ..default() }, "psi"),
        (Parameters { speed_per_s: -0.1, ..default() }, "speed"),
        (Parameters { width_of_areas: 0.0, ..default() }, "area-width"),
        (Parameters { edge: f32::NAN, ..default() }, "edge"),
        (Parameters { particle_radius: 0.0, ..default() }, "particle-radius"),
        (Parameters { retire_at: 1.0, ..default() }, "retire-at"),
        (Parameters { floor: Some(f32::NAN), ..default() }, "floor"),
        (Parameters { levels: Some(6), ..default() }, "levels"),
        (Parameters { level_of_detail: Some(6), ..default() }, "lod"),
        (Parameters { sources: vec![Vec3::NAN], ..default() }, "source"),
        (Parameters { sources: vec![Vec3::ZERO; 17], ..default() }, "source"),
        (Parameters { blocks: [6, 0, 8], ..default() }, "blocks"),
        (Parameters { blocks: [256, 256, 256], ..default() }, "blocks"),
        (Parameters { time_division: 0, ..default() }, "time-division"),
        (Parameters { fire: 1_000_001, ..default() }, "fire"),
        (Parameters { smoke: 1_000_001, ..default() }, "smoke"),
        (Parameters { albedo: Some(Vec3::splat(2.0)), ..default() }, "albedo"),
        (Parameters { time_step_s: f64::NAN, ..default() }, "time-step"),
        (Parameters { time_step_s: -1.0, ..default() }, "time-step"),
        (Parameters { first_frame: 100_001, ..default() }, "first-frame"),
        (Parameters { width: 0, ..default() }, "size"),
    ];
    // Table 3.1 and 6.1: between zero and one, neither included.
    for value in [0.0, 1.0, -0.5, f32::NAN] {
        cases.extend([
            (Parameters { epsilon: value, ..default() }, "epsilon"),
            (Parameters { beta: value, ..default() }, "beta"),
            (Parameters { rho: value, ..default() }, "rho"),
            (Parameters { phi: value, ..default() }, "phi"),
            (Parameters { gamma: value, ..default() }, "gamma"),
            (Parameters { spread: value, ..default() }, "spread"),
            (Parameters { omega: value, ..default() }, "omega"),
            (Parameters { upsilon: value, ..default() }, "upsilon"),
        ]);
    }
    for (parameters, name) in cases {
        assert_eq!(parameters.validate().unwrap_err().name, name);
    }
}

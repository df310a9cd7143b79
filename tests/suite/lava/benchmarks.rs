//! The first benchmark for lava codes of Cordonnier, Lev and Garel (2016), BM1, a dam break.

use fumarole::papers::lava::{Flow, Parameters, Particles, Sides};
use glam::{DVec3, Vec3};

use super::fluid::{animate, flowing, run, state};
use crate::common::gpu_test;

/// BM1: a block that is let go on level ground in two dimensions reaches 1.411 (g A^3 / (3 nu))^(1/5) t^(1/5) to either side, A the area of
/// its half (Huppert 1982).
#[test]
fn a_dam_break_spreads_as_a_viscous_gravity_current() {
    gpu_test(|device| {
        const COUNT: usize = 15 * 9 * 8;
        let spacing = 1.0 / 15.0;
        let flow = Flow {
            block_m: spacing * Vec3::new(15.0, 9.0, 8.0),
            viscosity_pa_s: 1000.0,
            slope_deg: Some(0.0),
            sides: Sides::Periodic,
            ..Flow::default()
        };
        let space_m = Vec3::new(3.2, 0.9, flow.block_m.z);
        let parameters = Parameters { particles: COUNT as u32, space_m, radius_m: 0.1, flow, ..flowing() };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        const STEPS: u32 = 35;
        run(device, &mut animate, STEPS);
        let (places, _) = state(device, &animate, COUNT);
        let aside = |place: &DVec3| {
            let way = place.x - 0.5;
            (way - 3.2 * (way / 3.2).round()).abs()
        };
        let mut ways: Vec<f64> = places.iter().map(aside).collect();
        ways.sort_by(f64::total_cmp);
        let front = ways[COUNT * 99 / 100] + 0.5 * f64::from(spacing);
        let time = f64::from(STEPS) * f64::from(parameters.time_step_s);
        let expected = 1.411 * (9.81 * 0.3f64.powi(3) / (3.0 * 1000.0 / 2700.0) * time).powf(0.2);
        println!("{time} s: front {front}, expected {expected}: {:.3}", front / expected);
        assert!((front / expected - 1.0).abs() < 0.1, "{front} {expected}");
    });
}

//! The benchmarks for lava codes of Cordonnier, Lev and Garel (2016) that need no laboratory's lava: BM1, a dam break; BM2, a flow down an
//! inclined plane; BM3, a dome that spreads and cools.

use fumarole::papers::lava::reference::{Sheet, Source};
use fumarole::papers::lava::{Flow, Heat, Parameters, Particles, Sides, Vent};
use glam::{DVec3, Vec3};

use super::fluid::{animate, flowing, run, state};
use super::heat::oracle_of;
use super::scene::texels;
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

/// The value that a hundredth of them exceeds.
fn front(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() * 99 / 100]
}

/// BM2: from a vent on a slope of 45 degrees, fed evenly, beside a sheet of lubrication theory; far down, its front goes as t^(7/9) and its
/// sides as t^(1/3) (Lister 1992).
#[test]
fn a_flow_down_a_plane_spreads_as_lubrication_theory_says() {
    gpu_test(|device| {
        const VENT: [f32; 2] = [0.3, 0.6];
        let parameters = Parameters {
            space_m: Vec3::new(1.3, 0.4, 1.2),
            particles: 4000,
            time_step_s: 1.0 / 60.0,
            radius_m: 0.05,
            flow: Flow {
                block_m: Vec3::new(0.4, 0.2, 0.4),
                viscosity_pa_s: 300.0,
                slope_deg: Some(45.0),
                vent: Vent { effusion_m3_s: 0.0064, middle_m: VENT, radius_m: 0.075, ..Vent::default() },
                ..Flow::default()
            },
            ..flowing()
        };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        let slope = std::f64::consts::FRAC_PI_4;
        let mut sheet = Sheet::new([65, 30], 0.02, 9.81, slope, 300.0 / 2700.0);
        let source = Source { x: f64::from(VENT[0]), radius: 0.075, rate: 0.0064, kelvin: 1423.0 };
        let half_m = 0.5 * parameters.flow.spacing_m(4000);
        let mut found = Vec::new();
        for steps in [150u32, 300] {
            let more = steps - animate.steps();
            run(device, &mut animate, more);
            sheet.flow(&source, f64::from(more) / 60.0, |_, _| 0.0);
            let (places, _) = state(device, &animate, animate.out() as usize);
            let [x, z] = VENT.map(f64::from);
            let along = front(places.iter().map(|p| p.x - x).collect()) + half_m;
            let across = front(places.iter().map(|p| (p.z - z).abs()).collect()) + half_m;
            let expected = [sheet.quantile(0.01, |at, _| at - x), sheet.quantile(0.01, |_, aside| aside)];
            let ratios = [along / expected[0], across / expected[1]];
            println!("{} s: {along:.3} m down, {across:.3} m aside, of theory's {ratios:.3?}", f64::from(steps) / 60.0);
            found.push([along, across]);
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.1), "{ratios:?}");
        }
        let [down, aside] = [0, 1].map(|axis| (found[1][axis] / found[0][axis]).log2());
        println!("t^{down:.3} down, t^{aside:.3} aside");
        assert!((down - 7.0 / 9.0).abs() < 0.1 && (aside - 1.0 / 3.0).abs() < 0.1, "{down} {aside}");
    });
}

/// BM3: a dome that is fed evenly on level ground spreads, conducts and radiates: its temperatures beside those of a sheet in which each
/// column cools as a slab does.
#[test]
fn a_dome_cools_as_it_spreads() {
    gpu_test(|device| {
        let heat = Heat { melt_k: 1200.0, conductivity_w_mk: 100.0, capacity_j_kgk: 12.0, ..Heat::default() };
        let parameters = Parameters {
            space_m: Vec3::new(1.2, 0.6, 1.2),
            particles: 1500,
            time_step_s: 1.0 / 60.0,
            radius_m: 0.1,
            flow: Flow {
                block_m: Vec3::new(0.4, 0.25, 0.4),
                viscosity_pa_s: 1000.0,
                slope_deg: Some(0.0),
                vent: Vent { effusion_m3_s: 0.01, middle_m: [0.6, 0.6], radius_m: 0.1, ..Vent::default() },
                heat,
                ..Flow::default()
            },
            ..flowing()
        };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        run(device, &mut animate, 240);
        let out = animate.out() as usize;
        let (places, _) = state(device, &animate, out);
        let motions: Vec<[f32; 4]> = texels(device, &animate.state().velocities);
        let oracle = oracle_of(&parameters);
        let mut sheet = Sheet::new([60, 30], 0.02, 9.81, 0.0, 1000.0 / 2700.0);
        let source = Source { x: 0.6, radius: 0.1, rate: 0.01, kelvin: 1200.0 };
        sheet.flow(&source, 4.0, |kelvin, thickness| oracle.shed(kelvin, thickness));
        let aside = |place: &DVec3| (place.x - 0.6).hypot(place.z - 0.6);
        let mean = |low: f64, high: f64| {
            let in_band = places.iter().zip(&motions).filter(|(place, _)| (low..high).contains(&aside(place)));
            let kelvin: Vec<f64> = in_band.map(|(_, motion)| f64::from(motion[3])).collect();
            kelvin.iter().sum::<f64>() / kelvin.len() as f64
        };
        let expected = |low: f64, high: f64| sheet.mean_kelvin(|x, z| (low..high).contains(&(x - 0.6).hypot(z))).0;
        let all = [mean(0.0, 9.0), expected(0.0, 9.0)];
        let lost = all.map(|kelvin| 1200.0 - kelvin);
        println!("all of it has cooled by {:.1} K of {:.1}", lost[0], lost[1]);
        for band in [[0.0, 0.1], [0.1, 0.2], [0.2, 0.3]] {
            let [found, theory] = [mean(band[0], band[1]), expected(band[0], band[1])];
            println!("{band:?} m from the vent: {found:.1} K, theory {theory:.1}");
            assert!((found - theory).abs() < 0.15 * lost[1], "{band:?}: {found} {theory}");
        }
        assert!(lost[1] > 30.0 && (lost[0] / lost[1] - 1.0).abs() < 0.1, "{lost:?}");
    });
}

//! Lava that comes out of a vent: counted, hot, and as far as theory has it.

use fumarole::measure::Paper;
use fumarole::papers::lava::{Flow, Heat, Inflow, Parameters, Particles, Rheology, Variant, Vent};
use glam::{DVec2, DVec3, Vec3};

use super::fluid::{animate, flowing, list, run, state};
use super::scene::{draw, read_back, texels, variant_of};
use crate::common::gpu_test;

/// 600 particles that come out within 20 steps.
fn erupting() -> Parameters {
    let vent = Vent { effusion_m3_s: 0.22, middle_m: [0.6, 0.6], radius_m: 0.3, ..Vent::default() };
    Parameters { flow: Flow { vent, ..flowing().flow }, ..flowing() }
}

/// Every particle comes once, as many as the effusion fills, with the melt's temperature, and none is lost; in both variants and
/// after a restart the same to the bit.
#[test]
fn lava_that_comes_out_is_counted() {
    gpu_test(|device| {
        let parameters = Parameters {
            flow: Flow { heat: Heat { emissivity: 0.0, ..Heat::default() }, ..erupting().flow },
            ..erupting()
        };
        let particles = Particles::of(&parameters);
        let inflow = Inflow::of(&parameters, 600);
        let step_m3 = f64::from(parameters.time_step_s) * 0.22;
        let particle_m3 = 0.6 * 0.5 * 0.5 / 600.0;
        let mut animate = animate(device, &parameters, &particles);
        let mut last = 0;
        for step in 1..=24 {
            run(device, &mut animate, 1);
            let out = animate.out();
            // To the nearest particle, up to the pool.
            let expected = (f64::from(step) * step_m3 / particle_m3).min(600.0);
            assert!((f64::from(out) - expected).abs() <= 0.501 && out == inflow.out(step), "{step}: {out} {expected}");
            assert!(out >= last);
            last = out;
            let (places, _) = state(device, &animate, 600);
            let motions: Vec<[f32; 4]> = texels(device, &animate.state().velocities);
            let space = parameters.space_m.as_dvec3();
            for (at, place) in places[..out as usize].iter().enumerate() {
                assert!(place.cmpgt(DVec3::ZERO).all() && place.cmplt(space).all(), "{step}, {at}: {place}");
                assert!((motions[at][3] - 1423.0).abs() < 1e-2, "{step}, {at}: {}", motions[at][3]);
            }
            let mut numbers: Vec<[u32; 2]> = list(device, &animate.sph().unwrap().sort.items);
            numbers.truncate(out as usize);
            let mut numbers: Vec<u32> = numbers.into_iter().map(|[_, number]| number).collect();
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..out), "{step}: every one that is out is sorted once");
        }
        assert_eq!(last, 600);
        let expected = texels::<u32>(device, &animate.state().positions);
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let mut lava = variant_of(device, variant, &parameters, &particles);
            for number in [5, 23] {
                draw(device, &mut lava, number);
                assert_eq!(lava.animate.out(), inflow.out(number + 1));
                if variant == Variant::Paper {
                    // Of those that are out, every one is in a cluster, and none that is not.
                    let bands = &read_back(&lava).cluster.clusters.particles;
                    let clustered: Vec<_> =
                        bands.iter().flatten().map(|point| point.position.map(f32::to_bits)).collect();
                    let mut distinct = clustered.clone();
                    distinct.sort_unstable();
                    distinct.dedup();
                    assert_eq!(distinct.len() as u32, lava.animate.out());
                }
            }
            assert!(expected == texels::<u32>(device, &lava.animate.state().positions), "{variant:?}");
            lava.restart().unwrap();
            draw(device, &mut lava, 23);
            assert!(expected == texels::<u32>(device, &lava.animate.state().positions), "{variant:?}, again");
        }
    });
}

/// From a vent on level ground, fed evenly: the radius is 0.715 (g Q^3 / (3 nu))^(1/8) t^(1/2) (Huppert 1982).
#[test]
fn a_dome_grows_as_a_viscous_gravity_current() {
    gpu_test(|device| {
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
                ..Flow::default()
            },
            ..flowing()
        };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        let kinematic = 1000.0 / 2700.0;
        for (steps, is_late) in [(120, false), (240, true)] {
            let more = steps - animate.steps();
            run(device, &mut animate, more);
            let out = animate.out() as usize;
            let (places, _) = state(device, &animate, out);
            let mut radii: Vec<f64> = places.iter().map(|p| (p.x - 0.6).hypot(p.z - 0.6)).collect();
            radii.sort_by(f64::total_cmp);
            let spacing = parameters.flow.spacing_m(1500);
            let front = radii[out * 99 / 100] + 0.5 * spacing;
            let time = f64::from(steps) / 60.0;
            let expected = 0.715 * (9.81 * 0.01f64.powi(3) / (3.0 * kinematic)).powf(0.125) * time.sqrt();
            let densest = list::<[f32; 2]>(device, &animate.sph().unwrap().factors);
            let densest = densest[..out].iter().map(|f| f[1]).fold(0.0, f32::max);
            println!("{time} s: front {front}, expected {expected}: {:.3}; densest {densest}", front / expected);
            assert!(densest < 1.5, "{densest}");
            if is_late {
                assert!((front / expected - 1.0).abs() < 0.1, "{front} {expected}");
            }
        }
    });
}

/// Toes come out where and when the law has them, each around its own middle, which leaves the break.
#[test]
fn toes_come_out_beside_each_other() {
    gpu_test(|device| {
        let heat = Heat { rheology: Rheology::Basalt, emissivity: 0.0, ..Heat::default() };
        let vent = Vent { toe_m3: 0.01, ..erupting().flow.vent };
        // In shorter steps, of which each fills no more of a small toe than it may.
        let flow = Flow { vent, heat, substeps: Some(4), ..erupting().flow };
        let parameters = Parameters { flow, ..erupting() };
        let toes = vent.toes(&parameters);
        assert!(toes.len() > 8, "{}", toes.len());
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        let mut before = 0;
        for step in 1..=20 {
            run(device, &mut animate, 1);
            let out = animate.out() as usize;
            let (places, _) = state(device, &animate, out);
            for (number, place) in places.iter().enumerate().skip(before) {
                let out_m3 = number as f64 * 2.5e-4;
                let toe = toes.iter().rfind(|toe| toe.first_m3 <= out_m3).unwrap();
                let radius = ((out_m3 - toe.first_m3) * 6.0 / std::f64::consts::PI / 3.0).cbrt();
                let middle = toe.break_m + radius * toe.way;
                // What a step pushes apart is less than three distances of particles.
                let aside = DVec2::new(place.x, place.z).distance(middle);
                assert!(aside < 0.3 + 0.19, "{step}, {number}: {aside}");
            }
            before = out;
        }
    });
}

#[test]
fn numbers_of_a_vent_that_cannot_be_are_refused() {
    let good = erupting();
    assert_eq!(good.validate(), Ok(()));
    let vent = |vent: Vent| Parameters { flow: Flow { vent, ..erupting().flow }, ..erupting() };
    let of = good.flow.vent;
    let cases = [
        ("effusion-rate", vent(Vent { effusion_m3_s: -1.0, ..of })),
        ("effusion-rate", vent(Vent { effusion_m3_s: f32::NAN, ..of })),
        ("effusion-rate", vent(Vent { effusion_m3_s: 1.0, ..of })),
        ("vent", vent(Vent { middle_m: [0.2, 0.6], ..of })),
        ("vent", vent(Vent { middle_m: [0.6, 1.0], ..of })),
        ("vent", vent(Vent { effusion_m3_s: 0.0, radius_m: 0.15, ..of })),
        ("vent-radius", vent(Vent { radius_m: 0.0, ..of })),
        ("vent-radius", vent(Vent { effusion_m3_s: 0.0, radius_m: 0.2, ..Vent::default() })),
        ("toe-volume", vent(Vent { toe_m3: 0.01, ..Vent::default() })),
        ("toe-volume", vent(Vent { toe_m3: 0.01, ..of })),
        ("toe-volume", vent(Vent { toe_m3: f32::NAN, ..of })),
    ];
    for (name, parameters) in cases {
        let error = parameters.validate().expect_err(name);
        assert_eq!(error.name, name, "{error}");
    }
}

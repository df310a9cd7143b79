//! The rock that a fluid's particles carry.

use fumarole::papers::lava::{Flow, Parameters, Particles, Shading, SurfaceDraw, SurfaceKind, Variant, Vent};
use glam::{DVec2, DVec3, Vec3};

use super::fluid::{animate, flowing, run, state};
use super::scene::{draw, texels, variant_of};
use crate::common::gpu_test;

/// Each laying is carried as far as its particle has gone since the step that it began with.
#[test]
fn particles_carry_the_rock_since_it_was_laid() {
    gpu_test(|device| {
        // Renewals 12 and 6 steps from the start on.
        let parameters = Parameters { flow: Flow { renewal_s: 0.4, ..flowing().flow }, ..flowing() };
        let particles = Particles::of(&parameters);
        let mut animate = animate(device, &parameters, &particles);
        let start: Vec<DVec3> = particles.positions.iter().map(|place| place.as_dvec3()).collect();
        let mut before = vec![start];
        for step in 0..20 {
            run(device, &mut animate, 1);
            before.push(state(device, &animate, 600).0);
            let rock = &animate.sph().unwrap().rock;
            let carried: Vec<[f32; 4]> = texels(device, &rock.states[animate.current()]);
            // The steps that the layings began with.
            let began = [step / 12 * 12, if step < 6 { 0 } else { (step - 6) / 12 * 12 + 6 }];
            let mut farthest = 0.0f64;
            for (at, now) in before[step + 1].iter().enumerate() {
                for (laying, began) in began.iter().enumerate() {
                    let gone = *now - before[*began][at];
                    let found = [carried[at][2 * laying], carried[at][2 * laying + 1]].map(f64::from);
                    let off = (DVec2::from(found) - DVec2::new(gone.x, gone.z)).length();
                    assert!(off < 1e-5, "{step}, {at}, {laying}: {found:?} {gone}");
                    farthest = farthest.max(gone.length());
                }
            }
            assert!(step < 5 || farthest > 0.01, "{step}: {farthest}");
        }
    });
}

/// Lava that comes out of a vent brings rock that has gone nowhere.
#[test]
fn rock_comes_out_of_a_vent_unmoved() {
    gpu_test(|device| {
        let vent = Vent { effusion_m3_s: 0.22, middle_m: [0.6, 0.6], radius_m: 0.3, ..Vent::default() };
        let flow = Flow { vent, renewal_s: 100.0, ..flowing().flow };
        let parameters = Parameters { flow, ..flowing() };
        let particles = Particles::of(&parameters);
        let mut animate = animate(device, &parameters, &particles);
        run(device, &mut animate, 12);
        let (places, _) = state(device, &animate, animate.out() as usize);
        let carried: Vec<[f32; 4]> = texels(device, &animate.sph().unwrap().rock.states[animate.current()]);
        for (at, now) in places.iter().enumerate() {
            let gone = *now - particles.positions[at].as_dvec3();
            let found = DVec2::new(carried[at][0].into(), carried[at][1].into());
            assert!((found - DVec2::new(gone.x, gone.z)).length() < 1e-5, "{at}: {found} {gone}");
        }
    });
}

/// A block that falls along x as a whole takes its rock along: what is seen of it is the picture before, moved.
#[test]
fn rock_moves_with_the_lava_that_is_seen() {
    gpu_test(|device| {
        let parameters = Parameters {
            shading: Shading::Rock,
            surface: SurfaceKind::Crossing,
            surface_draw: Some(SurfaceDraw::March),
            density: [60, 16, 36],
            radius_m: 0.15,
            border_m: 0.0,
            rock_tile_m: 0.8,
            flow: Flow { gravity_m_s2: 0.0, block_m: Vec3::new(0.6, 0.5, 0.6), renewal_s: 100.0, ..flowing().flow },
            ..flowing()
        };
        let mut particles = Particles::of(&parameters);
        for (place, velocity) in particles.positions.iter_mut().zip(&mut particles.velocities) {
            *place += Vec3::new(0.4, 0.3, 0.3);
            *velocity = Vec3::new(0.6, 0.0, 0.0);
        }
        let mut lava = variant_of(device, Variant::GpuDriven, &parameters, &particles);
        draw(device, &mut lava, 9);
        let pass = lava.surface_temperature.as_ref().unwrap();
        let temperatures: Vec<[f32; 4]> = texels(device, &pass.temperatures);
        let carried: Vec<[f32; 4]> = texels(device, &pass.carried);
        let covered = temperatures.iter().zip(&carried).filter(|(heat, _)| heat[1] > 0.0);
        // Ten steps of a thirtieth of a second; the block's own pressure moves its rim by up to a distance of particles.
        let (mut count, mut mean) = (0.0, DVec2::ZERO);
        for (_, [x, z, later_x, later_z]) in covered {
            for carried in [[x, z], [later_x, later_z]].map(|carried| DVec2::from(carried.map(|at| f64::from(*at)))) {
                assert!((carried - DVec2::new(0.2, 0.0)).length() < 0.12, "{carried}");
                mean += carried;
                count += 1.0;
            }
        }
        mean /= count;
        assert!(count > 200.0 && (mean - DVec2::new(0.2, 0.0)).length() < 0.02, "{count} {mean}");
        let share = temperatures[0][2];
        assert!((0.0..=1.0).contains(&share), "{share}");
    });
}

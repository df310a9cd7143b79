//! Stage one's first pass: particles stay, none is lost.

use std::collections::BTreeSet;

use fumarole::gpu::{Mode, Recorder};
use fumarole::papers::lava::reference::step;
use fumarole::papers::lava::{Animate, Parameters, Particles, State};
use glam::{DVec3, Vec3};

use super::scene::{parameters, shaders, texels};
use crate::common::gpu_test;

/// Fast enough that a particle crosses the space several times.
fn fast() -> Parameters {
    Parameters { speed_m_s: 3.0, particles: 500, ..parameters() }
}

#[test]
fn particles_stay_in_the_space_for_10_000_frames() {
    gpu_test(|device| {
        let parameters = fast();
        let particles = Particles::seeded(&parameters);
        let mut animation = Animate::new(&shaders(device), "test", &parameters, &particles).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let size = parameters.space_m;
        let mut crossings = BTreeSet::new();
        for _ in 0..100 {
            recorder.run(Mode::Plain, |frame| (0..100).try_for_each(|_| animation.record(frame))).unwrap();
            let State { positions, velocities } = animation.state();
            let positions: Vec<[f32; 4]> = texels(device, positions);
            let velocities: Vec<[f32; 4]> = texels(device, velocities);
            let mut turned = BTreeSet::new();
            for (i, before) in particles.velocities.iter().enumerate() {
                let (place, velocity) = (Vec3::from_slice(&positions[i]), Vec3::from_slice(&velocities[i]));
                // The speed along each axis is kept to the bit, so no particle is another.
                assert_eq!(velocity.abs(), before.abs(), "particle {i}");
                let slack = before.abs() * parameters.time_step_s * 1.0001;
                let is_inside = place.cmpge(-slack).all() && place.cmple(size + slack).all();
                assert!(is_inside, "particle {i} is at {place}");
                if velocity.y != before.y {
                    turned.insert(i);
                }
            }
            crossings.extend(turned);
        }
        assert_eq!(animation.steps(), 10_000);
        assert!(crossings.len() > 450, "{} particles have turned", crossings.len());
    });
}

#[test]
fn particles_follow_listing_5_1() {
    gpu_test(|device| {
        let parameters = fast();
        let particles = Particles::seeded(&parameters);
        let mut animation = Animate::new(&shaders(device), "test", &parameters, &particles).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut expected: Vec<(DVec3, DVec3)> =
            particles.positions.iter().zip(&particles.velocities).map(|(p, v)| (p.as_dvec3(), v.as_dvec3())).collect();
        let space = parameters.space_m.as_dvec3();
        let time_s = f64::from(parameters.time_step_s);
        let mut off = 0;
        for number in 1..=60 {
            recorder.run(Mode::Plain, |frame| animation.record(frame)).unwrap();
            let State { positions, velocities } = animation.state();
            let positions: Vec<[f32; 4]> = texels(device, positions);
            let velocities: Vec<[f32; 4]> = texels(device, velocities);
            for (i, (p, v)) in expected.iter_mut().enumerate() {
                step(p, v, space, time_s);
                let place = Vec3::from_slice(&positions[i]).as_dvec3();
                let velocity = Vec3::from_slice(&velocities[i]).as_dvec3();
                if place.distance(*p) > 1e-5 || velocity != *v {
                    // Rounding may decide in which step a particle on a border turns.
                    off += 1;
                    (*p, *v) = (place, velocity);
                }
            }
            assert!(off <= 2, "{off} particles are off after {number} steps");
        }
    });
}

#[test]
fn a_restart_returns_to_the_start() {
    gpu_test(|device| {
        let parameters = fast();
        let mut animation =
            Animate::new(&shaders(device), "test", &parameters, &Particles::seeded(&parameters)).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut after = |animation: &mut Animate, steps: u32| -> Vec<f32> {
            recorder.run(Mode::Plain, |frame| (0..steps).try_for_each(|_| animation.record(frame))).unwrap();
            texels(device, &animation.state().positions)
        };
        let first = after(&mut animation, 7);
        let further = after(&mut animation, 2);
        assert_ne!(first, further);
        animation.restart();
        assert_eq!(animation.steps(), 0);
        assert_eq!(after(&mut animation, 7), first);
    });
}

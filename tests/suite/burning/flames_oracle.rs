//! The device's particles, advanced by the oracle by one tick, are the device's next ones.

use std::cell::Cell;

use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::flames::{Fate, Group, Particle, Pools};
use fumarole::papers::burning::{Group as DeviceGroup, Parameters, Particle as DeviceParticle, Variant};
use fumarole::scene::{Mesh, shapes};
use glam::{DVec3, Vec3};

use super::dump;
use super::fire::{Fire, ball, quick};
use super::twin::Twin;
use crate::common::gpu_test;

fn particles(fire: &Fire) -> Vec<Particle> {
    let device: Vec<DeviceParticle> = fire.read(&fire.paper.flames().unwrap().particles);
    let particle = |p: &DeviceParticle| Particle {
        position: p.position.as_dvec3(),
        age: p.age_ticks as u32,
        life: p.life_ticks as u32,
        block: p.block as usize,
        own: p.random.map(f64::from),
    };
    device.iter().map(particle).collect()
}

fn groups(fire: &Fire) -> Vec<Group> {
    let device: Vec<DeviceGroup> = fire.read(&fire.paper.flames().unwrap().groups);
    let group =
        |g: &DeviceGroup| Group { firsts: [g.first_fire, g.first_smoke], first_ready: g.first_ready, weight: g.weight };
    device.iter().map(group).collect()
}

/// Equal, or one apart where the quotient that was cut off was whole but for rounding.
fn is_close(ours: (u32, f64), theirs: u32) -> bool {
    ours.0 == theirs || (ours.1 < 1e-4 && ours.0.abs_diff(theirs) == 1)
}

#[test]
fn every_particle_is_where_the_oracle_has_it() {
    let parameters = Parameters {
        fire: 600,
        smoke: 200,
        speed_per_s: 0.2,
        width_of_areas: 0.1,
        wind: Vec3::new(0.3, -0.05, -0.2),
        level_of_detail: Some(5),
        ..quick()
    };
    let fates = compare(&parameters, &ball(), 0, 160);
    let names = [Fate::Absent, Fate::Stays, Fate::Lit, Fate::Follows, Fate::Moves, Fate::Ends];
    assert!(names.iter().all(|fate| fates[*fate as usize] > 10), "{names:?}: {fates:?}");
}

/// More ready vertices in one block than a birth searches.
#[test]
fn particles_of_a_crowded_block_are_where_the_oracle_has_them() {
    let parameters = Parameters {
        fire: 60,
        smoke: 20,
        speed_per_s: 1.0,
        width_of_areas: 0.9,
        blocks: [1, 1, 1],
        level_of_detail: Some(5),
        ..quick()
    };
    let fates = compare(&parameters, &with_triangles(&shapes::sphere(32, 32), 40_000), 80, 12);
    assert!(fates[Fate::Follows as usize] > 10, "{fates:?}");
}

/// Burns for some ticks, compares `count` times, each three ticks after the last, and counts the fates.
fn compare(parameters: &Parameters, mesh: &Mesh, first: u32, count: u32) -> [u32; 6] {
    let counted = Cell::new([0; 6]);
    gpu_test(|device| {
        let pools = Pools {
            sizes: [parameters.fire, parameters.smoke],
            radius: parameters.particle_radius.into(),
            seed: parameters.noise_seed(),
            wind: parameters.wind.as_dvec3(),
        };
        let mut fire = Fire::new(device, Variant::Shell, parameters, mesh);
        let twin = Twin::new(&fire, Variant::Shell, parameters, mesh);
        let tick = twin.tick();
        let mut fates = [0; 6];
        fire.ticks(first);
        for _ in 0..count {
            fire.ticks(2);
            let before = particles(&fire);
            fire.ticks(1);
            let mut state = dump::state(&fire, false);
            state.mapped = vec![DVec3::ZERO; state.positions.len()];
            tick.map(&mut state);
            let at = format!("tick {}", state.tick);

            let found = groups(&fire);
            let wanted = tick.wanted(&state, &pools);
            let end = found.last().unwrap().firsts;
            assert!((0..2).all(|pool| is_close(wanted[pool], end[pool])), "{at}: {end:?} of {wanted:?} particles");
            for (block, ((ours, margins), theirs)) in tick.groups(&state, end).iter().zip(&found).enumerate() {
                let is_equal = (0..2).all(|pool| is_close((ours.firsts[pool], margins[pool]), theirs.firsts[pool]));
                let rest = |g: &Group| (g.first_ready, g.weight);
                assert!(is_equal && rest(ours) == rest(theirs), "{at}: block {block}: {theirs:?}, not {ours:?}");
            }

            let after = particles(&fire);
            let mut counts = [0; 2];
            for (number, ((ours, fate), theirs)) in
                tick.burn(&state, &pools, &found, &before).into_iter().zip(&after).enumerate()
            {
                fates[fate as usize] += 1;
                let at = format!("{at}: particle {number}, which {fate:?}");
                assert_eq!(ours.life, theirs.life, "{at}");
                if ours.life == 0 {
                    continue;
                }
                counts[usize::from(number >= parameters.fire as usize)] += 1;
                assert_eq!((ours.age, ours.block), (theirs.age, theirs.block), "{at}");
                assert!(
                    ours.position.distance(theirs.position) < 1e-4,
                    "{at} is at {}, not {}",
                    theirs.position,
                    ours.position
                );
                assert!((0..2).all(|k| (ours.own[k] - theirs.own[k]).abs() < 1e-6), "{at}");
            }
            let counted = fire.paper.counts().unwrap();
            assert_eq!([counted.fire_particles, counted.smoke_particles], counts, "{at}");
        }
        let ready = fire.read::<DeviceGroup>(&fire.paper.flames().unwrap().groups).last().unwrap().first_ready;
        assert!(parameters.blocks != [1, 1, 1] || ready > 10_000, "{ready} ready vertices");
        counted.set(fates);
    });
    counted.get()
}

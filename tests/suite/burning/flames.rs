//! Flame groups and their particles (3.6).

use fumarole::gpu::transfer::read_image;
use fumarole::measure::Paper;
use fumarole::papers::burning::{Group, Parameters, Particle, Variant};

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

fn burning() -> Parameters {
    Parameters { fire: 600, smoke: 200, speed_per_s: 0.2, width_of_areas: 0.1, ..quick() }
}

fn groups(fire: &Fire) -> Vec<Group> {
    fire.read(&fire.paper.flames().unwrap().groups)
}

fn particles(fire: &Fire) -> Vec<Particle> {
    fire.read(&fire.paper.flames().unwrap().particles)
}

fn is_there(particle: &&Particle) -> bool {
    particle.life_ticks > 0.0
}

#[test]
fn the_pools_are_shared_out_by_live_vertices_of_ready_blocks() {
    gpu_test(|device| {
        let parameters = burning();
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        let mut most = 0;
        for _ in 0..12 {
            fire.ticks(25);
            let (state, groups) = (fire.state(), groups(&fire));
            let weights: Vec<i32> = state.blocks.iter().map(|b| if b.ready > 0 { b.live } else { 0 }).collect();
            let total: i32 = weights.iter().sum();
            let share = (f64::from(total) / (0.25 * state.vertices.len() as f64)).min(1.0);
            let pools = [f64::from(parameters.fire), f64::from(parameters.smoke)].map(|pool| (pool * share).floor());
            let mut before = 0;
            for ((block, group), &weight) in groups.iter().enumerate().zip(&weights) {
                assert_eq!(group.weight as i32, weight, "{block}");
                let firsts = [group.first_fire, group.first_smoke];
                for (first, pool) in firsts.into_iter().zip(pools) {
                    let expected = pool * f64::from(before) / f64::from(total.max(1));
                    assert!((f64::from(first) - expected).abs() <= 1.001, "{block}: {first} is not {expected}");
                }
                before += weight;
            }
            let end = groups.last().unwrap();
            assert!((f64::from(end.first_fire) - pools[0]).abs() <= 1.0);
            most = most.max(end.first_fire);
        }
        assert_eq!(most, parameters.fire, "the whole pool burns once");
    });
}

#[test]
fn flames_burn_in_ready_blocks_alone_and_follow_the_live_vertices() {
    gpu_test(|device| {
        let parameters = burning();
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        let mut has_burnt = false;
        for _ in 0..24 {
            fire.ticks(20);
            let (state, groups) = (fire.state(), groups(&fire));
            let particles = particles(&fire);
            let (flames, smoke) = particles.split_at(parameters.fire as usize);
            for particle in flames.iter().filter(is_there) {
                assert!(state.blocks[particle.block as usize].ready > 0, "{particle:?}");
            }
            for particle in particles.iter().filter(is_there) {
                assert!(particle.position.is_finite() && particle.age_ticks < particle.life_ticks);
            }
            let count = |particles: &[Particle]| particles.iter().filter(is_there).count() as u32;
            assert_eq!((state.counts.fire_particles, state.counts.smoke_particles), (count(flames), count(smoke)));
            // A flame lives for less than 48 ticks, so that the number lags by that at most.
            let wanted = groups.last().unwrap().first_fire;
            if wanted == parameters.fire {
                has_burnt = true;
                assert!(count(flames) > wanted / 2, "{} of {wanted}", count(flames));
            }
        }
        assert!(has_burnt);
        let state = fire.state();
        assert_eq!((state.counts.ready_vertices, state.counts.fire_particles), (0, 0), "no flame without fuel");
    });
}

#[test]
fn flames_are_the_same_in_every_run_and_after_a_restart() {
    gpu_test(|device| {
        let bits = |fire: &Fire| bytemuck::cast_slice::<_, u32>(&particles(fire)).to_vec();
        let mut fire = Fire::new(device, Variant::Shell, &burning(), &ball());
        fire.ticks(120);
        let first = bits(&fire);
        fire.paper.restart().unwrap();
        assert!(particles(&fire).iter().filter(is_there).count() == 0, "a restart puts them out");
        fire.ticks(120);
        assert_eq!(bits(&fire), first);
        let mut other = Fire::new(device, Variant::Shell, &burning(), &ball());
        other.ticks(120);
        assert_eq!(bits(&other), first);
        let mut seeded = Fire::new(device, Variant::Shell, &Parameters { seed: 2, ..burning() }, &ball());
        seeded.ticks(120);
        assert_ne!(bits(&seeded), first);
    });
}

#[test]
fn fire_adds_light_smoke_covers_and_neither_leaves_a_picture_alone() {
    gpu_test(|device| {
        let pictured = |fire: u32, smoke: u32| {
            let parameters = Parameters { fire, smoke, width: 96, height: 72, ..burning() };
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
            fire.frame(230);
            read_image(device, fire.paper.picture()).unwrap()
        };
        let plain = pictured(0, 0);
        let lit = pictured(600, 0);
        let color = |bytes: &[u8], i: usize| (i % 4 < 3).then(|| bytes[i]);
        let is_darker = |a: &[u8], b: &[u8], i: usize| color(a, i) < color(b, i);
        assert!((0..plain.len()).all(|i| !is_darker(&lit, &plain, i)), "fire took light away");
        assert!((0..plain.len()).filter(|&i| is_darker(&plain, &lit, i)).count() > 500);
        let smoky = pictured(0, 600);
        assert!((0..plain.len()).filter(|&i| smoky[i] != plain[i]).count() > 300);
    });
}

#[test]
fn the_groups_of_a_million_blocks_hold_every_vertex() {
    gpu_test(|device| {
        let parameters = Parameters { blocks: [256, 256, 16], ..burning() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
        fire.ticks(110);
        let (state, groups) = (fire.state(), groups(&fire));
        assert!(state.counts.ready_vertices > 50);
        let ready_before = |block: usize| state.blocks[..block].iter().map(|b| b.ready as u32).sum::<u32>();
        for block in [1, 1000, state.blocks.len() / 2, state.blocks.len()] {
            assert_eq!(groups[block].first_ready, ready_before(block), "{block}");
        }
    });
}

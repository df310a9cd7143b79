//! Section 3.6: groups of fire and smoke particles by block. Their number and where they go follow from the
//! dissertation and are exact; lives, speeds and the hash that decides what is random are not in it, and are those of
//! `shaders/burning/flames.comp`.

use std::f64::consts::TAU;

use glam::DVec3;

use super::boundary::{RATE, area};
use super::{State, Tick};

/// The object's vertices over those in burning blocks that make whole pools burn.
const FRACTION_FOR_ALL: u64 = 4;
/// Ready vertices of a block from which on a random share of them, half as many as this or so, is searched (ours).
const LISTED: usize = 8192;
/// A free index is taken in one of so many ticks.
const BIRTH_TICKS: u32 = 8;

/// Fire or smoke.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kind {
    /// In ticks: at least, and what is random of it.
    life: [f64; 2],
    /// Diagonals a second.
    rise: f64,
    /// Above the vertex that it is born at, diagonals.
    above: f64,
}

const FIRE: Kind = Kind { life: [22.0, 26.0], rise: 0.17, above: 0.0 };
const SMOKE: Kind = Kind { life: [80.0, 90.0], rise: 0.13, above: 0.07 };
/// Diagonals a second to the sides.
const FLICKER: f64 = 0.05;

/// The particles of a fire.
#[derive(Debug, Clone, Copy)]
pub struct Pools {
    /// Fire and smoke at most; fire comes first.
    pub sizes: [u32; 2],
    /// Of a particle.
    pub radius: f64,
    /// Seed of the births.
    pub seed: u32,
    /// Diagonals a second.
    pub wind: DVec3,
}

/// The particles and vertices of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Group {
    /// Its first fire and its first smoke particle in their pools.
    pub firsts: [u32; 2],
    /// Combustion-ready vertices of the blocks before it.
    pub first_ready: u32,
    /// Live vertices while some are combustion-ready.
    pub weight: u32,
}

/// A number with how far the quotient that it is the whole part of lies from the next whole number.
pub type Whole = (u32, f64);

/// A particle of fire or smoke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Particle {
    /// Position of the particle in the object's frame.
    pub position: DVec3,
    /// In ticks.
    pub age: u32,
    /// In ticks; 0 of one that is not there.
    pub life: u32,
    /// The block that it was born in.
    pub block: usize,
    /// Two numbers of its own, 0 to 1.
    pub own: [f64; 2],
}

/// The effect of a tick on a particle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    Absent,
    Stays,
    /// A free index of the pool is taken.
    Lit,
    /// Its life is over and the next one of its group begins.
    Follows,
    /// Its block is consumed, and it burns on in a neighbour.
    Moves,
    /// Its life is over and its index is no longer wanted, or its block is consumed and no neighbour burns.
    Ends,
}

/// Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020: pcg3d.
pub(super) fn pcg3d(seed: [u32; 3]) -> [u32; 3] {
    let mut v = seed.map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |v: &mut [u32; 3]| {
        for (to, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    mix(&mut v);
    v = v.map(|x| x ^ (x >> 16));
    mix(&mut v);
    v
}

/// 24 bits as a number from 0 to below 1.
fn unit(bits: u32) -> f64 {
    f64::from(bits >> 8) / f64::from(1 << 24)
}

fn whole(above: u64, below: u64) -> Whole {
    let left = above % below;
    ((above / below) as u32, left.min(below - left) as f64 / below as f64)
}

impl Tick<'_> {
    fn flame_weight(state: &State, block: usize) -> u32 {
        let block = &state.blocks[block];
        if block.ready > 0 { block.live } else { 0 }
    }

    /// Fire and smoke particles that are wanted: the more, the more vertices lie in burning blocks.
    pub fn wanted(&self, state: &State, pools: &Pools) -> [Whole; 2] {
        let burning: u64 = (0..state.blocks.len()).map(|b| u64::from(Self::flame_weight(state, b))).sum();
        pools.sizes.map(|size| {
            let (all, part) = (self.model.rest.len() as u64, FRACTION_FOR_ALL * burning * u64::from(size));
            if part >= u64::from(size) * all { (size, f64::INFINITY) } else { whole(part, all) }
        })
    }

    /// The groups of all blocks, which divide the `wanted` particles by weight, and their end; each with the margin of
    /// its firsts.
    pub fn groups(&self, state: &State, wanted: [u32; 2]) -> Vec<(Group, [f64; 2])> {
        let weights: Vec<u32> = (0..state.blocks.len()).map(|b| Self::flame_weight(state, b)).collect();
        let total = weights.iter().sum::<u32>();
        let (mut before, mut first_ready) = (0, 0);
        let mut groups = Vec::new();
        for block in 0..=weights.len() {
            let firsts = wanted.map(|count| whole(u64::from(count) * u64::from(before), u64::from(total.max(1))));
            let weight = weights.get(block).copied().unwrap_or(0);
            groups.push((Group { firsts: firsts.map(|f| f.0), first_ready, weight }, firsts.map(|f| f.1)));
            before += weight;
            first_ready += state.blocks.get(block).map_or(0, |b| b.ready);
        }
        groups
    }

    /// Pass `flames` of the tick that made `state`, whose vertices are mapped: every particle with what has become of
    /// it.
    pub fn burn(&self, state: &State, pools: &Pools, groups: &[Group], before: &[Particle]) -> Vec<(Particle, Fate)> {
        let mut ready = vec![Vec::new(); state.blocks.len()];
        for v in (0..state.labels.len()).filter(|v| state.labels[*v] == area::READY && state.is_live(*v)) {
            ready[state.cells[v]].push(v);
        }
        for list in ready.iter_mut().filter(|list| list.len() > LISTED) {
            let share = u32::MAX / list.len() as u32 * (LISTED / 2) as u32;
            list.retain(|v| pcg3d([pools.seed, state.tick, *v as u32])[2] < share);
        }
        let of_fire = pools.sizes[0] as usize;
        let one = |(number, particle): (usize, &Particle)| {
            let pool = usize::from(number >= of_fire);
            let index = (number - pool * of_fire) as u32;
            let home = (0..state.blocks.len())
                .find(|b| (groups[*b].firsts[pool]..groups[b + 1].firsts[pool]).contains(&index));
            let (next, fate) = self.fate(state, pools, number as u32, pool, particle, home);
            match fate {
                Fate::Lit | Fate::Follows | Fate::Moves => {
                    let block = next.block;
                    (self.born(state, pools, number as u32, pool, block, &ready[block]), fate)
                }
                _ => (next, fate),
            }
        };
        before.iter().enumerate().map(one).collect()
    }

    /// The fate of a particle whose index in its pool belongs to the group `home`; of one that is to be born its block
    /// alone counts.
    fn fate(
        &self,
        state: &State,
        pools: &Pools,
        number: u32,
        pool: usize,
        particle: &Particle,
        home: Option<usize>,
    ) -> (Particle, Fate) {
        if particle.life == 0 {
            let is_time = pcg3d([pools.seed, number, state.tick])[1].is_multiple_of(BIRTH_TICKS);
            return match home.filter(|_| is_time) {
                Some(block) => (Particle { block, ..*particle }, Fate::Lit),
                None => (*particle, Fate::Absent),
            };
        }
        let speed = self.speed(state.tick, particle, [FIRE, SMOKE][pool]) + pools.wind;
        let position = particle.position + speed / RATE;
        let moved = Particle { position, age: particle.age + 1, ..*particle };
        // Smoke is in the air already; fire needs what burns.
        if pool == 0 && state.blocks[particle.block].ready == 0 {
            // Left, right, back, front, below, above; the first of several with as many vertices.
            let around = [[-1, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1], [0, -1, 0], [0, 1, 0]];
            let beside = around.into_iter().filter_map(|steps| self.model.grid.beside(particle.block, steps));
            let burning = beside.filter(|b| state.blocks[*b].ready > 0);
            let next = burning.rev().max_by_key(|b| state.blocks[*b].live);
            return match next {
                Some(block) => (Particle { block, ..moved }, Fate::Moves),
                None => (Particle { life: 0, ..moved }, Fate::Ends),
            };
        }
        match (moved.age >= moved.life, home) {
            (false, _) => (moved, Fate::Stays),
            (true, Some(block)) => (Particle { block, ..moved }, Fate::Follows),
            (true, None) => (Particle { life: 0, ..moved }, Fate::Ends),
        }
    }

    /// Diagonals a second: up, and to and fro.
    fn speed(&self, tick: u32, particle: &Particle, kind: Kind) -> DVec3 {
        let (p, time) = (particle.position, f64::from(tick) / RATE);
        let phase = TAU * particle.own[0];
        let sway_x = (31.0 * p.y - 7.0 * time + phase).sin() + 0.5 * (73.0 * p.x + 11.0 * time).sin();
        let sway_z = (27.0 * p.y - 6.0 * time + 1.7 * phase).cos() + 0.5 * (67.0 * p.z - 13.0 * time).cos();
        DVec3::new(FLICKER * sway_x, kind.rise * (0.6 + 0.8 * particle.own[1]), FLICKER * sway_z)
    }

    /// A new particle at that of the block's ready vertices with the lowest hash.
    fn born(&self, state: &State, pools: &Pools, number: u32, pool: usize, block: usize, ready: &[usize]) -> Particle {
        let kind = [FIRE, SMOKE][pool];
        let key = |v: usize| (pcg3d([v as u32, state.tick, number ^ pools.seed])[0], v);
        let vertex = ready.iter().copied().min_by_key(|v| key(*v)).expect("a block with weight has a ready vertex");
        let [of_life, first, second] = pcg3d([number, state.tick, pools.seed]).map(unit);
        let [x, z, _] = pcg3d([state.tick, pools.seed, number]).map(unit);
        let beside = DVec3::new((x - 0.5) * pools.radius, 0.2 * pools.radius + kind.above, (z - 0.5) * pools.radius);
        Particle {
            position: state.mapped[vertex] + beside,
            age: 0,
            life: (kind.life[0] + kind.life[1] * of_life) as u32,
            block,
            own: [first, second],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::Scene;
    use super::super::{Block, Variant};
    use super::*;

    const POOLS: Pools = Pools { sizes: [100, 50], radius: 0.02, seed: 1, wind: DVec3::ZERO };

    #[test]
    fn particles_are_divided_by_weight_and_none_is_lost() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        assert_eq!(tick.wanted(&state, &POOLS).map(|w| w.0), [0, 0], "nothing is ready before the fire");
        state.blocks.fill(Block::default());
        state.blocks[3] = Block { live: 30, ready: 1, ..Block::default() };
        state.blocks[5] = Block { live: 10, ready: 4, ..Block::default() };
        state.blocks[6] = Block { live: 99, ready: 0, ..Block::default() };
        // 40 of 642 vertices: a quarter would want all.
        assert_eq!(tick.wanted(&state, &POOLS).map(|w| w.0), [24, 12]);
        let groups: Vec<Group> = tick.groups(&state, [24, 12]).iter().map(|g| g.0).collect();
        let counts = |b: usize| [0, 1].map(|pool| groups[b + 1].firsts[pool] - groups[b].firsts[pool]);
        assert_eq!([counts(3), counts(5), counts(6)], [[18, 9], [6, 3], [0, 0]]);
        assert_eq!(groups.last().unwrap(), &Group { firsts: [24, 12], first_ready: 5, weight: 0 });
    }

    #[test]
    fn a_flame_moves_to_the_heaviest_burning_neighbour_and_smoke_stays() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        let home = scene.model.grid.cell(DVec3::new(0.0, 0.3, 0.0));
        let [left, right] = [-1, 1].map(|x| scene.model.grid.beside(home, [x, 0, 0]).unwrap());
        state.blocks.fill(Block::default());
        state.blocks[left] = Block { live: 3, ready: 1, ..Block::default() };
        state.blocks[right] = Block { live: 9, ready: 1, ..Block::default() };
        let flame = Particle { position: DVec3::Y, age: 3, life: 30, block: home, own: [0.5; 2] };
        let (moved, fate) = tick.fate(&state, &POOLS, 7, 0, &flame, None);
        assert_eq!((moved.block, fate), (right, Fate::Moves));
        assert_eq!(tick.fate(&state, &POOLS, 107, 1, &flame, None).1, Fate::Stays);
        state.blocks[right].ready = 0;
        assert_eq!(tick.fate(&state, &POOLS, 7, 0, &flame, None).0.block, left);
        state.blocks[left].ready = 0;
        let (gone, fate) = tick.fate(&state, &POOLS, 7, 0, &flame, Some(left));
        assert_eq!((gone.life, fate), (0, Fate::Ends));
        // A life that is over begins anew where its index in the pool belongs.
        state.blocks[home].ready = 1;
        let old = Particle { age: 29, ..flame };
        assert_eq!(tick.fate(&state, &POOLS, 7, 0, &old, Some(left)).1, Fate::Follows);
        assert_eq!(tick.fate(&state, &POOLS, 7, 0, &old, None).1, Fate::Ends);
    }
}

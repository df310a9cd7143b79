//! Relief of a fluid's crust (chapter 3): ropes by the skin's length, pieces by the particle that lies nearest, gaps by the flow's stretching.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

/// The crust, in metres, seconds and kelvin.
pub struct Crust {
    /// Length of a rope along the skin; 0 without any.
    pub rope: f64,
    /// Length of a piece; 0 without any.
    pub piece: f64,
    /// Height by which pieces are raised and tilted over their length.
    pub jumble: f64,
    /// Time in which new crust closes a gap.
    pub healing: f64,
    /// Share of the particles in the middle of a piece.
    pub kept: f64,
    /// Temperature at which there is no crust.
    pub melt: f64,
    /// Temperature at which there is nothing else.
    pub solidus: f64,
    /// Temperature around the lava.
    pub ambient: f64,
    /// Depth of lava that bears all of the relief.
    pub least: f64,
    /// Depth of the seam between two toes; 0 without any.
    pub seam: f64,
    /// Toe of each particle, by its number.
    pub toes: Vec<u32>,
}

/// The surface's columns, row by row.
pub struct Columns {
    /// Along x and z.
    pub counts: [usize; 2],
    /// Sides of the space.
    pub space: DVec2,
    /// Speed along x and z, temperature of the lava and its depth.
    pub motion: Vec<[f64; 4]>,
    /// Temperature of the surface, 1 where there is any lava, share of the rock's first laying.
    pub heat: Vec<[f64; 4]>,
    /// Way of both layings along x and z.
    pub carried: Vec<[f64; 4]>,
}

/// A place of the crust.
pub struct Texel {
    /// Height above the ground.
    pub height: f64,
    /// Temperature.
    pub kelvin: f64,
    /// True where a little more or less would be another piece, or one that lies too far away to be looked for.
    pub is_uncertain: bool,
}

/// Quantities of the columns at a place.
struct Mean {
    depth: f64,
    weight: f64,
    motion: [f64; 4],
    kelvin: f64,
    carried: [f64; 4],
}

/// Basis function of cubic B-splines: a box convolved with itself three times, as the truncated powers' difference.
fn basis(t: f64) -> f64 {
    // Far away the powers cancel but for rounding.
    if t.abs() >= 2.0 {
        return 0.0;
    }
    let powers = [1.0, -4.0, 6.0, -4.0, 1.0];
    (0..5).map(|i| powers[i] * (t + 2.0 - i as f64).max(0.0).powi(3) / 6.0).sum()
}

impl Columns {
    fn mean(&self, place: DVec2) -> Mean {
        let [columns, rows] = self.counts;
        let at = place / self.space * DVec2::new(columns as f64, rows as f64) - 0.5;
        let mut mean = Mean { depth: 0.0, weight: 0.0, motion: [0.0; 4], kelvin: 0.0, carried: [0.0; 4] };
        for z in -3..rows as i64 + 3 {
            for x in -3..columns as i64 + 3 {
                let share = basis(at.x - x as f64) * basis(at.y - z as f64);
                if share <= 0.0 {
                    continue;
                }
                let index = z.clamp(0, rows as i64 - 1) as usize * columns + x.clamp(0, columns as i64 - 1) as usize;
                mean.depth += share * self.motion[index][3];
                let weight = share * self.heat[index][1];
                mean.weight += weight;
                mean.kelvin += weight * self.heat[index][0];
                for axis in 0..4 {
                    mean.motion[axis] += weight * self.motion[index][axis];
                    mean.carried[axis] += weight * self.carried[index][axis];
                }
            }
        }
        let most = mean.weight.max(1e-6);
        mean.kelvin /= most;
        mean.motion = mean.motion.map(|sum| sum / most);
        mean.carried = mean.carried.map(|sum| sum / most);
        mean
    }
}

/// Steepness of a sine whose arc is so many times as long as its chord, by bisection of the arc's integral; 1.5 at most.
pub fn fold_steepness(longer: f64) -> f64 {
    let arc = |steepness: f64| {
        let slope = |i: u32| steepness * (TAU * (f64::from(i) + 0.5) / 400.0).cos();
        (0..400).map(|i| slope(i).hypot(1.0)).sum::<f64>() / 400.0
    };
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if arc(middle) < longer { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// O'Neill's generator of one word (2014), from 0 to below 1.
fn evenly(number: u32) -> f64 {
    f64::from(word(number) >> 8) / 16_777_216.0
}

fn word(number: u32) -> u32 {
    let state = number.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Height of the blocks that a piece is a heap of over its own, at a place from its middle, all over its length, and how near the place is to the
/// line between two of them.
fn rubble(from_middle: DVec2, number: u32) -> (f64, f64) {
    let at = 3.0 * from_middle;
    let mut blocks: Vec<(f64, DVec2, u32)> = Vec::new();
    for z in -1..=1 {
        for x in -1..=1 {
            let [column, row] = [at.x.floor() as i64 + x, at.y.floor() as i64 + z];
            let key = ((column + 128) * 256 + row + 128) as u32;
            let block = word(number ^ key);
            let middle = DVec2::new(column as f64 + evenly(block), row as f64 + evenly(block ^ 0x9e37_79b9));
            blocks.push((at.distance(middle), at - middle, block));
        }
    }
    blocks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (nearest, way, block) = blocks[0];
    let apart = blocks[1].0 - nearest;
    let share = (apart / 0.3).clamp(0.0, 1.0);
    let fallen = 0.5 * (1.0 - share * share * (3.0 - 2.0 * share));
    let tilt = (evenly(block ^ 0x7f4a_7c15) - 0.5) * way.x + (evenly(block ^ 0x94d0_49bb) - 0.5) * way.y;
    ((evenly(block ^ 0xbf58_476d) - 0.5 - fallen + 1.5 * tilt) / 3.0, apart)
}

impl Crust {
    /// At a place over level ground at 0. `particles` are places and numbers of all, `texel` the longer side of a column of the crust, and none
    /// is looked for farther away than `reach`.
    pub fn at(&self, columns: &Columns, particles: &[(DVec3, u32)], place: DVec2, texel: f64, reach: f64) -> Texel {
        const STEP: f64 = 1e-4;
        let mean = columns.mean(place);
        let difference = |of: &dyn Fn(&Mean) -> f64| {
            let along = |way: DVec2| {
                (of(&columns.mean(place + STEP * way)) - of(&columns.mean(place - STEP * way))) / (2.0 * STEP)
            };
            DVec2::new(along(DVec2::X), along(DVec2::Y))
        };
        let mut texel_of =
            Texel { height: mean.depth, kelvin: mean.kelvin, is_uncertain: (mean.weight - 1e-3).abs() < 1e-3 };
        if mean.weight <= 1e-3 || mean.depth <= 0.0 {
            return texel_of;
        }
        let grown = ((self.melt - mean.kelvin) / (self.melt - self.solidus)).clamp(0.0, 1.0);
        let mut relief = 0.0;
        if self.rope > 0.0 {
            let share = columns.heat[0][2];
            for (share, axis) in [(share, 0), (1.0 - share, 2)] {
                let slope = DVec2::X - difference(&|mean| mean.carried[axis]);
                let shortened = slope.length().max(1.0);
                let chord = self.rope / shortened;
                let turn = TAU * (place.x - mean.carried[axis]) / self.rope;
                // Slopes a sin(turn / 2) over half a turn either way from a crest, less the mean height.
                let height = 2.0 * (0.5 * turn).cos().abs() - 4.0 / PI;
                // Pressed together from a half to a third of the length on.
                let apart = (3.0 - shortened).clamp(0.0, 1.0);
                relief += grown * share * apart * fold_steepness(shortened) * chord / TAU * height;
            }
        }
        if self.piece > 0.0 {
            let top = DVec3::new(place.x, mean.depth, place.y);
            let kept = particles.iter().filter(|(_, number)| evenly(*number) < self.kept);
            let near = kept.clone().min_by(|a, b| a.0.distance(top).total_cmp(&b.0.distance(top)));
            let Some(&(middle, number)) = near else { return texel_of };
            let squared = middle.distance_squared(top);
            let line = |(other, _): &&(DVec3, u32)| {
                let across = (*other - middle).with_y(0.0).length().max(0.25 * self.piece);
                0.5 * (other.distance_squared(top) - squared) / across
            };
            let others = kept.filter(|(_, other)| *other != number);
            let within = |(other, _): &&(DVec3, u32)| (*other - top).with_y(0.0).abs().max_element() <= reach;
            let edge = others.clone().map(|other| line(&other)).fold(1e9, f64::min);
            let edge_within = others.filter(within).map(|other| line(&other)).fold(1e9, f64::min);
            texel_of.is_uncertain |= edge < 1e-4 * self.piece || edge < edge_within || squared.sqrt() > reach;
            let opening = difference(&|mean| mean.motion[0]).x + difference(&|mean| mean.motion[1]).y;
            let stretched = opening.max(0.0) * self.healing;
            let gaps = (stretched / (1.0 + stretched)).min(0.8);
            let half = 0.5 * self.piece * (1.0 - (1.0 - gaps).sqrt());
            let step = |low: f64, high: f64, at: f64| {
                let t = ((at - low) / (high - low)).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            };
            let gap = 1.0 - step(half - texel, half, edge);
            let core = mean.motion[2];
            let piece = ((mean.kelvin - gaps * core) / (1.0 - gaps)).max(self.ambient);
            texel_of.kelvin = (1.0 - gap) * piece + gap * core;
            let from = (top - middle).with_y(0.0);
            let tilt =
                1.5 * ((evenly(number ^ 0x9e37_79b9) - 0.5) * from.x + (evenly(number ^ 0x7f4a_7c15) - 0.5) * from.z);
            let raised = evenly(number ^ 0x94d0_49bb) - 0.5;
            let fallen = 0.5 * (1.0 - step(0.0, 0.2 * self.piece, edge));
            let (blocks, apart) = rubble(DVec2::new(from.x, from.z) / self.piece, number);
            texel_of.is_uncertain |= self.jumble > 0.0 && apart < 1e-3;
            let jumbled = self.piece * (raised - fallen + blocks) + tilt;
            relief += grown * (self.jumble * jumbled - 0.25 * gap * self.piece);
        }
        let borne = (mean.depth / self.least).clamp(0.0, 1.0);
        relief *= borne;
        if self.seam > 0.0 {
            let top = DVec3::new(place.x, mean.depth, place.y);
            // Wendland's C2 up to its factor.
            let weight = |place: DVec3| {
                let q = (place.distance(top) / reach).min(1.0);
                (1.0 - q).powi(4) * (1.0 + 4.0 * q)
            };
            // Of each toe the weight, and the distance of its nearest particle.
            let mut toes: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
            for (place, number) in particles {
                let (sum, nearest) = toes.entry(self.toes[*number as usize]).or_insert((0.0, f64::INFINITY));
                *sum += weight(*place);
                *nearest = nearest.min(place.distance(top));
            }
            let mut toes: Vec<(f64, f64)> = toes.into_values().collect();
            toes.sort_by(|a, b| b.0.total_cmp(&a.0));
            let share = |at: usize| toes.get(at).map_or(0.0, |toe| toe.0);
            // Particles at the rim of the kernel may have left the cells in which they are looked for.
            texel_of.is_uncertain |= share(0) + share(1) < 1e-2;
            // The device looks at the three that lie nearest: of all toes, either of the two that have most may be none of those.
            let is_near = |toe: &(f64, f64)| toes.iter().filter(|other| other.1 < toe.1 + 1e-6).count() <= 3;
            texel_of.is_uncertain |= !toes.iter().take(2).filter(|toe| toe.0 > 0.0).all(is_near);
            if share(0) > 0.0 {
                let inside = (share(0) - share(1)) / (share(0) + share(1));
                // The fold of a quarter of an ellipse, by its angle.
                let angle = (1.0 - inside).acos();
                relief -= self.seam.min(0.8 * mean.depth) * (1.0 - angle.sin());
                let share = (inside / 0.2).min(1.0);
                let crack = (1.0 - share * share * (3.0 - 2.0 * share)) * (1.0 - grown);
                let core = mean.motion[2].max(texel_of.kelvin);
                texel_of.kelvin += crack * (core - texel_of.kelvin);
            }
        }
        texel_of.height = (mean.depth + relief).max(mean.depth.min(0.5 * self.least));
        texel_of
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lava half a metre deep of toes whose particles have these distances from the place, above it.
    fn lowered(toes: &[(u32, f64)]) -> f64 {
        let columns = Columns {
            counts: [1, 1],
            space: DVec2::ONE,
            motion: vec![[0.0, 0.0, 1400.0, 0.5]],
            heat: vec![[1300.0, 1.0, 1.0, 0.0]],
            carried: vec![[0.0; 4]],
        };
        let crust = Crust {
            rope: 0.0,
            piece: 0.0,
            jumble: 0.0,
            healing: 0.0,
            kept: 1.0,
            melt: 1423.0,
            solidus: 1273.0,
            ambient: 300.0,
            least: 0.1,
            seam: 0.1,
            toes: toes.iter().map(|toe| toe.0).collect(),
        };
        let place = DVec2::splat(0.5);
        let particle = |(number, &(_, away)): (usize, &(u32, f64))| (DVec3::new(0.5, 0.5 + away, 0.5), number as u32);
        let particles: Vec<_> = toes.iter().enumerate().map(particle).collect();
        let texel = crust.at(&columns, &particles, place, 0.01, 0.2);
        assert!(!texel.is_uncertain);
        0.5 - texel.height
    }

    /// Two toes meet in one if they have as much as each other, whatever a third has beside them; not if one has as much as two others together.
    #[test]
    fn seams_lie_between_the_two_toes_that_have_most() {
        assert!((lowered(&[(0, 0.02), (1, 0.02)]) - 0.1).abs() < 1e-9);
        assert!((lowered(&[(0, 0.02), (1, 0.02), (2, 0.1)]) - 0.1).abs() < 1e-9);
        assert!(lowered(&[(0, 0.02), (0, 0.03)]).abs() < 1e-9);
        // A third of the way from the seam: the depth of a quarter of an ellipse there.
        let third = 0.1 * (1.0 - (1.0 - (2.0f64 / 3.0).powi(2)).sqrt());
        let between = lowered(&[(0, 0.05), (0, 0.05), (1, 0.05), (2, 0.05)]);
        assert!((between - third).abs() < 1e-9, "{between} {third}");
    }
}

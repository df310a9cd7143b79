//! A blue-noise mask by void and cluster (R. Ulichney, 1993): neighbours get places far apart, so that what is sampled once
//! a pixel errs in grain too fine to be seen.

use crate::scene::random::Random;

/// Texels of a side; the mask repeats without a seam.
pub const SIDE: usize = 64;
const COUNT: usize = SIDE * SIDE;
/// Texels from a point within which it is felt.
const REACH: isize = 7;
/// Standard deviation of a point's Gaussian, texels.
const SIGMA: f64 = 1.5;

/// The rank of each texel, row by row: every number below the count of texels once.
pub fn mask(seed: u64) -> Vec<u32> {
    let mut random = Random::with_stream(seed, 3);
    let mut points = Points { is_set: vec![false; COUNT], crowding: vec![0.0; COUNT] };
    let initial = COUNT / 10;
    let mut left = initial;
    while left > 0 {
        let texel = random.next_u32() as usize % COUNT;
        if !points.is_set[texel] {
            points.toggle(texel);
            left -= 1;
        }
    }
    // Moves the most crowded point into the greatest void, until it comes back to its own place.
    for _ in 0..COUNT {
        let cluster = points.most_crowded();
        points.toggle(cluster);
        let void = points.greatest_void();
        points.toggle(void);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; COUNT];
    let mut thinned = points.clone();
    for rank in (0..initial).rev() {
        let texel = thinned.most_crowded();
        thinned.toggle(texel);
        ranks[texel] = rank as u32;
    }
    for rank in initial..COUNT {
        let texel = points.greatest_void();
        points.toggle(texel);
        ranks[texel] = rank as u32;
    }
    ranks
}

/// Points on the texels of a torus.
#[derive(Clone)]
struct Points {
    is_set: Vec<bool>,
    /// Sum of the Gaussians of all points.
    crowding: Vec<f64>,
}

impl Points {
    /// Sets a point, or takes it away.
    fn toggle(&mut self, texel: usize) {
        self.is_set[texel] = !self.is_set[texel];
        let sign = if self.is_set[texel] { 1.0 } else { -1.0 };
        let (x, y) = ((texel % SIDE) as isize, (texel / SIDE) as isize);
        let side = SIDE as isize;
        for (dy, dx) in (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (dy, dx))) {
            let at = (y + dy).rem_euclid(side) * side + (x + dx).rem_euclid(side);
            let squared = (dx * dx + dy * dy) as f64;
            self.crowding[at as usize] += sign * (-squared / (2.0 * SIGMA * SIGMA)).exp();
        }
    }

    fn most_crowded(&self) -> usize {
        let set = (0..COUNT).filter(|&texel| self.is_set[texel]);
        set.max_by(|&a, &b| self.crowding[a].total_cmp(&self.crowding[b])).unwrap_or(0)
    }

    fn greatest_void(&self) -> usize {
        let free = (0..COUNT).filter(|&texel| !self.is_set[texel]);
        free.min_by(|&a, &b| self.crowding[a].total_cmp(&self.crowding[b])).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Mean power of the frequencies up to `most` cycles across the mask, over that of white noise.
    fn low_power(values: &[f64], most: i32) -> f64 {
        let mean = values.iter().sum::<f64>() / COUNT as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / COUNT as f64;
        let frequencies = || (-most..=most).flat_map(|u| (-most..=most).map(move |v| (u, v))).filter(|&f| f != (0, 0));
        let power = |(u, v): (i32, i32)| {
            let (mut re, mut im) = (0.0, 0.0);
            for (texel, value) in values.iter().enumerate() {
                let turn = f64::from(u) * (texel % SIDE) as f64 + f64::from(v) * (texel / SIDE) as f64;
                let (sin, cos) = (turn * TAU / SIDE as f64).sin_cos();
                re += (value - mean) * cos;
                im += (value - mean) * sin;
            }
            (re * re + im * im) / (COUNT as f64 * variance)
        };
        frequencies().map(power).sum::<f64>() / frequencies().count() as f64
    }

    #[test]
    fn ranks_are_all_different_and_their_noise_is_blue() {
        let ranks = mask(1);
        let mut sorted = ranks.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..COUNT as u32));
        assert!(ranks == mask(1) && ranks != mask(2));
        let blue: Vec<f64> = ranks.iter().map(|&rank| f64::from(rank)).collect();
        let mut random = Random::new(1);
        let white: Vec<f64> = blue.iter().map(|_| f64::from(random.unit())).collect();
        let [blue, white] = [blue, white].map(|values| low_power(&values, 6));
        assert!(blue < 0.02 && white > 0.7, "blue {blue}, white {white}");
    }
}

//! Noise like that of real frame times, for the self-tests of the comparison.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

pub struct Noise(Pcg64Mcg);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// A standard normal number (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// A first-order autoregressive series of unit variance.
    pub fn autoregressive(&mut self, count: usize, correlation: f64) -> Vec<f64> {
        let innovation = (1.0 - correlation * correlation).sqrt();
        let mut state = self.normal();
        (0..count)
            .map(|_| {
                let value = state;
                state = correlation * state + innovation * self.normal();
                value
            })
            .collect()
    }

    /// Logarithms of the medians of `processes` processes, of 150 frames each around 1 ms: processes differ by
    /// `deviation`, frames by `frame_deviation` with correlation 0.9, and one in fifty takes up to twice as long.
    pub fn process_log_medians(&mut self, processes: usize, deviation: f64, frame_deviation: f64) -> Vec<f64> {
        let median = |noise: &mut Self| {
            let level = 1.0 + deviation * noise.normal();
            let mut frames: Vec<f64> =
                noise.autoregressive(150, 0.9).iter().map(|x| level * (1.0 + frame_deviation * x)).collect();
            for frame in &mut frames {
                let (chance, height) = (noise.uniform(), noise.uniform());
                if chance < 0.02 {
                    *frame *= 1.0 + height;
                }
            }
            frames.sort_by(f64::total_cmp);
            0.5 * (frames[74] + frames[75])
        };
        (0..processes).map(|_| median(self).ln()).collect()
    }

    /// Logarithms of the machine's speed in the four processes of each of `count` blocks: a ramp of `drift` over a block on
    /// average, and, where there is drift, a step of 5 % in one block of ten.
    pub fn block_levels(&mut self, count: usize, drift: f64) -> Vec<[f64; 4]> {
        (0..count)
            .map(|_| {
                let slope = drift / 4.0 * (1.0 + 0.5 * self.normal());
                let step = if drift > 0.0 && self.uniform() < 0.1 { 0.05 } else { 0.0 };
                let at = (4.0 * self.uniform()) as usize;
                [0, 1, 2, 3].map(|place| slope * place as f64 + if place > at { step } else { 0.0 })
            })
            .collect()
    }

    /// Differences of B and A in blocks A B B A on a machine of such `levels`, in logarithms; B takes `factor` times as long.
    pub fn block_differences(&mut self, levels: &[[f64; 4]], factor: f64) -> Vec<f64> {
        let mut side = |places: [usize; 2]| -> Vec<f64> {
            let own = self.process_log_medians(2 * levels.len(), 0.01, 0.01);
            let pairs = levels.iter().zip(own.chunks_exact(2));
            pairs.map(|(level, own)| 0.5 * (own[0] + own[1] + level[places[0]] + level[places[1]])).collect()
        };
        let (a, b) = (side([0, 3]), side([1, 2]));
        b.iter().zip(a).map(|(b, a)| b - a + factor.ln()).collect()
    }

    /// A number from 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2_f64.powi(-53)
    }
}

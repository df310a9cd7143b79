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
        let mut uniform = || (self.0.next_u64() >> 11) as f64 * 2_f64.powi(-53);
        let (u, v) = (1.0 - uniform(), uniform());
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

    /// One process's frame times: independent noise of the given relative deviation.
    pub fn frame_times(&mut self, count: usize, mean_ms: f64, deviation: f64) -> Vec<f64> {
        (0..count).map(|_| mean_ms * (1.0 + deviation * self.normal())).collect()
    }

    /// One process's frame times as they are on a busy machine: the process as a whole is off by `drift`, and its
    /// frames by noise with correlation 0.9 from one to the next.
    pub fn drifting_frame_times(&mut self, count: usize, mean_ms: f64, deviation: f64, drift: f64) -> Vec<f64> {
        let level = mean_ms * (1.0 + drift * self.normal());
        let noise = self.autoregressive(count, 0.9);
        noise.iter().map(|x| level * (1.0 + deviation * x)).collect()
    }
}

//! Seeded random numbers: the same seed gives the same numbers on every machine.

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// A PCG-XSH-RR generator (O'Neill, 2014) with 64 bits of state.
///
/// Nothing here goes through a transcendental function, whose last bit differs between platforms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Random(Pcg32);

impl Random {
    /// The generator of `seed`, stream 0.
    pub fn new(seed: u64) -> Self {
        Self::with_stream(seed, 0)
    }

    /// One of 2^63 independent generators of the same seed, so that each particle system or noise
    /// layer can own one.
    pub fn with_stream(seed: u64, stream: u64) -> Self {
        Self(Pcg32::new(seed, stream))
    }

    /// A uniformly distributed integer.
    pub fn next_u32(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// A multiple of 2^-24, uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Uniform in [`low`, `high`], for finite bounds in either order. `high` can appear only
    /// through rounding.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        let t = self.unit();
        low * (1.0 - t) + high * t
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let point = Vec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0));
            let length_squared = point.length_squared();
            if (1e-6..=1.0).contains(&length_squared) {
                return point / length_squared.sqrt();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_reference_implementation() {
        // First outputs of `pcg32-demo` (seed 42, stream 54) of the PCG C library.
        let mut random = Random::with_stream(42, 54);
        let expected = [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293];
        assert_eq!(expected.map(|_| random.next_u32()), expected);
    }

    #[test]
    fn streams_and_seeds_differ() {
        let first = |mut random: Random| [(); 4].map(|()| random.next_u32());
        assert_eq!(first(Random::new(7)), first(Random::with_stream(7, 0)));
        assert_ne!(first(Random::new(7)), first(Random::with_stream(7, 1)));
        assert_ne!(first(Random::new(7)), first(Random::new(8)));
    }

    #[test]
    fn unit_is_uniform_and_below_one() {
        let mut random = Random::new(1);
        let mut bins = [0_u32; 10];
        for _ in 0..100_000 {
            let value = random.unit();
            assert!((0.0..1.0).contains(&value));
            bins[(value * 10.0) as usize] += 1;
        }
        // 10,000 expected, standard deviation 95.
        assert!(bins.iter().all(|&count| (9_500..10_500).contains(&count)), "{bins:?}");
    }

    #[test]
    fn range_stays_inside_its_bounds() {
        let mut random = Random::new(2);
        for _ in 0..1_000 {
            assert!((-3.0..=5.0).contains(&random.range(-3.0, 5.0)));
        }
    }

    #[test]
    fn directions_are_unit_and_without_bias() {
        let mut random = Random::new(3);
        let mut sum = Vec3::ZERO;
        for _ in 0..10_000 {
            let direction = random.direction();
            assert!((direction.length() - 1.0).abs() < 1e-6);
            sum += direction;
        }
        // The mean of each component has a standard deviation of 0.0058.
        assert!((sum / 10_000.0).abs().max_element() < 0.03);
    }
}

//! Lattice noise and turbulence (Perlin 1985) in double precision.

use glam::DVec3;

/// The hash with full avalanche that lattice and samples share with the shaders; integers, so exact.
pub fn scramble(value: u32) -> u32 {
    let mut h = value;
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

/// The pseudo-random gradient of a lattice point.
pub fn gradient(cell: [i32; 3], seed: u32) -> DVec3 {
    let factors = [0x8da6_b343, 0xd816_3841, 0xcb1a_b31f_u32];
    let mixed = cell.iter().zip(factors).fold(seed, |all, (&c, f)| all ^ (c as u32).wrapping_mul(f));
    let h = scramble(mixed);
    let part = |shift: u32| f64::from((h >> shift) & 1023) / 511.5 - 1.0;
    DVec3::new(part(0), part(10), part(20))
}

/// Noise with zeros on the lattice.
pub fn noise(p: DVec3, seed: u32) -> f64 {
    let low = p.floor();
    let t = p - low;
    let weight = |corner: u32, t: f64| {
        let s = t * t * (3.0 - 2.0 * t);
        if corner == 0 { 1.0 - s } else { s }
    };
    let corners = (0..8_u32).map(|i| [i & 1, (i >> 1) & 1, i >> 2]);
    corners
        .map(|[x, y, z]| {
            let corner = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let cell = (low + corner).to_array().map(|c| c as i32);
            gradient(cell, seed).dot(t - corner) * weight(x, t.x) * weight(y, t.y) * weight(z, t.z)
        })
        .sum()
}

/// The sum of |noise(p / scale) scale| over scales 1, 1/2, 1/4, ... above `pixel_size`.
pub fn turbulence(p: DVec3, pixel_size: f64, seed: u32) -> f64 {
    let scales = std::iter::successors(Some(1.0), |scale| Some(scale / 2.0)).take_while(|&scale| scale > pixel_size);
    scales.map(|scale| (noise(p / scale, seed) * scale).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero_on_the_lattice_and_continuous() {
        for i in 0..50 {
            let p = DVec3::new(f64::from(i), f64::from(3 * i % 7) - 3.0, f64::from(i % 5) - 2.0);
            assert_eq!(noise(p, 1), 0.0);
            let near = p + DVec3::splat(0.5);
            assert!((noise(near, 1) - noise(near + 1e-7, 1)).abs() < 1e-6);
        }
    }

    #[test]
    fn octaves_end_at_the_pixel_size() {
        let p = DVec3::new(0.3, 0.7, -0.2);
        assert_eq!(turbulence(p, 0.5, 1), noise(p, 1).abs());
        assert!(turbulence(p, 1.0, 1) == 0.0 && turbulence(p, 0.1, 1) > turbulence(p, 0.5, 1));
    }
}

//! Black bodies' light as the display shows it, by integrals over wavelengths finer than the observer's steps.

use super::super::blackbody::{FIRST_M, OBSERVER, STEP_M};

/// Linear light of the display's primaries at a temperature in kelvin, candela per square metre; negative where the
/// display has no such colour. By the trapezoidal rule with eight steps to each of the observer's, which is linear between
/// its rows, and by the inverse of the matrix that the primaries' chromaticities make.
pub fn light(kelvin: f64) -> [f64; 3] {
    const PARTS: usize = 8;
    let (planck, light_speed, boltzmann) = (6.626_070_15e-34_f64, 299_792_458.0_f64, 1.380_649e-23);
    let mut xyz = [0.0; 3];
    for at in 0..=(OBSERVER.len() - 1) * PARTS {
        let (row, part) = (at / PARTS, (at % PARTS) as f64 / PARTS as f64);
        let wavelength = FIRST_M + STEP_M * (row as f64 + part);
        let energy = planck * light_speed / wavelength;
        let radiance = 2.0 * energy * light_speed / wavelength.powi(4) / ((energy / (boltzmann * kelvin)).exp() - 1.0);
        let next = OBSERVER[(row + 1).min(OBSERVER.len() - 1)];
        for axis in 0..3 {
            let weight = OBSERVER[row][axis] * (1.0 - part) + next[axis] * part;
            xyz[axis] += 683.002 * radiance * weight * STEP_M / PARTS as f64;
        }
    }
    // Chromaticities of ITU-R BT.709's primaries and of its white, D65.
    let of = |x: f64, y: f64| glam::DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let primaries = glam::DMat3::from_cols(of(0.64, 0.33), of(0.3, 0.6), of(0.15, 0.06));
    let amounts = primaries.inverse() * of(0.3127, 0.3290);
    let [r, g, b] = (primaries.inverse() * glam::DVec3::from_array(xyz)).to_array();
    [r / amounts.x, g / amounts.y, b / amounts.z]
}

/// A linear value as the display encodes it.
pub fn encoded(value: f64) -> f64 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

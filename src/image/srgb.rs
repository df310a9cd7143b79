//! The sRGB transfer functions of IEC 61966-2-1, in `f64`.

use palette::encoding::{FromLinear, IntoLinear, Srgb};

/// The sRGB-encoded value of a linear one; both in 0..=1.
pub fn encode(linear: f64) -> f64 {
    Srgb::from_linear(linear)
}

/// The linear value of an sRGB-encoded one; both in 0..=1.
pub fn decode(encoded: f64) -> f64 {
    Srgb::into_linear(encoded)
}

/// The 8-bit sRGB value nearest to a linear one, which is clamped to 0..=1; NaN gives 0.
pub fn encode8(linear: f32) -> u8 {
    // In f64: palette's own u8 conversion is a table that may miss the nearest value.
    unit8(encode(f64::from(linear).clamp(0.0, 1.0)))
}

/// The 8-bit value nearest to one in 0..=1, without a transfer function; clamped, NaN gives 0.
pub(super) fn unit8(value: f64) -> u8 {
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard's text.
    fn standard(linear: f64) -> f64 {
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    }

    #[test]
    fn the_transfer_functions_are_the_standards_and_inverse() {
        for step in 0..=10_000 {
            let linear = f64::from(step) / 10_000.0;
            assert!((encode(linear) - standard(linear)).abs() < 1e-14, "{linear}");
            // The standard's two thresholds disagree by about 1e-8 in linear light.
            assert!((decode(encode(linear)) - linear).abs() < 1e-7, "{linear}");
        }
        assert!((encode(0.214_041_140) - 0.5).abs() < 1e-8);
        assert_eq!(encode8(0.214_041_14), 128);
    }

    #[test]
    fn eight_bits_are_the_nearest_and_return_unchanged() {
        for value in 0..=255u8 {
            assert_eq!(encode8(decode(f64::from(value) / 255.0) as f32), value);
        }
        for step in 0..=100_000 {
            let linear = step as f32 / 100_000.0;
            let exact = 255.0 * standard(f64::from(linear));
            assert!((f64::from(encode8(linear)) - exact).abs() <= 0.5 + 1e-9);
        }
    }

    #[test]
    fn values_outside_are_clamped() {
        assert_eq!(encode8(-1.0), 0);
        assert_eq!(encode8(-f32::INFINITY), 0);
        assert_eq!(encode8(7.5), 255);
        assert_eq!(encode8(f32::INFINITY), 255);
        assert_eq!(encode8(f32::NAN), 0);
    }
}

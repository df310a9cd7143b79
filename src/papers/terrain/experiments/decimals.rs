//! Numbers with so many digits after the point, in half of the time that the formatter of any precision takes.

use std::fmt::{Display, Formatter, Result};

/// A number as `{:.DECIMALS}` has it, but for the last digit where the number lies halfway to a double's precision.
pub struct Decimals<const DECIMALS: u32>(pub(super) f64);

/// Whole numbers below are doubles.
const WHOLE: f64 = (1_u64 << 52) as f64;
/// Digits of such a number, the point and the sign.
const MOST_BYTES: usize = 18;

impl<const DECIMALS: u32> Display for Decimals<DECIMALS> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        let scaled = (self.0.abs() * 10_u64.pow(DECIMALS) as f64).round();
        if scaled.is_nan() || scaled >= WHOLE {
            return write!(formatter, "{:.*}", DECIMALS as usize, self.0);
        }
        // From the last digit on, to the first before the point at least.
        let mut text = [0; MOST_BYTES];
        let (mut rest, mut first) = (scaled as u64, MOST_BYTES);
        let mut place = 0;
        while rest > 0 || place <= DECIMALS + 1 {
            first -= 1;
            if place == DECIMALS {
                text[first] = b'.';
            } else {
                text[first] = b'0' + (rest % 10) as u8;
                rest /= 10;
            }
            place += 1;
        }
        if self.0.is_sign_negative() {
            first -= 1;
            text[first] = b'-';
        }
        formatter.write_str(std::str::from_utf8(&text[first..]).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;

    #[test]
    fn numbers_are_those_of_the_formatter() {
        let mut random = Random::new(1);
        let some = [0.0, -0.0, 0.9996, -9.9999999, 1e-7, 4.5e9, -4.5e12, 1e300, f64::NAN, f64::INFINITY];
        let many = (0..20_000).map(|index| {
            let size = 10_f64.powi(index % 12 - 3);
            (f64::from(random.unit() - 0.5) * size * 1e6).round() / 1e6
        });
        let mut halfway = 0;
        for number in some.into_iter().chain(many) {
            let ours = [Decimals::<3>(number).to_string(), Decimals::<6>(number).to_string()];
            let theirs = [format!("{number:.3}"), format!("{number:.6}")];
            halfway += u32::from(ours != theirs);
            let apart = |ours: &str, theirs: &str| ours.parse::<f64>().unwrap() - theirs.parse::<f64>().unwrap();
            let is_near = number.is_nan() || number.is_infinite() || apart(&ours[0], &theirs[0]).abs() < 1.1e-3;
            assert!(is_near && ours[1] == theirs[1], "{ours:?} {theirs:?}");
        }
        assert!(halfway < 40, "{halfway} of 20,010");
    }
}

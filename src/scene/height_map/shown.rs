//! Numbers in messages.

use std::fmt::{Display, Formatter, Result};

/// A number as it is written, or with a power of ten where that would take many digits.
pub struct Shown(f64);

/// A number for a message.
pub fn shown(number: f64) -> Shown {
    Shown(number)
}

impl Display for Shown {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-6..1e9).contains(&size) {
            write!(formatter, "{}", self.0)
        } else {
            write!(formatter, "{:e}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_many_digits_are_shown_by_their_power_of_ten() {
        for (number, expected) in [
            (0.0, "0"),
            (-1.0, "-1"),
            (0.000_008_3, "0.0000083"),
            (4_000_000.5, "4000000.5"),
            (1e300, "1e300"),
            (-1e-300, "-1e-300"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(shown(number).to_string(), expected);
        }
    }
}

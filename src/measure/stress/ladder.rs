//! The values of an axis, from step to step.

/// Values that grow by a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ladder {
    /// The first value, at least 1.
    pub from: u64,
    /// Above 1.
    pub factor: f64,
    /// Greatest value of the axis.
    pub most: u64,
}

impl Ladder {
    /// The first value; none where the axis ends before it.
    pub fn first(&self) -> Option<u64> {
        Some(self.from).filter(|from| *from <= self.most)
    }

    /// The value after another: by the factor, rounded, and at least one more.
    pub fn after(&self, value: u64) -> Option<u64> {
        let next = (value as f64 * self.factor).round().max(value as f64 + 1.0);
        // Beyond 2^53 floats have no ones left; no axis goes so far.
        Some(next).filter(|next| *next <= (self.most as f64).min(9e15)).map(|next| next as u64)
    }

    /// The first value after another that is above `amount`.
    pub fn after_above(&self, value: u64, amount: f64) -> Option<u64> {
        let mut next = self.after(value)?;
        while next as f64 <= amount {
            next = self.after(next)?;
        }
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(ladder: Ladder) -> Vec<u64> {
        std::iter::successors(ladder.first(), |value| ladder.after(*value)).collect()
    }

    #[test]
    fn values_grow_by_the_factor_and_end_with_the_axis() {
        assert_eq!(values(Ladder { from: 4, factor: 2.0, most: 64 }), [4, 8, 16, 32, 64]);
        assert_eq!(values(Ladder { from: 1, factor: 1.5, most: 20 }), [1, 2, 3, 5, 8, 12, 18]);
        assert_eq!(values(Ladder { from: 1, factor: 1.05, most: 4 }), [1, 2, 3, 4]);
        assert_eq!(values(Ladder { from: 65, factor: 2.0, most: 64 }), [0; 0]);
        assert!(values(Ladder { from: 1, factor: 100.0, most: u64::MAX }).len() < 12);
    }

    #[test]
    fn what_a_step_had_already_is_passed_over() {
        let ladder = Ladder { from: 8, factor: 2.0, most: 100 };
        assert_eq!(ladder.after_above(8, 8.0), Some(16));
        assert_eq!(ladder.after_above(8, 33.0), Some(64));
        assert_eq!(ladder.after_above(8, 64.0), None);
    }
}

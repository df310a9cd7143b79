//! Ranges of parameters, and their text in help and messages.

/// A range of numbers, each end taken in or left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    low: Option<(f64, End)>,
    high: Option<(f64, End)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    In,
    Out,
}

impl Range {
    pub const ANY: Range = Range { low: None, high: None };

    /// `low` and more.
    pub const fn from(low: f64) -> Self {
        Range { low: Some((low, End::In)), high: None }
    }

    /// More than `low`.
    pub const fn above(low: f64) -> Self {
        Range { low: Some((low, End::Out)), high: None }
    }

    /// No more than `high`.
    pub const fn to(self, high: f64) -> Self {
        Range { high: Some((high, End::In)), ..self }
    }

    /// Less than `high`.
    pub const fn below(self, high: f64) -> Self {
        Range { high: Some((high, End::Out)), ..self }
    }

    /// Smallest and largest number that count as its ends, where it has them.
    pub fn ends(&self) -> (Option<f64>, Option<f64>) {
        (self.low.map(|(low, _)| low), self.high.map(|(high, _)| high))
    }

    /// Tests a number; `rounded` rounds the ends as the number was.
    pub fn holds(&self, value: f64, rounded: impl Fn(f64) -> f64) -> bool {
        let is_above = match self.low.map(|(low, end)| (rounded(low), end)) {
            None => true,
            Some((low, End::In)) => value >= low,
            Some((low, End::Out)) => value > low,
        };
        let is_below = match self.high.map(|(high, end)| (rounded(high), end)) {
            None => true,
            Some((high, End::In)) => value <= high,
            Some((high, End::Out)) => value < high,
        };
        is_above && is_below
    }

    /// `0 to 10`, `above 0 and at most 1`, `at least 4`; empty for any.
    pub fn text(&self) -> String {
        use End::{In, Out};
        match (self.low, self.high) {
            (None, None) => String::new(),
            (Some((low, In)), Some((high, In))) => format!("{low} to {high}"),
            (Some((low, In)), Some((high, Out))) => format!("{low} to below {high}"),
            (Some((low, Out)), Some((high, In))) => format!("above {low} and at most {high}"),
            (Some((low, Out)), Some((high, Out))) => format!("above {low} and below {high}"),
            (Some((low, In)), None) => format!("at least {low}"),
            (Some((low, Out)), None) => format!("above {low}"),
            (None, Some((high, In))) => format!("at most {high}"),
            (None, Some((high, Out))) => format!("below {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_in_or_out_as_the_words_say() {
        for (range, text, inside, outside) in [
            (Range::from(1.0).to(4096.0), "1 to 4096", &[1.0, 4096.0][..], &[0.0, 4097.0, f64::NAN][..]),
            (Range::above(0.0).to(1.0), "above 0 and at most 1", &[1e-9, 1.0], &[0.0, 1.1]),
            (Range::above(0.0).below(1.0), "above 0 and below 1", &[0.5], &[0.0, 1.0]),
            (Range::from(0.0).below(1.0), "0 to below 1", &[0.0, 0.9], &[1.0, -0.1]),
            (Range::from(4096.0), "at least 4096", &[4096.0, 1e30], &[4095.0]),
            (Range::above(0.0), "above 0", &[1e-30], &[0.0, -1.0, f64::NAN]),
            (Range::ANY, "", &[-1e30, 0.0], &[]),
        ] {
            assert_eq!(range.text(), text);
            assert!(inside.iter().all(|&v| range.holds(v, |end| end)), "{text}");
            assert!(outside.iter().all(|&v| !range.holds(v, |end| end)), "{text}");
        }
        // A tenth in single precision is the tenth that was typed.
        assert!(Range::from(0.0).to(0.1).holds(f64::from(0.1_f32), |end| f64::from(end as f32)));
    }
}

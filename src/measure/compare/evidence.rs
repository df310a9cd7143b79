//! Estimate of the logarithm of the ratio B / A of two sides' times, with its error.
//!
//! Sides that were measured apart give one number a process, the logarithm of its median: Welch's t-test compares them,
//! so that the noise of frames counts once, as it shows between processes; what a clock's steps hide does not show there, and
//! is added. Sides that were measured in turn, in blocks
//! A B B A, give one difference a block, in which drift cancels: the signed ranks of Wilcoxon compare those, exactly,
//! whatever their distribution, and steps of the clock rate weigh no more than any other outlier; what lies within the steps of
//! the clocks that tell the times speaks for neither side.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Evidence on ln(B / A), from at least two processes a side or two blocks.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// Estimate, its standard error, the part of that which the steps of the clocks make, and its degrees of freedom.
    Welch { estimate: f64, error: f64, rounding: f64, freedom: f64 },
    /// Means of all pairs of block differences, ascending (Walsh averages), the number of blocks, and by how much the steps of
    /// the clocks can have moved each mean at most.
    SignedRanks { walsh: Vec<f64>, blocks: usize, rounding: f64 },
}

impl Evidence {
    /// Compares the logarithms of the processes' medians, B less A. Absent with fewer than two processes on a side.
    pub fn welch(a: &[f64], b: &[f64]) -> Option<Self> {
        Self::welch_of_steps(a, b, [0.0; 2])
    }

    /// The same of medians that clocks have rounded, A's and B's to steps of these fractions of them. A median lies anywhere
    /// within its step, which has the variance of a uniform law; all processes of a side may be off alike, so that no number
    /// of them lessens it.
    pub fn welch_of_steps(a: &[f64], b: &[f64], steps: [f64; 2]) -> Option<Self> {
        let ((mean_a, mut a), (mean_b, mut b)) = (mean_and_error(a)?, mean_and_error(b)?);
        let [of_a, of_b] = steps.map(|step| step * step / 12.0);
        a.squared += of_a;
        b.squared += of_b;
        let squared = a.squared + b.squared;
        // Equal numbers have no spread, and any freedom will do.
        let freedom = squared * squared / (a.squared * a.squared / a.freedom + b.squared * b.squared / b.freedom);
        let freedom = if freedom.is_finite() { freedom } else { a.freedom.min(b.freedom) };
        let (error, rounding) = (squared.sqrt(), (of_a + of_b).sqrt());
        Some(Evidence::Welch { estimate: mean_b - mean_a, error, rounding, freedom })
    }

    /// Compares sides that were measured in blocks, by each block's difference of logarithms. Absent with fewer than two.
    pub fn signed_ranks(differences: &[f64]) -> Option<Self> {
        Self::signed_ranks_of_steps(differences, [0.0; 2])
    }

    /// The same of medians that clocks have rounded, A's and B's to steps of these fractions of them: each may be off by half a
    /// step, all of them alike.
    pub fn signed_ranks_of_steps(differences: &[f64], steps: [f64; 2]) -> Option<Self> {
        if differences.len() < 2 {
            return None;
        }
        let mut walsh = Vec::with_capacity(differences.len() * (differences.len() + 1) / 2);
        for (index, first) in differences.iter().enumerate() {
            walsh.extend(differences[index..].iter().map(|second| 0.5 * (first + second)));
        }
        walsh.sort_by(f64::total_cmp);
        Some(Evidence::SignedRanks { walsh, blocks: differences.len(), rounding: 0.5 * (steps[0] + steps[1]) })
    }

    /// The estimated ln(B / A): a difference of means, or the median of the Walsh averages (Hodges and Lehmann).
    pub fn estimate(&self) -> f64 {
        match self {
            Evidence::Welch { estimate, .. } => *estimate,
            Evidence::SignedRanks { walsh, .. } => {
                let middle = walsh.len() / 2;
                if walsh.len() % 2 == 1 { walsh[middle] } else { 0.5 * (walsh[middle - 1] + walsh[middle]) }
            }
        }
    }

    /// Probability of evidence at least as strong for a ratio above exp(`bound`), were it not above.
    pub fn p_above(&self, bound: f64) -> f64 {
        match self {
            Evidence::Welch { estimate, error, freedom, .. } => upper_tail((estimate - bound) / error, *freedom),
            Evidence::SignedRanks { walsh, blocks, rounding } => {
                // A Walsh average that may equal the bound speaks for neither side.
                let above = walsh.iter().filter(|average| **average - rounding > bound).count();
                tail_of_ranks(*blocks, above)
            }
        }
    }

    /// Probability of evidence at least as strong for a ratio below exp(`bound`), were it not below.
    pub fn p_below(&self, bound: f64) -> f64 {
        match self {
            Evidence::Welch { estimate, error, freedom, .. } => upper_tail((bound - estimate) / error, *freedom),
            Evidence::SignedRanks { walsh, blocks, rounding } => {
                let below = walsh.iter().filter(|average| **average + rounding < bound).count();
                tail_of_ranks(*blocks, below)
            }
        }
    }

    /// Probability of a difference at least as great were there none, to either side.
    pub fn p_different(&self) -> f64 {
        (2.0 * self.p_above(0.0).min(self.p_below(0.0))).min(1.0)
    }

    /// Both ends of the interval that holds ln(B / A) with probability 1 - `error`; infinite where the blocks are too
    /// few for one.
    pub fn interval(&self, error: f64) -> [f64; 2] {
        match self {
            Evidence::Welch { estimate, error: deviation, freedom, .. } => {
                let half = quantile(1.0 - 0.5 * error, *freedom) * deviation;
                [estimate - half, estimate + half]
            }
            Evidence::SignedRanks { walsh, blocks, rounding } => {
                // The k smallest and k greatest averages lie outside, for the greatest k that the error allows.
                let outside = rank_distribution(*blocks).take_while(|&tail| tail <= 0.5 * error).count();
                match outside {
                    0 => [f64::NEG_INFINITY, f64::INFINITY],
                    k => [walsh[k - 1] - rounding, walsh[walsh.len() - k] + rounding],
                }
            }
        }
    }

    /// Least probability that so many processes a side, or blocks, can give to one side: of ranks there are finitely many.
    pub(super) fn least_p(&self, count: usize) -> f64 {
        match self {
            Evidence::Welch { .. } => 0.0,
            Evidence::SignedRanks { .. } => 0.5_f64.powi(i32::try_from(count).unwrap_or(i32::MAX)),
        }
    }

    /// The same evidence as `factor` times as many processes or blocks would give it, to foretell how many are needed.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        match self {
            Evidence::Welch { estimate, error, rounding, freedom } => {
                let of_processes = (error * error - rounding * rounding).max(0.0);
                Evidence::Welch {
                    estimate: *estimate,
                    error: (of_processes / factor + rounding * rounding).sqrt(),
                    rounding: *rounding,
                    freedom: (freedom + 2.0) * factor - 2.0,
                }
            }
            Evidence::SignedRanks { walsh, blocks, rounding } => {
                // A normal law of the same quartiles stands for the averages.
                let at = |fraction: f64| walsh[((walsh.len() - 1) as f64 * fraction) as usize];
                let deviation = (at(0.75) - at(0.25)) / 1.349 * std::f64::consts::SQRT_2;
                let blocks = *blocks as f64 * factor;
                // As uncertain as a uniform law over all that the steps may have moved it by.
                let rounding = rounding / 3.0_f64.sqrt();
                Evidence::Welch {
                    estimate: self.estimate(),
                    error: (deviation / blocks.sqrt()).hypot(rounding),
                    rounding,
                    freedom: (blocks - 1.0).max(1.0),
                }
            }
        }
    }
}

/// Squared standard error of a mean, with its degrees of freedom.
struct Spread {
    squared: f64,
    freedom: f64,
}

fn mean_and_error(values: &[f64]) -> Option<(f64, Spread)> {
    if values.len() < 2 {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squared = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0) / count;
    Some((mean, Spread { squared, freedom: count - 1.0 }))
}

/// P(T > t) of Student's t.
fn upper_tail(t: f64, freedom: f64) -> f64 {
    // No spread at all: 0 / 0 says nothing.
    if t.is_nan() {
        return 1.0;
    }
    if t.is_infinite() {
        return if t > 0.0 { 0.0 } else { 1.0 };
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |law| law.sf(t))
}

fn quantile(probability: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(probability))
}

/// P(W >= `sum`) of the sum of the ranks of positive differences among `blocks`, were they symmetric about 0.
fn tail_of_ranks(blocks: usize, sum: usize) -> f64 {
    let greatest = blocks * (blocks + 1) / 2;
    rank_distribution(blocks).nth(greatest - sum.min(greatest)).unwrap_or(1.0)
}

/// P(W <= w) for w = 0, 1, ... up to the greatest sum: of the 2^n sets of ranks, those whose sum is at most w.
fn rank_distribution(blocks: usize) -> impl Iterator<Item = f64> {
    let greatest = blocks * (blocks + 1) / 2;
    let mut probability = vec![0.0; greatest + 1];
    probability[0] = 1.0;
    for rank in 1..=blocks {
        for sum in (0..=greatest).rev() {
            let without = probability[sum];
            let with = if sum >= rank { probability[sum - rank] } else { 0.0 };
            probability[sum] = 0.5 * (without + with);
        }
    }
    probability.into_iter().scan(0.0, |total, p| {
        *total += p;
        Some(*total)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 2e-4, "{found} for {expected}");
    }

    #[test]
    fn welch_agrees_with_a_worked_example() {
        // Two samples of the usual example of unequal variances; t, freedom, p and interval by SciPy.
        let a = [27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4];
        let b = [27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 30.5, 24.8];
        let evidence = Evidence::welch(&a, &b).unwrap();
        let Evidence::Welch { estimate, error, freedom, .. } = evidence else { panic!("{evidence:?}") };
        near(estimate / error, 2.87463);
        near(freedom, 27.9004);
        near(evidence.p_different(), 0.007656);
        let [low, high] = evidence.interval(0.05);
        near(low, 0.82169);
        near(high, 4.89831);
        near(evidence.p_above(low), 0.025);
        near(evidence.p_below(high), 0.025);
    }

    #[test]
    fn signed_ranks_meet_their_tables() {
        // Of 8 blocks the two-sided 5 % point is a sum of 3, of 10 it is 8 (published tables of the test).
        for (blocks, sum) in [(8, 3), (10, 8)] {
            let tails: Vec<f64> = rank_distribution(blocks).collect();
            assert!(tails[sum] <= 0.025 && tails[sum + 1] > 0.025, "{blocks}: {tails:?}");
            near(tails[tails.len() - 1], 1.0);
        }
        // All of five above: 1 in 32.
        let evidence = Evidence::signed_ranks(&[0.1, 0.2, 0.3, 0.4, 0.5]).unwrap();
        near(evidence.p_above(0.0), 1.0 / 32.0);
        near(evidence.p_below(0.0), 1.0);
        near(evidence.estimate(), 0.3);
        assert_eq!(evidence.interval(0.05), [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(evidence.interval(0.0625), [0.1, 0.5]);
    }

    #[test]
    fn tests_and_intervals_agree() {
        let differences: Vec<f64> = (0..20).map(|n| ((n * 37) % 19) as f64 * 0.01 - 0.05).collect();
        let evidence = Evidence::signed_ranks(&differences).unwrap();
        let [low, high] = evidence.interval(0.05);
        assert!(evidence.p_above(low - 1e-9) <= 0.025 && evidence.p_above(low + 1e-9) > 0.025 - 1e-9);
        assert!(evidence.p_below(high + 1e-9) <= 0.025);
    }

    /// All processes of a side read one number, which stands for any within its step.
    #[test]
    fn equal_readings_are_as_certain_as_their_clock() {
        let steps = [0.04; 2];
        let apart = |steps_apart: f64| Evidence::welch_of_steps(&[0.0; 2], &[0.04 * steps_apart; 2], steps).unwrap();
        let error = |evidence: &Evidence| match evidence {
            Evidence::Welch { error, .. } => *error,
            Evidence::SignedRanks { .. } => f64::NAN,
        };
        let one = apart(1.0);
        near(error(&one), 0.04 / 6.0_f64.sqrt());
        near(error(&one.scaled(100.0)), error(&one));
        assert!(one.p_different() > 0.1, "{one:?}");
        assert!(apart(20.0).p_different() < 0.01);
        near(apart(0.0).p_different(), 1.0);
        // Where processes differ by more, the steps are nothing.
        let [plain, stepped] = [[0.0; 2], [1e-4; 2]].map(|steps| {
            let evidence = Evidence::welch_of_steps(&[0.0, 0.1, 0.05], &[0.2, 0.3, 0.25], steps).unwrap();
            evidence.p_different()
        });
        near(plain, stepped);
    }

    #[test]
    fn too_few_are_no_evidence() {
        assert_eq!(Evidence::welch(&[1.0], &[1.0, 2.0]), None);
        assert_eq!(Evidence::signed_ranks(&[1.0]), None);
        let equal = Evidence::welch(&[1.0, 1.0], &[1.0, 1.0]).unwrap();
        assert_eq!(equal.p_different(), 1.0);
        let certain = Evidence::welch(&[1.0, 1.0], &[2.0, 2.0]).unwrap();
        assert_eq!(certain.p_above(0.5), 0.0);
    }
}

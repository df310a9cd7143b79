//! The ratio of two methods that one process measured in turn, frame by frame.
//!
//! Drift hits both alike, so the noise of frames is all that an interval has to cover. Frames are not independent
//! (clocks, caches and neighbours drift), so they are resampled in blocks long enough to keep their autocorrelation, the
//! same blocks on both sides.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::decision::CONFIDENCE;
use crate::measure::statistics::{median, percentile};

/// Fewer samples a side say nothing of their noise.
const LEAST_SAMPLES: usize = 5;
/// Resamples of the frames.
const RESAMPLES: usize = 1000;
/// Any fixed number: the same records always give the same interval.
const SEED: u64 = 0x66_75_6d_61_72_6f_6c_65;

/// Two medians and B / A with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Median of the one method in milliseconds.
    pub a_median_ms: f64,
    /// Median of the other.
    pub b_median_ms: f64,
    /// `b_median_ms / a_median_ms`: below 1 where B is faster.
    pub ratio: f64,
    /// Lower and upper end, of [`CONFIDENCE`]; absent with too few samples to tell their noise.
    pub interval: Option<[f64; 2]>,
}

/// The ratio B / A of two methods measured in one process, alternating frame by frame. Absent without samples, and where
/// a median is not positive.
pub fn ratio_within_process(a: &[f64], b: &[f64]) -> Option<Ratio> {
    let positive = |samples: &[f64]| median(samples).filter(|median| *median > 0.0);
    let (a_median_ms, b_median_ms) = (positive(a)?, positive(b)?);
    Some(Ratio { a_median_ms, b_median_ms, ratio: b_median_ms / a_median_ms, interval: interval(a, b) })
}

fn interval(a: &[f64], b: &[f64]) -> Option<[f64; 2]> {
    if a.len().min(b.len()) < LEAST_SAMPLES {
        return None;
    }
    let block_length = block_length(&residuals(&[a, b])?);
    let (a_draws, b_draws) = (resampled_log_medians(a, block_length), resampled_log_medians(b, block_length));
    let mut differences: Vec<f64> = b_draws.iter().zip(&a_draws).map(|(b, a)| b - a).collect();
    differences.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let bound = |fraction: f64| percentile(&differences, fraction).map(f64::exp);
    Some([bound(tail)?, bound(1.0 - tail)?])
}

/// Residuals of each side's samples, as fractions of its median, less what both have in common: frames differ by
/// content, and content is no noise. Frames are matched by their place, which needs equally many on each side.
fn residuals(sides: &[&[f64]]) -> Option<Vec<Vec<f64>>> {
    let mut residuals: Vec<Vec<f64>> = vec![];
    for samples in sides {
        let center = median(samples).filter(|center| *center > 0.0)?;
        residuals.push(samples.iter().map(|x| x / center).collect());
    }
    let length = residuals.first()?.len();
    if residuals.iter().all(|series| series.len() == length) {
        for frame in 0..length {
            let times: Vec<f64> = residuals.iter().map(|series| series[frame]).collect();
            let shared = median(&times)?;
            for series in &mut residuals {
                series[frame] -= shared;
            }
        }
    }
    Some(residuals)
}

/// The block length for the circular bootstrap that the autocorrelation calls for, between 1 and a third of the
/// shortest series: Politis and White (2004) with the correction of Patton, Politis and White (2009), on the
/// autocovariance averaged over the series.
fn block_length(series: &[Vec<f64>]) -> usize {
    let count = series.iter().map(Vec::len).min().unwrap_or(0);
    let n = count as f64;
    let run = 5.max(n.log10().sqrt().ceil() as usize);
    let longest = (3.0 * n.sqrt()).min(n / 3.0).floor().max(1.0);
    let last_lag = (n.sqrt().ceil() as usize + run).min(count.saturating_sub(1));
    let covariances: Vec<f64> =
        (0..=last_lag).map(|lag| mean(&series.iter().map(|s| autocovariance(s, lag)).collect::<Vec<_>>())).collect();
    let variance = covariances[0];
    if variance <= 0.0 || last_lag <= run {
        return 1;
    }
    // The lag after which a whole run of correlations cannot be told from none.
    let negligible = 2.0 * (n.log10() / n).sqrt() * variance;
    let vanished = (0..=last_lag - run).find(|&lag| {
        let following = &covariances[lag + 1..=lag + run];
        following.iter().all(|c| c.abs() < negligible)
    });
    let bandwidth = (2 * vanished.unwrap_or(last_lag - run)).clamp(1, last_lag);
    let (mut weighted, mut spectrum) = (0.0, variance);
    for (lag, covariance) in covariances.iter().enumerate().take(bandwidth + 1).skip(1) {
        let position = lag as f64 / bandwidth as f64;
        let window = (2.0 * (1.0 - position)).min(1.0);
        weighted += 2.0 * window * lag as f64 * covariance;
        spectrum += 2.0 * window * covariance;
    }
    let length = (1.5 * (weighted / spectrum).powi(2) * n).cbrt();
    // A spectrum of zero leaves no finite length; the longest is the careful choice.
    if length.is_finite() { length.ceil().clamp(1.0, longest) as usize } else { longest as usize }
}

fn autocovariance(series: &[f64], lag: usize) -> f64 {
    let center = mean(series);
    let pairs = series.iter().zip(series.iter().skip(lag));
    pairs.map(|(x, y)| (x - center) * (y - center)).sum::<f64>() / series.len() as f64
}

/// Logarithms of the medians of [`RESAMPLES`] circular block resamples of one side.
///
/// Each side starts from the same seed: sides with equally many frames get the same blocks, so that what the
/// frames' content adds is the same on both sides and leaves the ratio.
fn resampled_log_medians(samples: &[f64], block_length: usize) -> Vec<f64> {
    let count = samples.len();
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mut drawn = Vec::with_capacity(count + block_length);
    (0..RESAMPLES)
        .map(|_| {
            drawn.clear();
            while drawn.len() < count {
                let start = below(&mut random, count);
                drawn.extend(samples.iter().cycle().skip(start).take(block_length));
            }
            drawn.truncate(count);
            // A block of zeros has no logarithm; the smallest number stands for it and keeps the interval's end open.
            median_in_place(&mut drawn).max(f64::MIN_POSITIVE).ln()
        })
        .collect()
}

/// The median of at least one sample, which are reordered: sorting would take most of a comparison's time.
fn median_in_place(samples: &mut [f64]) -> f64 {
    let middle = samples.len() / 2;
    let even = samples.len().is_multiple_of(2);
    let (below, upper, _) = samples.select_nth_unstable_by(middle, f64::total_cmp);
    let upper = *upper;
    if even {
        let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        0.5 * (lower + upper)
    } else {
        upper
    }
}

/// A uniform index below `bound`, which is small enough that the method's bias of `bound / 2^64` is nothing.
fn below(random: &mut Pcg64Mcg, bound: usize) -> usize {
    ((u128::from(random.next_u64()) * bound as u128) >> 64) as usize
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Noise;
    use super::*;

    #[test]
    fn blocks_are_as_long_as_the_correlation() {
        let series = |correlation: f64| {
            let mut noise = Noise::new(1);
            (0..5).map(|_| noise.autoregressive(400, correlation)).collect::<Vec<_>>()
        };
        assert!(block_length(&series(0.0)) <= 4);
        let long = block_length(&series(0.9));
        assert!((15..=60).contains(&long), "{long}");
        assert_eq!(block_length(&[vec![1.0; 50]]), 1);
        assert_eq!(block_length(&[vec![1.0, 2.0]]), 1);
    }

    #[test]
    fn content_shared_by_both_sides_leaves_the_ratio() {
        let content: Vec<f64> = (0..200).map(|frame| 5.0 + 0.05 * f64::from(frame)).collect();
        let slower: Vec<f64> = content.iter().map(|x| 1.1 * x).collect();
        let found = ratio_within_process(&content, &slower).unwrap();
        let [low, high] = found.interval.unwrap();
        for value in [found.ratio, low, high] {
            assert!((value - 1.1).abs() < 1e-9, "{value}");
        }
    }

    #[test]
    fn swapping_the_sides_inverts_the_ratio() {
        let mut noise = Noise::new(3);
        let [a, b] = [0, 1].map(|_| noise.frame_times(100, 5.0, 0.03));
        let (there, back) = (ratio_within_process(&a, &b).unwrap(), ratio_within_process(&b, &a).unwrap());
        assert!((there.ratio * back.ratio - 1.0).abs() < 1e-12);
        assert!((there.interval.unwrap()[0] * back.interval.unwrap()[1]).ln().abs() < 0.02);
        assert_eq!(Some(there), ratio_within_process(&a, &b));
    }

    #[test]
    fn medians_agree_with_the_plain_ones() {
        let mut noise = Noise::new(4);
        for count in [1, 2, 3, 10, 11] {
            let mut samples = noise.autoregressive(count, 0.0);
            assert_eq!(median(&samples), Some(median_in_place(&mut samples)));
        }
    }

    #[test]
    fn nothing_has_no_ratio() {
        let times = [1.0, 2.0];
        assert!(ratio_within_process(&[], &times).is_none());
        assert!(ratio_within_process(&times, &[]).is_none());
        assert!(ratio_within_process(&times, &[0.0, 0.0, 1.0]).is_none());
        let partly_zero = ratio_within_process(&[1.0; 5], &[0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
        assert!(partly_zero.interval.unwrap().iter().all(|bound| bound.is_finite()));
    }

    /// A resample of one frame is that frame: an interval of no width would be a certainty that nobody has.
    #[test]
    fn few_samples_have_a_ratio_and_no_interval() {
        let times = [1.0, 1.1, 0.9, 1.05, 0.95];
        for (a, b) in [(1, 1), (4, 4), (4, 5), (5, 4)] {
            let found = ratio_within_process(&times[..a], &times[..b]).unwrap();
            assert!(found.ratio > 0.0 && found.interval.is_none(), "{a} {b}: {found:?}");
        }
        assert!(ratio_within_process(&times, &times).unwrap().interval.is_some());
    }
}

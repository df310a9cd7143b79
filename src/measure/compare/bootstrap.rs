//! The interval of a ratio of medians, by resampling processes and then blocks of consecutive frames.
//!
//! Frames of one process are not independent (clocks, caches and neighbours drift), and processes differ from each
//! other by more than their frames tell (memory layout, thread placement). So processes are drawn with replacement,
//! and the frames of each in blocks long enough to keep their autocorrelation. With few processes such an interval is
//! too narrow twice over: the spread of k drawn processes is short by √((k - 1) / k), and k processes know their own
//! spread badly. Its two halves are therefore widened by √(k / (k - 1)) and by Student's t with k - 1 degrees of
//! freedom over the normal quantile, k being the smaller number of processes of the two sides.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::Ratio;
use crate::measure::statistics::{median, percentile};

/// Probability with which the interval should contain the true ratio.
pub const CONFIDENCE: f64 = 0.95;
/// Draws of processes.
pub const RESAMPLES: usize = 10_000;

/// Draws of frame blocks in each process, from which the draws of processes choose.
const FRAME_RESAMPLES: usize = 500;
/// Any fixed number: the same records always give the same interval.
const SEED: u64 = 0x66_75_6d_61_72_6f_6c_65;

/// Compares two sides, each with the samples of one measured time per process. Absent when a side has no process, a
/// process has no samples, or a median is not positive, so that no ratio exists. With one process on a side the
/// interval knows the noise of frames only.
pub(super) fn estimate(a: &[Vec<f64>], b: &[Vec<f64>]) -> Option<Ratio> {
    let a_log = log_medians(a)?;
    let b_log = log_medians(b)?;
    let center = mean(&b_log) - mean(&a_log);
    let block_length = block_length(&residuals(a.iter().chain(b))?);
    let draws_of = |side: &[Vec<f64>]| -> Vec<Vec<f64>> {
        side.iter().map(|samples| resampled_log_medians(samples, block_length)).collect()
    };
    let (a_draws, b_draws) = (draws_of(a), draws_of(b));
    let mut random = Pcg64Mcg::seed_from_u64(SEED + 1);
    let mut differences: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let frames = below(&mut random, FRAME_RESAMPLES);
            let b_draw = mean_of_drawn_processes(&b_draws, frames, &mut random);
            b_draw - mean_of_drawn_processes(&a_draws, frames, &mut random)
        })
        .collect();
    differences.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let widening = small_sample_widening(a.len().min(b.len()));
    let bound = |fraction: f64| {
        let bound = percentile(&differences, fraction)?;
        Some((center + widening * (bound - center)).exp())
    };
    Some(Ratio {
        a_median_ms: mean(&a_log).exp(),
        b_median_ms: mean(&b_log).exp(),
        ratio: center.exp(),
        interval: [bound(tail)?, bound(1.0 - tail)?],
        block_length,
    })
}

fn log_medians(side: &[Vec<f64>]) -> Option<Vec<f64>> {
    if side.is_empty() {
        return None;
    }
    let medians = side.iter().map(|samples| median(samples));
    medians.map(|median| median.filter(|m| *m > 0.0).map(f64::ln)).collect()
}

/// Residuals of each process's samples, as fractions of its median, less what all processes have in common: frames
/// differ by content, and content is no noise. Frames are matched by their place, which needs equally many in every
/// process.
fn residuals<'a>(processes: impl Iterator<Item = &'a Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let mut residuals: Vec<Vec<f64>> = vec![];
    for samples in processes {
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

/// Logarithms of the medians of [`FRAME_RESAMPLES`] circular block resamples of one process.
///
/// Every process starts from the same seed: processes with equally many frames get the same blocks, so that what the
/// frames' content adds is the same on both sides and leaves the ratio.
fn resampled_log_medians(samples: &[f64], block_length: usize) -> Vec<f64> {
    let count = samples.len();
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mut drawn = Vec::with_capacity(count + block_length);
    (0..FRAME_RESAMPLES)
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

fn mean_of_drawn_processes(draws: &[Vec<f64>], frames: usize, random: &mut Pcg64Mcg) -> f64 {
    let total: f64 = (0..draws.len()).map(|_| draws[below(random, draws.len())][frames]).sum();
    total / draws.len() as f64
}

/// A uniform index below `bound`, which is small enough that the method's bias of `bound / 2^64` is nothing.
fn below(random: &mut Pcg64Mcg, bound: usize) -> usize {
    ((u128::from(random.next_u64()) * bound as u128) >> 64) as usize
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// See the module's page. One process leaves nothing to correct by.
fn small_sample_widening(processes: usize) -> f64 {
    if processes < 2 {
        return 1.0;
    }
    let k = processes as f64;
    (k / (k - 1.0)).sqrt() * student_t_975(processes - 1) / NORMAL_975
}

const NORMAL_975: f64 = 1.959_963_985;

/// 97.5 % quantile of Student's t: tabulated, then its expansion in 1 / freedom (Abramowitz and Stegun, 26.7.5).
fn student_t_975(freedom: usize) -> f64 {
    const TABLE: [f64; 10] = [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281];
    if let Some(tabulated) = TABLE.get(freedom.saturating_sub(1)) {
        return *tabulated;
    }
    let (z, v) = (NORMAL_975, freedom as f64);
    let terms = [
        z,
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| sum / v + term)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Noise;
    use super::*;

    #[test]
    fn student_t_meets_its_tables() {
        for (freedom, expected) in [(1, 12.7062), (10, 2.2281), (11, 2.2010), (30, 2.0423)] {
            assert!((student_t_975(freedom) - expected).abs() < 1e-3, "{freedom}");
        }
    }

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
    fn content_shared_by_all_processes_leaves_the_ratio() {
        let content: Vec<f64> = (0..200).map(|frame| 5.0 + 0.05 * f64::from(frame)).collect();
        let slower: Vec<f64> = content.iter().map(|x| 1.1 * x).collect();
        let found = estimate(&[content], &[slower]).unwrap();
        for value in [found.ratio, found.interval[0], found.interval[1]] {
            assert!((value - 1.1).abs() < 1e-9, "{value}");
        }
    }

    #[test]
    fn swapping_the_sides_inverts_the_ratio() {
        let mut noise = Noise::new(3);
        let sides: Vec<Vec<f64>> = (0..6).map(|_| noise.frame_times(100, 5.0, 0.03)).collect();
        let there = estimate(&sides[..3], &sides[3..]).unwrap();
        let back = estimate(&sides[3..], &sides[..3]).unwrap();
        assert!((there.ratio * back.ratio - 1.0).abs() < 1e-12);
        assert!((there.interval[0] * back.interval[1]).ln().abs() < 0.02);
        assert_eq!(there, estimate(&sides[..3], &sides[3..]).unwrap());
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
    fn what_has_no_ratio_has_no_estimate() {
        let of = |samples: &[f64]| vec![samples.to_vec()];
        let times = of(&[1.0, 2.0]);
        assert!(estimate(&[], &times).is_none());
        assert!(estimate(&times, &of(&[])).is_none());
        assert!(estimate(&times, &of(&[0.0, 0.0, 1.0])).is_none());
        let partly_zero = estimate(&times, &of(&[0.0, 1.0, 1.0])).unwrap();
        assert!(partly_zero.interval.iter().all(|bound| bound.is_finite()));
    }
}

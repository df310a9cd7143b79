//! Descriptive statistics of raw samples. Samples are never trimmed.

use crate::report::record::Summary;

/// Fewest samples of which a 95th percentile means something: one in twenty lies above it.
pub const P95_MIN_SAMPLES: usize = 20;
/// Fewest samples of which a 99th percentile means something.
pub const P99_MIN_SAMPLES: usize = 100;

/// Times this, the MAD of normally distributed samples is their standard deviation: 1 / Φ⁻¹(3/4).
pub const MAD_TO_DEVIATION: f64 = 1.482_602_218_505_602;

/// The middle sample, or the mean of the middle two; absent for no samples.
pub fn median(samples: &[f64]) -> Option<f64> {
    percentile(&sorted(samples), 0.5)
}

/// The plain median absolute deviation from the median, not scaled; absent for fewer than 2 samples.
/// [`MAD_TO_DEVIATION`] scales it to a standard deviation.
pub fn mad(samples: &[f64]) -> Option<f64> {
    if samples.len() < 2 {
        return None;
    }
    let center = median(samples)?;
    let deviations: Vec<f64> = samples.iter().map(|x| (x - center).abs()).collect();
    median(&deviations)
}

/// The value below which `fraction` (0 to 1) of ascending samples lie, interpolated linearly between the neighbours of
/// position `fraction * (n - 1)` (type 7 of Hyndman and Fan, 1996; the default of R and NumPy); absent for no samples.
pub fn percentile(ascending: &[f64], fraction: f64) -> Option<f64> {
    let last = ascending.len().checked_sub(1)?;
    let position = fraction.clamp(0.0, 1.0) * last as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(last);
    let weight = position - below as f64;
    Some(ascending[below] + weight * (ascending[above] - ascending[below]))
}

/// Raw samples and what they come to. Absent for no samples, and when one is not finite: such a time was not measured.
pub fn summarize(samples: &[f64]) -> Option<Summary> {
    if !samples.iter().all(|sample| sample.is_finite()) {
        return None;
    }
    let ascending = sorted(samples);
    let from = |fewest: usize, fraction: f64| percentile(&ascending, fraction).filter(|_| samples.len() >= fewest);
    Some(Summary {
        min: *ascending.first()?,
        median: percentile(&ascending, 0.5)?,
        mean: samples.iter().sum::<f64>() / samples.len() as f64,
        p95: from(P95_MIN_SAMPLES, 0.95),
        p99: from(P99_MIN_SAMPLES, 0.99),
        max: *ascending.last()?,
        mad: mad(samples),
        samples: samples.to_vec(),
    })
}

/// Noise of samples that should all be equal: their scaled MAD as a fraction of their median (0.03 is 3 %). Absent for
/// fewer than 2 samples or a median that is not positive.
pub fn relative_mad(samples: &[f64]) -> Option<f64> {
    let center = median(samples).filter(|center| *center > 0.0)?;
    Some(MAD_TO_DEVIATION * mad(samples)? / center)
}

/// Noise across repetitions of the same frames, as a fraction of the frame's time: what differs between frames by
/// content is no noise. `samples` holds whole repetitions of `frames` frames, one after the other.
///
/// The deviations of every sample from its frame's mean are pooled; the factor √(r / (r - 1)) makes up for that mean
/// being taken from the same r samples. Absent for fewer than 2 repetitions, an incomplete one, or a frame whose mean
/// is not positive.
pub fn repetition_noise(samples: &[f64], frames: usize) -> Option<f64> {
    if frames == 0 || !samples.len().is_multiple_of(frames) {
        return None;
    }
    let repetitions = samples.len() / frames;
    if repetitions < 2 {
        return None;
    }
    let mut deviations = Vec::with_capacity(samples.len());
    for frame in 0..frames {
        let times = || samples.iter().skip(frame).step_by(frames);
        let mean = times().sum::<f64>() / repetitions as f64;
        if mean <= 0.0 {
            return None;
        }
        deviations.extend(times().map(|time| (time / mean - 1.0).abs()));
    }
    let count = repetitions as f64;
    Some(MAD_TO_DEVIATION * (count / (count - 1.0)).sqrt() * median(&deviations)?)
}

fn sorted(samples: &[f64]) -> Vec<f64> {
    let mut ascending = samples.to_vec();
    ascending.sort_by(f64::total_cmp);
    ascending
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_mad_by_hand() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(mad(&[5.0]), None);
        assert_eq!(mad(&[1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9.0]), Some(1.0));
    }

    #[test]
    fn percentiles_interpolate_as_numpy_does() {
        let ascending = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(percentile(&ascending, 0.0), Some(1.0));
        assert_eq!(percentile(&ascending, 1.0), Some(8.0));
        assert_eq!(percentile(&ascending, 0.5), Some(3.0));
        assert!((percentile(&ascending, 0.95).unwrap() - 7.4).abs() < 1e-12);
        assert_eq!(percentile(&[], 0.5), None);
    }

    #[test]
    fn a_summary_has_only_what_its_samples_support() {
        assert_eq!(summarize(&[]), None);
        assert_eq!(summarize(&[1.0, f64::NAN]), None);
        let one = summarize(&[2.0]).unwrap();
        assert_eq!((one.min, one.median, one.mean, one.max), (2.0, 2.0, 2.0, 2.0));
        assert_eq!((one.p95, one.p99, one.mad), (None, None, None));
        let of = |count: u32| {
            let samples: Vec<f64> = (0..count).rev().map(f64::from).collect();
            summarize(&samples).unwrap()
        };
        assert_eq!(of(19).p95, None);
        assert!((of(20).p95.unwrap() - 18.05).abs() < 1e-12);
        assert_eq!(of(99).p99, None);
        assert!((of(100).p99.unwrap() - 98.01).abs() < 1e-12);
        assert_eq!(of(3).samples, [2.0, 1.0, 0.0], "the order is kept");
    }

    #[test]
    fn relative_mad_estimates_the_standard_deviation() {
        // Φ⁻¹ at equally spaced probabilities is a normal sample without randomness; here from its quartiles.
        let quartile = 1.0 / MAD_TO_DEVIATION;
        let samples = [-quartile, -quartile, 0.0, quartile, quartile].map(|x| 10.0 + 0.3 * x);
        assert!((relative_mad(&samples).unwrap() - 0.03).abs() < 1e-9);
        assert_eq!(relative_mad(&[0.0, 0.0]), None);
    }

    #[test]
    fn content_is_no_noise() {
        let frames = [1.0, 5.0, 20.0];
        let quiet: Vec<f64> = frames.repeat(3);
        assert!(repetition_noise(&quiet, 3).unwrap() < 1e-12);
        assert!(relative_mad(&quiet).unwrap() > 0.5);
        let two = [0.99, 4.95, 19.8, 1.01, 5.05, 20.2];
        let expected = MAD_TO_DEVIATION * 2_f64.sqrt() * 0.01;
        assert!((repetition_noise(&two, 3).unwrap() - expected).abs() < 1e-9);
        assert_eq!(repetition_noise(&frames, 3), None);
        assert_eq!(repetition_noise(&two, 4), None);
    }
}

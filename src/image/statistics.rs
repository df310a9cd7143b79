//! Statistics of the values of a target, without those that stand for none.

use super::view::kept;

/// Statistics of values. What is not finite, and sentinels as [`Ramp`](super::Ramp) knows them, count apart.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statistics {
    /// Values that count.
    pub count: u64,
    /// Values that are not finite.
    pub not_finite: u64,
    /// Values that are sentinels.
    pub masked: u64,
    /// The sentinels, each once.
    pub sentinels: Vec<f64>,
    /// Smallest and largest value, and the arithmetic mean; `None` where none counts.
    pub range_and_mean: Option<(f64, f64, f64)>,
    /// Values below which, of all that count, lie the wanted percentages; empty where none counts.
    pub percentiles: Vec<f64>,
    /// Counts in bins of equal width over the range; the last takes its end in.
    pub histogram: Vec<u64>,
}

impl Statistics {
    /// Statistics of `values` with the wanted percentiles, 0 to 100, and number of bins.
    pub fn of(values: impl Iterator<Item = f64>, percentiles: &[f64], bins: usize) -> Self {
        let mut not_finite = 0;
        let mut ascending: Vec<f64> =
            values.inspect(|v| not_finite += u64::from(!v.is_finite())).filter(|v| v.is_finite()).collect();
        ascending.sort_unstable_by(f64::total_cmp);
        let range = kept(&ascending);
        let masked = [&ascending[..range.start], &ascending[range.end..]];
        let sentinels = masked.iter().filter_map(|values| values.first().copied()).collect();
        let masked = masked.iter().map(|values| values.len() as u64).sum();
        let kept = &ascending[range];
        let (Some(&min), Some(&max)) = (kept.first(), kept.last()) else {
            return Statistics { not_finite, histogram: vec![0; bins], ..Statistics::default() };
        };
        let last = kept.len() - 1;
        // As many values beyond either end as a ramp leaves out.
        let beyond = |percent: f64| ((percent * kept.len() as f64 / 100.0 + 1e-9) as usize).min(last);
        let at = |percent: f64| if percent <= 50.0 { beyond(percent) } else { last - beyond(100.0 - percent) };
        let mut histogram = vec![0; bins];
        let scale = if max > min { bins as f64 / (max - min) } else { 0.0 };
        for value in kept {
            let bin = ((value - min) * scale) as usize;
            if let Some(count) = histogram.get_mut(bin.min(bins.saturating_sub(1))) {
                *count += 1;
            }
        }
        Statistics {
            count: kept.len() as u64,
            not_finite,
            masked,
            sentinels,
            range_and_mean: Some((min, max, kept.iter().sum::<f64>() / kept.len() as f64)),
            percentiles: percentiles.iter().map(|&percent| kept[at(percent)]).collect(),
            histogram,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentinels_and_what_is_not_finite_count_apart() {
        let values = (0..1000).map(f64::from).chain([-1e30, -1e30, f64::NAN, f64::INFINITY]);
        let found = Statistics::of(values, &[0.0, 0.1, 50.0, 99.9, 100.0], 10);
        assert_eq!((found.count, found.not_finite, found.masked), (1000, 2, 2));
        assert_eq!(found.sentinels, [-1e30]);
        assert_eq!(found.range_and_mean, Some((0.0, 999.0, 499.5)));
        assert_eq!(found.percentiles, [0.0, 1.0, 500.0, 998.0, 999.0]);
        assert_eq!(found.histogram, [100; 10]);
    }

    #[test]
    fn of_nothing_and_of_one_value_there_are_statistics_too() {
        let none = Statistics::of([f64::NAN].into_iter(), &[50.0], 2);
        assert_eq!((none.count, none.not_finite, none.range_and_mean, none.histogram), (0, 1, None, vec![0, 0]));
        let one = Statistics::of([7.0, 7.0].into_iter(), &[0.0, 99.0], 2);
        assert_eq!((one.percentiles, one.histogram), (vec![7.0, 7.0], vec![2, 0]));
        assert_eq!(Statistics::of([0.0, 1.0].into_iter(), &[], 0).histogram, Vec::<u64>::new());
    }
}

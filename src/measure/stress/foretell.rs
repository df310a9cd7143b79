//! Time and memory of the next step, from the exponent of the steps before it.

use crate::report::stress::{Series, Step};

/// Exponents that a foretelling follows: what the last two steps say may be chance.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.0..=3.0;

/// A cost at `value` by the exponent of the last two steps; of one step, in proportion. None without a step that tells.
pub fn cost(
    series: &Series,
    value: f64,
    place: impl Fn(&Step) -> f64,
    of: impl Fn(&Step) -> Option<f64>,
) -> Option<f64> {
    let points: Vec<(f64, f64)> = series
        .steps
        .iter()
        .filter_map(|step| Some((place(step), of(step).filter(|cost| *cost > 0.0)?)))
        .filter(|(x, _)| *x > 0.0 && *x < value)
        .collect();
    let &(x, y) = points.last()?;
    let exponent = match points[..] {
        [.., (before, cost), _] if before < x => (y / cost).ln() / (x / before).ln(),
        _ => 1.0,
    };
    Some(y * (value / x).powf(exponent.clamp(*EXPONENTS.start(), *EXPONENTS.end())))
}

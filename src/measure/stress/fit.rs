//! The exponent of a cost, and the knee where it changes.
//!
//! Costs are fitted on logarithms: ln y = a + b ln x has the exponent b. A second model has a knee: two lines that meet
//! at ln k, with the exponents b and b + c. For each k on a grid the other three numbers follow by least squares; k is the
//! one of least error. Which model holds is decided by Akaike's criterion with its correction for few points (Hurvich and
//! Tsai, 1989), n ln(s^2) + 2p + 2p(p + 1) / (n - p - 1), where p counts the variance too: 3 numbers against 5. It asks
//! for at least eight points before it can find a knee, and for more where they scatter. Scatter below 1 % counts as 1 %,
//! so that no rounding is taken for a bend.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::report::stress::{Scaling, Segment};

/// Standard deviation that made or very quiet data are taken to have at least.
const LEAST_SCATTER: f64 = 0.01;
/// Places that a knee is tried at.
const GRID: usize = 128;
/// Points that a segment must have on its side of the knee.
const A_SIDE: usize = 3;

/// The exponent of `y` in `x`, or the two around a knee, each with its 95 % interval. `None` for fewer than two different
/// `x` among the points of positive finite numbers.
pub fn scaling(points: &[(f64, f64)]) -> Option<Scaling> {
    let is_usable = |&&(x, y): &&(f64, f64)| x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite();
    let mut logs: Vec<(f64, f64)> = points.iter().filter(is_usable).map(|&(x, y)| (x.ln(), y.ln())).collect();
    logs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (logs.first()?.0, logs.last()?.0);
    if last <= first {
        return None;
    }
    let line = Line::fit(&logs)?;
    let broken = Broken::fit(&logs).filter(|broken| broken.criterion(logs.len()) < line.criterion(logs.len()));
    let segment = |from: f64, to: f64, exponent: f64, error: f64, numbers: usize| {
        let half = half_width(error, logs.len().saturating_sub(numbers));
        Segment {
            from: from.exp(),
            to: to.exp(),
            exponent,
            interval: half.map(|half| [exponent - half, exponent + half]),
        }
    };
    let segments = match &broken {
        None => vec![segment(first, last, line.slope, line.error, 2)],
        Some(Broken { knee, slopes, errors, .. }) => {
            vec![segment(first, *knee, slopes[0], errors[0], 4), segment(*knee, last, slopes[1], errors[1], 4)]
        }
    };
    Some(Scaling { points: logs.len(), segments, knee: broken.map(|broken| broken.knee.exp()) })
}

/// Half of the 95 % interval; none without a degree of freedom.
fn half_width(error: f64, freedom: usize) -> Option<f64> {
    let law = StudentsT::new(0.0, 1.0, Some(freedom as f64).filter(|freedom| *freedom > 0.0)?).ok()?;
    Some(law.inverse_cdf(0.975) * error).filter(|half| half.is_finite())
}

fn criterion(squares: f64, count: usize, numbers: usize) -> f64 {
    let (n, p) = (count as f64, numbers as f64);
    if count <= numbers + 1 {
        return f64::INFINITY;
    }
    n * (squares / n).max(LEAST_SCATTER * LEAST_SCATTER).ln() + 2.0 * p + 2.0 * p * (p + 1.0) / (n - p - 1.0)
}

struct Line {
    slope: f64,
    error: f64,
    squares: f64,
}

impl Line {
    fn fit(logs: &[(f64, f64)]) -> Option<Self> {
        let n = logs.len() as f64;
        let (x, y) = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
        let spread: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
        let squares: f64 = logs.iter().map(|p| (p.1 - y - slope * (p.0 - x)).powi(2)).sum();
        let error = (squares / (n - 2.0).max(1.0) / spread).sqrt();
        slope.is_finite().then_some(Line { slope, error, squares })
    }

    fn criterion(&self, count: usize) -> f64 {
        criterion(self.squares, count, 3)
    }
}

struct Broken {
    knee: f64,
    slopes: [f64; 2],
    errors: [f64; 2],
    squares: f64,
}

impl Broken {
    fn fit(logs: &[(f64, f64)]) -> Option<Self> {
        let (low, high) = (logs.get(A_SIDE - 1)?.0, logs.get(logs.len().checked_sub(A_SIDE)?)?.0);
        let knees = (0..=GRID).map(|step| low + (high - low) * step as f64 / GRID as f64);
        let fits = knees.filter(|_| low < high).filter_map(|knee| Broken::at(knee, logs));
        fits.min_by(|a, b| a.squares.total_cmp(&b.squares))
    }

    fn at(knee: f64, logs: &[(f64, f64)]) -> Option<Self> {
        // About the knee: a + b u + c max(u, 0).
        let row = |x: f64| [1.0, x - knee, (x - knee).max(0.0)];
        let mut normal = [[0.0; 3]; 3];
        let mut right = [0.0; 3];
        for &(x, y) in logs {
            let row = row(x);
            for i in 0..3 {
                right[i] += row[i] * y;
                for j in 0..3 {
                    normal[i][j] += row[i] * row[j];
                }
            }
        }
        let inverse = inverted(normal)?;
        let [a, b, c] = inverse.map(|row| row.iter().zip(right).map(|(m, r)| m * r).sum::<f64>());
        let fitted = |x: f64| row(x).iter().zip([a, b, c]).map(|(r, f)| r * f).sum::<f64>();
        let squares: f64 = logs.iter().map(|&(x, y)| (y - fitted(x)).powi(2)).sum();
        let variance = squares / (logs.len() as f64 - 4.0).max(1.0);
        let after = inverse[1][1] + inverse[2][2] + 2.0 * inverse[1][2];
        let errors = [inverse[1][1], after].map(|factor| (variance * factor.max(0.0)).sqrt());
        Some(Broken { knee, slopes: [b, b + c], errors, squares })
    }

    fn criterion(&self, count: usize) -> f64 {
        criterion(self.squares, count, 5)
    }
}

/// The inverse of a symmetric matrix; none of a singular one.
fn inverted(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    let scale = m[0][0] * m[1][1] * m[2][2];
    if determinant.abs() <= 1e-12 * scale.abs() {
        return None;
    }
    Some([0, 1, 2].map(|i| [0, 1, 2].map(|j| cofactor(j, i) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;

    fn doubling(count: u32, y: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..count).map(|step| f64::from(1 << step) * 1000.0).map(|x| (x, y(x))).collect()
    }

    /// A factor whose logarithm has the standard deviation `scatter`, nearly normal: a sum of twelve.
    fn noise(random: &mut Random, scatter: f64) -> f64 {
        let sum: f64 = (0..12).map(|_| f64::from(random.unit())).sum();
        ((sum - 6.0) * scatter).exp()
    }

    #[test]
    fn a_power_is_found_exactly() {
        for exponent in [0.0, 0.5, 1.0, 2.0, -1.0] {
            let found = scaling(&doubling(10, |x| 3.0 * x.powf(exponent))).unwrap();
            assert_eq!((found.knee, found.segments.len(), found.points), (None, 1, 10));
            assert!((found.segments[0].exponent - exponent).abs() < 1e-9, "{found:?}");
            assert!((found.segments[0].from - 1000.0).abs() < 1e-6 && (found.segments[0].to - 512_000.0).abs() < 1e-3);
        }
    }

    #[test]
    fn too_few_points_say_little_and_what_is_no_cost_nothing() {
        let two = scaling(&[(1.0, 1.0), (2.0, 4.0)]).unwrap();
        assert!((two.segments[0].exponent - 2.0).abs() < 1e-12 && two.segments[0].interval.is_none());
        assert!(scaling(&[(1.0, 1.0), (2.0, 4.0), (4.0, 16.0)]).unwrap().segments[0].interval.is_some());
        assert_eq!(scaling(&[]), None);
        assert_eq!(scaling(&[(1.0, 1.0), (1.0, 2.0)]), None);
        assert_eq!(scaling(&[(1.0, 0.0), (2.0, f64::NAN), (0.0, 3.0), (4.0, 1.0)]), None);
    }

    #[test]
    fn a_knee_is_found_where_it_is() {
        for (before, after) in [(0.0, 1.0), (1.0, 2.0), (1.0, 0.0)] {
            let cost = |x: f64| if x < 24_000.0 { (x / 24_000.0).powf(before) } else { (x / 24_000.0).powf(after) };
            for count in [9, 10, 12] {
                let found = scaling(&doubling(count, cost)).unwrap();
                let knee = found.knee.unwrap_or_else(|| panic!("{before} {after} {count}: {found:?}"));
                assert!((knee / 24_000.0).ln().abs() < 0.3, "{before} {after} {count}: {knee}");
                assert!((found.segments[0].exponent - before).abs() < 0.1, "{found:?}");
                assert!((found.segments[1].exponent - after).abs() < 0.1, "{found:?}");
            }
            // Fewer points are no evidence.
            assert_eq!(scaling(&doubling(6, cost)).unwrap().knee, None);
        }
    }

    #[test]
    fn a_fixed_cost_under_a_growing_one_bends() {
        let found = scaling(&doubling(12, |x| 5.0 + x / 16_000.0)).unwrap();
        assert!((20_000.0..300_000.0).contains(&found.knee.unwrap()), "{found:?}");
        assert!(found.segments[0].exponent < 0.3 && found.segments[1].exponent > 0.75, "{found:?}");
    }

    #[test]
    fn intervals_hold_the_truth_and_noise_makes_no_knees() {
        let mut random = Random::new(7);
        let (mut held, mut knees) = (0, 0);
        const FAMILIES: u32 = 1_000;
        for family in 0..FAMILIES {
            let exponent = f64::from(family % 5) * 0.5;
            let points: Vec<(f64, f64)> = doubling(8 + family % 5, |x| x.powf(exponent))
                .iter()
                .map(|p| (p.0, p.1 * noise(&mut random, 0.05)))
                .collect();
            let found = scaling(&points).unwrap();
            knees += u32::from(found.knee.is_some());
            let [low, high] = found.segments[0].interval.unwrap();
            held += u32::from(low <= exponent && exponent <= high);
        }
        assert!(knees * 100 <= 5 * FAMILIES, "{knees} false knees in {FAMILIES}");
        assert!(held * 100 >= 92 * FAMILIES, "{held} intervals of {FAMILIES} hold the exponent");
    }

    #[test]
    fn a_knee_under_noise_is_found_with_points_enough() {
        let mut random = Random::new(11);
        let cost = |x: f64| (x / 32_000.0).max(1.0);
        let found = (0..200).filter(|_| {
            let points: Vec<(f64, f64)> =
                doubling(12, cost).iter().map(|p| (p.0, p.1 * noise(&mut random, 0.05))).collect();
            scaling(&points).unwrap().knee.is_some_and(|knee| (knee / 32_000.0).ln().abs() < 0.7)
        });
        assert!(found.count() >= 190);
    }
}

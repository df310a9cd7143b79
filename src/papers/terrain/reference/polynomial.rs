//! The first root of a polynomial on 0..1.

/// Halvings after which two roots count as one that touches.
const DEEPEST: u32 = 50;

/// The first s in 0..1 where the polynomial with these factors of 1, s, s², ... is no longer above 0.
pub(super) fn first_root(powers: &[f64]) -> Option<f64> {
    match *powers {
        [c, b, a] => first_root_quadratic(a, b, c),
        _ => first_root_bernstein(&bernstein(powers), 0.0, 1.0, 0),
    }
}

/// Of a s² + b s + c; no difference of near numbers is taken besides the discriminant.
fn first_root_quadratic(a: f64, b: f64, c: f64) -> Option<f64> {
    if c <= 0.0 {
        return Some(0.0);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -(b + b.signum() * discriminant.sqrt()) / 2.0;
    // With q = 0 both roots are 0 or there is none, and c > 0 excludes 0.
    let roots = [q / a, c / q];
    let inside = |s: &f64| (0.0..=1.0).contains(s);
    roots.into_iter().filter(inside).min_by(f64::total_cmp)
}

/// From powers to Bernstein factors of the same degree.
fn bernstein(powers: &[f64]) -> Vec<f64> {
    let n = powers.len() - 1;
    let binomial = |n: usize, k: usize| (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64);
    let factor = |k: usize| (0..=k).map(|i| binomial(k, i) / binomial(n, i) * powers[i]).sum();
    (0..=n).map(factor).collect()
}

/// Bernstein factors enclose the polynomial, and their changes of sign are at least as many as its roots: none is no
/// root, one is one root; anything else is halved, the nearer half first.
fn first_root_bernstein(factors: &[f64], from: f64, to: f64, depth: u32) -> Option<f64> {
    if factors[0] <= 0.0 {
        return Some(from);
    }
    if factors.iter().all(|&f| f > 0.0) {
        return None;
    }
    let changes = factors.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count();
    let single = changes == 1;
    if depth == DEEPEST {
        return (single || factors.iter().any(|f| *f <= 0.0)).then_some(to);
    }
    let (near, far) = split(factors);
    let middle = (from + to) / 2.0;
    if single && near[near.len() - 1] > 0.0 {
        return first_root_bernstein(&far, middle, to, depth + 1);
    }
    first_root_bernstein(&near, from, middle, depth + 1).or_else(|| first_root_bernstein(&far, middle, to, depth + 1))
}

/// De Casteljau's halves.
fn split(factors: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut row = factors.to_vec();
    let mut near = Vec::with_capacity(row.len());
    let mut far = Vec::with_capacity(row.len());
    while let (Some(&first), Some(&last)) = (row.first(), row.last()) {
        near.push(first);
        far.push(last);
        row = row.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
    }
    far.reverse();
    (near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers of the product of (s - root).
    fn with_roots(roots: &[f64], lead: f64) -> Vec<f64> {
        roots.iter().fold(vec![lead], |powers, root| {
            let mut product = vec![0.0; powers.len() + 1];
            for (i, p) in powers.iter().enumerate() {
                product[i + 1] += p;
                product[i] -= p * root;
            }
            product
        })
    }

    #[test]
    fn the_first_of_several_roots_is_found_in_degree_six_and_two() {
        let powers = with_roots(&[0.9, 0.3, 0.31, 0.7, -0.4, 1.6], 3.0);
        let powers = if powers[0] > 0.0 { powers } else { powers.iter().map(|p| -p).collect() };
        assert!((first_root(&powers).unwrap() - 0.3).abs() < 1e-12);
        assert!((first_root(&with_roots(&[0.4, 0.2], 1.0)).unwrap() - 0.2).abs() < 1e-15);
        assert!((first_root(&with_roots(&[0.4, -0.2], -1.0)).unwrap() - 0.4).abs() < 1e-15);
    }

    #[test]
    fn no_root_in_the_interval_is_none_and_a_start_at_or_below_zero_is_a_root() {
        assert_eq!(first_root(&with_roots(&[1.5, 2.0], 1.0)), None);
        assert_eq!(first_root(&[1.0, 0.0, 0.0]), None);
        assert_eq!(first_root(&[1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0]), None);
        assert_eq!(first_root(&[0.0, 1.0, 0.0]), Some(0.0));
        assert_eq!(first_root(&[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0]), Some(0.0));
    }

    #[test]
    fn a_nearly_straight_quadratic_keeps_its_digits() {
        let root = first_root(&[1e-3, -1.0, 1e-14]).unwrap();
        assert!((root - 1e-3).abs() < 1e-17);
        assert_eq!(first_root(&[0.5, -1.0, 0.0]), Some(0.5));
    }

    #[test]
    fn a_near_miss_of_two_touching_roots_is_told_from_a_touch() {
        let touch = with_roots(&[0.37, 0.37, -1.0, -1.0, -1.0, -1.0], 1.0);
        let mut above = touch.clone();
        above[0] += 1e-9;
        let mut below = touch.clone();
        below[0] -= 1e-9;
        assert_eq!(first_root(&above), None);
        assert!((first_root(&below).unwrap() - 0.37).abs() < 1e-3);
    }
}

//! Phase functions in double precision.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::papers::gas::model::HenyeyGreenstein;

/// The sum of Henyey-Greenstein functions for the cosine of the angle by which light is turned; per steradian.
pub fn phase(functions: &[HenyeyGreenstein], cosine: f64) -> f64 {
    let one = |f: &HenyeyGreenstein| {
        let g = f64::from(f.g);
        f64::from(f.weight) * (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
    };
    functions.iter().map(one).sum()
}

/// A direction after a scattering, drawn by the sum of functions from two numbers of 0 to 1, and their weights' sum.
pub fn turned(functions: &[HenyeyGreenstein; 2], direction: DVec3, [place, around]: [f64; 2]) -> (DVec3, f64) {
    let [first, second] = functions.map(|f| f64::from(f.weight));
    let place = place * (first + second);
    let (g, place) = if place < first || second <= 0.0 {
        (functions[0].g, place / first)
    } else {
        (functions[1].g, (place - first) / second)
    };
    let g = f64::from(g);
    let cosine = if g.abs() < 1e-4 {
        2.0 * place - 1.0
    } else {
        let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * place);
        ((1.0 + g * g - root * root) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    let sine = (1.0 - cosine * cosine).sqrt();
    let (side, up) = direction.any_orthonormal_pair();
    let (sin, cos) = (around * TAU).sin_cos();
    ((direction * cosine + (side * cos + up * sin) * sine).normalize(), first + second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::gas::parameters::DEFAULT_PHASE;

    #[test]
    fn it_integrates_to_one_over_the_sphere() {
        for g in [-0.9, -0.3, 0.0, 0.5, 0.9] {
            let functions = [HenyeyGreenstein { weight: 1.0, g }];
            let count = 20_000;
            let step = 2.0 / f64::from(count);
            let sum: f64 = (0..count).map(|i| phase(&functions, -1.0 + (f64::from(i) + 0.5) * step)).sum();
            assert!((2.0 * PI * sum * step - 1.0).abs() < 1e-4, "{g}");
        }
    }

    /// Directions lie as their density says: the mean of each interval of cosines, and no side is preferred.
    #[test]
    fn directions_are_drawn_by_the_phase() {
        let (count, bins) = (400_u32, 10);
        let mut found = vec![0.0; bins];
        let mut sum = DVec3::ZERO;
        for i in 0..count * count {
            let place = [f64::from(i % count) + 0.5, f64::from(i / count) + 0.5].map(|n| n / f64::from(count));
            let (direction, weight) = turned(&DEFAULT_PHASE, DVec3::Y, place);
            assert!((direction.length() - 1.0).abs() < 1e-12 && (weight - 1.0).abs() < 1e-6);
            found[(((direction.y + 1.0) / 2.0 * bins as f64) as usize).min(bins - 1)] += 1.0 / f64::from(count * count);
            sum += direction / f64::from(count * count);
        }
        for (bin, found) in found.iter().enumerate() {
            let cosine = |part: u32| 2.0 * (bin as f64 + (f64::from(part) + 0.5) / 100.0) / bins as f64 - 1.0;
            let mean = (0..100).map(|part| phase(&DEFAULT_PHASE, cosine(part))).sum::<f64>() / 100.0;
            let expected = mean * 4.0 * PI / bins as f64;
            assert!((found - expected).abs() < 5e-3, "{bin}: {found} for {expected}");
        }
        // The mean cosine is the mean g.
        assert!((sum - DVec3::Y * (0.8 * 0.5 - 0.2 * 0.3)).length() < 1e-3, "{sum}");
    }

    #[test]
    fn positive_g_brightens_gas_before_the_light() {
        assert!(phase(&DEFAULT_PHASE, 1.0) > 2.0 * phase(&DEFAULT_PHASE, -1.0));
    }
}

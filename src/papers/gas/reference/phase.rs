//! Phase functions in double precision.

use std::f64::consts::PI;

use crate::papers::gas::model::HenyeyGreenstein;

/// The sum of Henyey-Greenstein functions for the cosine of the angle by which light is turned; per steradian.
pub fn phase(functions: &[HenyeyGreenstein], cosine: f64) -> f64 {
    let one = |f: &HenyeyGreenstein| {
        let g = f64::from(f.g);
        f64::from(f.weight) * (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
    };
    functions.iter().map(one).sum()
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

    #[test]
    fn positive_g_brightens_gas_before_the_light() {
        assert!(phase(&DEFAULT_PHASE, 1.0) > 2.0 * phase(&DEFAULT_PHASE, -1.0));
    }
}

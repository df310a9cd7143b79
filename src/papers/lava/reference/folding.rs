//! Folds of a stiff skin on a softer inside that is shortened (Fink and Fletcher 1978): a layer whose viscosity falls exponentially
//! with depth, over a half space, both without weight.

use std::f64::consts::TAU;

/// Rate at which a fold of a wave number, per thickness of the skin, grows over the rate of shortening. The skin's surface is so many times as
/// viscous as the inside.
///
/// The stream function's amplitude f, its slope, and the amplitudes of shear and of normal stress follow from each other with
/// height: f' = g, g' = t / eta - k^2 f, t' = 4 k^2 eta g - n, n' = k^2 t (Stokes's equations without a force). Two solutions that
/// vanish far below are carried up to the surface, where the shortened skin's own stress shears a slope and nothing presses.
pub fn fold_growth(wave: f64, stiffness: f64) -> f64 {
    const STEPS: usize = 200;
    let from_below = |[level, bend]: [f64; 2]| {
        let inside = 1.0 / stiffness;
        let shear = inside * (2.0 * wave * wave * level + 2.0 * wave * bend);
        let mut state = [level, wave * level + bend, shear, 2.0 * inside * wave.powi(3) * level];
        let step = 1.0 / STEPS as f64;
        for at in 0..STEPS {
            let slope = |[f, g, t, n]: [f64; 4], height: f64| {
                let eta = stiffness.powf(height);
                [g, t / eta - wave * wave * f, 4.0 * wave * wave * eta * g - n, wave * wave * t]
            };
            let moved = |by: [f64; 4], part: f64| std::array::from_fn(|i| state[i] + part * step * by[i]);
            let height = at as f64 * step - 1.0;
            let first = slope(state, height);
            let second = slope(moved(first, 0.5), height + 0.5 * step);
            let third = slope(moved(second, 0.5), height + 0.5 * step);
            let last = slope(moved(third, 1.0), height + step);
            state = std::array::from_fn(|i| {
                state[i] + step / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + last[i])
            });
        }
        state
    };
    let (one, other) = (from_below([1.0, 0.0]), from_below([0.0, 1.0]));
    // One's share x and the other's y: shear 4 k of a slope, no normal stress.
    let determinant = one[2] * other[3] - other[2] * one[3];
    let (x, y) = (4.0 * wave * other[3] / determinant, -4.0 * wave * one[3] / determinant);
    wave * (x * one[0] + y * other[0]).abs()
}

/// Length over the skin's thickness of the fold that grows fastest.
pub fn fold_length(stiffness: f64) -> f64 {
    // Growth has one maximum: by golden section over lengths of 2 to 60 thicknesses.
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = ((TAU / 60.0).ln(), (TAU / 2.0).ln());
    for _ in 0..60 {
        let (a, b) = (high - ratio * (high - low), low + ratio * (high - low));
        if fold_growth(a.exp(), stiffness) > fold_growth(b.exp(), stiffness) { high = b } else { low = a }
    }
    TAU / (0.5 * (low + high)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fluid of one viscosity that is shortened thickens by as much, and a bump of it grows no faster than twice that.
    #[test]
    fn a_fluid_of_one_viscosity_does_not_fold() {
        for wave in [0.3, 1.0, 3.0] {
            let growth = fold_growth(wave, 1.000001);
            assert!(growth < 2.1, "{wave}: {growth}");
        }
        assert!(fold_growth(1.0, 20.0) > 4.0);
    }
}

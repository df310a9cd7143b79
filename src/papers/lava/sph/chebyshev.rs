//! Coefficients of Chebyshev's semi-iteration.

/// Factors of the last change and of the residual, in each iteration.
pub type Coefficients = [f32; 2];

/// Largest eigenvalue of the viscous matrix, whose smallest is 1, by Gershgorin's circles: `stiffness` is step times
/// viscosity over density and h^2. Particles may be three times as dense as at rest, and every wall as near as it may.
pub fn largest_eigenvalue(stiffness: f64) -> f64 {
    /// Twice the integral of the kernel's slope over the distance, twice, three times as dense.
    const OTHERS: f64 = 2.0 * 28.0 * 3.0;
    /// Of a wall at the margin, a quarter of a particle's distance away, and of five of them.
    const WALLS: f64 = 27.0 * 5.0;
    1.0 + stiffness * (OTHERS + WALLS)
}

/// Iterations until nothing is left of an error but a thousandth.
pub fn needed(stiffness: f64) -> f64 {
    let ratio = (largest_eigenvalue(stiffness) + 1.0) / (largest_eigenvalue(stiffness) - 1.0);
    if ratio.is_finite() { ((2.0f64 / 1e-3).acosh() / ratio.acosh()).ceil() } else { 0.0 }
}

/// Those iterations' coefficients: none where nothing drags.
pub fn coefficients(stiffness: f64) -> Vec<Coefficients> {
    let count = needed(stiffness) as usize;
    if count == 0 {
        return Vec::new();
    }
    let largest = largest_eigenvalue(stiffness);
    let middle = 0.5 * (largest + 1.0);
    let half = 0.5 * (largest - 1.0);
    let ratio = middle / half;
    let mut rho = 1.0 / ratio;
    let mut list = vec![[0.0, (1.0 / middle) as f32]];
    while list.len() < count {
        let next = 1.0 / (2.0 * ratio - rho);
        list.push([(next * rho) as f32, (2.0 * next / half) as f32]);
        rho = next;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a scalar of any eigenvalue between the bounds.
    #[test]
    fn an_error_falls_to_a_thousandth_and_never_grows() {
        assert!(coefficients(0.0).is_empty());
        for stiffness in [1e-6, 0.01, 0.1, 3.0, 30.0] {
            let list = coefficients(stiffness);
            let largest = largest_eigenvalue(stiffness);
            for part in 0..=20 {
                let value = 1.0 + (largest - 1.0) * f64::from(part) / 20.0;
                // Solves value x = value from 0 on.
                let (mut x, mut change) = (0.0f64, 0.0f64);
                for [kept, gained] in &list {
                    change = f64::from(*kept) * change + f64::from(*gained) * value * (1.0 - x);
                    x += change;
                    assert!((1.0 - x).abs() < 1.0 + 1e-6, "{stiffness} {value}: {x}");
                }
                assert!((1.0 - x).abs() < 1.5e-3, "{stiffness} {value}: {x} after {}", list.len());
            }
        }
    }
}

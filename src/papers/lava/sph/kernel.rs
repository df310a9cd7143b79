//! The kernel's constants on a lattice at rest.

/// Radius of the kernel in distances of particles: 57 neighbours in a lattice.
pub const SUPPORT: f64 = 2.4;
/// 21 / (2 pi), as in `lava/sph.glsl`.
const SIGMA: f64 = 21.0 / std::f64::consts::TAU;

/// Factors by which the sums over a cubic lattice of distance 1 and radius [`SUPPORT`] are off their integrals: of the
/// density, and of the Laplacian of what grows with the square of a coordinate. Sums over particles are divided by them.
pub fn lattice_sums() -> (f64, f64) {
    let reach = SUPPORT as i32;
    let (mut density, mut laplacian) = (0.0, 0.0);
    for x in -reach..=reach {
        for y in -reach..=reach {
            for z in -reach..=reach {
                let q = f64::from(x * x + y * y + z * z).sqrt() / SUPPORT;
                let inside = (1.0 - q).max(0.0);
                density += SIGMA * inside.powi(4) * (1.0 + 4.0 * q) / SUPPORT.powi(3);
                laplacian += 20.0 * SIGMA * inside.powi(3) * f64::from(z * z) / SUPPORT.powi(5);
            }
        }
    }
    (density, laplacian)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_a_lattice_are_near_their_integrals() {
        let (density, laplacian) = lattice_sums();
        assert!((density - 1.0).abs() < 0.02 && (laplacian - 1.0).abs() < 0.05, "{density} {laplacian}");
    }
}

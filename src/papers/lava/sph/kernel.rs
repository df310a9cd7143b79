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

/// Steepness of the amount of lava, per radius of the kernel, above which a particle is at the surface: `lava/sph-heat.comp`'s.
const STEEP: f64 = 0.6;

/// Share of its face for each steepness of a particle: on a level lattice those of all layers add up to a layer's particles.
pub fn face_per_steepness() -> f64 {
    // The kernel integrated over a plane at a distance, as in `lava/sph.glsl`.
    let steepness = |q: f64| {
        let u = (1.0 - q).max(0.0);
        21.0 * u.powi(5) * (1.0 - 1.5 * u + 4.0 / 7.0 * u * u)
    };
    let layers = (0..3).map(|layer| steepness((f64::from(layer) + 0.5) / SUPPORT)).filter(|steep| *steep > STEEP);
    1.0 / layers.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral of the steepness over the particles' side is half; 16 % of it lies below the threshold, of a lattice's 7.
    #[test]
    fn a_layer_of_any_arrangement_has_a_face() {
        let lattice = face_per_steepness();
        let parts = 100_000;
        let sum = (0..parts).map(|part| {
            let u = 1.0 - (f64::from(part) + 0.5) / f64::from(parts);
            21.0 * u.powi(5) * (1.0 - 1.5 * u + 4.0 / 7.0 * u * u)
        });
        let random: f64 = sum.filter(|steep| *steep > STEEP).sum::<f64>() / f64::from(parts) * SUPPORT;
        assert!((lattice * random - 1.0).abs() < 0.1, "{lattice} {random}");
    }

    #[test]
    fn sums_over_a_lattice_are_near_their_integrals() {
        let (density, laplacian) = lattice_sums();
        assert!((density - 1.0).abs() < 0.02 && (laplacian - 1.0).abs() < 0.05, "{density} {laplacian}");
    }
}

//! The water surface: a triangle mesh, and two surfaces with a closed form.

use crate::papers::caustics::reference::AIR;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A vertex of the water mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterVertex {
    /// Position in the world, in metres.
    pub position: DVec3,
    /// Unit normal, upward.
    pub normal: DVec3,
}

/// The water as a triangle mesh; every index is below the number of vertices.
#[derive(Clone, Copy, Debug)]
pub struct Water<'a> {
    /// Vertices.
    pub vertices: &'a [WaterVertex],
    /// Faces F_j of section 4.3, wound either way.
    pub triangles: &'a [[u32; 3]],
}

/// One sine wave of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Amplitude, in metres.
    pub amplitude_m: f64,
    /// Unit direction of travel as (x, z).
    pub direction: DVec2,
    /// Wavelength, in metres, above 0.
    pub wavelength_m: f64,
    /// Angular frequency, in rad/s.
    pub angular_frequency_rad_s: f64,
    /// Phase at the origin at time 0, in radians.
    pub phase_rad: f64,
}

/// The sum of `waves` above `water_level_m` at (x, z): height Σ A sin(k·x - ωt + φ) and its analytic normal.
pub fn wave_vertex(waves: &[Wave], water_level_m: f64, x: f64, z: f64, time_s: f64) -> WaterVertex {
    let mut height = water_level_m;
    let mut slope = DVec2::ZERO;
    for wave in waves {
        let wave_vector = wave.direction * (TAU / wave.wavelength_m);
        let angle = wave_vector.dot(DVec2::new(x, z)) - wave.angular_frequency_rad_s * time_s + wave.phase_rad;
        height += wave.amplitude_m * angle.sin();
        slope += wave.amplitude_m * angle.cos() * wave_vector;
    }
    WaterVertex { position: DVec3::new(x, height, z), normal: DVec3::new(-slope.x, 1.0, -slope.y).normalize() }
}

/// A point of a spherical cap of water that bulges upward, highest at `vertex`; `None` beyond its radius.
pub fn spherical_cap_vertex(radius_m: f64, vertex: DVec3, x: f64, z: f64) -> Option<WaterVertex> {
    let offset = DVec2::new(x - vertex.x, z - vertex.z);
    let rise_squared = radius_m * radius_m - offset.length_squared();
    (rise_squared > 0.0).then(|| {
        let from_center = DVec3::new(offset.x, rise_squared.sqrt(), offset.y);
        WaterVertex { position: vertex - DVec3::Y * radius_m + from_center, normal: from_center / radius_m }
    })
}

/// How far below its vertex a spherical cap focuses parallel light from overhead, for rays near the axis: n R / (n - 1),
/// which is 4 R for n = 4/3.
pub fn spherical_cap_focus(radius_m: f64, refraction_index: f64) -> f64 {
    refraction_index * radius_m / (refraction_index - AIR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{Mesh, OVERHEAD, WATER, gentle_waves};
    use crate::papers::caustics::reference::{illumination_volumes, refract};

    #[test]
    fn the_analytic_normal_is_the_gradient_of_the_height() {
        let (waves, step) = (gentle_waves(), 1e-5);
        let at = |x, z| wave_vertex(&waves, 0.3, x, z, 0.7).position.y;
        for (x, z) in [(0.0, 0.0), (0.4, -1.2), (2.1, 0.9)] {
            let normal = wave_vertex(&waves, 0.3, x, z, 0.7).normal;
            let along_x = (at(x + step, z) - at(x - step, z)) / (2.0 * step);
            let along_z = (at(x, z + step) - at(x, z - step)) / (2.0 * step);
            assert!((normal.x / normal.y + along_x).abs() < 1e-8);
            assert!((normal.z / normal.y + along_z).abs() < 1e-8);
        }
    }

    #[test]
    fn waves_travel_along_their_direction() {
        let wave = gentle_waves()[0];
        let travelled = wave.direction * wave.angular_frequency_rad_s * wave.wavelength_m / TAU;
        let before = wave_vertex(&[wave], 0.0, 0.2, 0.1, 0.0).position.y;
        let after = wave_vertex(&[wave], 0.0, 0.2 + travelled.x, 0.1 + travelled.y, 1.0);
        assert!((before - after.position.y).abs() < 1e-12);
    }

    #[test]
    fn a_spherical_cap_focuses_four_radii_below_its_vertex() {
        let (radius, vertex) = (0.5, DVec3::new(1.0, 0.2, -1.0));
        let focus = spherical_cap_focus(radius, WATER.refraction_index);
        assert!((focus - 4.0 * radius).abs() < 1e-12);
        for (share, tolerance) in [(1e-3, 1e-5), (0.02, 1e-3)] {
            let offset = radius * share;
            let cap = spherical_cap_vertex(radius, vertex, vertex.x + offset, vertex.z).unwrap();
            let ray = refract(-DVec3::Y, cap.normal, AIR, WATER.refraction_index).unwrap();
            let crossing = cap.position.y - offset * ray.y / ray.x;
            assert!(((vertex.y - crossing) / focus - 1.0).abs() < tolerance);
        }
        assert_eq!(spherical_cap_vertex(radius, vertex, 3.0, 0.0), None);
    }

    #[test]
    fn the_illumination_volumes_of_a_cap_are_narrowest_at_its_focus() {
        let (radius, vertex) = (1.0, DVec3::ZERO);
        let cap = Mesh::grid(12, 0.2, |x, z| spherical_cap_vertex(radius, vertex, x, z).unwrap());
        let volumes = illumination_volumes(cap.water(), OVERHEAD, WATER);
        let spread = |depth: f64| -> f64 {
            let rays = volumes.iter().flat_map(|v| v.vertices.into_iter().zip(v.refracted));
            rays.map(|(p, t)| p + t * ((-depth - p.y) / t.y)).map(|p| p.x * p.x + p.z * p.z).sum()
        };
        let focus = spherical_cap_focus(radius, WATER.refraction_index);
        assert!(spread(focus) < 0.02 * spread(0.8 * focus));
        assert!(spread(focus) < 0.02 * spread(1.2 * focus));
    }
}

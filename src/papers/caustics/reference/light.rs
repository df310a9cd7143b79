//! Lights and Snell's law (section 2.6).

use glam::DVec3;

/// Index of refraction of air.
pub const AIR: f64 = 1.0;

/// The water as a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Index of refraction of the water against [`AIR`], above 1; 4/3 for water.
    pub refraction_index: f64,
    /// Absorption coefficient K of eq. 4-17, in 1/m, at least 0.
    pub absorption_per_m: f64,
}

/// A light of unit intensity above the water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceLight {
    /// Parallel rays along a unit direction that points into the scene.
    Parallel {
        /// Unit direction, from the light into the scene.
        direction: DVec3,
    },
    /// Rays from one point, without falloff.
    Point {
        /// Position in the world, in metres.
        position: DVec3,
    },
}

impl ReferenceLight {
    /// The unit direction of the ray that reaches `point`; zero where `point` is the point light itself.
    pub fn direction_at(&self, point: DVec3) -> DVec3 {
        match *self {
            Self::Parallel { direction } => direction.normalize_or_zero(),
            Self::Point { position } => (point - position).normalize_or_zero(),
        }
    }

    /// The unit direction of the light once refracted at flat water, for a receiver around `target` (4.2.1): a point
    /// light is aimed straight at `target`. `None` where the light does not come from above.
    pub fn refracted_at_flat_water(&self, target: DVec3, medium: Medium) -> Option<DVec3> {
        refract(self.direction_at(target), DVec3::Y, AIR, medium.refraction_index)
    }
}

/// Refracts the unit vector `incident` at a surface with unit `normal` on the side of index `n1`, into index `n2`
/// (eq. 2-7, 2-8):
///
/// T = (n1/n2) I + ((n1/n2) cos θ_I - cos θ_T) N, cos θ_I = -N·I, cos² θ_T = 1 - (n1/n2)² (1 - cos² θ_I).
///
/// The result is a unit vector; `None` where the ray does not run against the normal or is totally reflected.
pub fn refract(incident: DVec3, normal: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    let ratio = n1 / n2;
    let cos_incident = -normal.dot(incident);
    let cos_squared = 1.0 - ratio * ratio * (1.0 - cos_incident * cos_incident);
    (cos_incident > 0.0 && cos_squared >= 0.0)
        .then(|| ratio * incident + (ratio * cos_incident - cos_squared.sqrt()) * normal)
}

/// The part of unpolarised light that enters index `n2` from index `n1` under that cosine of incidence: 1 less the mean of
/// Fresnel's two reflectances. None of it where it is totally reflected.
pub fn transmitted(cos_incident: f64, n1: f64, n2: f64) -> f64 {
    let sine = n1 / n2 * (1.0 - cos_incident * cos_incident).max(0.0).sqrt();
    if sine >= 1.0 {
        return 0.0;
    }
    let cos_refracted = (1.0 - sine * sine).sqrt();
    let across = (n1 * cos_incident - n2 * cos_refracted) / (n1 * cos_incident + n2 * cos_refracted);
    let along = (n1 * cos_refracted - n2 * cos_incident) / (n1 * cos_refracted + n2 * cos_incident);
    1.0 - (across * across + along * along) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_reflects_two_percent_overhead_and_all_light_that_grazes_it() {
        let reflected = |cos_incident| 1.0 - transmitted(cos_incident, AIR, 4.0 / 3.0);
        assert!((reflected(1.0) - (1.0f64 / 7.0).powi(2)).abs() < 1e-15);
        // Brewster's angle: of the light that swings along the plane of incidence nothing.
        let brewster = (4.0f64 / 3.0).atan();
        let refracted = (brewster.sin() * 0.75).asin();
        let across = ((brewster - refracted).sin() / (brewster + refracted).sin()).powi(2) / 2.0;
        assert!((reflected(brewster.cos()) - across).abs() < 1e-14);
        assert!((reflected(0.0) - 1.0).abs() < 1e-15);
        assert_eq!(transmitted(0.3, 4.0 / 3.0, AIR), 0.0);
    }

    #[test]
    fn refraction_obeys_snells_law_in_the_plane_of_incidence() {
        for (n1, n2) in [(1.0, 4.0 / 3.0), (1.0, 1.5), (4.0 / 3.0, 1.0)] {
            for degrees in [0.0_f64, 10.0, 35.0, 48.0] {
                let normal = DVec3::new(0.3, 0.9, -0.2).normalize();
                let tangent = normal.any_orthonormal_vector();
                let (sin, cos) = degrees.to_radians().sin_cos();
                let refracted = refract(tangent * sin - normal * cos, normal, n1, n2).unwrap();
                assert!((refracted.length() - 1.0).abs() < 1e-14);
                assert!((n1 * sin - n2 * refracted.dot(tangent)).abs() < 1e-14);
                assert!(refracted.dot(normal) < 0.0);
                assert!(refracted.dot(tangent.cross(normal)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn total_reflection_and_light_from_behind_refract_nowhere() {
        let grazing = DVec3::new(0.8, -0.6, 0.0);
        assert_eq!(refract(grazing, DVec3::Y, 4.0 / 3.0, 1.0), None);
        assert_eq!(refract(grazing, -DVec3::Y, 1.0, 4.0 / 3.0), None);
    }
}

//! Landing of refracted light by the slope of the water that it passes.

use std::f64::consts::FRAC_PI_2;

/// By which the place where light lands a metre down moves for each unit of the water's slope, along the light's own plane and
/// across it; the light's refracted ray runs down by `cos_refracted`. By Snell's law a slope turns it by 1 - cos i / (n cos t) along
/// its own plane and across it, of which a slanted ray lands 1 / cos^2 t farther along, and 1 - 1/n from overhead both ways.
pub fn along_and_across(cos_refracted: f64, refraction_index: f64) -> (f64, f64) {
    let sin_incident = refraction_index * (1.0 - cos_refracted * cos_refracted).max(0.0).sqrt();
    let cos_incident = (1.0 - sin_incident * sin_incident).max(0.0).sqrt();
    let across = 1.0 - cos_incident / (refraction_index * cos_refracted);
    (across / (cos_refracted * cos_refracted), across)
}

/// The most by which the place where light lands a metre down moves where the water leans towards the light, or away from it, by
/// `slope`, by Snell's law; in flat water the light's refracted ray runs down by `cos_refracted`. Water that leans away by more than
/// the light slants is in its own shadow, and counts as if the light grazed it.
pub fn most_moved(cos_refracted: f64, slope: f64, refraction_index: f64) -> f64 {
    let sin_refracted = (1.0 - cos_refracted * cos_refracted).max(0.0).sqrt();
    let incident = (refraction_index * sin_refracted).min(1.0).asin();
    let moved = |slope: f64| {
        let to_normal = (incident - slope.atan()).clamp(-FRAC_PI_2, FRAC_PI_2);
        let refracted = incident - to_normal + (to_normal.sin() / refraction_index).asin();
        (refracted.tan() - sin_refracted / cos_refracted).abs()
    };
    moved(slope).max(moved(-slope))
}

/// Root of the mean square of [`along_and_across`] over the directions of slopes.
pub fn moved_by_slope(cos_refracted: f64, refraction_index: f64) -> f64 {
    let (along, across) = along_and_across(cos_refracted, refraction_index);
    // A wave whose crests lie anyhow moves light by its curvature's parts along and across.
    ((3.0 * along * along + 3.0 * across * across + 2.0 * along * across) / 8.0).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::{DVec2, DVec3};

    use super::super::reference::refract;
    use super::*;

    /// Against the oracle's refraction at surfaces that are tilted a little, all around.
    #[test]
    fn landings_move_as_refracted_rays_do() {
        for tilt in [0.0, 0.4, 0.9, 1.3_f64] {
            let incident = DVec3::new(tilt.sin(), -tilt.cos(), 0.0);
            let landing = |slope: DVec2| {
                let ray = refract(incident, DVec3::new(-slope.x, 1.0, -slope.y).normalize(), 1.0, 1.333).unwrap();
                DVec2::new(ray.x, ray.z) / -ray.y
            };
            // The divergence of what a wave along each direction does, which is what brings neighbouring rays together.
            let moved =
                |direction: DVec2| ((landing(1e-5 * direction) - landing(-1e-5 * direction)) / 2e-5).dot(direction);
            let all_around = (0..360).map(|i| moved(DVec2::from_angle(TAU * f64::from(i) / 360.0)).powi(2));
            let expected = (all_around.sum::<f64>() / 360.0).sqrt();
            let down = -refract(incident, DVec3::Y, 1.0, 1.333).unwrap().y;
            let found = moved_by_slope(down, 1.333);
            assert!((found / expected - 1.0).abs() < 1e-6, "{tilt}: {found} {expected}");
            let (along, across) = along_and_across(down, 1.333);
            assert!((moved(DVec2::X).abs() / along - 1.0).abs() < 1e-6, "{tilt}: {along}");
            assert!((moved(DVec2::Y).abs() / across - 1.0).abs() < 1e-6, "{tilt}: {across}");
        }
        assert!((moved_by_slope(1.0, 4.0 / 3.0) - 0.25).abs() < 1e-12);
    }

    /// Against the oracle's refraction at surfaces of every slope up to the steepest, along the light's plane.
    #[test]
    fn no_lesser_slope_moves_landings_farther() {
        for (index, tilt) in [1.333, 4.0].into_iter().flat_map(|index| [0.0, 0.6, 1.1, 1.45_f64].map(|t| (index, t))) {
            let incident = DVec3::new(tilt.sin(), -tilt.cos(), 0.0);
            let landing = |slope: f64| {
                let ray = refract(incident, DVec3::new(-slope, 1.0, 0.0).normalize(), 1.0, index)?;
                Some(ray.x / -ray.y)
            };
            let flat = landing(0.0).unwrap();
            let down = -refract(incident, DVec3::Y, 1.0, index).unwrap().y;
            let mut farthest = 0.0_f64;
            for slope in (1..=1000).map(|i| f64::from(i) * 0.01) {
                let moved = [slope, -slope].into_iter().filter_map(landing).map(|place| (place - flat).abs());
                farthest = moved.fold(farthest, f64::max);
                let most = most_moved(down, slope, index);
                assert!(most > farthest - 1e-9, "{index}, {tilt}, {slope}: {most} and {farthest}");
                // Beyond the slope that the light grazes it has no ray that comes near.
                let is_lit = landing(-slope).is_some();
                assert!(!is_lit || most < farthest + 1e-9, "{index}, {tilt}, {slope}: {most} and {farthest}");
            }
        }
    }
}

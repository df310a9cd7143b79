//! Surprises of a configuration that a user is warned of: options that a variant does not heed, and light that point
//! sampling does not show as it is.

use super::Caustics;
use super::parameters::{CullSteps, IntensityRule, Parameters, Variant};
use super::receiver::LitReceiver;
use super::water::LEVEL_M;
use crate::measure::Variant as _;

/// By which the landing of light moves from one metre of the water's surface to the next, root of the mean square, above which point
/// sampling is warned of. Neighbouring rays meet where it reaches 1, which waves of many phases do in places at 2.5 standard
/// deviations.
const FOLDING: f64 = 0.4;
/// The coverage that ends the warning.
const AVERAGED: u32 = 4;

impl Caustics {
    /// A line for each doubt.
    pub(super) fn doubts(&self) -> Vec<String> {
        let unheeded = unheeded(&self.parameters, self.variant);
        self.small_map().into_iter().chain(self.folded_light()).chain(unheeded).collect()
    }

    /// The light that reaches the receivers passes water beyond the border of a height map.
    fn small_map(&self) -> Option<String> {
        let map = self.parameters.water_map.as_ref()?;
        let (map_m, mesh_m) = (map.extent_m(), self.grid().extent_m());
        map_m.cmplt(mesh_m).any().then(|| {
            format!(
                "the water map {} covers {:.2} x {:.2} m of the water's mesh of {:.2} x {:.2} m; beyond its border the \
                 border's heights go on",
                map.name(),
                map_m.x,
                map_m.y,
                mesh_m.x,
                mesh_m.y
            )
        })
    }

    /// Maps are sampled at texel centres under water that folds its light on the way to the receivers.
    fn folded_light(&self) -> Option<String> {
        let p = &self.parameters;
        if self.variant == Variant::Hit || p.coverage >= AVERAGED {
            return None;
        }
        let deepest_m = |lit: &LitReceiver| lit.receiver.positions.iter().map(|point| point.y).reduce(f32::min);
        let index = f64::from(p.refraction_index);
        let bent = self.lit_receivers.iter().filter_map(|lit| {
            let depth_m = LEVEL_M - f64::from(deepest_m(lit)?);
            Some((depth_m, p.mean_curvature() * moved_by_slope(lit.aligned.axes.v.y, index) * depth_m))
        });
        // None for the stencil method, which has no maps.
        let (depth_m, bend) = bent.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (bend > FOLDING).then(|| {
            format!(
                "this water folds light on its way {depth_m:.1} m down: a caustics map that is sampled at texel centres, as the \
                 thesis's is, misses slivers of folded triangles or takes them for too bright; `coverage` {AVERAGED} averages them"
            )
        })
    }
}

/// By which the place where light lands a metre down moves for each unit of the water's slope, root of the mean square over slopes'
/// directions; the light's refracted ray runs down by `cos_refracted`. By Snell's law a slope turns it by 1 - cos i / (n cos t) along
/// its own plane and across it, of which a slanted ray lands 1 / cos^2 t farther along, and 1 - 1/n from overhead both ways.
fn moved_by_slope(cos_refracted: f64, refraction_index: f64) -> f64 {
    let sin_incident = refraction_index * (1.0 - cos_refracted * cos_refracted).max(0.0).sqrt();
    let cos_incident = (1.0 - sin_incident * sin_incident).max(0.0).sqrt();
    let across = 1.0 - cos_incident / (refraction_index * cos_refracted);
    let along = across / (cos_refracted * cos_refracted);
    // A wave whose crests lie anyhow moves light by its curvature's parts along and across.
    ((3.0 * along * along + 3.0 * across * across + 2.0 * along * across) / 8.0).sqrt()
}

/// Options are set that the variant does not heed.
fn unheeded(p: &Parameters, variant: Variant) -> Option<String> {
    use Variant::{Culled, Hit, LevelMap, LevelMapSmart, Stencil};
    let is_sampled = !matches!(variant, Hit | Stencil);
    let goes_by_distance = variant == LevelMap || variant == Culled && !p.culled_smart;
    // Each with whether it is set, and whether it is heeded.
    let options = [
        ("smart", p.culled_smart, matches!(variant, Culled | LevelMapSmart)),
        ("cull", p.cull != CullSteps::EVERY, variant == Culled),
        ("layers", p.layers > 1, variant == Hit),
        ("coverage", p.coverage > 1, is_sampled),
        ("intensity", p.intensity != IntensityRule::Face, is_sampled),
        ("planes-within", p.planes_within_m.is_some(), goes_by_distance),
        ("shadows", p.shadows, variant != Stencil),
    ];
    let idle = options.into_iter().filter(|&(_, is_set, is_heeded)| is_set && !is_heeded);
    let names: Vec<String> = idle.map(|(name, ..)| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| format!("{} does not heed {}", variant.as_str(), names.join(", ")))
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
            let moved = |i: u32| {
                let direction = DVec2::from_angle(TAU * f64::from(i) / 360.0);
                ((landing(1e-5 * direction) - landing(-1e-5 * direction)) / 2e-5).dot(direction)
            };
            let expected = ((0..360).map(|i| moved(i).powi(2)).sum::<f64>() / 360.0).sqrt();
            let down = -refract(incident, DVec3::Y, 1.0, 1.333).unwrap().y;
            let found = moved_by_slope(down, 1.333);
            assert!((found / expected - 1.0).abs() < 1e-6, "{tilt}: {found} {expected}");
        }
        assert!((moved_by_slope(1.0, 4.0 / 3.0) - 0.25).abs() < 1e-12);
    }
}

//! Surprises of a configuration that a user is warned of: options that a variant does not heed, and light that point
//! sampling does not show as it is.

use super::Caustics;
use super::parameters::{CullSteps, IntensityRule, Parameters, Variant};
use super::water::LEVEL_M;
use crate::measure::Variant as _;

/// Slope that a ray gains from one metre of the water's surface to the next, root of the mean square, times depth, above which point
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
        // None for the stencil method, which has no maps.
        let heights_m = self.lit_receivers.iter().flat_map(|lit| &lit.receiver.positions).map(|point| point.y);
        let depth_m = LEVEL_M - f64::from(heights_m.reduce(f32::min)?);
        // A ray is turned by (1 - 1/n) of the slope.
        let bend = p.mean_curvature() * (1.0 - 1.0 / f64::from(p.refraction_index)) * depth_m;
        (bend > FOLDING).then(|| {
            format!(
                "this water folds light on its way {depth_m:.1} m down: a caustics map that is sampled at texel centres, as the \
                 thesis's is, misses slivers of folded triangles or takes them for too bright; `coverage` {AVERAGED} averages them"
            )
        })
    }
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
        ("coverage", p.coverage > 1, is_sampled),
        ("intensity", p.intensity != IntensityRule::Face, is_sampled),
        ("planes-within", p.planes_within_m.is_some(), goes_by_distance),
        ("shadows", p.shadows, variant != Stencil),
    ];
    let idle = options.into_iter().filter(|&(_, is_set, is_heeded)| is_set && !is_heeded);
    let names: Vec<String> = idle.map(|(name, ..)| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| format!("{} does not heed {}", variant.as_str(), names.join(", ")))
}

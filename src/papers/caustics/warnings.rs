//! Surprises of a configuration that a user is warned of: options that a variant does not heed, and light that point
//! sampling does not show as it is.

use super::Caustics;
use super::landing::moved_by_slope;
use super::parameters::{CullSteps, IntensityRule, Parameters, SmartPlacement, Variant};
use super::receiver::LitReceiver;
use super::water::{LEVEL_M, least_cosine};
use crate::measure::Variant as _;
use crate::measure::parameter::{Given, listed};

/// By which the landing of light moves from one metre of the water's surface to the next, root of the mean square, above which point
/// sampling is warned of. Neighbouring rays meet where it reaches 1, which waves of many phases do in places at 2.5 standard
/// deviations.
const FOLDING: f64 = 0.4;
/// The coverage that ends the warning.
const AVERAGED: u32 = 4;

impl Caustics {
    /// A line for each doubt.
    pub(super) fn doubts(&self) -> Vec<String> {
        let unheeded = unheeded(&self.parameters, &self.given, self.variant);
        let still = unheeded_by_map(&self.parameters, &self.given);
        self.dry().into_iter().chain(self.small_map()).chain(self.folded_light()).chain(unheeded).chain(still).collect()
    }

    /// Receivers rise out of the water.
    fn dry(&self) -> Option<String> {
        let above_m = f64::from(self.underwater.bounds.max.y) - LEVEL_M;
        (above_m > 0.0).then(|| {
            format!(
                "the receivers reach {above_m:.2} m above the water's level, where none of them is lit, nor seen from above; a \
                 greater `water-depth` covers them"
            )
        })
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
            let most_slanted = least_cosine(&p.lights[lit.light], &lit.aligned, index);
            Some((depth_m, p.mean_curvature() * moved_by_slope(most_slanted, index) * depth_m))
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

/// Options are set that the variant does not heed. Numbers that every configuration has, and that experiments set for all variants,
/// count where a user gave them.
fn unheeded(p: &Parameters, given: &Given, variant: Variant) -> Option<String> {
    use Variant::{Culled, Hit, LevelMap, LevelMapSmart, Stencil, Volumetric};
    let is_sampled = !matches!(variant, Hit | Stencil);
    let is_smart = variant == LevelMapSmart || variant == Culled && p.culled_smart;
    // A threshold that is given is what planes would give.
    let has_threshold = is_smart && matches!(p.smart.placement, SmartPlacement::Fitted { epsilon_m: Some(_) });
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
        ("planes", given.has("planes"), is_sampled && !has_threshold),
        ("map-size", given.has("map-size"), variant != Stencil),
        ("mrt", given.has("mrt"), !matches!(variant, Volumetric | Stencil)),
        ("levels", given.has("levels"), is_smart && p.smart.placement != SmartPlacement::Kept),
        ("smart-placement", given.has("smart-placement"), is_smart),
        ("epsilon", given.has("epsilon"), is_smart),
    ];
    let idle = options.into_iter().filter(|&(_, is_set, is_heeded)| is_set && !is_heeded);
    listed(idle.map(|(name, ..)| name)).map(|names| format!("{} does not heed {names}", variant.as_str()))
}

/// Options of waves are given with a height map in their place, which has no chance in it and stands still.
fn unheeded_by_map(p: &Parameters, given: &Given) -> Option<String> {
    p.water_map.as_ref()?;
    let idle = ["seed", "time-step"].into_iter().filter(|name| given.has(name));
    listed(idle).map(|names| format!("`water-map` does not heed {names}"))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::water_map::WaterMap;
    use super::*;
    use crate::scene::{HeightMap, Samples};

    #[test]
    fn given_options_that_a_variant_does_not_heed_are_named() {
        use Variant::{Culled, Hit, LevelMap, LevelMapSmart, Stencil, Volumetric};
        let plain = Parameters::default();
        let smart = Parameters { culled_smart: true, ..plain.clone() };
        let mut kept = plain.clone();
        kept.smart.placement = SmartPlacement::Kept;
        let mut by_epsilon = smart.clone();
        by_epsilon.smart.placement = SmartPlacement::Fitted { epsilon_m: Some(0.05) };
        for (parameters, options, variant, names) in [
            (&kept, "planes levels smart-placement", Hit, "`planes`, `levels`, `smart-placement`"),
            (&plain, "planes levels", LevelMapSmart, ""),
            (&by_epsilon, "planes levels epsilon", LevelMapSmart, "`planes`"),
            (&by_epsilon, "levels epsilon", LevelMapSmart, ""),
            (&kept, "planes levels", LevelMapSmart, "`levels`"),
            (&by_epsilon, "smart planes levels epsilon", LevelMap, "`smart`, `levels`, `epsilon`"),
            (&plain, "levels", Culled, "`levels`"),
            (&smart, "planes levels", Culled, ""),
            (&by_epsilon, "planes levels epsilon", Culled, "`planes`"),
            (&plain, "map-size mrt planes", Stencil, "`planes`, `map-size`, `mrt`"),
            (&plain, "map-size mrt planes", Volumetric, "`mrt`"),
            (&plain, "map-size mrt", Hit, ""),
            // Not given, they are the experiments' own.
            (&Parameters { planes: 3, map_size: 64, mrt: false, ..plain.clone() }, "", Stencil, ""),
        ] {
            let given = options.split_whitespace().map(str::to_owned).collect();
            let found = unheeded(parameters, &given, variant).unwrap_or_default();
            let expected =
                if names.is_empty() { String::new() } else { format!("{} does not heed {names}", variant.as_str()) };
            assert_eq!(found, expected, "{options}, {variant:?}");
        }
    }

    #[test]
    fn water_by_a_map_heeds_nothing_of_moving_waves() {
        let heights = HeightMap::new(2, 2, Samples::Float(vec![0.0; 4])).unwrap();
        let map = Some(WaterMap::new("flat".to_owned(), Arc::new(heights)));
        let still = Parameters { water_map: map, ..Parameters::default() };
        let given = |options: &str| options.split_whitespace().map(str::to_owned).collect();
        assert_eq!(
            unheeded_by_map(&still, &given("camera seed time-step")).as_deref(),
            Some("`water-map` does not heed `seed`, `time-step`")
        );
        assert_eq!(unheeded_by_map(&still, &given("camera")), None);
        assert_eq!(unheeded_by_map(&Parameters::default(), &given("seed time-step")), None);
    }
}

//! Surprises of a configuration that a user is warned of: options of splats where rays draw the surface.

use super::parameters::{Parameters, SurfaceDraw, Variant};
use crate::measure::Variant as _;
use crate::measure::parameter::{Given, listed};

/// Parameters of splats, which rays do not heed.
const OF_SPLATS: [&str; 5] = ["splats", "splat-radius", "splat-shape", "splat-shading", "culling"];
/// Of stages two and three, and of none where densities are gathered too.
const OF_PRIMITIVES: &str = "geometry-stage";

/// A line on options that a user gave and that are not heeded.
pub(super) fn unheeded(p: &Parameters, given: &Given, variant: Variant) -> Option<String> {
    if p.surface_draw(variant) != SurfaceDraw::March {
        return None;
    }
    let of_primitives = (variant == Variant::GpuDriven).then_some(OF_PRIMITIVES);
    let idle = listed(OF_SPLATS.into_iter().chain(of_primitives).filter(|name| given.has(name)))?;
    Some(format!("{} draws by rays, which do not heed {idle}", variant.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_splats_that_rays_do_not_heed_are_named() {
        use SurfaceDraw::{March, Splats};
        use Variant::{GpuDriven, Paper};
        for (surface_draw, variant, options, names) in [
            (None, GpuDriven, "particles", ""),
            (None, Paper, "splats splat-radius", ""),
            (None, GpuDriven, "splat-radius splats", "`splats`, `splat-radius`"),
            (Some(Splats), GpuDriven, "splats", ""),
            (Some(March), Paper, "splats splat-radius", "`splats`, `splat-radius`"),
            (Some(March), Paper, "splat-shape culling geometry-stage", "`splat-shape`, `culling`"),
            (None, GpuDriven, "splat-shading culling geometry-stage", "`splat-shading`, `culling`, `geometry-stage`"),
            // A preset's own values are no surprise.
            (Some(March), Paper, "", ""),
        ] {
            let parameters = Parameters { surface_draw, ..Parameters::default() };
            let given = options.split_whitespace().map(str::to_owned).collect();
            let found = unheeded(&parameters, &given, variant).unwrap_or_default();
            let draws = format!("{} draws by rays, which do not heed {names}", variant.as_str());
            assert_eq!(found, if names.is_empty() { String::new() } else { draws }, "{options}, {variant:?}");
        }
    }

    #[test]
    fn every_name_is_an_option() {
        for name in OF_SPLATS.into_iter().chain([OF_PRIMITIVES]) {
            assert!(Parameters::declared().iter().any(|option| option.name == name), "{name}");
        }
    }
}

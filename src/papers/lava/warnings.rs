//! Surprises of a configuration that a user is warned of: options of splats where rays draw the surface.

use super::parameters::{Parameters, SurfaceDraw, Variant};
use super::setup::Setup;
use crate::measure::Variant as _;
use crate::measure::study::Study;

/// Parameters of splats, which rays do not heed.
const OF_SPLATS: [&str; 5] = ["splats", "splat-radius", "splat-shape", "splat-shading", "culling"];
/// Of stages two and three, and of none where densities are gathered too.
const OF_PRIMITIVES: &str = "geometry-stage";

/// A line on options that are set and not heeded. What a preset sets as well is no surprise.
pub(super) fn unheeded(p: &Parameters, variant: Variant) -> Option<String> {
    if p.surface_draw(variant) != SurfaceDraw::March {
        return None;
    }
    let known: Vec<Parameters> = [Parameters::default()]
        .into_iter()
        .chain(Setup::presets().iter().map(|preset| (preset.setup)().parameters))
        .collect();
    let is_idle = |name: &str| OF_SPLATS.contains(&name) || variant == Variant::GpuDriven && name == OF_PRIMITIVES;
    let options = Parameters::declared().into_iter().filter(|option| is_idle(option.name));
    let given = options.filter(|option| known.iter().all(|known| option.text(known) != option.text(p)));
    let names: Vec<String> = given.map(|option| format!("`{}`", option.name)).collect();
    (!names.is_empty()).then(|| format!("{} draws by rays, which do not heed {}", variant.as_str(), names.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::lava::{SplatCulling, SplatShape};

    #[test]
    fn options_of_splats_that_rays_do_not_heed_are_named() {
        let plain = Parameters::default();
        let discs = Parameters { splats: [61, 37], splat_radius_m: 0.05, ..plain.clone() };
        let others = Parameters {
            splat_shape: SplatShape::Fitted,
            culling: SplatCulling::Facing,
            geometry_stage: false,
            ..plain.clone()
        };
        let rays = |p: &Parameters| Parameters { surface_draw: Some(SurfaceDraw::March), ..p.clone() };
        let splats = |p: &Parameters| Parameters { surface_draw: Some(SurfaceDraw::Splats), ..p.clone() };
        use Variant::{GpuDriven, Paper};
        for (parameters, variant, names) in [
            (plain.clone(), GpuDriven, None),
            (discs.clone(), Paper, None),
            (discs.clone(), GpuDriven, Some("gpu-driven draws by rays, which do not heed `splats`, `splat-radius`")),
            (splats(&discs), GpuDriven, None),
            (rays(&discs), Paper, Some("paper draws by rays, which do not heed `splats`, `splat-radius`")),
            (rays(&others), Paper, Some("paper draws by rays, which do not heed `splat-shape`, `culling`")),
            (
                others,
                GpuDriven,
                Some("gpu-driven draws by rays, which do not heed `splat-shape`, `culling`, `geometry-stage`"),
            ),
        ] {
            assert_eq!(unheeded(&parameters, variant).as_deref(), names, "{variant:?}");
        }
        for preset in Setup::presets() {
            assert_eq!(unheeded(&(preset.setup)().parameters, GpuDriven), None, "{}", preset.name);
        }
    }
}

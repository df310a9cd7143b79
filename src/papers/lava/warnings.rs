//! Surprises of a configuration that a user is warned of: options of splats where rays draw the surface, splats that are too small
//! for its slopes.

use super::parameters::{Parameters, SurfaceDraw, Variant};
use super::splats::SplatShape;
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

/// Share of the surface on slopes down which splats do not reach each other, from which on a picture shows more holes than lava's own.
const GAPING: f64 = 0.1;

/// Parameters on which it hangs how far splats reach; a preset's own are meant to.
const OF_REACH: [&str; 4] = ["space", "splats", "splat-radius", "surface-draw"];

/// A line on discs that leave holes in a surface of these texels, normals and heights: down a slope of the angle a, a disc is only
/// cos a times as wide on the map, on which splats lie evenly.
pub(super) fn gaping(p: &Parameters, given: &Given, variant: Variant, surface: &[[f32; 4]]) -> Option<String> {
    let is_drawn = p.surface_draw(variant) == SurfaceDraw::Splats && p.splat_shape == SplatShape::Disc;
    if !is_drawn || !OF_REACH.into_iter().any(|name| given.has(name)) {
        return None;
    }
    let apart_m = (p.space_m.x / p.splats[0] as f32).max(p.space_m.z / p.splats[1] as f32);
    let least_cos = f64::from(apart_m / (2.0 * p.splat_radius_m)).min(1.0);
    let (mut all, mut steep) = (0.0, 0.0);
    for &[_, up, _, _] in surface {
        // No area of a height field is upright.
        let up = f64::from(up).max(1e-6);
        all += 1.0 / up;
        steep += if up <= least_cos { 1.0 / up } else { 0.0 };
    }
    (steep > GAPING * all).then(|| {
        format!(
            "the splats leave holes: discs of {} m that lie {apart_m} m apart do not meet on slopes of more than {:.0} degrees, \
             {:.0} % of the lava; give a larger `splat-radius`, more `splats`, or the `splat-shape` fitted",
            p.splat_radius_m,
            least_cos.acos().to_degrees(),
            100.0 * steep / all
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_that_do_not_meet_on_the_slopes_are_told() {
        let slope = |degrees: f32| [degrees.to_radians().sin(), degrees.to_radians().cos(), 0.0, 0.5];
        // 2.5 centimetres apart: splats of that radius meet up to 60 degrees.
        let p = Parameters { splats: [160, 40], splat_radius_m: 0.025, ..Parameters::default() };
        let given: Given = std::iter::once("splats".to_owned()).collect();
        let told = |p: &Parameters, surface: &[[f32; 4]]| gaping(p, &given, Variant::Paper, surface);
        assert_eq!(told(&p, &[slope(0.0), slope(59.0)]), None);
        // Twice as long as it is wide on the map.
        let line = told(&p, &[slope(0.0), slope(60.5)]).unwrap();
        assert!(
            line.contains("discs of 0.025 m that lie 0.025 m apart") && line.contains("60 degrees, 67 %"),
            "{line}"
        );
        let few: Vec<_> = std::iter::repeat_n(slope(0.0), 20).chain([slope(60.5)]).collect();
        assert_eq!(told(&p, &few), None);
        assert_eq!(told(&Parameters { splat_shape: SplatShape::Fitted, ..p.clone() }, &[slope(80.0)]), None);
        assert_eq!(gaping(&p, &given, Variant::GpuDriven, &[slope(80.0)]), None);
        assert_eq!(gaping(&p, &Given::default(), Variant::Paper, &[slope(80.0)]), None);
        // Apart even where it is level.
        assert!(told(&Parameters { splat_radius_m: 0.01, ..p }, &[slope(0.0)]).unwrap().contains("100 %"));
    }

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
        for name in OF_SPLATS.into_iter().chain([OF_PRIMITIVES]).chain(OF_REACH) {
            assert!(Parameters::declared().iter().any(|option| option.name == name), "{name}");
        }
    }
}

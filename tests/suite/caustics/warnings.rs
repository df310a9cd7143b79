//! Warnings of a configuration: options that a variant does not heed, and light that point sampling does not show as it
//! is.

use std::slice::from_ref;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Paper as _;
use fumarole::measure::study::Study;
use fumarole::papers::caustics::reference::intersection_triangle;
use fumarole::papers::caustics::setup::Setup;
use fumarole::papers::caustics::{
    Caustics, CullSteps, IntensityRule, Parameters, ReceiverInput, Variant, WaveParameters,
};
use fumarole::scene::Light;
use glam::{Mat4, Vec3};

use super::drawing::Drawing;
use super::oracle::Oracle;
use super::scene::{OVERHEAD, floor, parameters};
use crate::common::{gpu_test, shaders_by};

const GRAZING: Light = Light::Parallel { direction: Vec3::new(1.0, -0.3, 0.2), intensity: Vec3::ONE };

fn warnings(device: &Arc<Device>, variant: Variant, parameters: &Parameters, receiver: &ReceiverInput) -> Vec<String> {
    parameters.validate().unwrap();
    let shaders = shaders_by(device, Compiler::Glslang);
    Caustics::new(&shaders, "test", variant, parameters, from_ref(receiver)).unwrap().warnings()
}

/// Folded light is warned of where photons show it on the pool's floor, and not for objects on the way to which the same water
/// does not fold it.
#[test]
fn folded_light_is_warned_of_where_points_are_sampled() {
    gpu_test(|device| {
        let waves = |amplitude_m| WaveParameters { amplitude_m, ..Parameters::default().waves };
        let default = parameters(OVERHEAD);
        assert_eq!(default.waves, Parameters::default().waves);
        let shallow = floor().mesh.transformed(&Mat4::from_translation(Vec3::Y * 2.0));
        let shallow = ReceiverInput { mesh: shallow, ..floor() };
        let is_warned = |variant, p: &Parameters, receiver: &ReceiverInput| {
            let found = warnings(device, variant, p, receiver);
            assert!(found.iter().all(|line| line.contains("folds light")), "{found:?}");
            !found.is_empty()
        };
        for variant in [Variant::LevelMap, Variant::LevelMapSmart, Variant::Culled, Variant::Volumetric] {
            assert!(is_warned(variant, &default, &floor()), "{variant:?}");
            assert!(!is_warned(variant, &Parameters { coverage: 4, ..default.clone() }, &floor()), "{variant:?}");
        }
        for variant in [Variant::Hit, Variant::Stencil] {
            assert!(!is_warned(variant, &default, &floor()), "{variant:?}");
        }
        assert!(!is_warned(Variant::LevelMap, &Parameters { waves: waves(0.005), ..default.clone() }, &floor()));
        assert!(!is_warned(Variant::LevelMap, &default, &shallow));
        assert!(is_warned(Variant::LevelMap, &Parameters { waves: waves(0.21), ..default }, &shallow));
    });
}

#[test]
fn receivers_that_rise_out_of_the_water_are_told() {
    gpu_test(|device| {
        let still =
            Parameters { waves: WaveParameters { count: 0, ..Parameters::default().waves }, ..parameters(OVERHEAD) };
        for (up_m, is_told) in [(2.9, false), (3.5, true)] {
            let mesh = floor().mesh.transformed(&Mat4::from_translation(Vec3::Y * up_m));
            for variant in [Variant::LevelMap, Variant::Stencil] {
                let found = warnings(device, variant, &still, &ReceiverInput { mesh: mesh.clone(), ..floor() });
                let dry = found.iter().find(|line| line.contains("0.50 m above the water's level"));
                assert_eq!(dry.is_some(), is_told, "{up_m}, {variant:?}: {found:?}");
            }
        }
    });
}

/// Slanted light goes farther through the water and is turned more: where it lands the water's cells are turned over, by the oracle's
/// rays, in water under which light from overhead is not.
#[test]
fn slanted_light_that_folds_is_warned_of() {
    gpu_test(|device| {
        let waves = WaveParameters { amplitude_m: 0.03, ..Parameters::default().waves };
        for (light, is_folded) in [(OVERHEAD, false), (GRAZING, true)] {
            let parameters = Parameters { waves, water_triangles: 40_000, ..parameters(light) };
            let receiver = floor();
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            // On the plane across the light through the floor's middle.
            let triangles = oracle.volumes.iter().filter_map(|v| intersection_triangle(v, &oracle.receiver, 0.0));
            let rises: Vec<f64> =
                triangles.map(|t| (t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]).y).collect();
            let share = rises.iter().filter(|rise| **rise < 0.0).count() as f64 / rises.len() as f64;
            println!("{light:?}: {share:.4} of the triangles are turned over");
            assert_eq!(share.min(1.0 - share) > 0.005, is_folded, "{share}");
            let found = warnings(device, Variant::LevelMap, &parameters, &receiver);
            assert_eq!(found.iter().any(|line| line.contains("folds light")), is_folded, "{light:?}: {found:?}");
        }
    });
}

#[test]
fn options_that_a_variant_does_not_heed_are_named() {
    gpu_test(|device| {
        let gentle = WaveParameters { amplitude_m: 0.005, ..Parameters::default().waves };
        let plain = Parameters { waves: gentle, ..parameters(OVERHEAD) };
        let smart = Parameters { culled_smart: true, ..plain.clone() };
        let near = Parameters { planes_within_m: Some(2.0), ..plain.clone() };
        let near_and_smart = Parameters { culled_smart: true, ..near.clone() };
        let sampled = Parameters { coverage: 2, intensity: IntensityRule::Vertex, ..plain.clone() };
        let layered = Parameters { layers: 2, ..plain.clone() };
        let stepwise = Parameters { cull: CullSteps { groups: false, ..CullSteps::EVERY }, ..plain.clone() };
        let shadowed = Parameters { shadows: true, ..plain.clone() };
        use Variant::{Culled, Hit, LevelMap, LevelMapSmart, Stencil, Volumetric};
        for (parameters, variant, names) in [
            (&plain, Stencil, None),
            (&smart, LevelMap, Some("level-map does not heed `smart`")),
            (&smart, LevelMapSmart, None),
            (&smart, Culled, None),
            (&near, LevelMap, None),
            (&near, Culled, None),
            (&near, Volumetric, Some("volumetric does not heed `planes-within`")),
            (&near_and_smart, Culled, Some("culled does not heed `planes-within`")),
            (&sampled, Volumetric, None),
            (&sampled, Hit, Some("hit does not heed `coverage`, `intensity`")),
            (&layered, Hit, None),
            (&layered, LevelMap, Some("level-map does not heed `layers`")),
            (&stepwise, Culled, None),
            (&stepwise, LevelMap, Some("level-map does not heed `cull`")),
            (&shadowed, Hit, None),
            (&shadowed, Stencil, Some("stencil does not heed `shadows`")),
        ] {
            let found = warnings(device, variant, parameters, &floor());
            assert_eq!(found.first().map(String::as_str), names, "{variant:?}");
            assert!(found.len() < 2, "{found:?}");
        }
    });
}

/// The thesis's own configurations have none of the options that depart from it.
#[test]
fn the_preset_of_table_5_1_is_the_thesiss() {
    let preset = Setup::presets().into_iter().find(|preset| preset.name == "5-1").unwrap();
    let p = (preset.setup)().parameters;
    assert_eq!((p.planes, p.map_size, p.water_triangles), (101, 512, 10_000));
    assert!(!p.shadows && !p.fresnel && !p.culled_smart && p.planes_within_m.is_none());
    assert_eq!((p.coverage, p.layers, p.intensity), (1, 1, IntensityRule::Face));
}

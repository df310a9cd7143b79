//! The variant `culled` lights what the level map lights, bit for bit.

use std::path::PathBuf;
use std::slice::from_ref;

use fumarole::gpu::Compiler;
use fumarole::measure::parameter::Choice as _;
use fumarole::measure::study::Study;
use fumarole::papers::caustics::setup::Setup;
use fumarole::papers::caustics::{CullSteps, IntensityRule, Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::{Light, MeshSource};
use glam::Vec3;

use super::drawing::Drawing;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, parameters, sphere, teapot};
use crate::common::gpu_test;

fn assert_same(one: &Drawing, other: &Drawing, case: &str) {
    for target in ["position-map", "caustics-map", "combined-map", "underwater-color"] {
        assert!(one.target(target) == other.target(target), "{case}: {target}");
    }
    assert!(one.target("caustics-map").iter().any(|&light| light > 0.0), "{case}: nothing is lit");
}

fn bunny() -> ReceiverInput {
    let bunny = MeshSource::File(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj")));
    Setup { meshes: vec![bunny], ..Setup::default() }.load().unwrap().receivers.swap_remove(0)
}

#[test]
fn culled_pairs_light_exactly_what_all_pairs_light() {
    gpu_test(|device| {
        let receivers = [teapot(), bowl(), bunny()];
        for (light, receiver) in
            [OVERHEAD, OBLIQUE, POINT].into_iter().flat_map(|l| receivers.iter().map(move |r| (l, r)))
        {
            for (planes, map_size) in [(1, 65), (31, 96)] {
                let parameters = Parameters { planes, map_size, ..parameters(light) };
                let [all, culled] = [Variant::LevelMap, Variant::Culled]
                    .map(|variant| Drawing::of(device, variant, &parameters, from_ref(receiver)));
                assert_same(&all, &culled, &format!("{} under {light:?}, {planes} planes", receiver.mesh.name));
            }
        }
    });
}

/// As the benchmark draws them: 101 planes, maps of 512 texels, 10,000 triangles.
#[test]
fn culling_loses_nothing_at_full_size() {
    gpu_test(|device| {
        for receiver in [teapot(), sphere(), bunny()] {
            let parameters = Parameters { planes: 101, map_size: 512, water_triangles: 10_000, ..parameters(OVERHEAD) };
            let [all, culled] = [Variant::LevelMap, Variant::Culled]
                .map(|variant| Drawing::of(device, variant, &parameters, from_ref(&receiver)));
            assert_same(&all, &culled, &receiver.mesh.name);
        }
    });
}

/// Every choice of steps draws the same light; groups of planes of which the last is not full.
#[test]
fn each_step_of_culling_loses_nothing() {
    gpu_test(|device| {
        for (receiver, light, planes) in [(teapot(), OBLIQUE, 75), (bowl(), POINT, 33)] {
            let parameters = Parameters { planes, map_size: 150, ..parameters(light) };
            let all = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            for &cull in CullSteps::ALL {
                let culled = Drawing::of(
                    device,
                    Variant::Culled,
                    &Parameters { cull, ..parameters.clone() },
                    from_ref(&receiver),
                );
                assert_same(&all, &culled, cull.name());
            }
        }
    });
}

/// Receivers three times as far away as `planes-within` have a third of the planes; culling follows the level map.
#[test]
fn receivers_far_away_have_fewer_planes() {
    gpu_test(|device| {
        let receivers = [teapot(), bowl()];
        let mut parameters = parameters(OBLIQUE);
        let middle = teapot().mesh.bounds().center();
        parameters.planes = 30;
        parameters.camera.eye = middle + Vec3::X * 9.0;
        for (within_m, planes) in [(None, 30), (Some(100.0), 30), (Some(3.0), 10), (Some(0.001), 1)] {
            parameters.planes_within_m = within_m;
            let [all, culled] = [Variant::LevelMap, Variant::Culled]
                .map(|variant| Drawing::of(device, variant, &parameters, &receivers));
            assert_eq!(all.plane_counts[0], planes, "{within_m:?}");
            assert_same(&all, &culled, &format!("{within_m:?}"));
            assert!(all.map("caustics-map", 0, 1) == culled.map("caustics-map", 0, 1), "{within_m:?}");
        }
    });
}

/// Steep water under low light, several receivers and lights, a multiple of the map, odd numbers of triangles, the other
/// compiler.
#[test]
fn culling_loses_nothing_at_the_edges() {
    gpu_test(|device| {
        let steep = WaveParameters { count: 8, amplitude_m: 0.2, wavelength_m: 1.2 };
        let low = Light::Parallel { direction: Vec3::new(1.0, -0.2, 0.1), intensity: Vec3::ONE };
        let base = parameters(OVERHEAD);
        let cases = [
            Parameters { waves: steep, planes: 31, ..parameters(low) },
            Parameters { lights: vec![OBLIQUE, POINT], planes: 17, map_size: 97, water_triangles: 777, ..base.clone() },
            Parameters { coverage: 3, planes: 9, ..base.clone() },
            Parameters { intensity: IntensityRule::Vertex, planes: 9, ..base.clone() },
            Parameters { shadows: true, intensity: IntensityRule::Vertex, coverage: 2, planes: 9, ..parameters(low) },
            Parameters { shadows: true, lights: vec![OBLIQUE, POINT], planes: 17, ..base.clone() },
            Parameters { map_size: 1, water_triangles: 2, ..base },
        ];
        let receivers = [teapot(), bowl()];
        for (number, parameters) in cases.iter().enumerate() {
            let all = Drawing::of(device, Variant::LevelMap, parameters, &receivers);
            for compiler in [Compiler::Glslang, Compiler::Naga] {
                let all = match compiler {
                    Compiler::Glslang => &all,
                    Compiler::Naga => {
                        &Drawing::compiled_by(compiler, device, Variant::LevelMap, parameters, &receivers)
                    }
                };
                let culled = Drawing::compiled_by(compiler, device, Variant::Culled, parameters, &receivers);
                assert!(all.target("caustics-map") == culled.target("caustics-map"), "case {number}");
                assert!(all.map("caustics-map", 0, 1) == culled.map("caustics-map", 0, 1), "case {number}");
                assert!(all.target("underwater-color") == culled.target("underwater-color"), "case {number}");
            }
        }
    });
}

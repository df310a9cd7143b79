//! Variant against variant, run against run, compiler against compiler.

use std::slice::from_ref;

use fumarole::gpu::Compiler;
use fumarole::image::compare;
use fumarole::measure::Variant as _;
use fumarole::papers::caustics::{Parameters, Variant};
use glam::Vec3;

use super::drawing::Drawing;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, parameters, sphere, teapot, tilted_plane};
use crate::common::gpu_test;

/// Relative difference of two values that were stored as half floats once and twice.
const HALF_FLOATS: f32 = 2e-3;

#[test]
fn volumetric_lights_what_the_level_map_lights() {
    gpu_test(|device| {
        for (light, planes) in [(OVERHEAD, 9), (OBLIQUE, 9), (POINT, 9), (OBLIQUE, 1), (OBLIQUE, 31)] {
            for receiver in [teapot(), sphere(), tilted_plane(), bowl()] {
                let parameters = Parameters { planes, ..parameters(light) };
                let [level, slices] = [Variant::LevelMap, Variant::Volumetric]
                    .map(|v| Drawing::of(device, v, &parameters, from_ref(&receiver)));
                let pairs =
                    level.target("combined-map").chunks_exact(4).zip(slices.target("combined-map").chunks_exact(4));
                let texels = pairs.len();
                let agree = |(a, b): &(&[f32], &[f32])| {
                    let (a, b) = (Vec3::from_slice(a), Vec3::from_slice(b));
                    (a - b).abs().cmple(a.max(b) * HALF_FLOATS + 1e-6).all()
                };
                let off = texels - pairs.filter(agree).count();
                println!("{} under {light:?}, {planes} planes: {off} of {texels} texels differ", receiver.mesh.name);
                assert!(off * 1000 <= texels, "{} under {light:?}, {planes} planes: {off}", receiver.mesh.name);
            }
        }
    });
}

/// A plane seen from one side is in one slice everywhere; at a boundary of cells rounding may open or double a texel.
#[test]
fn a_tilted_plane_is_in_one_slice_everywhere() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE] {
            let parameters = parameters(light);
            let receiver = [tilted_plane()];
            let slices = Drawing::of(device, Variant::Volumetric, &parameters, &receiver);
            let level = Drawing::of(device, Variant::LevelMap, &parameters, &receiver);
            let heights = level.target("position-map");
            let alpha: Vec<f32> = slices.target("illumination-map").chunks_exact(4).map(|texel| texel[3]).collect();
            assert_eq!(alpha.len(), heights.len() * parameters.planes as usize);
            let in_slices = |texel: usize| alpha[texel..].iter().step_by(heights.len()).sum::<f32>();
            let once = |texel: &usize| in_slices(*texel) == if heights[*texel] > -1e29 { 1.0 } else { 0.0 };
            let off = heights.len() - (0..heights.len()).filter(once).count();
            assert!(off <= 2, "{off} texels are in no slice or in several");
        }
    });
}

#[test]
fn the_passes_are_those_of_the_thesis() {
    gpu_test(|device| {
        let passes = |variant, mrt| {
            let parameters = Parameters { mrt, ..parameters(OBLIQUE) };
            let drawing = Drawing::of(device, variant, &parameters, &[sphere()]);
            drawing.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect::<Vec<_>>()
        };
        let water = [("water-surface", 1), ("illumination-volumes", 1)];
        let with_water =
            |before: &[(&'static str, u32)], after: &[(&'static str, u32)]| [before, &water, after].concat();
        let level = [("caustics-map", 9), ("combine", 1), ("cast", 1), ("view", 1)];
        assert_eq!(
            passes(Variant::LevelMap, true),
            with_water(&[("reference-planes", 1), ("position-diffuse-map", 1)], &level)
        );
        assert_eq!(
            passes(Variant::LevelMap, false),
            with_water(&[("reference-planes", 1), ("position-map", 1), ("diffuse-map", 1)], &level)
        );
        let volumetric = [("caustics-map", 9), ("multiply", 9), ("combine-slices", 1), ("cast", 1), ("view", 1)];
        assert_eq!(
            passes(Variant::Volumetric, true),
            with_water(&[("sample-planes", 1), ("slice-images", 9)], &volumetric)
        );
        // Overhead, so that the light sees the sphere's upper half: with eight gaps of epsilon between nine planes,
        // four.
        let parameters = parameters(OVERHEAD);
        let smart = Drawing::of(device, Variant::LevelMapSmart, &parameters, &[sphere()]);
        let smart: Vec<_> = smart.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect();
        let profiled = [("bounding-box", 1), ("position-diffuse-map", 1), ("read-positions", 1), ("depth-profile", 1)];
        let four = [("caustics-map", 4), ("combine", 1), ("cast", 1), ("view", 1)];
        assert_eq!(smart, with_water(&profiled, &four));
        let culled = Drawing::of(device, Variant::Culled, &parameters, &[sphere()]);
        let culled: Vec<_> = culled.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect();
        let found = [("position-pyramid", 6), ("cull", 1), ("cull-count", 1), ("cull-sum", 1)];
        let drawn = [("cull-compact", 1), ("caustics-map", 1), ("combine", 1), ("cast", 1), ("view", 1)];
        let before = [("reference-planes", 1), ("position-diffuse-map", 1)];
        assert_eq!(culled, with_water(&before, &[&found[..], &drawn[..]].concat()));
        let smart = Parameters { culled_smart: true, ..parameters.clone() };
        let smart = Drawing::of(device, Variant::Culled, &smart, &[sphere()]);
        let smart: Vec<_> = smart.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect();
        let placed = [found[0], ("depth-profile", 1), ("sub-boxes", 1), ("smart-planes", 1)];
        let before = [("bounding-box", 1), ("position-diffuse-map", 1)];
        assert_eq!(smart, with_water(&before, &[&placed[..], &found[1..], &drawn[..]].concat()));
        let hit = Drawing::of(device, Variant::Hit, &parameters, &[sphere()]);
        let hit: Vec<_> = hit.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect();
        let landed = [("position-pyramid", 6), ("empty-sums", 1), ("intersect", 1), ("land", 1), ("straddle", 1)];
        let drawn = [("caustics-map", 1), ("combine", 1), ("cast", 1), ("view", 1)];
        let before = [("bounding-box", 1), ("position-diffuse-map", 1)];
        assert_eq!(hit, with_water(&before, &[&landed[..], &drawn[..]].concat()));
        let stencil = Drawing::of(device, Variant::Stencil, &parameters, &[sphere()]);
        let two_draws = 2 * stencil.grid.triangle_count();
        let stencil: Vec<_> = stencil.passes.iter().map(|pass| (pass.info.name, pass.calls)).collect();
        assert_eq!(stencil, with_water(&[("receivers", 1)], &[("stencil-volumes", two_draws), ("view", 1)]));
    });
}

#[test]
fn one_seed_gives_one_picture_and_another_seed_another() {
    gpu_test(|device| {
        for &variant in Variant::ALL {
            let [first, again, other] = [1, 1, 2].map(|seed| {
                let parameters = Parameters { seed, ..parameters(OBLIQUE) };
                Drawing::of(device, variant, &parameters, &[teapot()]).picture
            });
            assert_eq!(first, again);
            assert!(compare(&first, &other, None).unwrap().mean > 0.2);
        }
    });
}

#[test]
fn both_shader_compilers_draw_one_picture() {
    gpu_test(|device| {
        let mut parameters = parameters(OBLIQUE);
        parameters.camera = Parameters::camera_above(parameters.water_depth_m);
        for &variant in Variant::ALL {
            let [glslang, naga] = [Compiler::Glslang, Compiler::Naga].map(|compiler| {
                let drawing = Drawing::compiled_by(compiler, device, variant, &parameters, &[teapot()]);
                // Naga knows no atomics.
                let both = drawing.passes.iter().filter(|pass| !["land", "straddle"].contains(&pass.info.name));
                let mut compilers = both.filter_map(|pass| pass.info.compiler);
                assert!(compilers.all(|used| used == compiler));
                drawing.picture
            });
            let difference = compare(&glslang, &naga, None).unwrap();
            println!("{}: {difference:?}", variant.as_str());
            assert!(difference.mean <= 0.01 && difference.p99 <= 0.5, "{difference:?}");
        }
    });
}

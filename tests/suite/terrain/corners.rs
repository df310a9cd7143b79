//! Rays that read a cell's corners by one fetch: nothing may be seen of it.

use fumarole::gpu::Compiler;
use fumarole::measure::Paper as _;
use fumarole::papers::terrain::{Base, Corners, Inputs, Interpolation, Lod, MapInput, Parameters, Variant};
use fumarole::scene::random::Random;

use super::drawing::{Drawing, Painter};
use super::maps::{adversaries, alone, ridges, volcano};
use crate::common::gpu_test;

const VARIANTS: [Variant; 2] = [Variant::DdaCompute, Variant::DdaFragment];

fn small(corners: Corners, base: Base, lod: Lod) -> Parameters {
    Parameters { corners, base, lod, shadows: true, width: 83, height: 61, ..Parameters::default() }
}

fn assert_same(what: &str, packed: &Drawing, image: &Drawing) {
    // The steps to it too.
    let differ = packed.hits.iter().zip(&image.hits).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0, "{what}: hits");
    assert!(packed.normals == image.normals, "{what}: normals");
    assert!(packed.sunlit == image.sunlit, "{what}: shadows");
    assert!(packed.picture.pixels() == image.picture.pixels(), "{what}: the picture");
}

#[test]
fn rays_that_read_corners_by_one_fetch_see_the_same() {
    let mut maps: Vec<(&str, Vec<MapInput>)> =
        adversaries().into_iter().map(|(name, map)| (name, alone(map))).collect();
    let adversaries = maps.len();
    maps.push(("volcano", alone(volcano(100))));
    maps.push(("wide", alone(ridges(&mut Random::new(71), (1023, 601), 3000.0))));
    maps.push(("high", alone(ridges(&mut Random::new(72), (60, 130), 3000.0))));
    let two = [volcano(60), ridges(&mut Random::new(73), (65, 33), 900.0)].into_iter().flat_map(alone).collect();
    maps.push(("two", two));
    gpu_test(|device| {
        let mut seen = 0;
        for (index, (name, maps)) in maps.iter().enumerate() {
            let [compute, fragment] = VARIANTS;
            let ways = [
                (Base::Plane, Lod::Exact, fragment),
                (Base::Plane, Lod::Pixel, compute),
                (Base::Cylinder { radius_m: 30_000.0 }, Lod::Exact, compute),
                (Base::EARTH, Lod::Pixel, fragment),
            ];
            // What breaks bounds breaks them over a plane.
            for &(base, lod, variant) in &ways[..if index < adversaries { 2 } else { 4 }] {
                let [packed, image] = [Corners::Packed, Corners::Image]
                    .map(|corners| Drawing::of(device, variant, &small(corners, base, lod), maps));
                assert_same(&format!("{name} {base:?} {lod:?} {variant:?}"), &packed, &image);
                seen += packed.hits.iter().filter(|hit| hit.shift > 0).count();
            }
        }
        assert!(seen > 1000, "{seen} hits at coarser levels");
    });
}

#[test]
fn both_compilers_read_the_same_corners() {
    gpu_test(|device| {
        let maps = alone(ridges(&mut Random::new(74), (120, 97), 3000.0));
        let inputs = Inputs { maps: &maps, ..Inputs::default() };
        for variant in VARIANTS {
            let [packed, image] = [Corners::Packed, Corners::Image].map(|corners| {
                let parameters = small(corners, Base::Plane, Lod::Pixel);
                Painter::new(device, Compiler::Naga, variant, &parameters, &inputs).draw()
            });
            assert_same(&format!("{variant:?}"), &packed, &image);
        }
    });
}

/// Small maps are packed where nobody says; bicubic ones have no corners to pack, and other variants none to read.
#[test]
fn what_is_read_is_told() {
    gpu_test(|device| {
        let maps = alone(volcano(40));
        let inputs = Inputs { maps: &maps, ..Inputs::default() };
        let of = |variant, corners, interpolation| {
            let parameters = Parameters { interpolation, ..small(corners, Base::Plane, Lod::Pixel) };
            let paper = Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs).paper;
            (paper.corners(), paper.warnings().iter().any(|warning| warning.contains("`corners`")))
        };
        let fragment = Variant::DdaFragment;
        assert_eq!(of(fragment, Corners::Auto, Interpolation::Bilinear), (Some(Corners::Packed), false));
        assert_eq!(of(fragment, Corners::Image, Interpolation::Bilinear), (Some(Corners::Image), false));
        assert_eq!(of(fragment, Corners::Packed, Interpolation::Bicubic), (Some(Corners::Image), true));
        assert_eq!(of(Variant::GpuFragment, Corners::Packed, Interpolation::Bilinear), (None, false));
    });
}

//! Estimates of a configuration before anything is allocated, against the bytes that are allocated then.

use std::ffi::OsStr;

use fumarole::gpu::Compiler;
use fumarole::measure::parameter::Given;
use fumarole::measure::study::Study;
use fumarole::measure::{Paper, Variant};
use fumarole::papers::{burning, caustics, gas, lava, terrain};

use crate::common::{gpu_test, shaders_by};

/// Bytes beside the estimate: blocks of constants, alignment, and what the limits of few texels need.
const SMALL: f64 = 64.0 * 1024.0;
/// Estimated over allocated bytes, beyond those.
const SHARE: std::ops::RangeInclusive<f64> = 0.9..=1.15;

/// Makes every variant of each set-up; parameters are parted by spaces.
fn is_estimated<S: Study>(set_ups: &[&str]) {
    gpu_test(|device| {
        for parameters in set_ups {
            let mut study = S::default();
            let words: Vec<(&str, &str)> = parameters.split(' ').filter_map(|word| word.split_once('=')).collect();
            for declared in S::parameters() {
                let values: Vec<&OsStr> = words
                    .iter()
                    .filter(|(name, _)| *name == declared.name)
                    .map(|(_, value)| OsStr::new(value))
                    .collect();
                if !values.is_empty() {
                    declared.set(&mut study, &values).expect("it is a value of it");
                }
            }
            let given: Given = words.iter().map(|(name, _)| (*name).to_owned()).collect();
            study.resolve(&given).unwrap();
            let scene = study.load().unwrap();
            let shaders = shaders_by(device, Compiler::Glslang);
            for &variant in S::Variant::ALL {
                let what = format!("{} {} {parameters}", S::PAPER, variant.as_str());
                let estimate = study.estimate(device, &scene, variant);
                let estimated: f64 = estimate.bytes.iter().map(|(_, bytes)| bytes).sum();
                let paper = study.make(&shaders, "test", &scene, variant).unwrap();
                let made = device.live().total_bytes() as f64;
                println!("{what}: {estimated} bytes estimated, {made} made, {}", paper.targets().len());
                let is_near = SHARE.contains(&(estimated / made)) || (estimated - made).abs() < SMALL;
                assert!(is_near, "{what}: {estimated} bytes estimated, {made} made: {:?}", estimate.bytes);
                assert!(estimate.check(device, "test").is_ok(), "{what}");
                assert!(estimate.invocations.iter().all(|(_, count)| count.is_finite() && *count >= 0.0), "{what}");
            }
        }
    });
}

#[test]
fn lava_is_estimated() {
    is_estimated::<lava::setup::Setup>(&["size=320x200 splats=60x15", "particles=20000 density=64x32x48 size=64x48"]);
}

#[test]
fn gas_is_estimated() {
    is_estimated::<gas::setup::Setup>(&[
        "size=320x200 table=24",
        "size=64x48 table=48 object=teapot light=0,-1,0 light=1,-1,0",
        "size=320x200 table=24 object=bunny lists=tiles",
        "size=64x48 table=8 froxels=70x50x60",
    ]);
}

#[test]
fn caustics_is_estimated() {
    is_estimated::<caustics::setup::Setup>(&[
        "size=320x200 map-size=128 planes=7",
        "size=64x48 map-size=64 mesh=bunny mesh=box floor=true light=0,-1,0 light=1,-1,0 water-triangles=40000 planes=3",
        "size=64x48 map-size=64 layers=3 mesh=box floor=true planes=3",
        "size=64x48 map-size=64 smart=true levels=300 planes=9 water-triangles=4000",
        "size=64x48 map-size=64 coverage=4 shadows=true mesh=box planes=9 water-map=volcano water-map-range=0.1 water-map-spacing=0.01",
    ]);
}

#[test]
fn burning_is_estimated() {
    is_estimated::<burning::setup::Setup>(&[
        "size=320x200 triangles=900 levels=2",
        "size=64x48 mesh=box levels=4 blocks=16x16x16 fire=40000",
    ]);
}

#[test]
fn terrain_is_estimated() {
    is_estimated::<terrain::setup::Setup>(&[
        "size=320x200 resolution=200 shadows=true",
        "size=64x48 resolution=400 interpolation=bicubic object=teapot shadows=true",
        "size=320x200 map=volcano map=maunga-whau shadows=true object=bunny",
    ]);
}

//! Every variant with both compilers on the device of the tests, under the current layer.

use std::path::Path;

use super::{CAUSTICS, CAUSTICS_SMART, Paper, TINY, layer_manifest, library};
use crate::cli::program::{ONCE, folder};
use crate::faults::Layer;

/// Compilers of a run's passes.
fn compilers(run: &serde_json::Value) -> Vec<&str> {
    let passes = run["passes"].as_array().unwrap().iter();
    passes.filter_map(|pass| pass["shader_compiler"].as_str()).collect()
}

fn assert_clean(paper: &Paper) {
    let folder = folder();
    for compiler in ["glslang", "naga"] {
        let program = paper.run("bench --quiet --json").args(ONCE).args("--shader-compiler").arg(compiler);
        let program = program.args("--variant").arg(paper.variants);
        let ended = paper.under_current_layer(program.on_test_device(), &folder).run().succeeded();
        let record = ended.json();
        let runs = record["runs"].as_array().unwrap();
        assert_eq!(runs.len(), paper.variants().len());
        for run in runs {
            assert_eq!(run["validation"], "clean");
            // The CPU's variant of `terrain` has no shader.
            let compilers = compilers(run);
            assert!(compilers.is_empty() || compilers.contains(&compiler), "{}: {compilers:?}", run["variant"]);
        }
    }
}

#[test]
fn lava_is_clean() {
    assert_clean(&TINY[0].1);
}

#[test]
fn gas_is_clean() {
    assert_clean(&TINY[1].1);
}

#[test]
fn caustics_is_clean() {
    assert_clean(&TINY[2].1);
    let scene = "--size 32x24 --map-size 16 --water-triangles 100 --mesh box --smart";
    assert_clean(&Paper { scene, ..CAUSTICS_SMART });
}

#[test]
fn burning_is_clean() {
    assert_clean(&TINY[3].1);
}

#[test]
fn terrain_is_clean() {
    assert_clean(&TINY[4].1);
}

/// The manifest of these tests is the one that the loader takes.
#[test]
fn a_layer_that_cannot_be_loaded_ends_with_3() {
    let folder = folder();
    layer_manifest(&folder, Path::new("/no/such/layer.so"));
    let program = CAUSTICS.run("bench --quiet --validate").args(ONCE).on_test_device();
    program.env("VK_LAYER_PATH", folder.path()).run().refused(3, &["instance"]);
}

/// Clean runs say nothing of a layer that does not look: both see what is missing where nothing waits. The current one compares what
/// shaders read and write where its heuristic is on, and `gas` does nothing else that must wait.
#[test]
fn barriers_that_wait_for_nothing_are_told() {
    let name = "libVkLayer_khronos_validation.so";
    let layer = Layer::new();
    for (paper, scene) in TINY {
        let compares = scene.compares_shader_accesses;
        for (layer_library, compares) in [(Path::new(name), true), (&library(name), compares)] {
            let program = scene.run("bench --quiet").args(ONCE).on_test_device();
            let program = program.env("VK_SYNCVAL_SHADER_ACCESSES_HEURISTIC", compares.to_string());
            let ended = layer.above(layer_library, program).env("FUMAROLE_LAYER_DROPS_BARRIERS", "1").run();
            let (code, said) = (ended.status.code(), &ended.stderr);
            let is_told = code == Some(1) && said.contains("SYNC-HAZARD-");
            assert!(is_told || !compares, "{paper} under {}: {code:?}: {said}", layer_library.display());
        }
    }
}

//! `bench --profile` and `--capture`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::program::{ONCE, assert_schema, caustics, entries, folder, gas, read_json};
use crate::faults::Layer;
use crate::faults::lent::{assert_clean, label};

/// The library that stands for RenderDoc, which `cargo test` builds beside the programs, under RenderDoc's name in `folder`.
pub fn renderdoc(folder: &Path) {
    let programs = Path::new(env!("CARGO_BIN_EXE_fumarole")).parent().unwrap();
    let library = programs.join("examples/libtest_renderdoc.so");
    fs::copy(&library, folder.join("librenderdoc.so")).unwrap_or_else(|e| {
        panic!("{}: {e}: cargo build --release --locked --example test_renderdoc", library.display())
    });
}

#[test]
fn a_profile_runs_both_compilers_and_says_what_is_absent() {
    let out = folder();
    let record = out.path().join("a.json");
    let bench = caustics("bench --profile caustics-map --variant level-map,stencil").tiny();
    let ended = bench.args("--frames 2 --repeat 1 --warmup 1 --json").arg(&record).run().succeeded();
    for part in [
        "level-map: caustics-map",
        "GPU time of 2 frames",
        "counters: calls ",
        "bytes: read ",
        "floor: ",
        "glslang",
        "naga",
    ] {
        assert!(ended.stdout.contains(part), "{part} in\n{}", ended.stdout);
    }
    let record = read_json(&record);
    assert_schema(&record);
    let profile = &record["runs"][0]["profile"];
    assert_eq!(profile["pass"], "caustics-map");
    let [glslang, naga] = [&profile["compilers"][0], &profile["compilers"][1]];
    assert_eq!((&glslang["compiler"], &naga["compiler"]), (&Value::from("glslang"), &Value::from("naga")));
    for compiled in [glslang, naga] {
        assert!(compiled["gpu_ms"]["median"].as_f64().unwrap() > 0.0);
        assert!(compiled["fallback"].is_null(), "{compiled}");
        for binary in compiled["binaries"].as_array().unwrap() {
            let [bytes, instructions] = ["bytes", "instructions"].map(|name| binary[name].as_u64().unwrap());
            // An instruction is at least a word, and the header has five.
            assert!(instructions > 10 && bytes >= 4 * (instructions + 5), "{binary}");
        }
    }
    assert_ne!(glslang["binaries"], naga["binaries"], "each ran its own");
    assert!(record["runs"][1].get("profile").is_none(), "stencil has no such pass");
    if super::program::device() == "llvmpipe" {
        assert!(ended.stdout.contains("the device tells neither registers"), "{}", ended.stdout);
        assert!(ended.stdout.contains("VK_KHR_performance_query): the device has none"), "{}", ended.stdout);
        assert!(glslang["stages"].is_null() && profile["performance_counters"].is_null());
    }
}

#[test]
fn what_naga_has_no_binary_for_is_said() {
    let scene = "--size 24x16 --steps 4 --variant none --profile sort --frames 1 --repeat 1 --warmup 1 --no-limits";
    let ended = gas("bench").args(scene).on_test_device().run().succeeded();
    assert!(ended.stdout.contains("naga: gas/sort-one.comp: an atomic"), "{}", ended.stdout);
    assert!(ended.stdout.contains("floor: not known"), "no limits were measured: {}", ended.stdout);
}

#[test]
fn a_pass_that_is_not_there_is_refused_with_those_that_are() {
    let bench = caustics("bench --quiet --profile nothing --variant level-map").tiny().args(ONCE);
    bench.run().refused(2, &["--profile nothing", "caustics-map", "illumination-volumes"]);
}

#[test]
fn a_capture_without_renderdoc_is_refused_before_anything_is_measured() {
    let bench = caustics("bench --quiet --capture renderdoc --variant level-map").tiny().args(ONCE);
    bench.run().refused(2, &["capturing a frame", "not loaded", "renderdoccmd capture"]);
}

#[test]
fn renderdoc_captures_one_frame_of_each_variant() {
    let out = folder();
    renderdoc(out.path());
    let under_renderdoc = |options: &str| {
        let bench = caustics("bench --capture renderdoc --validate").tiny().args(ONCE).args(options).inside(out.path());
        bench.env("LD_LIBRARY_PATH", out.path()).env("LD_PRELOAD", "librenderdoc.so")
    };
    let ended = under_renderdoc("--variant level-map,volumetric --out captures").run().succeeded();
    let expected = ["caustics-level-map_frame0.rdc", "caustics-volumetric_frame1.rdc"];
    assert_eq!(entries(&out.path().join("captures")), expected);
    for name in expected {
        assert!(ended.stderr.contains(&format!("wrote captures/{name}")), "{}", ended.stderr);
    }
    // One frame, no more and no less, lies between the capture's two ends.
    let layer = Layer::new();
    let json = out.path().join("record.json");
    let bench = under_renderdoc("--variant level-map --out frame --json").arg(&json);
    let ended = layer.before(bench, false).run().succeeded();
    assert_clean(&layer.report(&ended));
    let captured = fs::read_to_string(out.path().join("frame/caustics-level-map_frame0.rdc")).unwrap();
    let record = read_json(&json);
    let of_device = record["runs"][0]["passes"].as_array().unwrap().iter().filter(|pass| pass["kind"] != "host");
    let expected: Vec<String> = of_device.map(label).collect();
    assert_eq!(captured.lines().collect::<Vec<_>>(), expected);

    // What was measured before is kept.
    let refused = under_renderdoc("--quiet --variant level-map --out refused --json kept.json");
    refused.run().refused(2, &["it captured nothing"]);
    let kept = read_json(&out.path().join("kept.json"));
    assert_schema(&kept);
    assert!(kept["runs"][0]["warnings"].to_string().contains("without a capture"), "{kept}");
    let refused = under_renderdoc("--quiet --variant level-map --processes 2 --out refused --json first.json");
    refused.run().refused(2, &["it captured nothing"]);
    assert_eq!(read_json(&out.path().join("first.json"))["runs"].as_array().unwrap().len(), 1);
}

//! Extensions that no device of the tests has, played by the layer next to the driver: what they tell is in the record, and
//! neither their rules as the layer keeps them nor a current Khronos layer's are broken.

use serde_json::Value;

use super::calls::{FAILURES, code, has_gone_on};
use super::{Layer, Report};
use crate::cli::program::{Ended, ONCE, Program, assert_schema, burning, caustics, gas, lava, terrain};
use crate::drivers::{layer_manifest, library};

/// Runs with `extensions` played, under the current Khronos layer.
fn lent(layer: &Layer, program: Program, extensions: &str) -> Program {
    layer_manifest(&layer.validation, &library("libVkLayer_khronos_validation.so"));
    layer.before(program, true).env("FUMAROLE_LAYER_LENDS", extensions)
}

pub fn assert_clean(report: &Report) {
    assert!(report.misuses.is_empty(), "{:?}", report.misuses);
    assert!(report.alive.is_empty(), "{:?}", report.alive);
}

/// The first run's profile, and its pass in the record.
fn profiled(ended: &Ended) -> (Value, Value) {
    let record = ended.json();
    assert_schema(&record);
    let run = &record["runs"][0];
    assert_eq!(run["validation"], "clean");
    let profile = run["profile"].clone();
    let passes = run["passes"].as_array().unwrap();
    let pass = passes.iter().find(|pass| pass["name"] == profile["pass"]).unwrap().clone();
    (profile, pass)
}

/// Profiles a pass with every counter that the layer plays, and gives the times that its frame records it.
fn assert_counted(program: Program, kind: &str) -> u64 {
    let layer = Layer::new();
    let ended = lent(&layer, program.args(ONCE).args("--quiet --json"), "performance-query").run().succeeded();
    assert_clean(&layer.report(&ended));
    let (profile, pass) = profiled(&ended);
    let names = ["draws", "dispatches", "render-passes", "traffic", "busy", "heat", "drift", "nothing"];
    assert_eq!(profile["performance_counters"], Value::from(names.to_vec()));
    assert!(profile.get("counters_unread").is_none());
    let mut recordings = 0;
    for compiled in profile["compilers"].as_array().unwrap() {
        let readings = &compiled["counters"];
        assert_eq!((&readings["replays"], &readings["left_out"]), (&4.into(), &Value::Array(vec![])), "two a replay");
        recordings = readings["recordings"].as_u64().unwrap();
        let counters = readings["counters"].as_array().unwrap();
        assert_eq!(counters.iter().map(|counter| counter["name"].as_str().unwrap()).collect::<Vec<_>>(), names);
        let value = |name: &str| &counters[names.iter().position(|known| *known == name).unwrap()]["value"];
        let calls = pass["calls"].clone();
        let zero = Value::from(0);
        let (draws, dispatches) = if kind == "compute" { (&zero, &calls) } else { (&calls, &zero) };
        assert_eq!((value("draws"), value("dispatches")), (draws, dispatches), "what the pass did and nothing else");
        let render_passes = if kind == "compute" { 0 } else { recordings };
        assert_eq!(*value("render-passes"), render_passes);
        assert_eq!(*value("traffic"), ((1u64 << 60) + 1) * recordings, "to the last digit");
        assert_eq!(*value("drift"), -7 * recordings as i64);
        assert_eq!((value("busy"), value("heat")), (&37.5.into(), &300.25.into()), "no sum of shares or temperatures");
        assert!(value("nothing").is_null(), "no number is absent");
        for counter in counters {
            let is_sum = ["1", "bytes", "cycles"].contains(&counter["unit"].as_str().unwrap());
            assert_eq!(counter["is_mean"], !is_sum && recordings > 1, "{counter}");
            assert_eq!(counter["category"], "played");
        }
        let told = |field: &str| counters.iter().map(|counter| counter[field].as_str().unwrap()).collect::<Vec<_>>();
        assert_eq!(told("unit"), ["1", "1", "1", "bytes", "%", "K", "cycles", "W"]);
        let [whole, part, one] = ["command buffer", "render pass", "command"];
        assert_eq!(told("scope"), [one, one, part, whole, whole, one, one, one]);
    }
    recordings
}

/// The label of a pass of a record.
pub fn label(pass: &Value) -> String {
    match pass["section"].as_str() {
        Some(section) => format!("{} ({section})", pass["name"].as_str().unwrap()),
        None => pass["name"].as_str().unwrap().to_owned(),
    }
}

#[test]
fn labels_and_pipelines_carry_pass_and_section() {
    let programs = [
        caustics("bench --variant level-map").tiny(),
        lava("bench --size 32x24 --particles 100 --radius 0.3 --density 8x4x4 --splats 10x5").on_test_device(),
        gas("bench --size 24x16 --steps 4 --variant table").on_test_device(),
        burning("bench --size 32x24 --mesh sphere --triangles 200 --blocks 2x2x2 --fire 20 --smoke 10")
            .on_test_device(),
        terrain("bench --variant gpu-fragment --size 32x24 --resolution 17").on_test_device(),
    ];
    for program in programs {
        let layer = Layer::new();
        let ended = layer.before(program.args(ONCE).args("--quiet --json"), false).run().succeeded();
        let report = layer.report(&ended);
        assert_clean(&report);
        let record = ended.json();
        let passes = record["runs"][0]["passes"].as_array().unwrap().iter();
        let mut sections = 0;
        for pass in passes.filter(|pass| pass["kind"] != "host") {
            sections += u32::from(pass["section"].is_string());
            let label = label(pass);
            assert!(report.labels.contains(&label), "{label} of {:?}", report.labels);
            let is_drawn = ["graphics", "compute"].contains(&pass["kind"].as_str().unwrap());
            assert!(!is_drawn || report.pipelines.contains(&label), "{label} of {:?}", report.pipelines);
        }
        assert!(sections >= 3);
    }
}

#[test]
fn counters_of_the_device_are_those_of_the_pass() {
    let program = caustics("bench --variant level-map --profile caustics-map").tiny();
    assert!(assert_counted(program, "graphics") >= 1);
    let scene = "--size 24x16 --steps 4 --variant none --profile sort";
    assert!(assert_counted(gas("bench").args(scene).on_test_device(), "compute") >= 1);
}

#[test]
fn a_table_of_counters_is_printed() {
    let layer = Layer::new();
    let program = caustics("bench --variant level-map --profile caustics-map").tiny().args(ONCE);
    let ended = lent(&layer, program, "performance-query").run().succeeded();
    for part in ["of frame 0, replayed 4 times", "traffic", "command buffer", "37.5", "300.25", "bytes"] {
        assert!(ended.stdout.contains(part), "{part} in\n{}", ended.stdout);
    }
}

#[test]
fn counters_that_another_process_has_are_said_to_be_unread() {
    let layer = Layer::new();
    let program = caustics("bench --variant level-map --profile caustics-map --quiet --json").tiny().args(ONCE);
    let ended = lent(&layer, program, "performance-query").env("FUMAROLE_LAYER_LOCKED", "1").run().succeeded();
    assert_clean(&layer.report(&ended));
    let (profile, _) = profiled(&ended);
    let reason = profile["counters_unread"].as_str().unwrap();
    assert!(reason.contains("profiling lock"), "{reason}");
    assert!(profile["compilers"][0]["counters"].is_null());
    assert_eq!(profile["performance_counters"].as_array().unwrap().len(), 8);
}

#[test]
fn what_the_drivers_compiler_tells_is_in_the_profile() {
    let layer = Layer::new();
    let program =
        lava("bench --size 32x24 --particles 100 --radius 0.3 --density 8x4x4 --splats 10x5 --splat-radius 0.2");
    let program = program.args("--profile blending").on_test_device().args(ONCE);
    let path = layer.folder.path().join("a.json");
    let ended = lent(&layer, program.arg("--json").arg(&path), "executable-properties").run().succeeded();
    assert_clean(&layer.report(&ended));
    for part in ["registers 24, spills -1, occupancy 0.75, uses scratch true", "subgroups of 32", "assembly: 2 lines"] {
        assert!(ended.stdout.contains(part), "{part} in\n{}", ended.stdout);
    }
    let record = crate::cli::program::read_json(&path);
    assert_schema(&record);
    for compiled in record["runs"][0]["profile"]["compilers"].as_array().unwrap() {
        let stages = compiled["stages"].as_array().unwrap();
        assert_eq!(stages.len(), compiled["binaries"].as_array().unwrap().len(), "a stage for each binary");
        for (index, stage) in stages.iter().enumerate() {
            assert_eq!(stage["statistics"][0]["value"], (24 + index).to_string());
            assert_eq!(stage["texts"], serde_json::json!({ "assembly": "mov r0, r1\nexit" }));
        }
    }
}

#[test]
fn the_end_of_every_frame_is_told() {
    let layer = Layer::new();
    let frames = |frames: u32, extensions: &str| {
        let program = caustics("bench --variant level-map,volumetric --quiet --repeat 1 --warmup 1 --no-limits").tiny();
        let program = program.arg("--frames").arg(frames.to_string());
        let ended = lent(&layer, program, extensions).run().succeeded();
        let report = layer.report(&ended);
        assert_clean(&report);
        report.frames
    };
    let (two, five) = (frames(2, "frame-boundary"), frames(5, "frame-boundary"));
    assert_eq!(five - two, 2 * 3 * 3, "plain, timestamped and bracketed frames of two variants");
    assert_eq!(frames(2, ""), 0);
}

/// The last call of each name, which is the counters' where they use it, fails.
#[test]
fn a_count_that_fails_leaves_neither_lock_nor_queries() {
    let layer = Layer::new();
    let run = |failing: &str| {
        let program = caustics("bench --variant level-map --profile caustics-map --quiet --json").tiny().args(ONCE);
        let program = layer.before(program, false).env("FUMAROLE_LAYER_LENDS", "performance-query");
        program.env("FUMAROLE_LAYER_FAIL", failing).run()
    };
    let calls = layer.report(&run("").succeeded()).calls;
    for name in ["vkAcquireProfilingLockKHR", "vkEnumeratePhysicalDeviceQueueFamilyPerformanceQueryCountersKHR"] {
        assert!(calls.iter().any(|(called, _)| called == name), "{name} is not among {calls:?}");
    }
    let calls = calls.iter().filter(|(name, _)| name != "vkCreateInstance");
    for ((name, count), failure) in calls.zip(FAILURES.into_iter().cycle()) {
        let ended = run(&format!("{name}@{count}:{failure}"));
        let report = layer.report(&ended);
        assert_clean(&report);
        match code(name, failure) {
            // A wait is asked again where the machine is slow, and the run that was counted had more of them.
            _ if report.failed.is_none() => assert!(report.count(name) < *count, "{name}@{count} did not fail"),
            _ if has_gone_on(name, &ended) => {}
            0 => drop(ended.succeeded()),
            code if ended.stdout.is_empty() => ended.refused(code, &[]),
            // What was measured before the profile is kept.
            code => {
                assert_eq!((ended.status.code(), ended.stderr.lines().count()), (Some(code), 1), "{}", ended.stderr);
                let warnings = ended.json()["runs"][0]["warnings"].to_string();
                assert!(warnings.contains("without a profile: "), "{warnings}");
            }
        }
    }
}

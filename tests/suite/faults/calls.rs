//! Every call that returns a result fails once, in set-up and frames of each paper: the program ends with one line, frees
//! what it made and leaves old files alone.
//!
//! One call of each name fails in one way, drawn anew with `FUMAROLE_TEST_SEED`. With `FUMAROLE_TEST_ALL_FAULTS=FILE` every
//! call of every variant does, in [`rounds`]: out of host memory, out of device memory and with the device lost in turn, the
//! first and the last of each name in each way. The file keeps what was found, and a run that was ended goes on from there.

use std::env;
use std::fs;
use std::path::Path;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::{Layer, PAPERS, Paper, rounds};
use crate::cli::program::{Ended, ONCE, entries, folder};

pub const FAILURES: [&str; 3] = ["host", "device", "lost"];
/// Running out of memory for an object's name costs the name.
pub const HARMLESS: &str = "vkSetDebugUtilsObjectNameEXT";
/// The allocator takes other memory where the device has none left that the host can write, and so these may fail once.
pub const MEMORY: [&str; 2] = ["vkAllocateMemory", "vkMapMemory"];
/// Calls before there is a device.
const BEFORE_A_DEVICE: [&str; 6] = [
    "vkCreateInstance",
    "vkCreateDebugUtilsMessengerEXT",
    "vkEnumeratePhysicalDevices",
    "vkEnumerateDeviceExtensionProperties",
    "vkGetPhysicalDeviceCalibrateableTimeDomainsEXT",
    "vkCreateDevice",
];

/// The exit code of a run in which a call fails so.
pub fn code(name: &str, failure: &str) -> i32 {
    match name {
        HARMLESS if failure != "lost" => 0,
        _ if BEFORE_A_DEVICE.contains(&name) || name.contains("QueueFamilyPerformance") => 3,
        _ => 1,
    }
}

/// True of a run that had other memory in place of what a failing call would have given.
pub fn has_gone_on(name: &str, ended: &Ended) -> bool {
    MEMORY.contains(&name) && ended.status.success()
}

/// Calls of a sample, by name and number, and how they fail.
fn sample<'a>(paper: &Paper, calls: &'a [(String, usize)]) -> Vec<(&'a str, usize, &'static str)> {
    let seed = env::var("FUMAROLE_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let mut random = Pcg32::new(seed, paper.name.len() as u64);
    let mut below = |count: usize| random.next_u32() as usize % count;
    calls.iter().map(|(name, count)| (name.as_str(), 1 + below(*count), FAILURES[below(FAILURES.len())])).collect()
}

/// Runs a bench that replaces old files, with a call failing.
fn run(paper: &Paper, layer: &Layer, out: &Path, failing: &str) -> Ended {
    let program = paper.run("bench --quiet --json a.json --image a.png --trace a.trace").args(ONCE).inside(out);
    // Of many variants, whose calls are those of one.
    let program = match paper.name {
        "gas" => program.args("--variant table"),
        "terrain" => program.args("--variant gpu-compute"),
        _ => program,
    };
    layer.before(program, false).env("FUMAROLE_LAYER_FAIL", failing).run()
}

fn assert_faults_are_told(paper: &Paper) {
    if let Some(file) = env::var_os("FUMAROLE_TEST_ALL_FAULTS") {
        return rounds::assert_all_faults_are_told(paper, Path::new(&file));
    }
    let (layer, out) = (Layer::new(), folder());
    let ended = run(paper, &layer, out.path(), "").succeeded();
    let whole = layer.report(&ended);
    assert_eq!(whole.alive, [""; 0], "{}", paper.name);
    for name in ["vkCreateInstance", "vkGetCalibratedTimestampsEXT", "vkQueueSubmit2", "vkGetQueryPoolResults"] {
        assert!(whole.count(name) > 0, "{}: {name} is not among {:?}", paper.name, whole.calls);
    }
    // The record, the trace, and a picture of each variant.
    let written = entries(out.path());
    for (name, number, failure) in sample(paper, &whole.calls) {
        let what = format!("{} with {name}@{number}:{failure}", paper.name);
        for name in &written {
            fs::write(out.path().join(name), "old").unwrap();
        }
        let ended = run(paper, &layer, out.path(), &format!("{name}@{number}:{failure}"));
        if name == "vkCreateInstance" {
            // None was made, and so none was ended.
            ended.refused(3, &["instance"]);
            continue;
        }
        let report = layer.report(&ended);
        assert_eq!(report.alive, [""; 0], "{what}: {}", ended.stderr);
        if report.failed.is_none() {
            // A wait is asked again where the machine is slow, and the run that was counted had more of them.
            assert!(report.count(name) < number, "{what}: it did not fail");
            ended.succeeded();
            continue;
        }
        if has_gone_on(name, &ended) {
            continue;
        }
        let code = code(name, failure);
        assert_eq!(ended.status.code(), Some(code), "{what}: {}", ended.stderr);
        assert!(!ended.stderr.contains("allocating 0 bytes"), "{what}: {}", ended.stderr);
        if code == 0 {
            continue;
        }
        ended.refused(code, &[]);
        assert_eq!(entries(out.path()), written, "{what}");
        // A record tells of a picture that fails, and other variants' pictures may be drawn: each file is the old one or whole.
        for name in &written {
            let path = out.path().join(name);
            let bytes = fs::read(&path).unwrap();
            let is_whole = match name.ends_with(".png") {
                true => fumarole::image::read_png(&path).is_ok(),
                false => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
            };
            assert!(bytes == b"old" || is_whole, "{what}: {name}");
        }
    }
}

/// Under validation the program has the layer's messages sent to it. The Khronos layer above makes calls of its own, so the one
/// call alone fails.
#[test]
fn messages_that_cannot_be_had_are_told() {
    let layer = Layer::new();
    let name = "vkCreateDebugUtilsMessengerEXT";
    for failure in FAILURES {
        let program = layer.before(PAPERS[2].run("bench --quiet --json").args(ONCE), true);
        let ended = program.env("FUMAROLE_LAYER_FAIL", format!("{name}@1:{failure}")).run();
        let report = layer.report(&ended);
        assert_eq!((report.failed.as_deref(), report.alive), (Some(name), vec![]), "{}", ended.stderr);
        ended.refused(3, &["debug messenger"]);
    }
}

#[test]
fn lava_tells_of_failing_calls() {
    assert_faults_are_told(&PAPERS[0]);
}

#[test]
fn gas_tells_of_failing_calls() {
    assert_faults_are_told(&PAPERS[1]);
}

#[test]
fn caustics_tells_of_failing_calls() {
    assert_faults_are_told(&PAPERS[2]);
}

#[test]
fn burning_tells_of_failing_calls() {
    assert_faults_are_told(&PAPERS[3]);
}

#[test]
fn terrain_tells_of_failing_calls() {
    assert_faults_are_told(&PAPERS[4]);
}

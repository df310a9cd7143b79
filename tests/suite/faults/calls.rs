//! Every call that returns a result fails once, in set-up and frames of each paper: the program ends with one line, frees
//! what it made and leaves old files alone.
//!
//! `FUMAROLE_TEST_ALL_FAULTS=1` fails every call in every way, which takes hours; else a sample of them, drawn anew with
//! `FUMAROLE_TEST_SEED`.

use std::env;
use std::fs;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::{Layer, PAPERS, Paper};
use crate::cli::program::{Ended, ONCE, entries, folder};

const FAILURES: [&str; 3] = ["host", "device", "lost"];
/// Failing calls tried of each paper.
const SAMPLE: usize = 24;
/// Running out of memory for an object's name costs the name.
const HARMLESS: &str = "vkSetDebugUtilsObjectNameEXT";
/// Calls before there is a device.
const BEFORE_A_DEVICE: [&str; 3] =
    ["vkEnumeratePhysicalDevices", "vkEnumerateDeviceExtensionProperties", "vkCreateDevice"];

/// Numbers of the calls to fail, and how.
fn chosen(paper: &Paper, calls: usize) -> Vec<(usize, &'static str)> {
    let all = (1..=calls).flat_map(|call| FAILURES.map(|failure| (call, failure)));
    if env::var_os("FUMAROLE_TEST_ALL_FAULTS").is_some() {
        return all.collect();
    }
    let seed = env::var("FUMAROLE_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let mut random = Pcg32::new(seed, paper.name.len() as u64);
    let all: Vec<_> = all.collect();
    (0..SAMPLE).map(|_| all[random.next_u32() as usize % all.len()]).collect()
}

/// Runs a bench that replaces old files, with a call failing.
fn run(paper: &Paper, layer: &Layer, out: &std::path::Path, failing: &str) -> Ended {
    let program = paper.run("bench --quiet --json a.json --image a.png").args(ONCE).inside(out);
    layer.before(program, false).env("FUMAROLE_LAYER_FAIL", failing).run()
}

fn assert_faults_are_told(paper: &Paper) {
    let (layer, out) = (Layer::new(), folder());
    let ended = run(paper, &layer, out.path(), "0:host").succeeded();
    let whole = layer.report(&ended);
    assert_eq!(whole.alive, [""; 0], "{}", paper.name);
    // The record, and a picture of each variant.
    let written = entries(out.path());
    for (call, failure) in chosen(paper, whole.calls) {
        let what = format!("{} with {call}:{failure}", paper.name);
        for name in &written {
            fs::write(out.path().join(name), "old").unwrap();
        }
        let ended = run(paper, &layer, out.path(), &format!("{call}:{failure}"));
        if call == 1 {
            // No instance was made, and so none was ended.
            ended.refused(3, &["instance"]);
            continue;
        }
        let report = layer.report(&ended);
        let Some(name) = report.failed else {
            // A wait is asked again where the machine is slow, and the run that was counted had more of them.
            assert!(report.calls < call, "{what}: nothing failed in {} calls", report.calls);
            ended.succeeded();
            continue;
        };
        let what = format!("{what} ({name})");
        assert_eq!(report.alive, [""; 0], "{what}: {}", ended.stderr);
        if name == HARMLESS && failure != "lost" {
            ended.succeeded();
            continue;
        }
        let code = if BEFORE_A_DEVICE.contains(&name.as_str()) { 3 } else { 1 };
        assert_eq!(ended.status.code(), Some(code), "{what}: {}", ended.stderr);
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

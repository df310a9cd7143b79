//! `stress`: every paper climbs, and whatever ends a step or the call leaves a record that the next call goes on with.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::program::{Program, burning, caustics, entries, folder, fumarole, gas, lava, read_json, terrain};
use crate::common::beside_others;

/// Far above what a step of these scenes takes.
const SOON: Duration = Duration::from_secs(60);

pub fn assert_schema(record: &Value) {
    let read = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    let bench = read(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.bench-1.json")));
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.stress-1.json"));
    let mut schema = read(&text.replace("urn:fumarole:bench-1#", "#"));
    for (name, part) in bench["$defs"].as_object().unwrap() {
        let parts = schema["$defs"].as_object_mut().unwrap();
        assert!(name == "sha256" || !parts.contains_key(name), "{name} is in both schemas");
        parts.entry(name).or_insert_with(|| part.clone());
    }
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(record).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

pub fn steps(record: &Value) -> Vec<Value> {
    record["series"].as_array().unwrap().iter().flat_map(|series| series["steps"].as_array().unwrap().clone()).collect()
}

fn values(record: &Value) -> Vec<u64> {
    steps(record).iter().map(|step| step["value"].as_u64().unwrap()).collect()
}

pub fn kinds(record: &Value) -> Vec<&str> {
    record["series"].as_array().unwrap().iter().map(|series| series["stop"]["kind"].as_str().unwrap()).collect()
}

/// The record in a folder that holds one.
pub fn record(folder: &Path) -> Value {
    let name = entries(folder).into_iter().find(|name| name.ends_with(".json")).expect("a record");
    let record = read_json(&folder.join(name));
    assert_schema(&record);
    record
}

/// A climb of a few steps, which begins with these.
fn assert_climbs(program: Program, expected: &[u64]) -> TempDir {
    let out = folder();
    let ended = program.args("--budget 40 --out").arg(out.path()).on_test_device().run().succeeded();
    let record = record(out.path());
    // A busy machine may not come to the end.
    let (found, kind) = (values(&record), kinds(&record)[0].to_owned());
    assert!(found.starts_with(expected) && ["end", "time"].contains(&kind.as_str()), "{found:?} {kind}");
    assert!(
        ended.stdout.contains(&format!("stopped by {kind}")) && ended.stdout.contains("exponent"),
        "{}",
        ended.stdout
    );
    let rows = entries(out.path()).into_iter().find(|name| name.ends_with(".csv")).unwrap();
    let rows = fs::read_to_string(out.path().join(rows)).unwrap();
    let passes: usize = steps(&record).iter().map(|step| step["run"]["passes"].as_array().unwrap().len()).sum();
    assert_eq!(rows.lines().count(), 1 + passes);
    let plot = entries(out.path()).into_iter().find(|name| name.ends_with(".svg")).unwrap();
    roxmltree::Document::parse(&fs::read_to_string(out.path().join(plot)).unwrap()).unwrap();
    for step in steps(&record) {
        let run = &step["run"];
        let rate = step["amount"].as_f64().unwrap() / run["frame_ms"]["median"].as_f64().unwrap() * 1e3;
        assert!((step["throughput_per_s"].as_f64().unwrap() / rate - 1.0).abs() < 1e-9);
        assert!(run["memory"]["by_resource"].as_array().unwrap().len() > 2 && run["load_ms"].is_number());
        assert_eq!((run["frames"].as_u64(), run["repeat"].as_u64()), (Some(1), Some(3)));
    }
    let costs = record["series"][0]["costs"].as_array().unwrap();
    let names: Vec<&str> = costs.iter().map(|cost| cost["name"].as_str().unwrap()).collect();
    for pass in steps(&record)[0]["run"]["passes"].as_array().unwrap() {
        assert!(names.contains(&pass["name"].as_str().unwrap()) || pass["gpu_ms"].is_null(), "{names:?}");
    }
    assert!(["frame", "load", "pipelines", "device memory", "process memory"].iter().all(|name| names.contains(name)));
    out
}

const SMALL: &str = "--size 64x48 --map-size 32 --water-triangles 200";

#[test]
fn caustics_climbs_to_the_end_of_its_planes() {
    let out = assert_climbs(caustics("stress --axis planes --from 512 --factor 2.5").args(SMALL), &[512, 1280]);
    // What reads a bench's record reads this one.
    let path = out.path().join("stress-caustics-planes.json");
    let compared = fumarole("compare").arg(&path).arg(&path).run().succeeded();
    assert!(
        compared.stdout.contains("SAME: frame") && !compared.stdout.contains("UNCLEAR: frame"),
        "{}",
        compared.stdout
    );
    fumarole("report --output").arg(out.path().join("page.html")).arg(out.path()).run().succeeded();
    let page = fs::read_to_string(out.path().join("page.html")).unwrap();
    assert!(page.contains("caustics-map") && page.contains("stress-caustics-planes.svg"));
}

#[test]
fn lava_climbs() {
    let scene = "stress --axis splats --from 400 --factor 4 --size 32x24 --particles 50 --density 8x8x8";
    let out = assert_climbs(lava(scene), &[400, 1600]);
    assert_eq!(steps(&record(out.path()))[0]["run"]["config"]["splats"], json!([40, 10]));
}

#[test]
fn gas_climbs() {
    let out = assert_climbs(gas("stress --axis lights --size 45x31 --variant table"), &[1, 2, 4]);
    let record = record(out.path());
    let lights = |step: &Value| step["run"]["config"]["lights"].as_array().unwrap().len();
    assert_eq!(steps(&record).iter().map(lights).collect::<Vec<_>>(), [1, 2, 4]);
}

#[test]
fn burning_climbs() {
    let out = assert_climbs(burning("stress --axis active-share --from 16 --size 32x24"), &[16, 32, 64, 128]);
    let record = record(out.path());
    let active: Vec<f64> = steps(&record).iter().map(|step| step["amount"].as_f64().unwrap()).collect();
    assert!(active.is_sorted() && active[3] > 10.0 * active[0], "{active:?}");
}

#[test]
fn terrain_climbs_over_its_map() {
    assert_climbs(terrain("stress --axis map --from 100 --factor 9 --size 32x24"), &[100, 900]);
}

#[test]
fn meshes_are_divided_and_objects_multiplied() {
    for (program, key) in [
        (caustics("stress --axis receiver-triangles --planes 2").args(SMALL), "receiver_triangles"),
        (terrain("stress --axis object-triangles --size 32x24 --resolution 64"), "object_triangles"),
        (
            lava("stress --axis object-triangles --size 32x24 --particles 50 --density 8x8x8 --splats 20x20"),
            "object_triangles",
        ),
        (gas("stress --axis surface-triangles --size 45x31 --variant no-volume"), "triangles"),
        (burning("stress --axis triangles --size 32x24"), "triangles"),
    ] {
        let out = folder();
        let program = program.args("--from 20000 --factor 100 --until device --quiet --budget 15 --out");
        program.arg(out.path()).on_test_device().run().succeeded();
        let record = record(out.path());
        let step = &steps(&record)[0];
        let count = step["run"]["config"][key].as_f64().unwrap();
        assert!((20_000.0..60_000.0).contains(&count) && step["amount"] == count, "{key}: {count}");
    }
    for (program, names) in [
        (caustics("stress --axis receivers --from 3 --planes 2").args(SMALL), "mesh"),
        (terrain("stress --axis objects --from 3 --size 32x24 --resolution 64"), "object"),
    ] {
        let out = folder();
        let program = program.args("--factor 100 --until device --quiet --budget 20 --out");
        program.arg(out.path()).on_test_device().run().succeeded();
        assert_eq!(steps(&record(out.path()))[0]["run"]["config"][names].as_array().unwrap().len(), 3);
    }
    let out = folder();
    let layers =
        gas("stress --axis fragments --from 4 --factor 4 --variant no-volume --size 45x31 --budget 25 --quiet --out");
    layers.arg(out.path()).on_test_device().run().succeeded();
    let record = record(out.path());
    // Lists that grew while frames were measured are as large in the record as they became.
    for step in steps(&record) {
        let resources = step["run"]["memory"]["by_resource"].as_array().unwrap();
        let links = resources.iter().find(|resource| resource["name"] == "fragment-links").unwrap();
        let slots = step["run"]["results"]["fragment_slots"].as_u64().unwrap();
        assert!(links["bytes"].as_u64().unwrap() >= 16 * slots, "{links}, {slots}");
    }
    let found: Vec<f64> = steps(&record).iter().map(|step| step["amount"].as_f64().unwrap()).collect();
    // Twelve more layers of every pixel, whose diagonals are in both of their triangles.
    let more = (found[1] - found[0]) / (12.0 * 45.0 * 31.0);
    assert!((1.0..1.2).contains(&more), "{found:?}");
}

/// The axes that no test above climbs: a step of each is what its value says.
#[test]
fn the_other_axes_set_what_they_name() {
    for (program, axis, from, key, found) in [
        (caustics("stress --size 32x24"), "water-triangles", 6_000, "water_triangles", json!(6_000)),
        (caustics("stress --size 32x24"), "map", 1_600, "map_size", json!(40)),
        (lava("stress --size 32x24"), "particles", 500, "particles", json!(500)),
        (lava("stress --size 32x24 --particles 500"), "grid", 512, "density", json!(null)),
        (gas("stress --size 45x31 --variant table"), "table", 1_000, "table", json!(10)),
        (gas("stress --size 45x31"), "steps", 6, "steps", json!(6)),
        (burning("stress --size 32x24"), "particles", 50, "fire", json!(50)),
        (burning("stress --size 32x24"), "blocks", 64, "blocks", json!([3, 4, 5])),
        (terrain("stress --resolution 64"), "screen", 1_200, "size", json!(null)),
    ] {
        let out = folder();
        let program = program.args("--factor 100 --until device --quiet --budget 20 --axis").arg(axis);
        let program = program.arg("--from").arg(from.to_string()).arg("--out").arg(out.path());
        program.on_test_device().run().succeeded();
        let step = &steps(&record(out.path()))[0];
        let config = &step["run"]["config"];
        assert!(found.is_null() || config[key] == found, "{axis}: {}", config[key]);
        let amount = step["amount"].as_f64().unwrap();
        assert!((0.7..1.4).contains(&(amount / f64::from(from))), "{axis}: {amount} for {from}");
    }
}

#[test]
fn a_matrix_crosses_axes_and_variants() {
    let out = folder();
    let matrix = "stress --matrix planes,map --from 16 --factor 4 --variants level-map,culled --budget 25 --quiet";
    let scene = caustics(matrix).args("--size 32x24 --water-triangles 50 --out").arg(out.path());
    scene.on_test_device().run().succeeded();
    let record = record(out.path());
    let series = record["series"].as_array().unwrap();
    let rows = |variant: &str| -> Vec<u64> {
        series.iter().filter(|s| s["variant"] == variant).map(|s| s["across"].as_u64().unwrap()).collect()
    };
    assert!(rows("level-map").starts_with(&[16_384, 65_536]) && rows("culled").starts_with(&[16_384, 65_536]));
    assert_eq!(series[0]["steps"][0]["value"], 16);
    assert_eq!(series[0]["steps"][0]["run"]["variant"], "level-map");
    let names = entries(out.path());
    assert!(names.contains(&"stress-caustics-planes-map.svg".to_owned()), "{names:?}");
    assert!(names.contains(&"stress-caustics-planes-map-culled-16384.svg".to_owned()), "{names:?}");
}

fn planes(out: &Path, options: &str) -> Program {
    caustics("stress --axis planes --quiet").args(SMALL).args(options).arg("--out").arg(out).on_test_device()
}

#[test]
fn a_second_call_goes_on_and_measures_no_step_again() {
    let out = folder();
    planes(out.path(), "--from 256 --factor 1.5 --budget 2").run().succeeded();
    let first = record(out.path());
    planes(out.path(), "--from 256 --factor 2 --budget 100").run().succeeded();
    let second = record(out.path());
    assert_eq!(kinds(&second), ["end"]);
    for step in steps(&first) {
        let again = steps(&second).into_iter().find(|other| other["value"] == step["value"]);
        assert_eq!(again, Some(step));
    }
    assert!([256, 512, 1024, 2048, 4096].iter().all(|value| values(&second).contains(value)));
    // Nothing is left to do.
    let started = Instant::now();
    planes(out.path(), "--from 256 --factor 2 --budget 1").run().succeeded();
    assert_eq!(record(out.path())["series"], second["series"]);
    assert!(started.elapsed() < SOON);

    // Other work is another record.
    for (options, difference) in
        [("--warmup 2", "warmup"), ("--seed 2", "--seed"), ("--absorption 0.5", "--absorption")]
    {
        planes(out.path(), options).run().refused(2, &["going on with", difference, "--anew"]);
    }
    assert_eq!(record(out.path())["series"], second["series"]);
    planes(out.path(), "--from 2048 --budget 100 --repeat 2 --anew").run().succeeded();
    assert_eq!(values(&record(out.path())), [2048, 4096]);
}

fn children(process: u32) -> Vec<u32> {
    let listed = fs::read_to_string(format!("/proc/{process}/task/{process}/children")).unwrap_or_default();
    listed.split_whitespace().map(|id| id.parse().unwrap()).collect()
}

/// True when the process was there to be sent it.
fn send(name: &str, process: u32) -> bool {
    Command::new("kill").args([name, &process.to_string()]).stderr(Stdio::null()).status().unwrap().success()
}

fn signal(name: &str, process: u32) {
    assert!(send(name, process));
}

fn until<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + SOON;
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(Instant::now() < deadline, "waited for {what}");
        thread::sleep(Duration::from_millis(2));
    }
}

/// The process of a step after the first: the record has one already.
fn later_step(parent: u32, out: &Path) -> u32 {
    let path = out.join("stress-caustics-planes.json");
    until("a finished step", || {
        let text = fs::read_to_string(&path).ok()?;
        let record: Value = serde_json::from_str(&text).unwrap();
        (!steps(&record).is_empty()).then_some(())
    });
    let mut seen = children(parent);
    until("the next step", || {
        let now = children(parent);
        let new = now.iter().copied().find(|child| !seen.contains(child));
        seen = now;
        new
    })
}

#[test]
fn killed_in_a_step_it_loses_that_step_alone() {
    beside_others(|| {
        let out = folder();
        let running = planes(out.path(), "--from 64 --factor 1.05 --budget 100").start();
        let child = later_step(running.id(), out.path());
        signal("-KILL", running.id());
        let ended = running.end();
        assert_eq!(ended.status.code(), None);
        // Its child does not outlive it.
        until("the end of the step", || {
            let status = fs::read_to_string(format!("/proc/{child}/status")).unwrap_or_default();
            (status.is_empty() || status.contains("State:\tZ")).then_some(())
        });
        let path = out.path().join("stress-caustics-planes.json");
        let left = read_json(&path);
        assert_schema(&left);
        assert!(!steps(&left).is_empty());
        planes(out.path(), "--from 64 --factor 1.05 --budget 2").run().succeeded();
        let gone_on = read_json(&path);
        for step in steps(&left) {
            assert!(steps(&gone_on).contains(&step), "measured again: {}", step["value"]);
        }
        assert!(gone_on["series"][0]["stop"].is_object());
    });
}

#[test]
fn a_step_that_crashes_or_is_killed_ends_its_series_and_says_so() {
    beside_others(|| {
        for (name, kind, part) in [("-SEGV", "crash", "signal"), ("-KILL", "crash", "killed")] {
            let out = folder();
            let mut running = planes(out.path(), "--from 64 --factor 1.05 --budget 100").start();
            later_step(running.id(), out.path());
            // A step can end before the signal reaches it: then the next one gets it.
            until("the end of the series", || {
                for step in children(running.id()) {
                    send(name, step);
                }
                running.has_ended().then_some(())
            });
            running.end().succeeded();
            let record = record(out.path());
            assert_eq!(kinds(&record), [kind]);
            assert!(record["series"][0]["stop"]["reason"].as_str().unwrap().contains(part));
            assert!(!steps(&record).is_empty());
        }
    });
}

#[test]
fn ctrl_c_keeps_what_is_finished() {
    beside_others(|| {
        let out = folder();
        let running = planes(out.path(), "--from 64 --factor 1.05 --budget 100").start();
        later_step(running.id(), out.path());
        signal("-INT", running.id());
        running.end().succeeded();
        let record = record(out.path());
        assert_eq!(kinds(&record), ["interruption"]);
        assert!(!steps(&record).is_empty());
    });
}

#[test]
fn the_budget_is_kept_and_every_paper_leaves_a_record() {
    let out = folder();
    let started = Instant::now();
    let all = fumarole("stress --budget 15 --quiet --out").arg(out.path());
    all.on_test_device().run().succeeded();
    // Starting processes and writing files comes on top.
    assert!(started.elapsed() < Duration::from_secs(45), "{:?}", started.elapsed());
    let records: Vec<String> = entries(out.path()).into_iter().filter(|name| name.ends_with(".json")).collect();
    let expected =
        ["burning-triangles", "caustics-receiver-triangles", "gas-surface-triangles", "lava-particles", "terrain-map"];
    assert_eq!(records, expected.map(|name| format!("stress-{name}.json")));
    for name in records {
        let record = read_json(&out.path().join(&name));
        assert_schema(&record);
        assert_eq!(kinds(&record), ["time"], "{name}");
    }
}

#[test]
fn what_the_device_or_the_axis_refuses_is_a_record_too() {
    for (options, kind, part) in [
        ("--axis map --from 4000000000 --budget 10", "memory", "limit"),
        ("--axis planes --from 5000 --budget 10", "end", "4096"),
    ] {
        let out = folder();
        let program = caustics("stress --markdown").args(options).arg("--out").arg(out.path());
        let ended = program.on_test_device().run().succeeded();
        let record = record(out.path());
        assert_eq!(kinds(&record), [kind], "{options}");
        assert!(record["series"][0]["stop"]["reason"].as_str().unwrap().contains(part), "{record}");
        assert!(ended.stdout.contains("stopped by"), "{}", ended.stdout);
    }
}

#[test]
fn wrong_inputs_are_refused_before_anything_is_measured() {
    let out = folder();
    let inside = |program: Program| program.inside(out.path()).on_test_device().run();
    inside(caustics("stress --axis length")).refused(2, &["--axis length", "receiver-triangles", "planes"]);
    inside(caustics("stress --matrix planes")).refused(2, &["--matrix planes", "A,B"]);
    inside(caustics("stress --matrix planes,planes")).refused(2, &["two different"]);
    inside(caustics("stress --axis planes --planes 9")).refused(2, &["--planes", "--from"]);
    inside(caustics("stress --factor 1")).misused(&["1.05 to 100"]);
    inside(caustics("stress --budget 0")).misused(&["1 to 1000000"]);
    inside(caustics("stress --from 0")).misused(&["--from"]);
    inside(caustics("stress --variants deep")).misused(&["deep"]);
    inside(caustics("stress --until doomsday")).misused(&["doomsday"]);
    inside(caustics("stress --axis planes --matrix planes,map")).misused(&["cannot be used"]);
    inside(terrain("stress --axis map --map jacksboro")).refused(2, &["synthetic volcano"]);
    inside(caustics("stress --mesh nowhere.obj")).refused(2, &["nowhere.obj"]);
    fs::write(out.path().join("other.json"), "{}").unwrap();
    inside(caustics("stress --json other.json")).refused(2, &["other.json", "no record of stress"]);
    assert_eq!(fs::read_to_string(out.path().join("other.json")).unwrap(), "{}");
    for (option, name) in [("json", "a.json"), ("csv", "a.csv")] {
        let several = caustics("stress --axis planes --devices 0,1").arg(format!("--{option}")).arg(name);
        several.inside(out.path()).run().refused(2, &[&format!("--{option}"), "several devices", "--out"]);
    }
    inside(caustics("stress --until memory --frames 2")).refused(2, &["--frames", "--until memory"]);
    inside(caustics("stress --until device --warmup 1")).refused(2, &["--warmup", "--until device"]);
    assert!(!out.path().join("fumarole-out").exists());
    caustics("stress --device nobody --out").arg(out.path()).run().refused(2, &["nobody"]);
    let listed = caustics("stress --list").run().succeeded();
    assert!(listed.stdout.lines().count() == 5 && listed.stdout.starts_with("receiver-triangles"));
}

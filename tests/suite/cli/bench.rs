//! `bench`: the record and the files beside it.

use std::collections::BTreeSet;
use std::fs;
use std::thread;
use std::time::Duration;

use serde_json::Value;

use super::program::{
    ONCE, assert_schema, burning, caustics, device, file, folder, fumarole, gas, lava, read_json, sha256, terrain,
};

const BOTH: &str = "--variant level-map,volumetric";

fn names(runs: &Value, field: &str) -> Vec<String> {
    runs.as_array().unwrap().iter().map(|run| run[field].as_str().unwrap().to_owned()).collect()
}

/// Asserts that `summary` holds `count` samples and agrees with them.
fn assert_summary(summary: &Value, count: usize, what: &str) {
    let samples: Vec<f64> = summary["samples"].as_array().unwrap().iter().map(|s| s.as_f64().unwrap()).collect();
    assert_eq!(samples.len(), count, "{what}");
    let smallest = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = samples.iter().copied().fold(0.0, f64::max);
    assert_eq!(summary["min"].as_f64(), Some(smallest), "{what}");
    assert_eq!(summary["max"].as_f64(), Some(largest), "{what}");
    let median = summary["median"].as_f64().unwrap();
    assert!(smallest >= 0.0 && (smallest..=largest).contains(&median), "{what}: {summary}");
    for absent in ["p95", "p99"] {
        assert!(summary[absent].is_null(), "{what}: {count} samples have no {absent}");
    }
}

#[test]
fn the_record_on_standard_output_is_whole_and_alone() {
    let options = "--json --frames 3 --repeat 2 --warmup 1 --no-limits --seed 7";
    let ended = caustics("bench").tiny().args(options).args(BOTH).run().succeeded();
    let record = ended.json();
    assert_schema(&record);
    assert_eq!(ended.stderr.lines().count(), 1, "the device alone: {}", ended.stderr);
    let name = record["environment"]["device"]["name"].as_str().unwrap();
    assert!(ended.stderr.starts_with(&format!("device: {name}")), "{}", ended.stderr);
    assert_eq!(record["command"].as_array().unwrap()[1], "bench");
    assert_eq!(names(&record["runs"], "variant"), ["level-map", "volumetric"]);
    for run in record["runs"].as_array().unwrap() {
        let variant = run["variant"].as_str().unwrap();
        for (field, value) in [("width", 96), ("height", 64), ("seed", 7), ("frames", 3), ("repeat", 2), ("process", 0)]
        {
            assert_eq!(run[field], value, "{variant} {field}");
        }
        for (field, value) in [("planes", 5), ("map_size", 64), ("water_triangles", 500)] {
            assert_eq!(run["config"][field], value, "{variant} {field}");
        }
        assert_eq!(run["validation"], "off");
        assert!(run["limits"].is_null() && run["image"].is_null() && run["experiment"].is_null());
        assert_summary(&run["frame_ms"], 6, variant);
        assert_passes(run);
        assert_memory(run);
    }
}

fn assert_passes(run: &Value) {
    for pass in run["passes"].as_array().unwrap() {
        let what = format!("{} {}", run["variant"], pass["name"]);
        if pass["kind"] == "host" {
            assert!(pass["gpu_ms"].is_null() && pass["submission"].is_null(), "{what}");
            assert_summary(&pass["host_ms"], 6, &what);
            continue;
        }
        assert!(pass["host_ms"].is_null(), "{what}");
        assert_summary(&pass["gpu_ms"], 6, &what);
        assert_eq!(pass["shader_compiler"], "glslang", "{what}");
        let counted = match pass["kind"].as_str().unwrap() {
            "compute" => ["compute_invocations", "compute_invocations"],
            _ => ["vertices", "primitives"],
        };
        for counter in counted {
            assert!(pass["statistics"][counter].as_u64().unwrap() > 0, "{what}: {counter}");
        }
    }
}

fn assert_memory(run: &Value) {
    let memory = &run["memory"];
    let resources = memory["by_resource"].as_array().unwrap();
    let names: BTreeSet<&str> = resources.iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert!(names.contains("caustics-map") && names.contains("water"), "{names:?}");
    let sum: u64 = resources.iter().map(|r| r["bytes"].as_u64().unwrap()).sum();
    let bytes = |field: &str| memory[field].as_u64().unwrap();
    assert_eq!(bytes("device_bytes") + bytes("host_bytes"), sum);
    assert!(bytes("peak_bytes") >= sum);
}

#[test]
fn every_variant_meets_the_schema() {
    let ended = caustics("bench --json --variant all").tiny().args(ONCE).run().succeeded();
    let record = ended.json();
    assert_schema(&record);
    let variants = names(&record["runs"], "variant");
    assert!(["level-map", "volumetric"].iter().all(|v| variants.contains(&(*v).to_owned())), "{variants:?}");
}

#[test]
fn the_limits_of_the_device_are_measured_and_every_pass_is_set_against_them() {
    let options = "--json --frames 1 --repeat 1 --warmup 1 --variant level-map";
    let record = caustics("bench").tiny().args(options).run().succeeded().json();
    let run = &record["runs"][0];
    for limit in [
        "copy_gb_s",
        "fma_gflops",
        "fill_gpix_s",
        "blend_gpix_s",
        "vertex_gvertices_s",
        "triangle_gtriangles_s",
        "issue_ginvocations_s",
        "empty_draw_ms",
        "empty_dispatch_ms",
    ] {
        assert!(run["limits"][limit].as_f64().unwrap() > 0.0, "{limit}");
        assert_eq!(run["limits"]["samples"][limit]["median"], run["limits"][limit]);
        assert!(run["limits"]["samples"][limit]["samples"].as_array().unwrap().len() >= 5, "{limit}");
    }
    for pass in run["passes"].as_array().unwrap().iter().filter(|pass| pass["kind"] != "host") {
        let floors = pass["floors"].as_object().unwrap();
        let bound = pass["bound"].as_str().unwrap();
        let longest = floors.values().filter_map(Value::as_f64).fold(0.0, f64::max);
        assert_eq!(floors[bound], longest, "{pass}");
        assert!(pass["floor_ms"].as_f64().unwrap() >= longest, "{pass}");
        let at_most = &pass["bytes"]["at_most"];
        for side in ["read", "written"] {
            assert!(at_most[side].as_u64().unwrap() >= pass["bytes"][side].as_u64().unwrap(), "{pass}");
        }
    }
    // What reads two textures pixel by pixel and writes one says so to the byte: 64 x 64 of 4, 16 and 8 or 16 bytes.
    let combine = run["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "combine").unwrap();
    assert_eq!(combine["bytes"]["uncertain"], serde_json::json!([]), "{combine}");
    assert_eq!(combine["bytes"]["read"].as_u64().unwrap() % (64 * 64), 0, "{combine}");
}

/// The pass's share of its floor as the table prints it.
fn printed_share(pass: &Value) -> Option<String> {
    let (floor, gpu) = (pass["floor_ms"].as_f64()?, pass["counted_ms"].as_f64()?);
    (gpu > 0.0).then(|| format!("{:.0} % {}", 100.0 * floor / gpu, pass["bound"].as_str().unwrap()))
}

#[test]
fn every_papers_passes_have_a_floor_and_the_table_says_how_near_they_come() {
    let papers = [
        lava("bench --variant all --size 32x24 --particles 300 --radius 0.2 --density 12x6x6 --splats 40x10"),
        lava("bench --size 32x24 --simulation sph --particles 300"),
        gas("bench --variant all --size 24x16 --steps 6 --table 6"),
        gas("bench --variant none --size 24x16 --steps 6 --density-cache 8"),
        gas("bench --variant none --size 24x16 --samples 2 --march delta"),
        caustics("bench --variant all --size 32x24 --map-size 32 --water-triangles 200 --planes 3"),
        burning("bench --variant all --size 32x24 --mesh sphere --triangles 200 --blocks 2x2x2 --fire 20 --smoke 10"),
        terrain("bench --variant all --size 32x24 --resolution 17"),
    ];
    for program in papers {
        let out = folder();
        let options = "--json r.json --frames 1 --repeat 1 --warmup 1";
        let ended = program.on_test_device().inside(out.path()).args(options).run().succeeded();
        assert!(ended.stdout.contains("share of limit"), "{}", ended.stdout);
        let record = read_json(&out.path().join("r.json"));
        let runs = record["runs"].as_array().unwrap().iter();
        let passes: Vec<&Value> = runs.flat_map(|run| run["passes"].as_array().unwrap()).collect();
        for pass in passes.iter().filter(|pass| pass["kind"] != "host" && pass["calls"] != 0) {
            assert!(pass["floor_ms"].as_f64().is_some_and(|floor| floor > 0.0), "{pass}");
            assert!(pass["bound"].is_string(), "{pass}");
            let Some(share) = printed_share(pass) else { continue };
            let name = pass["name"].as_str().unwrap();
            let is_row = |line: &str| line.trim_start().starts_with(name) && line.contains(&share);
            assert!(ended.stdout.lines().any(is_row), "{name}: {share} in\n{}", ended.stdout);
        }
        assert!(passes.into_iter().filter_map(printed_share).count() >= 3);
    }
}

#[test]
fn every_file_is_written_and_well_formed() {
    let out = folder();
    let files = "--json r/a.json --csv r/a.csv --trace r/a.trace --image r/a.png";
    let options = "--frames 3 --repeat 1 --warmup 1 --no-limits";
    let ended = caustics("bench").inside(out.path()).tiny().args(options).args(BOTH).args(files).run().succeeded();
    let written: BTreeSet<String> = ended.stderr.lines().map(str::to_owned).collect();
    let wrote = |name: &str| format!("wrote {name}");
    assert_eq!(written, ["r/a.csv", "r/a.json", "r/a.png", "r/a-volumetric.png", "r/a.trace"].map(wrote).into());
    let path = |ending: &str| out.path().join(format!("r/a.{ending}"));
    let record = read_json(&path("json"));
    assert_schema(&record);
    let passes: Vec<&Value> =
        record["runs"].as_array().unwrap().iter().flat_map(|run| run["passes"].as_array().unwrap()).collect();
    let pass_names: BTreeSet<&str> = passes.iter().map(|pass| pass["name"].as_str().unwrap()).collect();
    for name in pass_names.iter().chain(&["level-map", "volumetric", device().as_str()]) {
        assert!(ended.stdout.contains(name), "the table lacks {name}:\n{}", ended.stdout);
    }

    let csv = fs::read_to_string(path("csv")).unwrap();
    let rows: Vec<Vec<String>> = csv.lines().map(cells).collect();
    assert_eq!(rows.len(), 1 + passes.len());
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let column = |name: &str| rows[0].iter().position(|cell| cell == name).unwrap();
    for (row, pass) in rows[1..].iter().zip(&passes) {
        assert_eq!(row[column("pass")], pass["name"].as_str().unwrap());
        let median = row[column("gpu_median_ms")].parse::<f64>().ok();
        assert_eq!(median, pass["gpu_ms"]["median"].as_f64());
        let environment = &record["environment"];
        assert_eq!(row[column("date")], environment["date"].as_str().unwrap());
        assert_eq!(row[column("driver_version")], environment["device"]["driver_version"].as_str().unwrap());
        assert_eq!(row[column("lp_num_threads")], environment["host"]["lp_num_threads"].to_string());
        assert_eq!(row[column("shader_compiler")], pass["shader_compiler"].as_str().unwrap_or_default());
    }

    let trace = read_json(&path("trace"));
    let events = trace["traceEvents"].as_array().unwrap();
    let spans: Vec<&Value> = events.iter().filter(|event| event["ph"] == "X").collect();
    let traced: BTreeSet<&str> = spans.iter().map(|span| span["name"].as_str().unwrap()).collect();
    let expected: BTreeSet<&str> =
        pass_names.iter().copied().chain(["record", "wait for the device", "submission"]).collect();
    assert_eq!(traced, expected);
    assert_timeline(&spans);
    assert!(spans.iter().all(|span| span["ts"].as_f64().unwrap() >= 0.0 && span["dur"].as_f64().unwrap() >= 0.0));

    let picture = fumarole::image::read_png(&path("png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (96, 64));
    // Each variant's is the last frame's, as `render` shows it; the first has the name that was given.
    for (run, (variant, name)) in [("level-map", "r/a.png"), ("volumetric", "r/a-volumetric.png")].iter().enumerate() {
        let recorded = &record["runs"][run]["image"];
        assert_eq!(recorded["path"], *name);
        assert_eq!(recorded["sha256"], sha256(&out.path().join(name)).as_str());
        let render = caustics("render --quiet --frame 2 --image last.png --variant").arg(variant);
        render.inside(out.path()).tiny().run().succeeded();
        assert_eq!(recorded["sha256"], sha256(&out.path().join("last.png")).as_str(), "{variant}");
    }
}

/// Every measured frame, of the variants in turn, has the host's work and its waits, and where the device was timed its work on the
/// same clock: what the device does lies inside the host's waits, and says of its pass what was counted.
fn assert_timeline(spans: &[&Value]) {
    let number = |span: &Value, name: &str| span[name].as_f64().unwrap();
    let frame_of = |span: &Value| {
        let [mode, repetition, frame] = ["mode", "repetition", "frame"].map(|name| span["args"][name].to_string());
        (span["pid"].to_string(), mode, repetition, frame)
    };
    let on = |track: &str| spans.iter().filter(|span| span["cat"] == track).collect::<Vec<_>>();
    let frames: BTreeSet<_> = spans.iter().map(|span| frame_of(span)).collect();
    // Two variants of three frames, each plain, timestamped and bracketed.
    assert_eq!(frames.len(), 18);
    let timed = frames.iter().filter(|(_, mode, ..)| mode != "\"plain\"").cloned().collect();
    for (track, expected) in [("host", &frames), ("wait", &frames), ("GPU", &timed)] {
        assert_eq!(on(track).iter().map(|span| frame_of(span)).collect::<BTreeSet<_>>(), *expected, "{track}");
    }
    let mut in_time: Vec<_> = on("host").into_iter().filter(|span| span["name"] == "record").collect();
    in_time.sort_by(|a, b| number(a, "ts").total_cmp(&number(b, "ts")));
    let in_turn: Vec<_> = in_time.chunk_by(|a, b| frame_of(a) == frame_of(b)).map(|frame| &frame[0]["pid"]).collect();
    assert_eq!(in_turn, [1, 2].repeat(9).iter().collect::<Vec<_>>(), "frame by frame, not one variant after the other");

    // Without the device's calibrated clock the first span would begin where the wait does.
    let first = |track: &str, frame: &_| {
        let starts = on(track).into_iter().filter(|span| frame_of(span) == *frame).map(|span| number(span, "ts"));
        starts.fold(f64::INFINITY, f64::min)
    };
    assert!(frames.iter().any(|frame| timed.contains(frame) && first("GPU", frame) != first("wait", frame)));

    let is_pass = |span: &&&&Value| span["args"]["mode"] == "timestamped";
    for span in on("GPU").iter().filter(is_pass) {
        let is_within = |wait: &&&&Value| {
            let (start, end) = (number(wait, "ts") - 300.0, number(wait, "ts") + number(wait, "dur") + 300.0);
            frame_of(wait) == frame_of(span)
                && start <= number(span, "ts")
                && number(span, "ts") + number(span, "dur") <= end
        };
        assert!(on("wait").iter().any(|wait| is_within(&wait)), "{span}");
        assert!(span["args"]["calls"].as_u64().unwrap() > 0 && !span["args"]["section"].is_null(), "{span}");
        assert!(span["args"]["bytes_read"].as_u64().is_some(), "{span}");
        let is_counted = |name: &str| span["args"][name].as_u64().is_some_and(|count| count > 0);
        assert!(["vertices", "compute_invocations"].into_iter().any(is_counted), "{span}");
    }
}

/// The cells of a line of CSV.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_quoted = false;
    for character in line.chars() {
        match character {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => cells.push(String::new()),
            other => cells.last_mut().unwrap().push(other),
        }
    }
    cells
}

#[test]
fn fresh_processes_are_numbered_and_the_first_writes_the_picture() {
    let out = folder();
    let files = "--json a.json --csv a.csv --trace a.trace --image a.png";
    let program = caustics("bench --processes 2").inside(out.path()).tiny().args(ONCE).args(BOTH);
    let ended = program.args(files).run().succeeded();
    for (run, name) in ["a.png", "a-volumetric.png"].iter().enumerate() {
        assert!(ended.stderr.contains(&format!("wrote {name}\n")), "{}", ended.stderr);
        let recorded = read_json(&out.path().join("a.json"))["runs"][run]["image"].clone();
        assert_eq!(recorded["sha256"], sha256(&out.path().join(name)).as_str());
    }
    let record = read_json(&out.path().join("a.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let found: Vec<(u64, &str)> =
        runs.iter().map(|run| (run["process"].as_u64().unwrap(), run["variant"].as_str().unwrap())).collect();
    assert_eq!(found, [(0, "level-map"), (0, "volumetric"), (1, "level-map"), (1, "volumetric")]);
    assert!(runs[2..].iter().all(|run| run["image"].is_null()), "the first process has drawn them");
    assert!(!read_json(&out.path().join("a.trace"))["traceEvents"].as_array().unwrap().is_empty());
    let count: usize = runs.iter().map(|run| run["passes"].as_array().unwrap().len()).sum();
    assert_eq!(fs::read_to_string(out.path().join("a.csv")).unwrap().lines().count(), 1 + count);
    assert!(record["command"].as_array().unwrap().contains(&"--processes".into()));
}

#[test]
fn a_fresh_process_that_fails_says_it_once() {
    caustics("bench --processes 2 --mesh no-such.obj").tiny().args(ONCE).run().refused(2, &["no-such.obj"]);
    let nowhere = caustics("bench --processes 2").tiny().args(ONCE).env("TMPDIR", "/no/such");
    nowhere.run().refused(1, &["a temporary file in /no/such: it is no folder", "TMPDIR"]);
}

/// The mesh goes when the first process has measured it and writes its picture: the last cannot read it, and those before
/// it are kept.
#[test]
fn a_later_process_that_fails_throws_none_before_it_away() {
    let out = folder();
    let mesh = file(&out, "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    let options = "bench --processes 3 --min-time 1 --no-limits --variant level-map --mesh mesh.obj --quiet";
    let program = caustics(options).args("--json a.json --image a.png").inside(out.path()).tiny();
    let mut running = program.start();
    while !out.path().join("a.png").exists() && !running.has_ended() {
        thread::sleep(Duration::from_millis(3));
    }
    fs::remove_file(mesh).unwrap();
    let ended = running.end();
    assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: ") && ended.stderr.contains("mesh.obj"), "{}", ended.stderr);
    let record = read_json(&out.path().join("a.json"));
    assert_schema(&record);
    let processes: Vec<u64> =
        record["runs"].as_array().unwrap().iter().map(|run| run["process"].as_u64().unwrap()).collect();
    assert!(processes == [0] || processes == [0, 1], "{processes:?}");
}

#[test]
fn shaders_of_the_other_compiler_are_named_in_the_record() {
    let ended = caustics("bench --json --shader-compiler naga").tiny().args(ONCE).run().succeeded();
    let compilers: BTreeSet<String> = ended.json()["runs"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|run| run["passes"].as_array().unwrap().clone())
        .filter_map(|pass| pass["shader_compiler"].as_str().map(str::to_owned))
        .collect();
    assert!(compilers.contains("naga"), "{compilers:?}");
}

#[test]
fn the_drivers_threads_are_the_cores_unless_the_user_sets_them() {
    let program = || caustics("bench --json --quiet --variant level-map").tiny().args(ONCE);
    let record = program().without("LP_NUM_THREADS").run().succeeded().json();
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(record["environment"]["host"]["lp_num_threads"], cores);
    let warnings = record["runs"][0]["warnings"].to_string();
    assert!(!warnings.contains("LP_NUM_THREADS"), "{warnings}");
    let record = program().env("LP_NUM_THREADS", "1").run().succeeded().json();
    assert_eq!(record["environment"]["host"]["lp_num_threads"], 1);
    let record = fumarole("caustics bench --json --quiet --variant level-map").tiny().args(ONCE);
    let record = record.without("LP_NUM_THREADS").run().succeeded().json();
    assert_eq!(record["environment"]["host"]["lp_num_threads"], cores);
}

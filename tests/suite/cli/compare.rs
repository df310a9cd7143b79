//! `fumarole compare`: verdicts and exit codes.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use serde_json::Value;

use super::program::{ONCE, Program, caustics, file, folder, fumarole, read_json, sha256, terrain};

/// One measured record, from which the others are made.
fn measured() -> &'static Value {
    static RECORD: OnceLock<Value> = OnceLock::new();
    RECORD.get_or_init(|| {
        let options = "--json --quiet --frames 20 --repeat 1 --warmup 1 --no-limits --variant level-map,volumetric";
        caustics("bench").tiny().args(options).run().succeeded().json()
    })
}

/// The record as `processes` processes would have measured it, every time multiplied by `factor`, the processes
/// differing by a few tenths of a percent.
pub fn record_of(processes: u32, factor: f64) -> Value {
    let mut record = measured().clone();
    let mut runs = Vec::new();
    for process in 0..processes {
        let factor = factor * (1.0 + 0.002 * f64::from(process % 3));
        for run in measured()["runs"].as_array().unwrap() {
            let mut run = run.clone();
            run["process"] = process.into();
            scale(&mut run["frame_ms"], factor);
            for pass in run["passes"].as_array_mut().unwrap() {
                scale(&mut pass["gpu_ms"], factor);
                scale(&mut pass["host_ms"], factor);
            }
            runs.push(run);
        }
    }
    record["runs"] = runs.into();
    record
}

fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Number(number) => *value = (number.as_f64().unwrap() * factor).into(),
        Value::Array(items) => items.iter_mut().for_each(|item| scale(item, factor)),
        Value::Object(fields) => fields.values_mut().for_each(|field| scale(field, factor)),
        _ => {}
    }
}

fn compare(a: &Path, b: &Path) -> Program {
    fumarole("compare").arg(a).arg(b)
}

fn verdicts(comparison: &Value) -> Vec<&str> {
    comparison["runs"].as_array().unwrap().iter().map(|run| run["frame"]["verdict"].as_str().unwrap()).collect()
}

#[test]
fn a_record_against_itself_is_the_same() {
    let out = folder();
    let record = file(&out, "a.json", measured().to_string());
    let ended = compare(&record, &record).args("--fail-above 1%").run().succeeded();
    assert_eq!(ended.stdout.matches("SAME:").count(), 2, "{}", ended.stdout);
    assert_eq!(ended.stderr, "");
    let json = compare(&record, &record).arg("--json").run().succeeded().json();
    assert_eq!(json["schema"], "fumarole.compare/2");
    assert_eq!(verdicts(&json), ["SAME", "SAME"]);
}

#[test]
fn a_regression_beyond_the_limit_ends_with_4() {
    let out = folder();
    let a = file(&out, "a.json", record_of(5, 1.0).to_string());
    let slower = file(&out, "slower.json", record_of(5, 1.2).to_string());
    let report = out.path().join("report.json");
    let ended = compare(&a, &slower).args("--fail-above 5% --json").arg(&report).run();
    assert_eq!(ended.status.code(), Some(4), "{}{}", ended.stdout, ended.stderr);
    assert_eq!(ended.stdout.matches("SLOWER:").count(), 2, "{}", ended.stdout);
    assert_eq!(ended.stderr, "", "the report says it");
    let report = read_json(&report);
    assert_eq!(verdicts(&report), ["SLOWER", "SLOWER"]);
    assert!((report["runs"][0]["frame"]["ratio"].as_f64().unwrap() - 1.2).abs() < 0.01, "{report}");

    // Neither a higher limit, nor none, nor the other direction is a regression.
    compare(&a, &slower).args("--fail-above 0.5").run().succeeded();
    assert!(compare(&a, &slower).run().succeeded().stdout.contains("SLOWER:"));
    let ended = compare(&a, &slower).args("--fail-above 5").run();
    assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("\"5\" is not a share: give 5% or 0.05"), "{}", ended.stderr);
    assert!(compare(&slower, &a).args("--fail-above 5%").run().succeeded().stdout.contains("FASTER:"));
}

/// One pass half as slow again under a flat frame fails, unless its share is less than what is asked for.
#[test]
fn passes_below_the_least_share_do_not_fail() {
    let out = folder();
    let a = file(&out, "a.json", record_of(5, 1.0).to_string());
    let mut slower = record_of(5, 1.0);
    for run in slower["runs"].as_array_mut().unwrap() {
        let passes = run["passes"].as_array_mut().unwrap();
        scale(&mut passes.iter_mut().find(|pass| pass["name"] == "illumination-volumes").unwrap()["gpu_ms"], 1.5);
    }
    let b = file(&out, "b.json", slower.to_string());
    let ended = compare(&a, &b).args("--fail-above 5% --min-share 0%").run();
    assert_eq!(ended.status.code(), Some(4), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains("regression beyond 5 %: illumination-volumes"), "{}", ended.stdout);
    compare(&a, &b).args("--fail-above 5% --min-share 80%").run().succeeded();
}

/// Without `--min-share` a pass counts from 2 % of the frame on, on the side where its share is greater.
#[test]
fn passes_count_from_two_percent_of_the_frame() {
    let out = folder();
    for (share, code) in [(0.019, 0), (0.021, 4)] {
        let [a, b] = [("a.json", 1.0), ("b.json", 1.5)].map(|(name, slower)| {
            let mut record = record_of(5, 1.0);
            for run in record["runs"].as_array_mut().unwrap() {
                let frame_ms = run["frame_ms"]["median"].as_f64().unwrap();
                let passes = run["passes"].as_array_mut().unwrap();
                let pass = passes.iter_mut().find(|pass| pass["name"] == "illumination-volumes").unwrap();
                let pass_ms = pass["gpu_ms"]["median"].as_f64().unwrap();
                scale(&mut pass["gpu_ms"], slower / 1.5 * share * frame_ms / pass_ms);
            }
            file(&out, name, record.to_string())
        });
        let ended = compare(&a, &b).args("--fail-above 5%").run();
        assert_eq!(ended.status.code(), Some(code), "{share}: {}{}", ended.stdout, ended.stderr);
        assert!(ended.stdout.contains("SLOWER"), "{}", ended.stdout);
    }
}

/// A run that reads the file.
type Reading<'a> = &'a dyn Fn(&str) -> Program;

/// Files count by what they hold, wherever they lie: a mesh, a map, a drape.
#[test]
fn files_are_told_by_their_content() {
    const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    const MAP: &str = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n7 8 9\n";
    let out = folder();
    for (name, text) in [
        ("a.obj", MESH.to_owned()),
        ("b.obj", MESH.to_owned()),
        ("moved.obj", MESH.replace("v 1 0 0", "v 2 0 0")),
        ("a.asc", MAP.to_owned()),
        ("b.asc", MAP.to_owned()),
        ("moved.asc", MAP.replace('9', "8")),
    ] {
        file(&out, name, text);
    }
    for (name, red) in [("a.png", 200), ("b.png", 200), ("moved.png", 100)] {
        let picture = fumarole::image::Rgba8::new(2, 2, [red, 30, 30, 255].repeat(4)).unwrap();
        fumarole::image::write_png(&out.path().join(name), &picture).unwrap();
    }
    let caustics = |file: &str| caustics("bench --variant level-map --mesh").arg(file).tiny();
    let terrain =
        |options: String| terrain("bench --variant gpu-fragment --size 32x24").args(&options).on_test_device();
    let map = |file: &str| terrain(format!("--map {file}"));
    let object = |file: &str| terrain(format!("--resolution 17 --object {file}"));
    let drape = |file: &str| terrain(format!("--resolution 17 --drape {file}"));
    let papers: [(&str, Reading<'_>); 4] = [("obj", &caustics), ("asc", &map), ("obj", &object), ("png", &drape)];
    for (ending, program) in papers {
        let record = |name: &str| {
            let (source, json) = (format!("{name}.{ending}"), format!("{name}.json"));
            program(&source).args(ONCE).args("--quiet --json").arg(&json).inside(out.path()).run().succeeded();
            let json = out.path().join(json);
            let inputs = &read_json(&json)["runs"][0]["inputs"];
            let digest = sha256(&out.path().join(&source));
            assert!(inputs.as_array().unwrap().iter().any(|input| input["sha256"] == digest.as_str()), "{inputs}");
            json
        };
        let [a, b, moved] = ["a", "b", "moved"].map(record);
        compare(&a, &b).run().succeeded();
        compare(&a, &moved).run().refused(2, &["moved.json"]);
    }
}

#[test]
fn files_of_one_side_are_joined_by_commas() {
    let out = folder();
    let paths = |factor: f64, side: &str| {
        let write = |process: u32| {
            let mut record = record_of(1, factor * (1.0 + 0.001 * f64::from(process)));
            record["runs"].as_array_mut().unwrap().iter_mut().for_each(|run| run["process"] = process.into());
            file(&out, &format!("{side}{process}.json"), record.to_string()).to_str().unwrap().to_owned()
        };
        (0..5).map(write).collect::<Vec<_>>().join(",")
    };
    let ended = fumarole("compare --fail-above 5%").arg(paths(1.0, "a")).arg(paths(1.2, "b")).run();
    assert_eq!(ended.status.code(), Some(4), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains("5 processes"), "{}", ended.stdout);
}

#[test]
fn one_process_a_side_is_unclear_at_best() {
    let out = folder();
    let a = file(&out, "a.json", record_of(1, 1.0).to_string());
    let b = file(&out, "b.json", record_of(1, 1.2).to_string());
    let ended = compare(&a, &b).args("--fail-above 5%").run().succeeded();
    assert_eq!(ended.stdout.matches("UNCLEAR: frame").count(), 2, "{}", ended.stdout);
    // What is not certain fails where that is asked for.
    let ended = compare(&a, &b).args("--fail-unclear").run();
    assert_eq!(ended.status.code(), Some(4));
}

#[test]
fn what_cannot_be_compared_is_refused_with_the_field() {
    let out = folder();
    let a = file(&out, "a.json", measured().to_string());
    for (pointer, value, name) in [
        ("/config/planes", Value::from(9), "planes"),
        ("/width", Value::from(100), "width"),
        ("/seed", Value::from(2), "seed"),
    ] {
        let mut other = measured().clone();
        for run in other["runs"].as_array_mut().unwrap() {
            *run.pointer_mut(pointer).unwrap() = value.clone();
        }
        let b = file(&out, "b.json", other.to_string());
        compare(&a, &b).run().refused(2, &["a.json", "b.json", name, &value.to_string()]);
    }
}

#[test]
fn what_is_no_record_is_refused_with_its_name() {
    let out = folder();
    let text = measured().to_string();
    let a = file(&out, "a.json", &text);
    let cases: [(&str, &[u8]); 6] = [
        ("empty.json", b""),
        ("cut-off.json", &text.as_bytes()[..text.len() / 2]),
        ("words.json", b"no record"),
        ("binary.json", &[0xff, 0xfe, 0x00, 0x80]),
        ("other.json", b"{\"schema\": \"fumarole.bench/999\"}"),
        ("fields.json", b"{\"schema\": \"fumarole.bench/1\", \"runs\": 3}"),
    ];
    for (name, bytes) in cases {
        let b = file(&out, name, bytes);
        compare(&a, &b).run().refused(2, &[name]);
        compare(&b, &a).run().refused(2, &[name]);
    }
    compare(&a, &out.path().join("missing.json")).run().refused(2, &["missing.json"]);
    compare(&a, out.path()).run().refused(2, &[out.path().to_str().unwrap()]);
    compare(&a, &a).arg("--json").arg(out.path()).run().refused(2, &["directory"]);
    assert_eq!(fs::read_to_string(&a).unwrap(), text);
}

#[test]
fn arguments_are_two_sides_and_a_share() {
    let program = || fumarole("compare a.json b.json");
    program().arg("c.json").run().misused(&["c.json"]);
    fumarole("compare a.json").run().misused(&["B.json"]);
    fumarole("compare a.json,,b.json c.json").run().misused(&["a.json,,b.json"]);
    for share in ["much", "nan", "-5%", "inf"] {
        program().arg(format!("--fail-above={share}")).run().misused(&["--fail-above", share]);
    }
}

#[test]
fn a_missing_variant_fails_where_that_is_asked_for() {
    let out = folder();
    let a = file(&out, "a.json", record_of(3, 1.0).to_string());
    let mut fewer = record_of(3, 1.0);
    fewer["runs"].as_array_mut().unwrap().retain(|run| run["variant"] == "level-map");
    let b = file(&out, "b.json", fewer.to_string());
    assert!(compare(&a, &b).run().succeeded().stdout.contains("only in A: caustics volumetric"));
    assert_eq!(compare(&a, &b).args("--fail-missing").run().status.code(), Some(4));
    compare(&b, &a).args("--fail-missing").run().succeeded();
}

#[test]
fn markdown_has_tables_for_a_pull_request() {
    let out = folder();
    let a = file(&out, "a.json", record_of(5, 1.0).to_string());
    let b = file(&out, "b.json", record_of(5, 1.2).to_string());
    let text = compare(&a, &b).args("--markdown --margin 1%").run().succeeded().stdout;
    assert!(text.starts_with("**What is compared**"), "{text}");
    assert!(text.contains("| --- | --- | ---: |") && text.contains("± 1 %"), "{text}");
    assert_eq!(compare(&a, &b).args("--margin 200%").run().status.code(), Some(2));
}

/// Records edited by hand: every way to read them ends in a verdict or in one line.
#[test]
fn odd_records_are_compared_or_refused() {
    let out = folder();
    let a = file(&out, "a.json", record_of(3, 1.0).to_string());
    type Edit = fn(&mut Value);
    let edits: [(&str, i32, Edit); 8] = [
        ("huge", 4, |run| run["frame_ms"]["samples"] = vec![1e308; 20].into()),
        ("zero", 4, |run| run["frame_ms"]["samples"] = vec![0.0; 20].into()),
        ("no frame", 4, |run| run["frame_ms"] = Value::Null),
        ("no sample", 4, |run| run["frame_ms"]["samples"] = Value::Array(vec![])),
        ("no pass", 4, |run| run["passes"] = Value::Array(vec![])),
        ("negative", 2, |run| run["frame_ms"]["samples"][3] = (-1.0).into()),
        ("text", 2, |run| run["frame_ms"]["samples"][3] = "5".into()),
        ("no number", 2, |run| run["frame_ms"]["samples"][3] = Value::Null),
    ];
    for (what, code, edit) in edits {
        let mut record = record_of(3, 1.0);
        record["runs"].as_array_mut().unwrap().iter_mut().for_each(edit);
        let b = file(&out, "b.json", record.to_string());
        let ended = compare(&a, &b).args("--fail-above 5% --fail-unclear --fail-missing").run();
        assert_eq!(ended.status.code(), Some(code), "{what}: {}{}", ended.stdout, ended.stderr);
        if code == 2 {
            ended.refused(2, &["b.json"]);
        } else {
            assert!(!ended.stdout.contains("inf") && !ended.stdout.contains("NaN"), "{what}: {}", ended.stdout);
            compare(&a, &b).arg("--json").run().succeeded().json();
        }
    }
    // A number that JSON does not have.
    let b = file(&out, "b.json", record_of(3, 1.0).to_string().replacen("\"process\":0", "\"process\":NaN", 1));
    compare(&a, &b).run().refused(2, &["b.json", "no JSON"]);
}

/// Fields that the first program of the schema did not write are absent, and no reason to refuse.
#[test]
fn older_records_are_read() {
    let out = folder();
    let mut older = record_of(3, 1.0);
    let strip = |value: &mut Value, fields: &[&str]| {
        let object = value.as_object_mut().unwrap();
        fields.iter().for_each(|field| drop(object.remove(*field)));
    };
    strip(&mut older["environment"]["host"], &["cpu_governor", "variables"]);
    strip(&mut older["environment"]["build"], &["executable_sha256"]);
    for run in older["runs"].as_array_mut().unwrap() {
        strip(run, &["inputs", "loading", "started"]);
        for pass in run["passes"].as_array_mut().unwrap() {
            pass["bytes"] = Value::Null;
            strip(pass, &["shaders", "counted_ms", "floor_ms", "bound", "floors"]);
        }
    }
    super::program::assert_schema(&older);
    let (a, b) = (file(&out, "a.json", older.to_string()), file(&out, "b.json", record_of(3, 1.0).to_string()));
    let ended = compare(&a, &b).run().succeeded();
    assert_eq!(ended.stdout.matches("SAME:").count(), 2, "{}", ended.stdout);
    assert!(ended.stdout.contains("do not say when each process ran"), "{}", ended.stdout);
    let page = out.path().join("page.html");
    fumarole("report --quiet").arg(&a).arg("--output").arg(&page).run().succeeded();
    assert!(fs::read_to_string(page).unwrap().contains("caustics level-map"));
}

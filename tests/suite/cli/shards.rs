//! `stress`, `ab` and experiments in shards: together they are the whole, and `assemble`, `compare` and `report` take it.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::program::{ONCE, Program, assert_schema, caustics, device, entries, folder, fumarole, read_json};

const SCENE: &str = "--size 32x24 --map-size 16 --water-triangles 100 --mesh box";

fn assemble(parts: &Path) -> Program {
    fumarole("assemble").arg(parts)
}

fn assert_missing(parts: &Path, count: &str, numbers: &str) {
    assert_eq!(assemble(parts).args("--missing").arg(count).run().succeeded().stdout, numbers);
}

/// Of the records `STEM-shard-I-of-N.json`, asserts that `assemble` refuses a gap, overlaps, and parts of another whole.
/// `contents` points to what a part has measured, `settings` to a part of what fixes its work.
fn assert_only_the_whole_is_assembled(parts: &Path, (stem, count): (&str, u32), contents: &str, settings: &str) {
    let out = folder();
    let name = |number: u32| format!("{stem}-shard-{number}-of-{count}.json");
    let records: Vec<Value> = (0..count).map(|number| read_json(&parts.join(name(number)))).collect();
    let second = &records[1];
    // The others with this one, or none, in place of the second; and in another folder what is there twice.
    let refused = |case: &str, second: Option<&Value>, again: Option<&Value>, said: &[&str]| {
        let [place, other] = ["parts", "again"].map(|name| out.path().join(case).join(name));
        [&place, &other].into_iter().for_each(|folder| fs::create_dir_all(folder).unwrap());
        for (number, record) in (0..).zip(&records).filter(|(number, _)| *number != 1) {
            fs::write(place.join(name(number)), record.to_string()).unwrap();
        }
        for (folder, record) in [(&place, second), (&other, again)] {
            record.into_iter().for_each(|record| fs::write(folder.join(name(1)), record.to_string()).unwrap());
        }
        let joined = out.path().join("joined");
        let program = fumarole("assemble --quiet").arg(&place).arg(&other).arg("--out").arg(&joined);
        program.run().refused(2, said);
        assert!(!joined.exists(), "{stem}: {case}");
    };
    let changed = |pointer: &str, value: Value| {
        let mut record = second.clone();
        *record.pointer_mut(pointer).unwrap_or_else(|| panic!("{stem} has no {pointer}")) = value;
        record
    };
    let shard = if second["shard"].is_array() { "/shard" } else { "/share/shard" };
    refused("gap", None, None, &[stem, &format!("of {count} shards are missing 1")]);
    refused("twice", Some(second), Some(second), &["both are shard 1"]);
    let of_more = changed(shard, json!([1, count + 1]));
    refused("count", Some(&of_more), None, &[&format!("of {}", count + 1), &format!("of {count}")]);
    let overlapping = changed(contents, records[0].pointer(contents).unwrap().clone());
    refused("overlap", Some(&overlapping), None, &["assembling", "both have"]);
    for (pointer, what) in [
        ("/environment/device/name", "device.name"),
        ("/environment/host/cpu", "host.cpu"),
        ("/environment/build/executable_sha256", "build.executable_sha256"),
    ] {
        let foreign = changed(pointer, "another".into());
        refused(what, Some(&foreign), None, &[what, "another", "two wholes"]);
    }
    let foreign = changed(settings, "another".into());
    refused("settings", Some(&foreign), None, &["settings differ", "two wholes"]);
}

#[test]
fn a_climb_in_shards_is_one_record() {
    let out = folder();
    let place = |name: &str| out.path().join(name);
    let climb = |options: &str, to: &str| {
        let words =
            "stress --axis planes --variants level-map,culled,volumetric --from 60 --factor 30 --repeat 1 --quiet";
        caustics(words).args(SCENE).args(options).arg("--out").arg(place(to)).on_test_device().run().succeeded();
    };
    climb("", "whole");
    climb("--shard 1/2", "parts");
    assert_missing(&place("parts"), "2", "0\n");
    assemble(&place("parts")).run().refused(2, &["stress-caustics-planes", "of 2 shards are missing 0"]);
    assemble(&place("parts")).args("--missing 3").run().refused(2, &["--missing 3", "of 2"]);
    climb("--shard 0/2", "parts");
    assert_missing(&place("parts"), "2", "");
    assert_only_the_whole_is_assembled(&place("parts"), ("stress-caustics-planes", 2), "/series", "/axis/name");
    let ended = assemble(&place("parts")).arg("--out").arg(place("joined")).run().succeeded();
    assert!(ended.stdout.contains("exponent") && ended.stdout.contains("volumetric"), "{}", ended.stdout);
    assert_eq!(entries(&place("joined")), entries(&place("whole")));
    let name = "stress-caustics-planes.json";
    let [whole, joined] = ["whole", "joined"].map(|folder| read_json(&place(folder).join(name)));
    let steps = |record: &Value| -> Vec<(Value, Value, Vec<Value>)> {
        let values = |series: &Value| series["steps"].as_array().unwrap().iter().map(|s| s["value"].clone()).collect();
        let series = record["series"].as_array().unwrap();
        series.iter().map(|s| (s["variant"].clone(), s["stop"]["kind"].clone(), values(s))).collect()
    };
    assert_eq!(steps(&joined), steps(&whole));
    assert!(joined["shard"].is_null() && joined["settings"] == whole["settings"]);
    let page = fumarole("report --quiet --output").arg(place("report.html")).arg(place("joined"));
    page.run().succeeded();
    // Of other settings.
    climb("--shard 0/2 --seed 2 --anew", "parts");
    assemble(&place("parts")).run().refused(2, &["shard-0-of-2", "settings"]);
}

#[test]
fn blocks_of_shards_are_compared_together() {
    let out = folder();
    let place = |name: &str| out.path().join(name);
    let measure = |shard: &str| {
        let ab = fumarole("ab --blocks 2 --quiet --shard").arg(shard).arg("--out").arg(place("parts"));
        let ab = ab.arg("--b").arg("--seed 2").args("caustics --variant level-map").args(SCENE).args(ONCE);
        ab.arg("--device").arg(device()).run()
    };
    measure("0/3").refused(2, &["2 --blocks for 3 shards"]);
    measure("0/2").succeeded();
    measure("1/2").succeeded();
    for stem in ["ab-a", "ab-b"] {
        assert_only_the_whole_is_assembled(&place("parts"), (stem, 2), "/share/items", "/share/identity");
    }
    assemble(&place("parts")).arg("--quiet").arg("--out").arg(place("joined")).run().succeeded();
    let [a, b] = ["a", "b"].map(|side| place("joined").join(format!("ab-{side}.json")));
    for record in [&a, &b].map(|path| read_json(path)) {
        assert_schema(&record);
        assert_eq!(record["share"]["items"], serde_json::json!([0, 0, 1, 1]));
        let processes: Vec<_> = record["runs"].as_array().unwrap().iter().map(|run| run["process"].clone()).collect();
        assert_eq!(processes, [0, 1, 2, 3]);
    }
    let compared = fumarole("compare --blocks --json").arg(place("compared.json")).arg(&a).arg(&b).run().succeeded();
    assert!(compared.stdout.contains("blocks A B B A"), "{}", compared.stdout);
    let compared = read_json(&place("compared.json"));
    assert_eq!((&compared["design"], &compared["runs"][0]["a_processes"]), (&"blocks".into(), &4.into()));
    let part = place("parts").join("ab-b-shard-1-of-2.json");
    fumarole("compare --blocks").arg(&a).arg(&part).run().refused(2, &["not of the same blocks"]);
    fumarole("compare").arg(&a).arg(&b).run().refused(2, &["seed is 1 in the first and 2 in the second"]);

    // Its time is over after a block of four.
    let ab = fumarole("ab --blocks 4 --budget 1 --shard 0/1 --out").arg(place("cut")).arg("--b").arg("--seed 2");
    let ab = ab.args("caustics --variant level-map").args(SCENE).args(ONCE).args("--min-time 1");
    let ended = ab.arg("--device").arg(device()).run().succeeded();
    let cut = "shard-0-of-1 was ended after 1 of its 4 blocks";
    assert!(ended.stderr.contains(cut), "{}", ended.stderr);
    for side in ["a", "b"] {
        let record = read_json(&place("cut").join(format!("ab-{side}-shard-0-of-1.json")));
        assert!(record["runs"][1]["warnings"].to_string().contains(cut), "{record}");
    }
}

#[test]
fn a_sweep_in_shards_is_the_experiment() {
    let out = folder();
    let place = |name: &str| out.path().join(name);
    let experiment = |to: &str| {
        let sweep = caustics("experiment 5-1 --counts 3,5,7 --quiet").args(SCENE).args(ONCE);
        sweep.arg("--out").arg(place(to)).on_test_device()
    };
    for shard in ["1/4", "0/4", "3/4"] {
        experiment("parts").arg("--shard").arg(shard).run().succeeded();
    }
    assert_missing(&place("parts"), "4", "2\n");
    let before = read_json(&place("parts").join("caustics-5-1-shard-0-of-4.json"));
    let again = caustics("experiment 5-1 --counts 3,5,7").args(SCENE).args(ONCE).args("--shard 0/4 --out");
    let again = again.arg(place("parts")).on_test_device().run().succeeded();
    assert!(again.stderr.contains("this part is finished"), "{}", again.stderr);
    assert_eq!(read_json(&place("parts").join("caustics-5-1-shard-0-of-4.json")), before);
    experiment("parts").args("--shard 2/4").run().succeeded();
    assert_only_the_whole_is_assembled(&place("parts"), ("caustics-5-1", 4), "/share/items", "/share/identity");
    assemble(&place("parts")).arg("--quiet").arg("--out").arg(place("joined")).run().succeeded();
    let joined = place("joined").join("caustics-5-1.json");
    let record = read_json(&joined);
    assert_schema(&record);
    assert_eq!(record["share"]["items"], serde_json::json!([0, 0, 1, 1, 2, 2]));
    fumarole("compare").arg(&joined).arg(&joined).run().succeeded();

    // The table is that of the runs that were measured.
    experiment("table").arg("--assembled").arg(&joined).run().succeeded();
    let files = ["-against-volumetric.csv", "-tables.json", ".csv", ".json", ".svg"];
    assert_eq!(entries(&place("table")), files.map(|suffix| format!("caustics-5-1{suffix}")));
    let table = read_json(&place("table").join("caustics-5-1.json"));
    let figures = |record: &Value| -> Vec<_> {
        let runs = record["runs"].as_array().unwrap().iter();
        runs.map(|run| [&run["config"]["planes"], &run["variant"], &run["frame_ms"]].map(Clone::clone)).collect()
    };
    assert_eq!(figures(&table), figures(&record));

    experiment("other").args("--seed 3 --assembled").arg(&joined).run().refused(2, &["--assembled", "other options"]);
    let part = place("parts").join("caustics-5-1-shard-0-of-4.json");
    experiment("other").arg("--assembled").arg(part).run().refused(2, &["one part alone"]);
    let whole = caustics("experiment 5-2 --shard 0/2").inside(out.path()).on_test_device().run();
    whole.refused(2, &["--shard", "5-2", "5-1, 5-3"]);
    let whole = caustics("experiment 5-2 --assembled").arg(&joined).inside(out.path()).on_test_device().run();
    whole.refused(2, &["--assembled: 5-2", "5-1, 5-3"]);
}

//! `stress`, `ab` and experiments in shards: together they are the whole, and `assemble`, `compare` and `report` take it.

use std::path::Path;

use serde_json::Value;

use super::program::{ONCE, Program, assert_schema, caustics, device, entries, folder, fumarole, read_json};

const SCENE: &str = "--size 32x24 --map-size 16 --water-triangles 100 --mesh box";

fn assemble(parts: &Path) -> Program {
    fumarole("assemble").arg(parts)
}

fn assert_missing(parts: &Path, count: &str, numbers: &str) {
    assert_eq!(assemble(parts).args("--missing").arg(count).run().succeeded().stdout, numbers);
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
}

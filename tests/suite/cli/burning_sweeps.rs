//! Experiments of burning with tables beside their runs: the share of active vertices, optimisations, scaling.

use std::fs;

use serde_json::Value;

use super::burning::{BRIEF, SMALL};
use super::experiment_tables::shown_tables;
use super::program::{ONCE, assert_schema, burning, folder, read_json};
use super::report::assert_table_schema;

#[test]
fn a_tick_is_timed_by_the_share_of_active_vertices() {
    let out = folder();
    let experiment = burning("experiment active --triangles 2000 --speed 0.1 --size 48x32").args(ONCE);
    shown_tables(experiment, out.path(), "burning-active");
    assert_schema(&read_json(&out.path().join("burning-active.json")));
    let passes = fs::read_to_string(out.path().join("burning-active-passes.csv")).unwrap();
    let rows = passes.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    for (row, share) in rows.iter().zip([1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 70.0]) {
        assert!((row[0] - share).abs() < 1.0 + 0.1 * share, "{share} %: {passes}");
        assert!((row[1..5].iter().sum::<f64>() - row[5]).abs() < 1e-3 * row[5] && row[1] > 0.0, "{passes}");
    }
    assert_eq!((rows.len(), rows[6][6]), (7, 100.0));
    assert!(out.path().join("burning-active.svg").exists());
}

#[test]
fn optimisations_are_swept() {
    let out = folder();
    for name in ["blocks", "limits"] {
        let words = if name == "blocks" { SMALL.replace("--blocks 3x3x3", "") } else { SMALL.to_owned() };
        let experiment = burning("experiment").arg(name).args("--triangles 300 --frames 2").args(BRIEF).args(&words);
        shown_tables(experiment, out.path(), &format!("burning-{name}"));
    }
    let record = read_json(&out.path().join("burning-blocks.json"));
    assert_schema(&record);
    let blocks: Vec<&Value> =
        record["runs"].as_array().unwrap().iter().map(|run| &run["experiment"]["paper"]).collect();
    assert_eq!(blocks, [&Value::Null, &Value::Null, &70.0.into(), &30.0.into(), &Value::Null]);
    let rows = |name: &str| -> Vec<Vec<f64>> {
        let text = fs::read_to_string(out.path().join(name)).unwrap();
        let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        text.lines().skip(1).map(numbers).collect()
    };
    let active = rows("burning-limits-active.csv");
    // A lower limit, fewer active vertices at once, a longer fire.
    assert_eq!(active.len(), 3);
    assert!(active[2][1] <= active[1][1] && active[1][1] <= active[0][1], "{active:?}");
    assert!(active[2][2] >= active[1][2] && active[1][2] >= active[0][2] && active[2][2] > active[0][2], "{active:?}");
    assert_eq!(rows("burning-limits-division.csv").iter().map(|row| row[0]).collect::<Vec<_>>(), [1.0, 2.0, 4.0, 8.0]);
    // Nothing is loaded in a frame, or something that takes time.
    let loading = rows("burning-limits-loading.csv");
    assert!(loading.len() == 2 && loading[0][1].is_nan() && loading[1][1] > 0.0, "{loading:?}");
}

#[test]
fn scaling_follows_the_active_triangles() {
    let out = folder();
    let experiment = burning("experiment scaling --counts 200,800 --size 48x32").args(ONCE);
    shown_tables(experiment, out.path(), "burning-scaling");
    assert_schema(&read_json(&out.path().join("burning-scaling.json")));
    let rates = fs::read_to_string(out.path().join("burning-scaling-rates.csv")).unwrap();
    let active = |count: &str| -> u32 {
        let line = rates.lines().find(|line| line.starts_with(count) && line.contains("internal-deformation")).unwrap();
        line.split(',').nth(1).unwrap().parse().unwrap()
    };
    assert!(active("800") > 2 * active("200") && active("200") > 0, "{rates}");
}

#[test]
fn laws_are_measured_on_any_mesh() {
    let out = folder();
    let experiment = burning("experiment laws --mesh teapot --triangles 800 --speed 0.4 --flammability 20 --setting 1");
    experiment.arg("--out").arg(out.path()).on_test_device().run().succeeded();
    let document = read_json(&out.path().join("burning-laws.json"));
    assert_table_schema(&document);
    let rows = document["table"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6, "{rows:?}");
    for row in rows {
        let (side, bound) = row["bound"].as_str().unwrap().rsplit_once(' ').unwrap();
        let (bound, is_least) = (bound.parse::<f64>().unwrap(), side == "at least");
        let measured = row["measured"].as_f64();
        let holds = measured.map(|measured| if is_least { measured >= bound } else { measured <= bound });
        assert_eq!(row["holds"].as_str().map(|holds| holds == "yes"), holds, "{row}");
        // The teapot is open, and has no volume to keep.
        assert!(holds != Some(false) || row["law"].as_str().unwrap().starts_with("edges"), "{row}");
    }
}

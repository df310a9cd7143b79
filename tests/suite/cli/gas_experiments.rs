//! Experiments of `gas` that sweep a number or compare methods: their tables hold what was measured.

use serde_json::Value;

use super::program::{ONCE, folder, gas, read_json};

/// The table of an experiment that was run once.
fn table(name: &str, options: &str) -> Value {
    let out = folder();
    let experiment = gas(&format!("experiment {name} {options} --quiet --out .")).args(ONCE);
    experiment.on_test_device().inside(out.path()).run().succeeded();
    read_json(&out.path().join(format!("gas-{name}.json")))["table"].clone()
}

fn column<T>(table: &Value, name: &str, of: impl Fn(&Value) -> Option<T>) -> Vec<T> {
    let cells = table["rows"].as_array().unwrap().iter().map(|row| of(&row[name]));
    cells.map(|cell| cell.unwrap_or_else(|| panic!("{name}: {table}"))).collect()
}

/// Larger tables and more steps are nearer to what they are compared with; turbulence has a share of the time.
#[test]
fn sweeps_and_the_share_of_turbulence_are_written() {
    let by_size = table("table-size", "--steps 20 --counts 4,24 --size 90x62");
    assert_eq!(column(&by_size, "count", Value::as_u64), [4, 24]);
    let luv = column(&by_size, "Luv mean", Value::as_f64);
    assert!(luv[1] < 0.7 * luv[0], "{by_size}");
    // Along the viewer's rays.
    let samples = column(&by_size, "samples", Value::as_u64);
    assert!(samples[0] > 0 && samples[0] == samples[1], "{by_size}");
    let by_steps = table("steps", "--counts 4,16,64 --size 90x62");
    let luv = column(&by_steps, "Luv mean", Value::as_f64);
    assert!(luv[1] < luv[0] && luv[1] > 0.0 && luv[2] == 0.0, "{by_steps}");
    // There are no tables, and no -0 of them.
    assert!(column(&by_steps, "tables ms", Value::as_f64).into_iter().all(|ms| ms.to_bits() == 0), "{by_steps}");
    assert!(column(&by_steps, "samples", Value::as_u64).is_sorted_by(|fewer, more| 2 * fewer < *more), "{by_steps}");
    // Of times, so short ones on a busy machine may even be the other way round.
    let noise = table("noise", "--steps 20 --size 90x62");
    let one = |name: &str| column(&noise, name, Value::as_f64)[0];
    let [turbulent, constant, share] = ["turbulent ms", "constant ms", "share"].map(one);
    assert!(turbulent > 0.0 && constant > 0.0, "{noise}");
    assert!((share - (turbulent - constant) / turbulent).abs() < 1e-9, "{noise}");
    assert!(one("turbulent samples") > 0.0 && one("constant samples") > 0.0, "{noise}");
}

/// Linked lists and those by tiles have one picture, of ever more fragments; a buffer of 8 loses what lies behind.
#[test]
fn lists_are_compared_behind_sheets() {
    let table = table("lists", "--counts 2,40 --size 45x31");
    assert_eq!(column(&table, "sheets", Value::as_u64), [2, 2, 2, 40, 40, 40]);
    let lists = column(&table, "lists", |cell| cell.as_str().map(str::to_owned));
    assert_eq!(lists, ["linked", "tiles", "k:8", "linked", "tiles", "k:8"]);
    assert!(column(&table, "surfaces ms", Value::as_f64).into_iter().all(|ms| ms > 0.0), "{table}");
    let (luv, fragments) = (column(&table, "Luv mean", Value::as_f64), column(&table, "fragments", Value::as_u64));
    for method in 0..3 {
        assert!((luv[method] > 0.0) == (method == 2) && (luv[3 + method] > 0.0) == (method == 2), "{table}");
        assert!(fragments[3 + method] > fragments[method], "{table}");
    }
    let rows = table["rows"].as_array().unwrap();
    assert!([2, 5].iter().all(|&nearest: &usize| rows[nearest]["lost pixels"].as_u64() > Some(0)), "{table}");
}

/// The more a ray may lose, the fewer samples it takes, for nothing that is seen.
#[test]
fn skipped_bricks_are_compared() {
    let table = table("skipping", "--density-cache 16 --size 24x16 --steps 12");
    let (samples, luv) = (column(&table, "samples", Value::as_u64), column(&table, "Luv mean", Value::as_f64));
    assert_eq!(samples.len(), 3 * 2 * 4, "{table}");
    for (samples, luv) in samples.chunks(4).zip(luv.chunks(4)) {
        assert!(samples.iter().rev().is_sorted() && samples[3] > 0, "{table}");
        assert!(luv[..2].iter().all(|luv| *luv == 0.0) && luv[3] < 0.5, "{table}");
    }
    let ball = &samples[16..20];
    assert!(ball[1] * 3 < ball[0] * 2, "most of its box is empty: {table}");
}

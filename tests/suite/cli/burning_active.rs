//! `burning experiment active`.

use std::fs;

use super::program::{ONCE, assert_schema, burning, folder, read_json};

#[test]
fn a_tick_is_timed_by_the_share_of_active_vertices() {
    let out = folder();
    let experiment = burning("experiment active --triangles 2000 --speed 0.1 --size 48x32 --out .").args(ONCE);
    experiment.on_test_device().inside(out.path()).run().succeeded();
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

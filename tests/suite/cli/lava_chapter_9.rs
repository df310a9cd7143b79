//! `lava` through the binary: an experiment for each heading of chapter 9.

use fumarole::measure::study::Study;
use fumarole::papers::lava::setup::Setup;
use serde_json::Value;

use super::program::{ONCE, assert_schema, entries, folder, lava, read_json};

const SMALL: &str = "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --splat-radius 0.2";

/// In the thesis's order.
const HEADINGS: [(&str, &str); 7] = [
    ("flow", "Improved particle simulation"),
    ("cooling", "Temperature variables and heat transfer simulations"),
    ("radiance", "Convert lava temperature to emitted radiance"),
    ("shading", "Look at other shading techniques"),
    ("normals", "Calculate the surface normals by accumulation"),
    ("gaps", "Eliminate large gaps between splats"),
    ("culling", "Culling"),
];

/// Rows of the table of an experiment, or of the named one of its tables.
fn rows(name: &str, options: &str) -> Vec<Value> {
    let out = folder();
    lava("experiment")
        .arg(name)
        .args(SMALL)
        .args(options)
        .args("--quiet --out .")
        .on_test_device()
        .inside(out.path())
        .run()
        .succeeded();
    let files = entries(out.path());
    let tables = format!("lava-{name}-tables.json");
    let file = if files.contains(&tables) { tables } else { format!("lava-{name}.json") };
    let document = read_json(&out.path().join(file));
    document["table"]["rows"].as_array().unwrap_or_else(|| panic!("{document}")).clone()
}

fn number(row: &Value, column: &str) -> f64 {
    row[column].as_f64().unwrap_or_else(|| panic!("{column}: {row}"))
}

#[test]
fn each_heading_has_its_experiment() {
    let experiments = Setup::experiments();
    for (name, heading) in HEADINGS {
        let experiment = experiments.iter().find(|experiment| experiment.name == name).unwrap();
        let cited = format!("Chapter 9, \"{heading}\": ");
        assert!(experiment.help.starts_with(&cited), "{name}: {}", experiment.help);
    }
}

#[test]
fn what_radiates_cools() {
    let fluid = "--simulation sph --heat-capacity 12 --frames 9 --corrections 4";
    let rows = rows("cooling", fluid);
    assert_eq!(rows.len(), 2);
    assert!((number(&rows[0], "emissivity") - 0.95).abs() < 1e-6 && number(&rows[1], "emissivity") == 0.0);
    assert!(number(&rows[0], "mean K") < number(&rows[1], "mean K") - 0.01, "{rows:?}");
    assert!((number(&rows[1], "mean K") - 1423.0).abs() < 0.01, "{rows:?}");
    lava("experiment cooling").on_test_device().run().refused(2, &["--simulation"]);
    lava("experiment cooling --simulation sph --emissivity 0").on_test_device().run().refused(2, &["--emissivity"]);
}

#[test]
fn a_fluid_is_followed_over_many_steps() {
    let out = folder();
    let fluid = "--simulation sph --heat-capacity 12 --frames 90 --quiet --out .";
    let experiment = lava("experiment stability").args(SMALL).args(fluid).on_test_device();
    experiment.inside(out.path()).run().succeeded();
    let files = ["-compression.svg", ".csv", ".json", ".svg"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("lava-stability{suffix}")));
    let table = read_json(&out.path().join("lava-stability.json"));
    let rows = table["table"]["rows"].as_array().unwrap();
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert!(rows.len() == 46 && number(first, "frame") == 0.0 && number(last, "frame") == 89.0, "{table}");
    for row in rows {
        assert_eq!(number(row, "mass kg"), number(first, "mass kg"), "{row}");
        assert_eq!(number(row, "particles"), 400.0, "{row}");
    }
    assert!((number(first, "mass kg") - 0.72 * 2700.0).abs() < 0.1, "{first}");
    assert!(number(last, "energy J/kg") < number(first, "energy J/kg") - 0.5, "{table}");
    assert!(number(last, "mean K") < number(first, "mean K") - 0.1, "{table}");
    assert!(number(last, "front m") > number(first, "front m") + 0.5, "{table}");
    lava("experiment stability").on_test_device().run().refused(2, &["--simulation"]);
    lava("experiment stability --simulation sph --sides periodic")
        .on_test_device()
        .run()
        .refused(2, &["--sides periodic"]);
}

/// Hot lava comes out under what is there, lifts it and pushes it aside.
#[test]
fn lava_out_of_a_vent_is_followed_over_many_steps() {
    let vent = "--simulation sph --heat-capacity 12 --effusion-rate 0.1 --vent-radius 0.3 --vent 0.6,0.5 --frames 60";
    let rows = rows("stability", vent);
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    // 0.2 of 0.72 m^3.
    assert_eq!((number(first, "particles"), number(last, "particles")), (2.0, 111.0), "{rows:?}");
}

/// Every law at every frame, for more than a minute of lava that falls, spreads and comes to rest; it takes twice as long. Beside
/// other tests its passes, of a millisecond each, cost a fifth less of the processor on the thread that submits them.
#[test]
fn four_thousand_particles_hold_their_laws_for_two_thousand_frames() {
    let out = folder();
    let experiment = lava("experiment stability --simulation sph --particles 4000 --frames 2000 --quiet --out .");
    experiment.on_test_device().env("LP_NUM_THREADS", "0").inside(out.path()).run().succeeded();
    let table = read_json(&out.path().join("lava-stability.json"));
    let rows = table["table"]["rows"].as_array().unwrap();
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!(number(last, "frame"), 1999.0, "{table}");
    for row in rows {
        assert_eq!(number(row, "mass kg"), number(first, "mass kg"), "{row}");
        assert!(number(row, "greatest compression %") < 20.0, "{row}");
    }
    assert!(number(last, "mean speed m/s") < 0.1 && number(last, "front m") > 3.9, "{last}");
}

#[test]
fn pixels_have_planck_s_chromaticities() {
    let rows = rows("radiance", "");
    let within: Vec<&Value> = rows.iter().filter(|row| number(row, "kelvin") >= 2000.0).collect();
    assert!(rows.len() == 11 && within.len() == 7, "{rows:?}");
    for row in within {
        assert!(number(row, "apart") < 2e-3, "{row}");
    }
    // More saturated than the display's red.
    assert!(number(&rows[0], "apart") > 2e-3, "{}", rows[0]);
    lava("experiment radiance --simulation sph").on_test_device().run().refused(2, &["--simulation"]);
    lava("experiment radiance --color blackbody").run().refused(2, &["--color"]);
}

#[test]
fn shadings_are_set_beside_each_other() {
    let rows = rows("shading", ONCE);
    let names: Vec<&str> = rows.iter().map(|row| row["shading"].as_str().unwrap()).collect();
    assert_eq!(names, ["gouraud", "deferred", "march"]);
    for row in &rows {
        assert!(number(row, "stage three ms") > 0.0 && number(row, "frame ms") > 0.0, "{row}");
    }
    let contrast = |row: usize| number(&rows[row], "contrast of neighbours");
    assert!(contrast(1) > contrast(0) && contrast(2) > contrast(0), "{rows:?}");
    lava("experiment shading --splat-shading deferred").run().refused(2, &["--splat-shading"]);
}

#[test]
fn normals_are_set_beside_the_isosurface_s() {
    let rows = rows("normals", "--particles 3000 --density 40x12x16 --border 0");
    assert_eq!(rows.len(), 4);
    for row in &rows {
        let (median, p95) = (number(row, "median degrees"), number(row, "p95 degrees"));
        assert!(number(row, "columns") > 200.0 && median > 0.0 && median <= p95 && p95 <= 180.0, "{row}");
    }
    // Inside the lava gradients point anywhere: what the thesis calls rather poor.
    assert!(number(&rows[1], "median degrees") > number(&rows[3], "median degrees"), "{rows:?}");
}

#[test]
fn gaps_are_counted_from_all_around() {
    let rows = rows("gaps", "--size 120x90 --splats 200x50 --splat-radius 0.016");
    let of = |row: usize, column: &str| number(&rows[row], column);
    assert!(rows[0]["splats"] == "disc" && rows[1]["splats"] == "fitted", "{rows:?}");
    assert!(of(0, "cameras") == 32.0 && of(0, "pixels") > 3000.0 && of(0, "pixels") == of(1, "pixels"), "{rows:?}");
    assert!(of(1, "gaps") <= of(0, "gaps") && of(0, "most gaps of a camera") <= of(0, "gaps"), "{rows:?}");
    lava("experiment gaps --splat-shape fitted").run().refused(2, &["--splat-shape"]);
}

#[test]
fn splats_that_stay_are_counted() {
    let rows = rows("culling", ONCE);
    let names: Vec<(&str, &str)> =
        rows.iter().map(|row| (row["camera"].as_str().unwrap(), row["culling"].as_str().unwrap())).collect();
    assert_eq!(rows.len(), 18);
    assert_eq!(names[..4], [("fig-8.1", "off"), ("fig-8.1", "frustum"), ("fig-8.1", "facing"), ("fig-8.2", "off")]);
    for three in rows.chunks_exact(3) {
        assert!(three[0]["splats"].is_null() && number(&three[0], "times faster") == 1.0, "{three:?}");
        let [frustum, facing] = [1, 2].map(|row: usize| number(&three[row], "splats"));
        assert!(facing <= frustum && frustum <= 400.0 && number(&three[1], "clusters") <= 7.0, "{three:?}");
    }
    // Close to one end.
    assert!(number(&rows[13], "splats") < 400.0, "{}", rows[13]);
    let record = lava("bench --json --quiet --validate --culling facing --splat-shading deferred")
        .args(SMALL)
        .args(ONCE)
        .on_test_device()
        .run()
        .succeeded()
        .json();
    assert_schema(&record);
    let run = &record["runs"][0];
    assert!(run["results"]["kept_splats"].as_u64().unwrap() <= 400 && run["results"]["splat_clusters"] == 7);
    assert_eq!(run["validation"], "clean");
    lava("experiment culling --culling off").run().refused(2, &["--culling"]);
}

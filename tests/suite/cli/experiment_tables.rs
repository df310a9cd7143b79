//! Output of an experiment beside its runs: its tables, on the page too, and every warning once.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::program::{ONCE, Program, caustics, folder, fumarole, gas, lava, read_json};
use super::report::assert_table_schema;

/// Asserts that the tables beside a record are printed and stand on the page of their folder, with the document's own
/// digits, and gives them by their places.
pub(super) fn shown_tables(program: Program, folder: &Path, name: &str) -> Vec<Value> {
    let printed = program.arg("--out").arg(folder).on_test_device().run().succeeded().stdout;
    let document = read_json(&folder.join(format!("{name}-tables.json")));
    assert_table_schema(&document);
    let page = folder.join("page.html");
    fumarole("report --quiet").arg(folder).arg("--output").arg(&page).run().succeeded();
    let text = fs::read_to_string(page).unwrap();
    let section = text.split_once("<section class=\"record tables\"").expect("the tables have a section").1;
    let tables: Vec<Value> =
        [&document["table"]].into_iter().chain(document["more"].as_object().unwrap().values()).cloned().collect();
    for table in &tables {
        let title = table["title"].as_str().unwrap();
        assert!(printed.contains(title) && section.contains(&format!("<h3>{title}</h3>")), "{title}: {printed}");
        let rows = table["rows"].as_array().unwrap();
        assert!(!rows.is_empty(), "{title}");
        for cell in rows.iter().flat_map(|row| row.as_object().unwrap().values()) {
            let shown = match cell {
                Value::Null => continue,
                Value::String(text) => format!(">{text}</td>"),
                number => format!("data-value=\"{number}\""),
            };
            assert!(section.contains(&shown), "{shown} of {title}");
        }
    }
    tables
}

#[test]
fn the_ratios_of_caustics_stand_on_the_page() {
    let out = folder();
    let options = "--counts 3,5 --mesh sphere --size 96x64 --map-size 64 --water-triangles 500";
    let program = caustics("experiment appendix").args(options).args("--frames 3 --repeat 2 --warmup 1 --no-limits");
    let tables = shown_tables(program, out.path(), "caustics-appendix");
    assert_eq!(tables.len(), 2);
    let run = read_json(&out.path().join("caustics-appendix.json"))["runs"][1].clone();
    assert_eq!(run["variant"], "volumetric");
    let row = &tables[0]["rows"][0];
    let own = 1.0 / run["results"]["level_map_over_volumetric"].as_f64().unwrap();
    assert_eq!(row["volumetric / level-map"].as_f64(), Some(own));
    // Six frames a method are enough for an interval.
    assert!(row["from"].as_f64().unwrap() <= own && own <= row["to"].as_f64().unwrap(), "{row}");
    assert_eq!(tables[1]["rows"].as_array().unwrap().len(), 2);
}

#[test]
fn the_stages_of_lava_stand_on_the_page() {
    let out = folder();
    let options = "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --surface-draw splats";
    let program = lava("experiment readback").args(options).args(ONCE);
    let tables = shown_tables(program, out.path(), "lava-readback");
    let [stages] = &tables[..] else { panic!("{tables:?}") };
    let of = |variant: &str| stages["rows"].as_array().unwrap().iter().filter(|row| row["variant"] == variant).count();
    assert_eq!((of("paper"), of("gpu-driven")), (4, 4));
}

#[test]
fn a_warning_of_all_runs_is_printed_once_at_the_end() {
    let out = folder();
    let options = "--counts 3 --mesh sphere --size 64x48 --map-size 32 --water-triangles 200 --validate --no-limits";
    let program =
        caustics("experiment 5-1 --frames 3 --repeat 2 --warmup 1").args(options).arg("--out").arg(out.path());
    let ended = program.on_test_device().run().succeeded();
    let runs = read_json(&out.path().join("caustics-5-1.json"))["runs"].as_array().unwrap().clone();
    let warnings: Vec<&str> = ended.stdout.lines().filter_map(|line| line.strip_prefix("warning: ")).collect();
    let of_layer: Vec<&&str> = warnings.iter().filter(|warning| warning.contains("validation layer")).collect();
    assert_eq!(of_layer, [&"the validation layer is on: times include it (2 of 2 runs)"], "{}", ended.stdout);
    for warning in runs.iter().flat_map(|run| run["warnings"].as_array().unwrap()) {
        // Of noise the greatest is said.
        let warning = warning.as_str().unwrap();
        let warning = if warning.starts_with("noisy: ") { "noisy: " } else { warning };
        assert_eq!(warnings.iter().filter(|line| line.starts_with(warning)).count(), 1, "{warning}: {warnings:?}");
    }
    let last: Vec<&str> = ended.stdout.lines().rev().take(warnings.len()).collect();
    assert!(last.iter().all(|line| line.starts_with("warning: ")), "{}", ended.stdout);
}

#[test]
fn what_is_measured_without_runs_has_the_machines_warnings() {
    let out = folder();
    let options = "--counts 3 --mesh sphere --size 64x48 --map-size 32 --water-triangles 200 --validate";
    let program = caustics("experiment 5-4").args(options).arg("--out").arg(out.path());
    let ended = program.on_test_device().run().succeeded();
    assert_eq!(
        ended.stdout.lines().last(),
        Some("warning: the validation layer is on: times include it"),
        "{}",
        ended.stdout
    );
    let document = read_json(&out.path().join("caustics-5-4.json"));
    assert_eq!(document["warnings"], json!(["the validation layer is on: times include it"]));
    let page = out.path().join("page.html");
    fumarole("report --quiet -o").arg(&page).arg(out.path()).run().succeeded();
    let page = fs::read_to_string(page).unwrap();
    assert_eq!(page.matches("Warning: the validation layer is on").count(), 1);
}

#[test]
fn warnings_of_runs_that_became_a_table_are_printed_too() {
    let out = folder();
    let program = gas("experiment noise --size 30x20 --steps 4 --validate").args(ONCE).arg("--out").arg(out.path());
    let ended = program.on_test_device().run().succeeded();
    let said = "warning: the validation layer is on: times include it (2 of 2 runs)\n";
    assert_eq!(ended.stdout.matches(said).count(), 1, "{}", ended.stdout);
    assert!(ended.stdout.lines().last().unwrap().starts_with("warning: "), "{}", ended.stdout);
    let document = read_json(&out.path().join("gas-noise.json"));
    let warnings = document["warnings"].as_array().unwrap();
    assert!(warnings.iter().all(|line| ended.stdout.contains(&format!("warning: {}\n", line.as_str().unwrap()))));
    assert!(warnings.contains(&"the validation layer is on: times include it (2 of 2 runs)".into()), "{warnings:?}");
}

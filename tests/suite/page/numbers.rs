//! The page shows the record's own numbers, all of them, and draws bars of their lengths.

use serde_json::{Map, Value};

use super::browser::Browser;
use super::report;
use crate::cli::compare::record_of;
use crate::cli::program::{file, folder, fumarole};
use crate::common::beside_others;

/// An expression for the rows of the first table that a selector finds: cells by their headings, numbers with all digits.
fn rows_of(table: &str) -> String {
    format!(
        "(() => {{ const table = document.querySelector({table:?}); const heads = \
         [...table.tHead.rows[0].cells].map((cell) => cell.textContent); return [...table.tBodies[0].rows].map((row) => \
         Object.fromEntries([...row.cells].map((cell, at) => [heads[at], cell.dataset.value ?? cell.textContent]))); }})()"
    )
}

/// An expression for the rows of a table with headings at their left: its cells, numbers with all digits.
fn facts_of(table: &str) -> String {
    format!(
        "Object.fromEntries([...{table}.tBodies[0].rows].map((row) => [row.cells[0].textContent, [...row.cells].slice(1)\
         .map((cell) => cell.querySelector('[data-value]')?.dataset.value ?? cell.textContent)]))"
    )
}

fn parsed(text: &Value) -> Option<f64> {
    text.as_str().and_then(|text| text.parse().ok())
}

#[track_caller]
fn assert_number(found: &Value, expected: Option<f64>, what: &str) {
    let is_equal = match (parsed(found), expected) {
        (Some(found), Some(expected)) => (found - expected).abs() <= 1e-12 * expected,
        (found, expected) => found == expected,
    };
    assert!(is_equal, "{what}: {found}, {expected:?}");
}

fn assert_frame(browser: &mut Browser, section: &str, run: &Value) {
    let shown = browser.value(&format!(
        "[...document.querySelectorAll('{section} .frame [data-value]')].map((one) => one.dataset.value)"
    ));
    let frame = |name: &str| run["frame_ms"][name].as_f64();
    let rate = frame("median").map(|ms| 1000.0 / ms);
    let of_run = ["unaccounted_ms", "overlap_ms", "stamp_floor_ms", "load_ms", "pipeline_ms"];
    let expected = ["median", "mad", "min", "p95", "p99", "max"].map(frame).into_iter().chain([rate]);
    let expected: Vec<f64> = expected.chain(of_run.map(|name| run[name].as_f64())).flatten().collect();
    let shown = shown.as_array().unwrap();
    assert_eq!(shown.len(), expected.len(), "{shown:?}");
    shown.iter().zip(expected).for_each(|(found, expected)| assert_number(found, Some(expected), "of the frame"));
}

/// The columns of the table of passes, with what they are of a pass.
const NUMBERS: [(&str, &str); 16] = [
    ("GPU ms", "/gpu_ms/median"),
    ("± MAD", "/gpu_ms/mad"),
    ("floor ms", "/floor_ms"),
    ("host ms", "/host_ms/median"),
    ("wait ms", "/wait_ms/median"),
    ("calls", "/calls"),
    ("vertices", "/statistics/vertices"),
    ("primitives", "/statistics/primitives"),
    ("clipped primitives", "/statistics/clipped_primitives"),
    ("fragments", "/statistics/fragments"),
    ("invocations", "/statistics/compute_invocations"),
    ("samples", "/statistics/samples_passed"),
    ("bytes read", "/bytes/read"),
    ("bytes written", "/bytes/written"),
    ("read, at most", "/bytes/at_most/read"),
    ("written, at most", "/bytes/at_most/written"),
];
const TEXTS: [(&str, &str); 5] = [
    ("pass", "/name"),
    ("section", "/section"),
    ("kind", "/kind"),
    ("bound by", "/bound"),
    ("compiler", "/shader_compiler"),
];

fn assert_passes(browser: &mut Browser, section: &str, run: &Value) {
    let rows = browser.value(&rows_of(&format!("{section} table")));
    let (rows, passes) = (rows.as_array().unwrap(), run["passes"].as_array().unwrap());
    assert_eq!(rows.len(), passes.len());
    for (row, pass) in rows.iter().zip(passes) {
        let of = |path: &str| pass.pointer(path).and_then(Value::as_f64);
        for (column, path) in NUMBERS {
            assert_number(&row[column], of(path), &format!("{column} of {}", pass["name"]));
        }
        let share =
            of("/floor_ms").zip(of("/counted_ms").or(of("/gpu_ms/median"))).map(|(floor, gpu)| 100.0 * floor / gpu);
        assert_number(&row["share of limit, %"], share, "share of limit");
        let ms = [of("/gpu_ms/median"), of("/host_ms/median")].into_iter().flatten().reduce(|sum, ms| sum + ms);
        let part = ms.map(|ms| 100.0 * ms / run["frame_ms"]["median"].as_f64().unwrap());
        assert_number(&row["% of frame"], part, "share of the frame");
        for (column, path) in TEXTS {
            assert_eq!(row[column], pass.pointer(path).and_then(Value::as_str).unwrap_or_default(), "{column}");
        }
        assert_eq!(row.as_object().unwrap().len(), NUMBERS.len() + TEXTS.len() + 2, "no other column: {row}");
    }
}

/// Limits by what the page calls them.
const LIMITS: [(&str, &str); 16] = [
    ("copy, GB/s", "copy_gb_s"),
    ("copy inside the caches, GB/s", "small_copy_gb_s"),
    ("multiply-add, GFLOPS", "fma_gflops"),
    ("fill rgba8, Gpixel/s", "fill_gpix_s"),
    ("fill r32f, Gpixel/s", "fill_r32f_gpix_s"),
    ("fill rgba16f, Gpixel/s", "fill_rgba16f_gpix_s"),
    ("fill rgba32f, Gpixel/s", "fill_rgba32f_gpix_s"),
    ("blend rgba8, Gpixel/s", "blend_gpix_s"),
    ("blend r32f, Gpixel/s", "blend_r32f_gpix_s"),
    ("blend rgba16f, Gpixel/s", "blend_rgba16f_gpix_s"),
    ("blend rgba32f, Gpixel/s", "blend_rgba32f_gpix_s"),
    ("vertices, Gvertex/s", "vertex_gvertices_s"),
    ("triangles, Gtriangle/s", "triangle_gtriangles_s"),
    ("invocations, Ginvocation/s", "issue_ginvocations_s"),
    ("empty draw, ms", "empty_draw_ms"),
    ("empty dispatch, ms", "empty_dispatch_ms"),
];

/// Limits, parameters, results, input files and memory.
fn assert_details(browser: &mut Browser, section: &str, run: &Value) {
    let limits = browser.value(&facts_of(&format!("document.querySelector('{section} table.limits')")));
    assert_eq!(limits.as_object().unwrap().len(), LIMITS.len(), "{limits}");
    for (heading, name) in LIMITS {
        let samples = &run["limits"]["samples"][name];
        assert_number(&limits[heading][0], samples["median"].as_f64(), heading);
        assert_number(&limits[heading][1], samples["mad"].as_f64(), heading);
    }
    let inputs = run["inputs"].as_array().unwrap().iter();
    let inputs: Map<String, Value> =
        inputs.map(|file| (file["path"].as_str().unwrap().to_owned(), file["sha256"].clone())).collect();
    let of = |name: &str| run[name].as_object().unwrap().clone();
    for (heading, expected) in
        [("Parameters", of("config")), ("The paper's own figures", of("results")), ("Input files, SHA-256", inputs)]
    {
        let table = format!(
            "[...document.querySelectorAll('{section} h4')].find((one) => one.textContent === {heading:?})\
             .nextElementSibling"
        );
        let found = browser.value(&facts_of(&table));
        assert_eq!(found.as_object().unwrap().len(), expected.len(), "{found}");
        for (name, expected) in expected {
            let expected = if heading.starts_with("Input") { expected } else { expected.to_string().into() };
            assert_eq!(found[&name][0], expected, "{heading}: {name}");
        }
    }
    let memory = browser.value(&format!(
        "(() => {{ const table = [...document.querySelectorAll('{section} details table.sortable')].find((one) => \
         one.tHead.textContent.startsWith('resource')); return [...table.tBodies[0].rows].map((row) => ({{name: \
         row.cells[0].textContent, bytes: Number(row.cells[1].dataset.value)}})); }})()"
    ));
    assert_eq!(memory, run["memory"]["by_resource"]);
}

fn assert_environment(browser: &mut Browser, environment: &Value) {
    let shown = browser.value(&facts_of("document.querySelector('#record-0 > details table')"));
    let text = |path: &str| match environment.pointer(path).unwrap() {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(|item| item.as_str().unwrap()).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    };
    let mut expected = Map::new();
    for (heading, parts) in [
        ("device", vec![text("/device/name"), format!("({})", text("/device/type"))]),
        ("device's UUID", vec![text("/device/uuid")]),
        ("Vulkan", vec![text("/device/api_version")]),
        ("driver", vec![text("/device/driver"), text("/device/driver_version")]),
        ("system", vec![text("/host/os"), text("/host/kernel")]),
        ("processor", vec![text("/host/cpu")]),
        ("cores", vec![text("/host/logical_cores")]),
        ("LP_NUM_THREADS", vec![text("/host/lp_num_threads")]),
        ("layers", vec![text("/layers")]),
        ("program", vec![text("/build/version"), text("/build/git_commit"), text("/build/profile")]),
        ("CPU governor", vec![text("/host/cpu_governor")]),
        ("loader", vec![text("/loader")]),
        ("compiler of the program", vec![text("/build/rustc")]),
        ("SHA-256 of the program", vec![text("/build/executable_sha256")]),
        ("measured", vec![text("/date")]),
        ("VK_DRIVER_FILES", vec![text("/host/variables/VK_DRIVER_FILES")]),
    ] {
        expected.insert(heading.to_owned(), vec![parts.join(" ")].into());
    }
    assert_eq!(shown, Value::Object(expected));
}

#[test]
fn the_pages_numbers_are_the_records_in_the_browser() {
    beside_others(|| {
        let (_out, page, record) = report();
        let mut browser = Browser::start();
        browser.open(&page);
        for (index, run) in record["runs"].as_array().unwrap().iter().enumerate() {
            let section = format!("#run-0-{index}");
            assert_frame(&mut browser, &section, run);
            assert_passes(&mut browser, &section, run);
            assert_details(&mut browser, &section, run);
        }
        assert_environment(&mut browser, &record["environment"]);
        let ratio = browser.value(
            "[...document.querySelectorAll('#record-0 > .wide td.number')].map((cell) => cell.dataset.value ?? '')",
        );
        let row = &record["runs"][1]["experiment"];
        let expected = [row["paper"].as_f64(), row["ours"].as_f64(), Some(1.45), Some(1.55), row["ratio"].as_f64()];
        for (found, expected) in ratio.as_array().unwrap().iter().zip(expected) {
            assert_eq!(found.as_str().unwrap().parse::<f64>().ok(), expected, "{ratio}");
        }
        // An experiment's own tables.
        let tables: Value = serde_json::from_str(include_str!("../../data/tables.json")).unwrap();
        let rows = browser.value(&rows_of("section.tables .wide table"));
        for (row, expected) in rows.as_array().unwrap().iter().zip(tables["table"]["rows"].as_array().unwrap()) {
            for (name, expected) in expected.as_object().unwrap() {
                let found = &row[name];
                let is_equal = match expected {
                    Value::Null => found == "",
                    Value::Number(number) => found.as_str().unwrap().parse() == Ok(number.as_f64().unwrap()),
                    other => found == other,
                };
                assert!(is_equal, "{name}: {found}, {expected}");
            }
        }
        assert_eq!(rows.as_array().unwrap().len(), 2);
        assert_eq!(browser.value("document.querySelectorAll('section.tables table.sortable').length"), 2);
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

/// Every bar is as long as its share of the time of all, and begins where those before it end, in both drawings.
#[test]
fn bars_are_as_long_as_their_times() {
    beside_others(|| {
        let (_out, page, record) = report();
        let mut browser = Browser::start();
        browser.open(&page);
        for (index, run) in record["runs"].as_array().unwrap().iter().enumerate() {
            let time = |pass: &Value| {
                let times = ["gpu_ms", "host_ms"].map(|clock| pass[clock]["median"].as_f64());
                times.into_iter().flatten().reduce(|sum, ms| sum + ms)
            };
            let times: Vec<f64> = run["passes"].as_array().unwrap().iter().filter_map(time).collect();
            let total_ms: f64 = times.iter().sum();
            let drawings = browser.value(&format!(
                "[...document.querySelectorAll('section.run')[{index}].querySelectorAll('svg.bars')].map((svg) => \
                 [...svg.querySelectorAll('rect')].map((rect) => {{ const box = rect.getBBox(); return [box.x, box.width, \
                 box.y, box.height]; }}))"
            ));
            let drawings: Vec<Vec<[f64; 4]>> = serde_json::from_value(drawings).unwrap();
            assert_eq!(drawings.len(), 2, "stacked, and as a timeline");
            for bars in &drawings {
                assert_eq!(bars.len(), times.len());
                let length: f64 = bars.iter().map(|[_, width, ..]| width).sum();
                // Lengths have two digits behind the point.
                let digits = 0.03 / length;
                let mut before_ms = 0.0;
                for ([x, width, ..], ms) in bars.iter().zip(&times) {
                    assert!(
                        (width / length - ms / total_ms).abs() < digits,
                        "{width} of {length}: {ms} of {total_ms} ms"
                    );
                    let start = (x - bars[0][0]) / length;
                    assert!(
                        (start - before_ms / total_ms).abs() < 2.0 * digits,
                        "at {start}: {before_ms} of {total_ms} ms"
                    );
                    before_ms += ms;
                }
            }
            let [stacked, timeline] = &drawings[..] else { panic!("two drawings") };
            assert!(stacked.iter().all(|bar| bar[2] == stacked[0][2]), "one bar");
            assert!(timeline.windows(2).all(|two| two[0][2] + two[0][3] <= two[1][2]), "a row each");
        }
    });
}

/// The verdicts on the page are those of `compare`, number by number.
#[test]
fn verdicts_are_those_of_compare() {
    beside_others(|| {
        let out = folder();
        for (name, factor) in [("a.json", 1.0), ("b.json", 1.5)] {
            file(&out, name, record_of(3, factor).to_string());
        }
        let program = |words: &str| fumarole(words).inside(out.path());
        let compared = program("compare a.json b.json --json").run().succeeded().json();
        program("report --quiet --a a.json --b b.json --output report.html").run().succeeded();
        let mut browser = Browser::start();
        browser.open(&out.path().join("report.html"));
        let headlines = browser.value("[...document.querySelectorAll('#verdicts p')].map((line) => line.textContent)");
        let number = |value: &Value, digits: usize| {
            value.as_f64().map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
        };
        let interval = |time: &Value| match &time["interval"] {
            Value::Null => "-".to_owned(),
            ends => format!("[{}, {}]", number(&ends[0], 4), number(&ends[1], 4)),
        };
        for (index, run) in compared["runs"].as_array().unwrap().iter().enumerate() {
            let frame = &run["frame"];
            let (verdict, ratio) = (frame["verdict"].as_str().unwrap(), number(&frame["ratio"], 4));
            let [a, b] = ["a_median_ms", "b_median_ms"].map(|side| number(&frame[side], 3));
            let of_frame = interval(frame);
            let line =
                format!("{verdict}: frame B / A {ratio} {of_frame}, A {a} ms (3 processes), B {b} ms (3 processes)");
            assert!(headlines.as_array().unwrap().contains(&line.as_str().into()), "{line} in {headlines}");
            assert_eq!(verdict, "SLOWER");
            let table = format!("document.querySelectorAll('#verdicts table')[{index}]");
            let rows = browser.value(&format!(
                "[...{table}.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent))"
            ));
            let rows: Vec<Vec<String>> = serde_json::from_value(rows).unwrap();
            let passes = run["passes"].as_array().unwrap();
            assert_eq!(rows.len(), passes.len());
            for (row, pass) in rows.iter().zip(passes) {
                let clock = pass["clock"].as_str().unwrap().replace("gpu", "GPU");
                let share = pass["share"].as_f64().map_or("-".to_owned(), |share| format!("{:.1} %", 100.0 * share));
                let name = pass["name"].as_str().unwrap().to_owned();
                let [a, b] = ["a_median_ms", "b_median_ms"].map(|side| number(&pass[side], 3));
                assert_eq!(row[..7], [name, clock, a, b, share, number(&pass["ratio"], 4), interval(pass)]);
                assert!(row[7].starts_with(pass["verdict"].as_str().unwrap()), "{row:?}");
            }
        }
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

//! `fumarole report`: one page from what lies on the disk.

use std::fs;

use base64::Engine;
use fumarole::image::{Rgba8, read_png, write_png};
use serde_json::{Value, json};

use super::compare::record_of;
use super::program::{ONCE, caustics, file, folder, fumarole, read_json, sha256};

/// The number of the record that the page shows after some text.
fn shown_after(page: &str, text: &str) -> f64 {
    let rest = page.split_once(text).unwrap_or_else(|| panic!("no {text}")).1;
    let number = rest.strip_prefix("<span data-value=\"").unwrap_or_else(|| panic!("no number after {text}"));
    number.split('"').next().unwrap().parse().unwrap()
}

#[test]
fn a_folder_becomes_a_page_with_pictures_plots_and_numbers() {
    let out = folder();
    let path = |name: &str| out.path().join(name);
    let bench = caustics("bench").tiny().args(ONCE).args("--quiet --variant level-map,volumetric");
    bench.arg("--json").arg(path("run.json")).arg("--image").arg(path("run.png")).run().succeeded();
    file(&out, "plot.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
    file(&out, "other.json", "{\"schema\": \"fumarole.compare/2\"}");
    file(&out, "broken.json", "{");
    let page = path("page.html");
    let ended = fumarole("report").arg(out.path()).arg("--output").arg(&page).run().succeeded();
    for name in ["broken.json", "other.json"] {
        assert!(ended.stderr.contains(name), "what could not be read is named: {}", ended.stderr);
    }
    let text = fs::read_to_string(&page).unwrap();
    let record: serde_json::Value = serde_json::from_str(&fs::read_to_string(path("run.json")).unwrap()).unwrap();
    for run in record["runs"].as_array().unwrap() {
        let median = &run["frame_ms"]["median"];
        assert!(text.contains(&format!("data-value=\"{median}\"")), "{median}");
        for pass in run["passes"].as_array().unwrap() {
            assert!(text.contains(&format!("<td>{}</td>", pass["name"].as_str().unwrap())));
        }
    }
    // Each variant's picture, the second over the first under a divider, with their difference as it is.
    assert_eq!(text.matches("data:image/png").count(), 2);
    assert_eq!(text.matches("<div class=\"divided\">").count(), 1);
    let [first, second] = ["run.png", "run-volumetric.png"].map(|name| read_png(&path(name)).unwrap());
    let difference = fumarole::image::compare(&first, &second, None).unwrap();
    assert!(difference.mean > 0.0, "the methods draw different pictures");
    let caption = &text[text.find("CIE Luv difference").unwrap()..];
    let [mean, p99] = ["mean ", "99th percentile "].map(|name| shown_after(caption, name));
    assert_eq!([mean, p99], [difference.mean, difference.p99]);
    assert!(caption.contains(&format!(">{:.3}</span>", difference.mean)), "{caption}");
    assert_eq!(text.matches("data:image/svg+xml").count(), 1);

    // A picture that has changed since is not shown as the record's.
    fs::write(path("run.png"), "other").unwrap();
    fs::remove_file(path("run-volumetric.png")).unwrap();
    let ended = fumarole("report").arg(path("run.json")).arg("--output").arg(&page).run().succeeded();
    assert!(ended.stderr.contains("changed since"), "{}", ended.stderr);
    assert!(!fs::read_to_string(&page).unwrap().contains("data:image/png"));
}

/// The console's tables of an experiment without runs stand on the page, with the document's own digits.
#[test]
fn tables_of_experiments_stand_on_the_page_as_they_are_printed() {
    let out = folder();
    let printed = caustics("experiment 5-2 --out").arg(out.path()).on_test_device().run().succeeded().stdout;
    let document = read_json(&out.path().join("caustics-5-2.json"));
    assert_table_schema(&document);
    let page = out.path().join("page.html");
    fumarole("report --quiet").arg(out.path()).arg("--output").arg(&page).run().succeeded();
    let text = fs::read_to_string(&page).unwrap();
    let section = text.split_once("<section class=\"record tables\"").expect("the tables have a section").1;
    assert!(section.contains(document["table"]["title"].as_str().unwrap()));
    let headings = ["mesh", "triangles", "thesis"].map(|name| format!("<button type=\"button\">{name}</button></th>"));
    assert!(section.contains(&headings.join("<th class=\"number\">")), "{section}");
    let rows = document["table"]["rows"].as_array().unwrap();
    for row in rows {
        let mesh = row["mesh"].as_str().unwrap();
        let numbers = [&row["triangles"], &row["thesis"]].map(|number| match number {
            Value::Null => "<td class=\"number\"></td>".to_owned(),
            number => format!("<td class=\"number\" data-value=\"{number}\" title=\"{number}\">{number}</td>"),
        });
        assert!(
            section.contains(&format!("<tr><td class=\"\">{mesh}</td>{}</tr>", numbers.concat())),
            "{row} in {section}"
        );
        let words: Vec<String> = [&row["mesh"], &row["triangles"], &row["thesis"]]
            .into_iter()
            .filter(|cell| !cell.is_null())
            .map(|cell| cell.as_str().map_or_else(|| cell.to_string(), str::to_owned))
            .collect();
        assert!(printed.lines().any(|line| line.split_whitespace().eq(&words)), "{words:?} in {printed}");
    }
    assert!(rows.len() > 2 && rows.iter().any(|row| row["thesis"].is_u64()), "{rows:?}");
    assert!(section.contains("caustics experiment 5-2 --out"), "its command is there");

    // By itself, too; too large a one is left to its CSV.
    fumarole("report --quiet").arg(out.path().join("caustics-5-2.json")).arg("-o").arg(&page).run().succeeded();
    assert!(fs::read_to_string(&page).unwrap().contains("record tables"));
    let mut large = document;
    large["table"]["rows"] = vec![json!({}); 60_000].into();
    file(&out, "caustics-5-2.json", large.to_string());
    let ended = fumarole("report").arg(out.path()).arg("-o").arg(&page).run().succeeded();
    assert!(ended.stderr.contains("180000 cells are too large"), "{}", ended.stderr);
}

/// Records of this schema from before limits had samples and five more of them, before primitives were counted behind the
/// clipper, and before rows had intervals.
#[test]
fn older_records_are_shown() {
    let out = folder();
    let frozen: Value = serde_json::from_str(include_str!("../../data/record.json")).unwrap();
    let mut older = frozen.clone();
    let run = &mut older["runs"][0];
    run["limits"] = json!({"copy_gb_s": 6.5, "fma_gflops": 40.25, "fill_gpix_s": 0.75, "blend_gpix_s": 0.375});
    run["experiment"] = json!({"row": "teapot, 31 planes", "paper": 2.0, "ours": 1.5, "ratio": 0.8125});
    assert!(run["passes"][1]["statistics"]["clipped_primitives"].is_null());
    for (name, record) in [("frozen.json", &frozen), ("older.json", &older)] {
        let path = file(&out, name, record.to_string());
        let page = out.path().join("page.html");
        let ended = fumarole("report").arg(path).arg("--output").arg(&page).run().succeeded();
        assert!(!ended.stderr.contains("warning"), "{}", ended.stderr);
        let text = fs::read_to_string(&page).unwrap();
        let numbers = [115.8080865, 5.2033655, 0.009504499999999999, 3851.0, 797_344.0, 77808.0];
        let of_older = [6.5, 40.25, 0.75, 0.375, 2.0, 1.5, 0.8125];
        let expected = numbers.iter().chain(of_older.iter().filter(|_| name == "older.json"));
        for number in expected {
            assert!(text.contains(&format!("data-value=\"{number}")), "{number} of {name}");
        }
        assert!(!text.contains("clipped primitives"));
    }
}

/// Plots and verdicts have the command that they come from, and a comparison that was kept is shown as it is.
#[test]
fn plots_and_kept_comparisons_have_their_commands() {
    let out = folder();
    let place = |name: &str| out.path().join(name);
    for name in ["gas", "gas-1", "gas-12"] {
        let mut record = record_of(1, 1.0);
        record["command"] = json!(["fumarole", "made", name]);
        file(&out, &format!("{name}.json"), record.to_string());
    }
    for name in ["gas-1", "gas-1-tables", "gas-12", "lava-1"] {
        file(&out, &format!("{name}.svg"), "<svg xmlns='http://www.w3.org/2000/svg'/>");
    }
    let compare = fumarole("compare gas.json gas-1.json --json kept.json").inside(out.path());
    compare.run().succeeded();
    let kept = read_json(&place("kept.json"));
    assert_eq!(kept["a_commands"], json!([["fumarole", "made", "gas"]]));
    assert_eq!(kept["b_commands"], json!([["fumarole", "made", "gas-1"]]));
    assert_eq!(kept["command"].as_array().unwrap()[1..], ["compare", "gas.json", "gas-1.json", "--json", "kept.json"]);
    fumarole("report --quiet . -o page.html").inside(out.path()).run().succeeded();
    let text = fs::read_to_string(place("page.html")).unwrap();
    let plots = text.split_once("id=\"plots\"").unwrap().1;
    for (plot, made) in
        [("gas-1", Some("gas-1")), ("gas-1-tables", Some("gas-1")), ("gas-12", Some("gas-12")), ("lava-1", None)]
    {
        let rest = plots.split_once(&format!("<figcaption>{plot}.svg</figcaption>")).unwrap().1;
        let code = made.map(|name| format!("<p class=\"command\"><code>fumarole made {name}</code>"));
        assert!(rest.starts_with(code.as_deref().unwrap_or("</figure>")), "{plot}: {rest}");
    }
    let verdicts = &text[text.find("id=\"verdicts\"").unwrap()..text.find("class=\"record\"").unwrap()];
    let shown = |label: &str, command: &str| verdicts.contains(&format!("<span>{label}</span><code>{command}</code>"));
    assert!(shown("A by", "fumarole made gas") && shown("B by", "fumarole made gas-1"), "{verdicts}");
    assert!(verdicts.contains("compare gas.json gas-1.json --json kept.json</code>"), "{verdicts}");
}

/// Documents of ours that are not shown are named once; others are nobody's business.
#[test]
fn nothing_of_ours_is_left_out_in_silence() {
    let out = folder();
    file(&out, "plot.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
    file(&out, "a.json", "{\"schema\": \"fumarole.part/1\"}");
    file(&out, "b.json", "{\"schema\": \"fumarole.part/1\"}");
    file(&out, "later.json", "{\"schema\": \"fumarole.table/2\"}");
    file(&out, "older.json", "{\"experiment\": \"5-2\", \"environment\": {}, \"command\": [], \"table\": {}}");
    file(&out, "trace.json", "{\"traceEvents\": []}");
    let page = out.path().join("page.html");
    let ended = fumarole("report").arg(out.path()).arg("--output").arg(&page).run().succeeded();
    let said =
        ["schema \"fumarole.part/1\": a.json and 1 more", "\"fumarole.table/2\": later.json", "older.json: tables of"];
    for part in said {
        assert_eq!(ended.stderr.matches(part).count(), 1, "{part} in {}", ended.stderr);
    }
    assert!(!ended.stderr.contains("trace.json"), "{}", ended.stderr);
    let text = fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("class=\"warning\"").count(), 3, "{text}");
}

/// A page is no larger for a heading that stands there often, or for many tables.
#[test]
fn tables_that_no_page_holds_are_left_out() {
    let out = folder();
    let mut tables: Value =
        serde_json::from_str(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/tables.json"))).unwrap();
    file(&out, "small.json", tables.to_string());
    tables["table"]["columns"] = json!(vec!["mesh"; 2000]);
    tables["table"]["rows"] = json!([{"mesh": "x".repeat(100_000)}]);
    file(&out, "repeated.json", tables.to_string());
    tables["table"] = tables["more"]["smallest"].clone();
    let wide = json!({"title": "", "columns": vec!["mesh"; 400], "rows": vec![json!({"mesh": 1}); 300]});
    tables["more"] = json!({"a": wide, "b": wide});
    file(&out, "many.json", tables.to_string());
    let page = out.path().join("page.html");
    let ended = fumarole("report").arg(out.path()).arg("--output").arg(&page).run().succeeded();
    for part in ["repeated.json: its tables have too much text", "many.json: tables of 240001 cells"] {
        assert!(ended.stderr.contains(part), "{part} in {}", ended.stderr);
    }
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains("small.json") && text.len() < 200_000, "{} bytes", text.len());
}

pub fn assert_table_schema(document: &Value) {
    let read = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.table-1.json"));
    let bench = read(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.bench-1.json")));
    let mut schema = read(&text.replace("urn:fumarole:bench-1#", "#"));
    for (name, part) in bench["$defs"].as_object().unwrap() {
        schema["$defs"][name] = part.clone();
    }
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(document).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

#[test]
fn verdicts_come_first_and_nothing_to_show_is_refused() {
    let out = folder();
    let record = out.path().join("a.json");
    caustics("bench").tiny().args(ONCE).args("--quiet --variant level-map --json").arg(&record).run().succeeded();
    let page = out.path().join("page.html");
    let sides = fumarole("report --quiet").arg("--a").arg(&record).arg("--b").arg(&record);
    sides.arg("--output").arg(&page).run().succeeded();
    let text = fs::read_to_string(&page).unwrap();
    let place = |part: &str| text.find(part).unwrap_or_else(|| panic!("no {part}"));
    assert!(place("SAME: frame") < place("<h3>caustics level-map: 96 × 64</h3><p class=\"frame\">"), "{text}");

    let empty = folder();
    fumarole("report").arg(empty.path()).run().refused(2, &["no record"]);
    fumarole("report").arg(out.path().join("none.json")).arg("--output").arg(&page).run().refused(2, &["none.json"]);
    assert_eq!(fumarole("report").run().status.code(), Some(2));
}

#[test]
fn two_records_a_side_are_joined_for_their_verdicts() {
    let out = folder();
    let side = |name: &str, factor: f64| {
        let picture = out.path().join(format!("{name}.png"));
        let shades = (0..96 * 64).flat_map(|at| [(at % 96) as u8, (100.0 * factor) as u8, (at / 96) as u8, 255]);
        write_png(&picture, &Rgba8::new(96, 64, shades.collect()).unwrap()).unwrap();
        let paths = [0, 1].map(|number| {
            let mut record = record_of(3, factor * (1.0 + 0.001 * f64::from(number)));
            record["runs"].as_array_mut().unwrap().retain(|run| run["variant"] == "level-map");
            record["runs"][0]["image"] = json!({"path": picture, "sha256": sha256(&picture)});
            file(&out, &format!("{name}{number}.json"), record.to_string()).to_str().unwrap().to_owned()
        });
        paths.join(",")
    };
    let page = out.path().join("page.html");
    let program = fumarole("report --quiet").arg("--a").arg(side("a", 1.0)).arg("--b").arg(side("b", 1.5));
    program.arg("--output").arg(&page).run().succeeded();
    let text = fs::read_to_string(&page).unwrap();
    let place = |part: &str| text.find(part).unwrap_or_else(|| panic!("no {part}"));
    assert!(place("SLOWER: frame B / A 1.5") < place("<h3>caustics level-map: 96 × 64</h3><p class=\"frame\">"));
    assert!(text.contains("6 processes"), "of two records of three each");
    // What both have drawn lies once under a divider, with the verdicts.
    assert_eq!(text.matches("<div class=\"divided\">").count(), 1);
    let [a, b] = ["a.png", "b.png"].map(|name| read_png(&out.path().join(name)).unwrap());
    let difference = fumarole::image::compare(&a, &b, None).unwrap();
    let caption = &text[place("left A, right B")..place("class=\"record\"")];
    assert_eq!(["mean ", "99th percentile "].map(|n| shown_after(caption, n)), [difference.mean, difference.p99]);
}

/// Each side's picture of a number of planes lies with the other's of the same, in whatever order the records have them.
#[test]
fn pictures_of_other_parameters_are_not_put_together() {
    let out = folder();
    let side = |name: &str, planes: [u32; 2]| {
        let mut record = record_of(1, 1.0);
        let run = record["runs"].as_array().unwrap().iter().find(|run| run["variant"] == "level-map").unwrap().clone();
        let runs = planes.map(|planes| {
            let picture = out.path().join(format!("{name}-{planes}.png"));
            // By its green, which side and how many.
            let green = planes as u8 + if name == "a" { 0 } else { 100 };
            let pixels = (0..96 * 64).flat_map(|_| [0, green, 0, 255]).collect();
            write_png(&picture, &Rgba8::new(96, 64, pixels).unwrap()).unwrap();
            let mut run = run.clone();
            run["config"]["planes"] = planes.into();
            run["image"] = json!({"path": picture, "sha256": sha256(&picture)});
            run
        });
        record["runs"] = json!(runs);
        file(&out, &format!("{name}.json"), record.to_string())
    };
    let page = out.path().join("page.html");
    let program = fumarole("report --quiet").arg("--a").arg(side("a", [7, 11])).arg("--b").arg(side("b", [11, 7]));
    program.arg("--output").arg(&page).run().succeeded();
    let text = fs::read_to_string(&page).unwrap();
    let verdicts = &text[..text.find("class=\"record\"").unwrap()];
    assert_eq!(verdicts.matches("<div class=\"divided\">").count(), 2);
    for planes in [7, 11] {
        let title = format!("caustics level-map, planes {planes}: 96 × 64");
        let [a, b] = ["a", "b"].map(|side| out.path().join(format!("{side}-{planes}.png")));
        let difference = fumarole::image::compare(&read_png(&a).unwrap(), &read_png(&b).unwrap(), None).unwrap();
        let mean = shown_after(verdicts, &format!("{title}, left A, right B; CIE Luv difference: mean "));
        assert_eq!(mean, difference.mean, "{planes}");
        let [a, b] = [a, b].map(|path| base64::engine::general_purpose::STANDARD.encode(fs::read(path).unwrap()));
        for (side, png) in [("A", a), ("B", b)] {
            let image = format!("<img src=\"data:image/png;base64,{png}\" alt=\"picture of {title} by side {side}\">");
            assert!(verdicts.contains(&image), "{planes} of {side}");
        }
    }
}

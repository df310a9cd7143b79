//! `fumarole report`: one page from what lies on the disk.

use std::fs;

use fumarole::image::{Rgba8, read_png, write_png};
use serde_json::json;

use super::compare::record_of;
use super::program::{ONCE, caustics, file, folder, fumarole, sha256};

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
    assert!(ended.stderr.contains("broken.json"), "what could not be read is named: {}", ended.stderr);
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

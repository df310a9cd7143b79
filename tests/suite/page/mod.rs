//! The page of a report in a real browser: it loads without a word on the console, shows the record's numbers, sorts, moves
//! its divider, prints, and fits narrow screens and dark rooms. Its structure is kept as `tests/golden/report.txt`;
//! `FUMAROLE_BLESS=1` writes it anew, and `FUMAROLE_SCREENSHOTS=FOLDER` writes pictures to look at.

mod browser;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::TempDir;

use self::browser::Browser;
use crate::cli::compare::record_of;
use crate::cli::program::{file, folder, fumarole, sha256};
use crate::common::beside_others;

const OUTLINE: &str = include_str!("outline.js");

/// A folder with a record of two variants, their pictures, an experiment's tables, plots, and the page that shows them with
/// verdicts first.
fn report(hostile: Option<&str>) -> (TempDir, PathBuf, Value) {
    let out = folder();
    let mut record: Value = serde_json::from_str(include_str!("../../data/report.json")).unwrap();
    for (index, name) in ["level-map", "volumetric"].iter().enumerate() {
        let path = out.path().join(format!("{name}.png"));
        let shade = |x: usize, y: usize| [(5 * x) as u8, (7 * y) as u8, 90 * index as u8, 255];
        let pixels = (0..32).flat_map(|y| (0..48).flat_map(move |x| shade(x, y))).collect();
        fumarole::image::write_png(&path, &fumarole::image::Rgba8::new(48, 32, pixels).unwrap()).unwrap();
        record["runs"][index]["image"]["sha256"] = sha256(&path).into();
    }
    let mut tables: Value = serde_json::from_str(include_str!("../../data/tables.json")).unwrap();
    if let Some(text) = hostile {
        record["command"] = json!(["fumarole", text]);
        record["runs"][0]["passes"][1]["name"] = text.into();
        record["runs"][0]["warnings"] = json!([text]);
        record["runs"][1]["experiment"]["row"] = text.into();
        record["runs"][1]["memory"]["by_resource"][0]["name"] = text.into();
        record["environment"]["device"]["name"] = text.into();
        tables["command"] = json!(["fumarole", text]);
        tables["experiment"] = text.into();
        tables["environment"]["device"]["name"] = text.into();
        tables["table"]["title"] = text.into();
        tables["table"]["columns"].as_array_mut().unwrap().push(text.into());
        tables["table"]["rows"][0][text] = text.into();
        tables["table"]["rows"][1]["mesh"] = text.into();
    }
    file(&out, "run.json", record.to_string());
    file(&out, "caustics-5-2.json", tables.to_string());
    for name in ["plot.svg", "caustics-5-2.svg"] {
        let plot = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 6'><rect width='9' height='6'/></svg>";
        file(&out, name, plot);
    }
    let sides = fumarole("report --quiet . --a run.json --b run.json --output report.html").inside(out.path());
    sides.run().succeeded();
    let page = out.path().join("report.html");
    (out, page, record)
}

/// An expression for the rows of the first table that a selector finds: cells by their headings, numbers with all digits.
fn rows_of(table: &str) -> String {
    format!(
        "(() => {{ const table = document.querySelector({table:?}); const heads = \
         [...table.tHead.rows[0].cells].map((cell) => cell.textContent); return [...table.tBodies[0].rows].map((row) => \
         Object.fromEntries([...row.cells].map((cell, at) => [heads[at], cell.dataset.value ?? cell.textContent]))); }})()"
    )
}

fn shown(browser: &mut Browser, name: &str) {
    if let Some(folder) = env::var_os("FUMAROLE_SCREENSHOTS") {
        fs::create_dir_all(&folder).unwrap();
        fs::write(Path::new(&folder).join(name), browser.screenshot()).unwrap();
    }
}

#[test]
fn the_page_loads_in_silence_and_has_its_structure() {
    beside_others(|| {
        let (_out, page, _) = report(None);
        let mut browser = Browser::start();
        browser.look(1200, "light", "screen");
        browser.open(&page);
        shown(&mut browser, "wide-light.png");
        let outline = browser.value(OUTLINE).as_str().unwrap().to_owned();
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/report.txt");
        if env::var_os("FUMAROLE_BLESS").is_some() {
            fs::write(&golden, &outline).unwrap();
        }
        let expected = fs::read_to_string(&golden).expect("the golden is there: FUMAROLE_BLESS=1 makes it");
        for (line, (found, expected)) in outline.lines().zip(expected.lines()).enumerate() {
            assert_eq!(found, expected, "line {} of the structure", line + 1);
        }
        assert_eq!(outline.lines().count(), expected.lines().count());
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

#[test]
fn the_command_of_every_number_is_copied_at_a_click() {
    beside_others(|| {
        let (_out, page, _) = report(None);
        let mut browser = Browser::start();
        let permissions = json!({"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]});
        browser.ask("Browser.grantPermissions", permissions);
        browser.ask("Emulation.setFocusEmulationEnabled", json!({"enabled": true}));
        browser.open(&page);
        let number = |browser: &mut Browser, what: &str| {
            browser.value(&format!("document.querySelectorAll({what:?}).length")).as_u64().unwrap()
        };
        // The folder's record, the sides', the experiment's tables: one each, at the top. Verdicts: what compared, and each side.
        // A plot has that of the document beside it, where there is one.
        assert_eq!(number(&mut browser, "section.record"), 4);
        assert_eq!(number(&mut browser, "section.record > p.command > button.copy"), 4);
        assert_eq!(number(&mut browser, "section.record:not(:has(> h2 + p.command))"), 0);
        assert_eq!(number(&mut browser, "section.record button.copy"), 4);
        assert_eq!(number(&mut browser, "#verdicts button.copy"), 3);
        assert_eq!((number(&mut browser, "#plots figure"), number(&mut browser, "#plots button.copy")), (2, 1));
        let count = number(&mut browser, "button.copy");
        assert_eq!(count, 8);
        let run = "fumarole caustics bench --variant 'level-map,volumetric' --json run.json";
        let experiment = "fumarole caustics experiment 5-2";
        let compared = "/fumarole report --quiet . --a run.json --b run.json --output report.html";
        let commands = [compared, run, run, run, run, run, experiment, experiment];
        let in_order = browser.value("[...document.querySelectorAll('.command code')].map((code) => code.textContent)");
        for (index, command) in commands.iter().enumerate() {
            let found = in_order[index].as_str().unwrap();
            assert!(found.ends_with(command), "{found}, {command}");
        }
        for index in 0..count {
            let copied = browser.value(&format!(
                "(async () => {{ const button = document.querySelectorAll('button.copy')[{index}]; button.click(); \
                 while (button.textContent !== 'Copied') await new Promise((later) => setTimeout(later, 5)); \
                 const code = button.parentElement.querySelector('code').textContent; \
                 return [await navigator.clipboard.readText(), code]; }})()"
            ));
            assert_eq!(copied[0], copied[1]);
            assert!(copied[0].as_str().unwrap().contains("fumarole"), "{copied}");
        }
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

#[test]
fn the_pages_numbers_are_the_records_in_the_browser() {
    beside_others(|| {
        let (_out, page, record) = report(None);
        let mut browser = Browser::start();
        browser.open(&page);
        for (index, run) in record["runs"].as_array().unwrap().iter().enumerate() {
            let section =
                format!("document.querySelectorAll('section.record')[0].querySelectorAll('section.run')[{index}]");
            let frame = browser.value(&format!("{section}.querySelector('.frame [data-value]').dataset.value"));
            assert_eq!(frame.as_str().unwrap().parse::<f64>().unwrap(), run["frame_ms"]["median"].as_f64().unwrap());
            let passes = format!("section.record:nth-of-type(2) section.run:nth-of-type({}) table", index + 1);
            let rows = browser.value(&rows_of(&passes));
            for (row, pass) in rows.as_array().unwrap().iter().zip(run["passes"].as_array().unwrap()) {
                assert_eq!(row["pass"], pass["name"]);
                let of = |path: &str| pass.pointer(path).and_then(Value::as_f64);
                let share = of("/floor_ms").zip(of("/gpu_ms/median")).map(|(floor, gpu)| 100.0 * floor / gpu);
                for (column, expected) in [
                    ("GPU ms", of("/gpu_ms/median")),
                    ("host ms", of("/host_ms/median")),
                    ("wait ms", of("/wait_ms/median")),
                    ("floor ms", of("/floor_ms")),
                    ("share of limit, %", share),
                    ("vertices", of("/statistics/vertices")),
                    ("bytes read", of("/bytes/read")),
                    ("written, at most", of("/bytes/at_most/written")),
                ] {
                    let found = row[column].as_str().unwrap().parse::<f64>().ok();
                    let is_equal = match (found, expected) {
                        (Some(found), Some(expected)) => (found - expected).abs() <= 1e-12 * expected,
                        (found, expected) => found == expected,
                    };
                    assert!(is_equal, "{column} of {}: {found:?}, {expected:?}", pass["name"]);
                }
            }
        }
        let ratio = browser.value(
            "[...document.querySelectorAll('section.record > .wide td.number')].map((cell) => cell.dataset.value ?? '')",
        );
        let row = &record["runs"][1]["experiment"];
        let expected = [row["paper"].as_f64(), row["ours"].as_f64(), Some(1.45), Some(1.55), row["ratio"].as_f64()];
        for (found, expected) in ratio.as_array().unwrap().iter().zip(expected) {
            assert_eq!(found.as_str().unwrap().parse::<f64>().ok(), expected, "{ratio}");
        }
        // Memory by resource, in its order.
        for (index, run) in record["runs"].as_array().unwrap().iter().enumerate() {
            let memory = browser.value(&format!(
                "(() => {{ const run = document.querySelectorAll('section.run')[{index}]; const table = \
                 [...run.querySelectorAll('details table.sortable')].find((one) => \
                 one.tHead.textContent.startsWith('resource')); return [...table.tBodies[0].rows].map((row) => ({{name: \
                 row.cells[0].textContent, bytes: Number(row.cells[1].textContent)}})); }})()"
            ));
            assert_eq!(memory, run["memory"]["by_resource"]);
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
        let (_out, page, record) = report(None);
        let mut browser = Browser::start();
        browser.open(&page);
        for (index, run) in record["runs"].as_array().unwrap().iter().enumerate() {
            let time = |pass: &Value| pass["gpu_ms"]["median"].as_f64().or(pass["host_ms"]["median"].as_f64());
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

#[test]
fn tables_sort_by_keyboard_and_the_divider_moves() {
    beside_others(|| {
        let (_out, page, _) = report(None);
        let mut browser = Browser::start();
        browser.open(&page);
        let first = "document.querySelector('section.run table.sortable tbody tr td').textContent";
        assert_eq!(browser.value(first), "reference-planes");
        // The column of GPU times, twice: ascending, then descending.
        let button = "document.querySelector('section.run table.sortable th.number button')";
        browser.value(&format!("{button}.focus()"));
        browser.press("Enter", 13);
        let sort = format!("{button}.parentElement.getAttribute('aria-sort')");
        assert_eq!(browser.value(&sort), "ascending");
        browser.press("Enter", 13);
        assert_eq!(browser.value(&sort), "descending");
        assert_eq!(browser.value(first), "illumination-volumes");

        let divided = "document.querySelector('.divided')";
        browser.value(&format!("{divided}.querySelector('input').focus()"));
        browser.press("ArrowRight", 39);
        assert_eq!(browser.value(&format!("{divided}.style.getPropertyValue('--at')")), "51%");
        let sizes = format!("[...{divided}.querySelectorAll('img')].map((image) => image.naturalWidth)");
        assert_eq!(browser.value(&sizes), json!([48, 48]));
        let caption = browser.value(&format!("{divided}.parentElement.querySelector('figcaption').textContent"));
        assert!(caption.as_str().unwrap().contains("CIE Luv difference: mean "), "{caption}");

        // Every control is reached by the keyboard, and the command is there to copy.
        let unreachable = "[...document.querySelectorAll('button, input, summary, a, .wide')].filter((one) => one.tabIndex < 0).length";
        assert_eq!(browser.value(unreachable), 0);
        let command = browser.value("document.querySelector('section.record .command code').textContent");
        assert!(command.as_str().unwrap().starts_with("fumarole caustics bench"), "{command}");
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

#[test]
fn narrow_screens_dark_rooms_and_paper_have_their_looks() {
    beside_others(|| {
        let (_out, page, _) = report(None);
        let mut browser = Browser::start();
        browser.look(360, "dark", "screen");
        browser.open(&page);
        shown(&mut browser, "narrow-dark.png");
        let overflow = "document.documentElement.scrollWidth - document.documentElement.clientWidth";
        assert_eq!(browser.value(overflow), 0, "nothing is wider than the screen");
        let contrast = "(() => { const light = (text) => { const [r, g, b] = text.match(/[\\d.]+/g).map(Number).map((v) => v / \
                        255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 \
                        * g + 0.0722 * b; }; const style = getComputedStyle(document.body); const [a, b] = \
                        [light(style.color), light(style.backgroundColor)]; return [b, (Math.max(a, b) + 0.05) / \
                        (Math.min(a, b) + 0.05)]; })()";
        let of = |value: &Value, at: usize| value[at].as_f64().unwrap();
        let dark = browser.value(contrast);
        assert!(of(&dark, 0) < 0.1 && of(&dark, 1) > 7.0, "{dark}");
        assert_eq!(
            browser.value("getComputedStyle(document.documentElement).scrollBehavior"),
            "auto",
            "motion is reduced"
        );
        browser.look(1200, "light", "screen");
        let light = browser.value(contrast);
        assert!(of(&light, 0) > 0.8 && of(&light, 1) > 7.0, "{light}");
        assert_eq!(browser.value(overflow), 0);

        browser.look(800, "light", "print");
        shown(&mut browser, "print.png");
        assert_eq!(browser.value("getComputedStyle(document.querySelector('nav')).display"), "none");
        let hidden = "[...document.querySelectorAll('details table')].filter((table) => \
                      !table.getClientRects().length).length";
        assert_eq!(browser.value(hidden), 0, "what is folded away is printed");
        let print = browser.ask("Page.printToPDF", json!({}));
        assert!(print["data"].as_str().unwrap().len() > 10_000);
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

#[test]
fn a_hostile_record_runs_nothing() {
    beside_others(|| {
        let hostile =
            "<img src=x onerror=\"window.hit=1\"></script><script>window.hit=1</script>' onfocus='window.hit=1";
        let (_out, page, _) = report(Some(hostile));
        let mut browser = Browser::start();
        browser.open(&page);
        assert!(browser.value("window.hit ?? null").is_null());
        assert_eq!(browser.value("document.scripts.length"), 1);
        assert_eq!(
            browser.value("[...document.querySelectorAll('td')].some((cell) => cell.textContent.includes('onerror'))"),
            true
        );
        // What is shown of tables and commands is the text as it is.
        for place in [
            "section.tables h3",
            "section.tables .wide th:last-child button",
            "section.tables .wide td:last-child",
            "section.tables .wide tr + tr td",
            "section.tables details td",
            "nav a[href='#tables-0']",
        ] {
            let text = browser.value(&format!("document.querySelector({place:?}).textContent"));
            assert!(text.as_str().unwrap().contains(hostile), "{place}: {text}");
        }
        let commands = browser.value("[...document.querySelectorAll('.command code')].map((code) => code.textContent)");
        let texts = commands.as_array().unwrap().iter().filter(|text| text.as_str().unwrap().contains("onerror"));
        assert_eq!(texts.count(), 7, "{commands}");
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

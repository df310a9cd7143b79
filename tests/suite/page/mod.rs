//! The page of a report in a real browser: it loads without a word on the console, shows the record's numbers, sorts, moves
//! its divider, prints, and fits narrow screens and dark rooms. Its structure is kept as `tests/golden/report.txt`;
//! `FUMAROLE_BLESS=1` writes it anew, and `FUMAROLE_SCREENSHOTS=FOLDER` writes pictures to look at.

mod browser;
mod looks;
mod numbers;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::TempDir;

use self::browser::Browser;
use crate::cli::program::{file, folder, fumarole, sha256};
use crate::common::beside_others;

const OUTLINE: &str = include_str!("outline.js");

/// A folder with a record of two variants, their pictures, an experiment's tables, plots, and the page that shows them with
/// verdicts first.
fn report() -> (TempDir, PathBuf, Value) {
    report_of(|_, _| {})
}

/// The same with another record and tables.
fn report_of(change: impl FnOnce(&mut Value, &mut Value)) -> (TempDir, PathBuf, Value) {
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
    change(&mut record, &mut tables);
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

fn shown(browser: &mut Browser, name: &str) {
    if let Some(folder) = env::var_os("FUMAROLE_SCREENSHOTS") {
        fs::create_dir_all(&folder).unwrap();
        fs::write(Path::new(&folder).join(name), browser.screenshot()).unwrap();
    }
}

#[test]
fn the_page_loads_in_silence_and_has_its_structure() {
    beside_others(|| {
        let (_out, page, _) = report();
        let mut browser = Browser::start();
        browser.look(1200, "light", "screen");
        browser.open(&page);
        shown(&mut browser, "wide-light.png");
        browser.look(1200, "dark", "screen");
        shown(&mut browser, "wide-dark.png");
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
        let (_out, page, _) = report();
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
fn tables_sort_by_keyboard_and_the_divider_moves() {
    beside_others(|| {
        let (_out, page, _) = report();
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

/// A record of many processes is as long as one of the first of them: what they measured is folded away, and not printed.
#[test]
fn other_processes_lie_behind_the_first_of_their_configuration() {
    beside_others(|| {
        let (_out, page, _) = report_of(|record, _| {
            let mut runs = vec![];
            for process in 0..3 {
                for (variant, planes) in [(0, 31), (1, 7), (1, 11)] {
                    let mut run = record["runs"][variant].clone();
                    run["process"] = process.into();
                    run["config"]["planes"] = planes.into();
                    run["image"] = Value::Null;
                    runs.push(run);
                }
            }
            record["runs"] = runs.into();
        });
        let mut browser = Browser::start();
        browser.look(1280, "light", "screen");
        browser.open(&page);
        shown(&mut browser, "processes.png");
        let texts = |browser: &mut Browser, what: &str| {
            browser.value(&format!("[...document.querySelectorAll({what:?})].map((one) => one.textContent)"))
        };
        let titles = ["level-map: 48 × 32", "volumetric, planes 7: 48 × 32", "volumetric, planes 11: 48 × 32"];
        let titles = titles.map(|title| format!("caustics {title}"));
        assert_eq!(texts(&mut browser, "#record-0 > section.run > h3"), json!(titles));
        let labels = titles.clone().map(|title| title.replace(": 48 × 32", ""));
        assert_eq!(texts(&mut browser, "nav a[href^='#run-0-']"), json!(labels));
        let of_others = |process: u32| titles.clone().map(|title| format!("{title}, process {process}"));
        let folded = texts(&mut browser, "#record-0 > details.processes > section.run > h3");
        let mut expected = [of_others(1), of_others(2)].concat();
        expected.sort_by_key(|title| titles.iter().position(|first| title.starts_with(first)));
        assert_eq!(folded, json!(expected));
        assert_eq!(texts(&mut browser, "details.processes > summary")[0], "2 runs of it by other processes");
        // Nowhere else on the page is a run, and every link leads somewhere.
        let open = "[...document.querySelectorAll('section.run')].filter((run) => run.checkVisibility() && \
                    !run.closest('details')).length";
        assert_eq!(browser.value(open), 9, "three in each of the folder's and the sides' records");
        let astray = "[...document.querySelectorAll('nav a')].filter((link) => !document.querySelector(\
                      link.getAttribute('href'))).length";
        assert_eq!(browser.value(astray), 0);
        let is_seen = "document.querySelector('details.processes section.run').checkVisibility()";
        assert_eq!(browser.value(is_seen), false, "it is folded away");
        browser.value("document.querySelector('details.processes summary').focus()");
        browser.press("Enter", 13);
        assert_eq!(browser.value(is_seen), true, "a key opens it");
        browser.value("document.querySelector('details.processes').open = false");
        browser.look(800, "light", "print");
        assert_eq!(browser.value(is_seen), false, "it is not printed");
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

#[test]
fn a_hostile_record_runs_nothing() {
    beside_others(|| {
        let hostile =
            "<img src=x onerror=\"window.hit=1\"></script><script>window.hit=1</script>' onfocus='window.hit=1";
        let (_out, page, _) = report_of(|record, tables| {
            record["command"] = json!(["fumarole", hostile]);
            record["runs"][0]["passes"][1]["name"] = hostile.into();
            record["runs"][0]["warnings"] = json!([hostile]);
            record["runs"][1]["experiment"]["row"] = hostile.into();
            record["runs"][1]["memory"]["by_resource"][0]["name"] = hostile.into();
            record["environment"]["device"]["name"] = hostile.into();
            tables["command"] = json!(["fumarole", hostile]);
            tables["experiment"] = hostile.into();
            tables["environment"]["device"]["name"] = hostile.into();
            tables["table"]["title"] = hostile.into();
            tables["table"]["columns"].as_array_mut().unwrap().push(hostile.into());
            tables["table"]["rows"][0][hostile] = hostile.into();
            tables["table"]["rows"][1]["mesh"] = hostile.into();
        });
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

//! Narrow screens, dark rooms, paper, and letters in bars that can be read.

use serde_json::{Value, json};

use super::browser::Browser;
use super::{report, report_of, shown};
use crate::common::beside_others;

/// A function for the contrast of two colours, as the Web Content Accessibility Guidelines have it.
const CONTRAST: &str = "const light = (text) => { const [r, g, b] = text.match(/[\\d.]+/g).map(Number).map((v) => v / \
                        255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 \
                        * g + 0.0722 * b; }; const contrast = (a, b) => { const [low, high] = [light(a), light(b)].sort((a, b) => a - b); \
                        return (high + 0.05) / (low + 0.05); };";

#[test]
fn narrow_screens_dark_rooms_and_paper_have_their_looks() {
    beside_others(|| {
        let (_out, page, _) = report();
        let mut browser = Browser::start();
        browser.look(360, "dark", "screen");
        browser.open(&page);
        shown(&mut browser, "narrow-dark.png");
        let overflow = "document.documentElement.scrollWidth - document.documentElement.clientWidth";
        assert_eq!(browser.value(overflow), 0, "nothing is wider than the screen");
        let contrast = format!(
            "(() => {{ {CONTRAST} const style = getComputedStyle(document.body); return [light(style.backgroundColor), \
             contrast(style.color, style.backgroundColor)]; }})()"
        );
        let of = |value: &Value, at: usize| value[at].as_f64().unwrap();
        let dark = browser.value(&contrast);
        assert!(of(&dark, 0) < 0.1 && of(&dark, 1) > 7.0, "{dark}");
        assert_eq!(
            browser.value("getComputedStyle(document.documentElement).scrollBehavior"),
            "auto",
            "motion is reduced"
        );
        browser.look(1200, "light", "screen");
        let light = browser.value(&contrast);
        assert!(of(&light, 0) > 0.8 && of(&light, 1) > 7.0, "{light}");
        assert_eq!(browser.value(overflow), 0);

        browser.look(800, "light", "print");
        shown(&mut browser, "print.png");
        assert_eq!(browser.value("getComputedStyle(document.querySelector('nav')).display"), "none");
        let hidden = "[...document.querySelectorAll('details table')].filter((table) => \
                      !table.checkVisibility()).length";
        assert_eq!(browser.value(hidden), 0, "what is folded away is printed");
        let print = browser.ask("Page.printToPDF", json!({}));
        assert!(print["data"].as_str().unwrap().len() > 10_000);
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

/// Every kind of pass has a bar, wide enough for its name.
#[test]
fn letters_in_bars_can_be_read() {
    beside_others(|| {
        let (_out, page, _) = report_of(|record, _| {
            for (index, kind) in ["graphics", "compute", "host", "transfer"].into_iter().enumerate() {
                let time = json!({"samples": [5.0], "min": 5.0, "median": 5.0, "mean": 5.0, "p95": null, "p99": null,
                    "max": 5.0, "mad": null});
                let pass = &mut record["runs"][0]["passes"][index];
                pass["kind"] = kind.into();
                pass["name"] = format!("{kind}-pass").into();
                for clock in ["gpu_ms", "host_ms"] {
                    pass[clock] = if (clock == "host_ms") == (kind == "host") { time.clone() } else { Value::Null };
                }
            }
        });
        let mut browser = Browser::start();
        browser.open(&page);
        // What is under a name in a bar: the rectangle before it.
        let inside = format!(
            "(() => {{ {CONTRAST} return [...document.querySelectorAll('#run-0-0 text.inside')].filter((text) => \
             text.checkVisibility()).map((text) => {{ const under = text.previousElementSibling, style = \
             getComputedStyle(under), name = getComputedStyle(text); return [text.textContent, contrast(name.fill, style.fill), \
             [style.fillOpacity, style.opacity, name.fillOpacity, name.opacity].map(Number), \
             under.getBoundingClientRect().right - text.getBoundingClientRect().right]; }}); }})()"
        );
        let beside = format!(
            "(() => {{ {CONTRAST} const paper = getComputedStyle(document.body).backgroundColor; return \
             Math.min(...[...document.querySelectorAll('svg text:not(.inside)')].map((text) => \
             contrast(getComputedStyle(text).fill, paper))); }})()"
        );
        // Pixels of an em as they are on the screen.
        let smallest = "Math.min(...[...document.querySelectorAll('svg text')].filter((text) => text.checkVisibility()).map(\
                        (text) => parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a))";
        for (width, scheme) in [(1280, "light"), (1280, "dark"), (900, "light"), (360, "light"), (360, "dark")] {
            browser.look(width, scheme, "screen");
            shown(&mut browser, &format!("bars-{width}-{scheme}.png"));
            let names = browser.value(&inside);
            let names = names.as_array().unwrap();
            assert_eq!(names.len(), if width < 800 { 0 } else { 5 }, "{width}: {names:?}");
            for name in names {
                assert!(name[1].as_f64().unwrap() >= 4.5, "{scheme}: {name}");
                assert_eq!(name[2], json!([1, 1, 1, 1]), "{name}");
                assert!(name[3].as_f64().unwrap() > 0.0, "it ends inside its bar: {name}");
            }
            let contrast = browser.value(&beside).as_f64().unwrap();
            assert!(contrast >= 4.5, "{scheme}: {contrast}");
            let pixels = browser.value(smallest).as_f64().unwrap();
            assert!(pixels >= 9.5, "letters of {pixels} pixels at {width}");
            let overflow = "document.documentElement.scrollWidth - document.documentElement.clientWidth";
            assert_eq!(browser.value(overflow), 0, "{width}");
        }
        assert!(browser.console.is_empty(), "{:?}", browser.console);
    });
}

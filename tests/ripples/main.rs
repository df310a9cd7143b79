//! A sixth paper, which only the tests know: what a new paper has to have, and that every verb then works.

mod paper;

use std::fs;
use std::path::Path;

use fumarole::cli::paper_from;
use paper::{Setup, height};

/// Runs the paper's command on lavapipe and gives its exit code.
fn ripples(arguments: &[&str]) -> u8 {
    let device = std::env::var("FUMAROLE_TEST_DEVICE").unwrap_or_else(|_| "llvmpipe".to_owned());
    let arguments = ["ripples"].iter().chain(arguments).map(|a| (*a).into());
    paper_from::<Setup>(arguments.chain(["--device".into(), device.into()]))
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// README's guide, "How to add a paper", shows the declaration of this paper's parameter as it is.
#[test]
fn the_guide_quotes_the_paper() {
    let unspaced = |text: &str| text.split_whitespace().collect::<String>();
    let guide = include_str!("../../README.md").split("## How to add a paper").nth(1).unwrap();
    let quoted = guide.split("```rust").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert!(quoted.contains("Parameter::new(\"wavelength\""), "{quoted}");
    assert!(
        unspaced(include_str!("paper.rs")).contains(&unspaced(quoted)),
        "not as tests/ripples/paper.rs has it: {quoted}"
    );
}

#[test]
fn every_verb_works_for_a_paper_of_150_lines() {
    let out = tempfile::tempdir().unwrap();
    let file = |name: &str| out.path().join(name).display().to_string();
    let folder = out.path().display().to_string();
    assert_eq!(ripples(&["passes", "--json"]), 0);
    let record = file("record.json");
    let once = ["--frames", "1", "--repeat", "1", "--warmup", "1", "--no-limits", "--quiet", "--validate"];
    assert_eq!(ripples(&[&["bench", "--wavelength", "9", "--json", &record][..], &once].concat()), 0);
    let run = &json(Path::new(&record))["runs"][0];
    assert_eq!((&run["paper"], &run["config"]["wavelength"]), (&"ripples".into(), &9.0.into()));
    let names: Vec<&str> = run["passes"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["propagate", "shade"]);

    assert_eq!(ripples(&["experiment", "1", "--out", &folder, "--quiet"]), 0);
    let table = json(&out.path().join("ripples-1.json"));
    let rows = table["table"]["rows"].as_array().unwrap();
    assert!(rows.len() == 4 && rows.iter().all(|row| row["difference"].as_f64().unwrap() < 1e-5), "{rows:?}");

    let (picture, heights) = (file("picture.png"), format!("heights={}", file("heights.npy")));
    assert_eq!(ripples(&["render", "--frame", "2", "--image", &picture, "--dump", &heights, "--quiet"]), 0);
    let bytes = fs::read(out.path().join("heights.npy")).unwrap();
    let dumped: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes[bytes.len() - 64 * 4..]);
    for (column, &dumped) in (0..).zip(&dumped) {
        assert!((f64::from(dumped) - height(column, 16.0, 0.25)).abs() < 1e-5, "column {column}: {dumped}");
    }

    assert_eq!(ripples(&["bench", "--wavelength", "1"]), 2);
    let sources = [
        include_str!("paper.rs"),
        include_str!("../../shaders/test/ripples.comp"),
        include_str!("../../shaders/test/ripples.frag"),
    ];
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    let lines: usize = sources.iter().map(|source| source.lines().filter(is_code).count()).sum();
    assert!(lines < 150, "{lines} lines");
}

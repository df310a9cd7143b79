//! `passes`: the paper's passes in the paper's order; the two programs are one.

use serde_json::Value;

use super::program::{ONCE, caustics, folder, fumarole, sha256};

const LEVEL_MAP: [&str; 7] = [
    "reference-planes",
    "position-diffuse-map",
    "water-surface",
    "illumination-volumes",
    "caustics-map",
    "combine",
    "cast",
];
const VOLUMETRIC: [&str; 8] = [
    "sample-planes",
    "slice-images",
    "water-surface",
    "illumination-volumes",
    "caustics-map",
    "multiply",
    "combine-slices",
    "cast",
];

fn names(passes: &Value) -> Vec<&str> {
    passes.as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap()).collect()
}

#[test]
fn the_passes_are_the_papers_in_its_order() {
    let listed = caustics("passes --json --variant level-map,volumetric").tiny().run().succeeded();
    assert_eq!(listed.stderr, "");
    let listed = listed.json();
    for (variant, word, expected) in [(0, "level-map", &LEVEL_MAP[..]), (1, "volumetric", &VOLUMETRIC[..])] {
        let variant = &listed[variant];
        assert_eq!((&variant["paper"], &variant["variant"]), (&"caustics".into(), &word.into()));
        assert_eq!(names(&variant["passes"]), expected);
        for (place, pass) in variant["passes"].as_array().unwrap().iter().enumerate() {
            assert_eq!(pass["order"], place + 1);
            assert_ne!(pass["section"], "", "{pass}");
            assert!(!pass["writes"].as_array().unwrap().is_empty(), "{pass}");
            let is_host = pass["kind"] == "host";
            assert_eq!(pass["shaders"].as_array().unwrap().is_empty(), is_host, "{pass}");
        }
        let text = caustics("passes --variant").arg(word).tiny().run().succeeded();
        for name in expected {
            assert!(text.stdout.contains(name), "{name}\n{}", text.stdout);
        }
    }
    let caustics_map = &listed[0]["passes"][4];
    assert_eq!((&caustics_map["calls"], &caustics_map["blend"][0]), (&5.into(), &"add".into()));
}

#[test]
fn a_bench_measures_the_passes_that_are_listed() {
    let record = caustics("bench --json --quiet").tiny().args(ONCE).run().succeeded().json();
    let listed = caustics("passes --json").tiny().run().succeeded().json();
    for (run, listed) in record["runs"].as_array().unwrap().iter().zip(listed.as_array().unwrap()) {
        assert_eq!(run["variant"], listed["variant"]);
        assert_eq!(names(&run["passes"]), names(&listed["passes"]));
    }
}

#[test]
fn two_passes_replace_the_one_with_two_targets() {
    let listed = caustics("passes --json --no-mrt --variant level-map").tiny().run().succeeded().json();
    let names = names(&listed[0]["passes"]);
    assert_eq!(names.len(), LEVEL_MAP.len() + 1, "{names:?}");
    assert!(!names.contains(&"position-diffuse-map"), "{names:?}");
}

#[test]
fn the_umbrella_and_the_papers_binary_are_the_same() {
    let both = |arguments: &str| {
        let own = caustics(arguments).tiny().run().succeeded();
        let umbrella = fumarole("caustics").args(arguments).tiny().run().succeeded();
        (own.stdout, umbrella.stdout)
    };
    let (own, umbrella) = both("passes --json");
    assert_eq!(own, umbrella);
    let out = folder();
    for (program, name) in [(caustics("render"), "own"), (fumarole("caustics render"), "umbrella")] {
        let program = program.inside(out.path()).args("--quiet --image").arg(format!("{name}.png"));
        program.tiny().run().succeeded();
    }
    assert_eq!(sha256(&out.path().join("own.png")), sha256(&out.path().join("umbrella.png")));
    caustics("bench --planes 0").run().refused(2, &["--planes 0"]);
    fumarole("caustics bench --planes 0").run().refused(2, &["--planes 0"]);
}

#[test]
fn every_verb_explains_itself() {
    for verb in ["devices", "all", "compare", "caustics", "caustics bench", "caustics render", "caustics experiment"] {
        let help = fumarole(verb).arg("--help").run().succeeded();
        assert!(help.stdout.contains("Usage: fumarole"), "{verb}\n{}", help.stdout);
        assert_eq!(help.stderr, "");
    }
    assert!(caustics("--version").run().succeeded().stdout.starts_with("caustics "));
    let verbs = caustics("").run();
    assert_eq!(verbs.status.code(), Some(2));
    for verb in ["passes", "bench", "experiment", "render"] {
        assert!(verbs.stderr.contains(verb), "{}", verbs.stderr);
    }
}

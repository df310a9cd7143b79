//! `gas` through the binary: its passes, its record, its tables, and what it refuses.

use super::program::{ONCE, Program, assert_schema, entries, folder, gas, read_json};

const SMALL: &str = "--size 45x31 --steps 8 --table 8";

fn small(verb: &str) -> Program {
    gas(verb).args(SMALL).on_test_device()
}

#[test]
fn the_passes_follow_the_shadowing() {
    let listed = small("passes --json").run().succeeded().json();
    let names = |variant: &str| -> Vec<String> {
        let found = listed.as_array().unwrap().iter().find(|v| v["variant"] == variant).unwrap();
        found["passes"].as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap().to_owned()).collect()
    };
    let surfaces = ["empty-lists", "fragments", "sort"];
    let joined = |middle: &[&'static str]| [&surfaces[..], middle, &["resolve"]].concat();
    assert_eq!(names("no-volume"), joined(&[]));
    assert_eq!(names("none"), joined(&["volume"]));
    assert_eq!(names("surfaces"), joined(&["volume", "light-attenuation"]));
    assert_eq!(names("traced"), joined(&["volume", "light-attenuation"]));
    assert_eq!(names("table"), joined(&["density-table", "shadow-table", "volume", "light-attenuation"]));
}

#[test]
fn table_2_is_written_with_the_ratios_beside_the_paper_s() {
    let out = folder();
    let ended = small("experiment 2 --out .").args("--frames 1 --repeat 1 --warmup 1 --no-limits").inside(out.path());
    let ended = ended.run().succeeded();
    assert_eq!(entries(out.path()), ["gas-2.csv", "gas-2.json", "gas-2.svg"]);
    let record = read_json(&out.path().join("gas-2.json"));
    assert_schema(&record);
    for run in record["runs"].as_array().unwrap() {
        let minutes = match run["variant"].as_str().unwrap() {
            "none" => 80.0,
            "surfaces" => 101.0,
            "traced" => 1800.0,
            "table" => 127.0,
            other => panic!("{other}"),
        };
        assert!((run["experiment"]["paper"].as_f64().unwrap() - minutes / 80.0).abs() < 1e-9, "{}", run["experiment"]);
        assert!(run["results"]["fragments"].as_u64().unwrap() > 0, "{run}");
    }
    assert!(ended.stdout.contains("paper ratio"), "{}", ended.stdout);
}

#[test]
fn the_volume_is_seen_and_another_seed_is_another_gas() {
    let out = folder();
    for (name, options) in [
        ("a", "--variant none"),
        ("b", "--variant none"),
        ("c", "--variant none --seed 2"),
        ("d", "--variant no-volume"),
    ] {
        small(&format!("render --quiet --image {name}.png")).args(options).inside(out.path()).run().succeeded();
    }
    let read = |name: &str| std::fs::read(out.path().join(name)).unwrap();
    assert!(read("a.png") == read("b.png"));
    assert!(read("a.png") != read("c.png"));
    assert!(read("a.png") != read("d.png"));
}

/// What changes how the picture is made, and not what it shows; and what changes the gas.
#[test]
fn bands_and_pulled_vertices_show_the_same_and_other_densities_do_not() {
    let out = folder();
    let draw = |name: &str, options: &str| {
        small(&format!("render --quiet --variant table --image {name}.png"))
            .args(options)
            .inside(out.path())
            .run()
            .succeeded();
        std::fs::read(out.path().join(format!("{name}.png"))).unwrap()
    };
    let own = draw("own", "");
    assert!(own == draw("bands", "--list-bytes 20000"));
    assert!(own == draw("pulled", "--no-geometry-stage"));
    let mut others = vec![own];
    for (name, options) in [
        ("constant", "--density constant"),
        ("turbulence", "--density turbulence"),
        ("clouds", "--density clouds"),
        ("fog", "--density fog --first-frame 300"),
        ("hypertexture", "--density hypertexture"),
        ("opaque", "--opaque 3"),
        ("power", "--power 2"),
        ("scale", "--texture-scale 4"),
    ] {
        let picture = draw(name, options);
        assert!(!others.contains(&picture), "{name}");
        others.push(picture);
    }
    assert!(others[0] == draw("steam", "--density steam"));
}

#[test]
fn what_cannot_be_is_refused_by_its_option() {
    for (options, parts) in [
        ("--steps 0", &["--steps 0", "1 to 100000"][..]),
        ("--table 1", &["--table 1"]),
        ("--table 513", &["--table 513"]),
        ("--tau -1", &["--tau -1"]),
        ("--albedo 1.5", &["--albedo"]),
        ("--falloff 2", &["--falloff 2"]),
        ("--phase 0.5,0.5,0.2,0", &["--phase", "add up to 1"]),
        ("--pixel-size 0", &["--pixel-size 0"]),
        ("--shadow-threshold -1", &["--shadow-threshold -1"]),
        ("--early-end 2", &["--early-end 2"]),
        ("--light 0,0,0", &["--light 0,0,0"]),
        ("--size 0x0", &["--size 0x0"]),
        ("--opaque -1", &["--opaque -1"]),
        ("--power 0", &["--power 0"]),
        ("--texture-scale 0", &["--texture-scale 0"]),
        ("--list-bytes 10", &["--list-bytes 10", "at least 4096"]),
        // A row of glass wants more than its four fragments a pixel, and a row is the least that is done at once.
        ("--preset fig-6 --size 300x40 --list-bytes 20000", &["--list-bytes"]),
        ("--object no-such.obj", &["no-such.obj"]),
    ] {
        gas("bench").on_test_device().args(options).args(ONCE).run().refused(2, parts);
    }
    for option in ["tau", "albedo", "falloff", "pixel-size", "shadow-threshold", "early-end"] {
        for value in ["nan", "inf", "two", ""] {
            gas("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
    gas("bench --preset fig-9").run().misused(&["--preset", "fig-8"]);
    gas("experiment 2 --preset fig-3").run().refused(2, &["--preset"]);
}

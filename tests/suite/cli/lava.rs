//! `lava` through the binary: its passes, its record, its experiments, and what it refuses.

use std::fs;

use fumarole::image::read_png;
use fumarole::papers::lava::Rock;
use serde_json::Value;

use super::program::{ONCE, Program, assert_schema, device, entries, file, folder, fumarole, lava, read_json};
use crate::faults::Layer;

/// Small enough for lavapipe's single-threaded geometry stage.
const SMALL: &str = "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --splat-radius 0.2";

/// In the thesis's order.
const PASSES: [&str; 11] = [
    "animate",
    "read-positions",
    "cluster",
    "density",
    "read-density",
    "extract",
    "accumulate-depths",
    "normal-height",
    "visibility",
    "blending",
    "normalisation",
];

fn small(verb: &str) -> Program {
    lava(verb).args(SMALL).on_test_device()
}

fn names(passes: &Value) -> Vec<&str> {
    passes.as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap()).collect()
}

#[test]
fn the_passes_are_the_thesis_s() {
    let listed = small("passes --json").run().succeeded().json();
    assert_eq!(names(&listed[0]["passes"]), PASSES);
    // Two clusters of four planes.
    assert_eq!(listed[0]["passes"][3]["calls"], 2);
}

#[test]
fn a_bench_times_gpu_and_host_and_says_what_it_did() {
    let record = small("bench --json --quiet --validate").args(ONCE).run().succeeded().json();
    assert_schema(&record);
    let run = &record["runs"][0];
    assert_eq!(
        (&run["paper"], &run["variant"], &run["validation"]),
        (&"lava".into(), &"paper".into(), &"clean".into())
    );
    assert_eq!(names(&run["passes"]), PASSES);
    for pass in run["passes"].as_array().unwrap() {
        let is_host = ["cluster", "extract"].contains(&pass["name"].as_str().unwrap());
        assert_eq!(pass["host_ms"].is_null(), !is_host, "{pass}");
        assert_eq!(pass["gpu_ms"].is_null(), is_host, "{pass}");
    }
    assert_eq!(run["config"]["density"], serde_json::json!([16, 8, 8]));
    assert!(run["results"]["accepted_grid_points"].as_u64().unwrap() > 0, "{}", run["results"]);
    for rate in ["particles_per_s", "grid_points_per_s", "splats_per_s", "frames_per_s"] {
        assert!(run["results"][rate].as_f64().unwrap() > 0.0, "{rate}: {}", run["results"]);
    }
}

#[test]
fn a_crust_that_is_too_fine_names_what_is() {
    let basalt = || small("render").args("--simulation sph --rheology basalt --surface crossing");
    basalt().args("--space 40x2x40 --skin 20 --pieces 1").run().refused(2, &["--pieces 1", "take a finer --density"]);
    basalt().args("--skin 0.001 --pieces 1.5").run().refused(2, &["--skin 0.001", "take a finer --density"]);
}

#[test]
fn a_density_that_accepts_nothing_is_a_warning_with_the_range() {
    let record = small("bench --json --quiet --rho 1e6").args(ONCE).run().succeeded().json();
    let warnings = record["runs"][0]["warnings"].to_string();
    assert!(warnings.contains("no grid point was accepted") && warnings.contains("densities are"), "{warnings}");
}

/// A warning of a record stands on standard error of a picture, and of an experiment at its end.
#[test]
fn a_picture_of_nothing_is_a_warning_too() {
    let out = folder();
    let ended = small("render --rho 1e6 --image flat.png").inside(out.path()).run().succeeded();
    assert!(ended.stderr.contains("warning: no grid point was accepted"), "{}", ended.stderr);
    let ended = small("experiment fig-8.1 --rho 1e6 --out .").inside(out.path()).run().succeeded();
    assert_eq!(ended.stdout.matches("warning: no grid point was accepted").count(), 1, "{}", ended.stdout);
}

#[test]
fn objects_stand_in_the_picture_and_in_the_record() {
    let out = folder();
    file(&out, "wall.obj", "v 1 0.2 0.5\nv 3 0.2 0.5\nv 3 1.5 0.5\nv 1 1.5 0.5\nf 1 2 3 4\n");
    file(&out, "broken.obj", "v 0 0 0\nf 1 2 3\n");
    let picture = |options: &str, name: &str| {
        small("render --quiet").args(options).arg("--image").arg(name).inside(out.path()).run().succeeded();
        fs::read(out.path().join(name)).unwrap()
    };
    let alone = picture("", "alone.png");
    assert!(picture("", "again.png") == alone);
    assert!(picture("--object wall.obj@own", "wall.png") != alone);
    let boxed = picture("--object wall.obj@own --object box", "both.png");
    assert!(boxed != picture("--object wall.obj@own", "wall.png"));
    assert!(picture("--object wall.obj@own --object box@3,0.5,0.5,30,0.2", "placed.png") != boxed);
    let bench = small("bench --json --quiet --validate --object wall.obj@own --object box@99,0,0")
        .args(ONCE)
        .inside(out.path());
    let record = bench.run().succeeded().json();
    assert_schema(&record);
    let run = &record["runs"][0];
    assert_eq!(run["config"]["object"], serde_json::json!(["wall.obj@own", "box@99,0,0,0"]));
    let warnings = run["warnings"].to_string();
    assert!(warnings.contains("--object 2 of 2, box, is outside the picture"), "{warnings}");
    assert_eq!(names(&run["passes"]).last(), Some(&"objects"));
    small("render --object broken.obj").inside(out.path()).run().refused(2, &["broken.obj", "line 2"]);
}

/// No device limits them.
#[test]
fn more_passes_than_the_program_records_are_refused() {
    let render = small("render --quiet").args("--density 4x400000x4 --particles 10");
    render.run().refused(2, &["--density", "300016 passes in a frame", "the 65536 that this program records"]);
}

#[test]
fn a_frame_is_the_same_alone_and_in_a_range() {
    let out = folder();
    small("render --frame 3 --image alone.png --quiet").inside(out.path()).run().succeeded();
    small("render --frame 2..4 --image of.png --quiet").inside(out.path()).run().succeeded();
    let read = |name: &str| fs::read(out.path().join(name)).unwrap();
    assert_eq!(entries(out.path()), ["alone.png", "of-0002.png", "of-0003.png"]);
    assert!(read("alone.png") == read("of-0003.png"));
    assert!(read("of-0002.png") != read("of-0003.png"));
}

#[test]
fn figures_are_pictures_and_textures() {
    let out = folder();
    let figures = [
        ("fig-4.1", &["lava-fig-4.1-position.png", "lava-fig-4.1-velocity.png"][..]),
        ("fig-4.2", &["lava-fig-4.2a-density.png", "lava-fig-4.2b-normal-height.png", "lava-fig-4.2c-heights.png"]),
        ("fig-6.3", &["lava-fig-6.3-heights.png", "lava-fig-6.3-normal-height.png"]),
        ("fig-7.2", &["lava-fig-7.2.png"]),
        ("fig-8.3", &["lava-fig-8.3.png"]),
    ];
    for (name, files) in figures {
        let folder = out.path().join(name);
        small(&format!("experiment {name} --quiet")).arg("--out").arg(&folder).run().succeeded();
        assert_eq!(entries(&folder), files);
    }
    let picture = |name: &str| read_png(&out.path().join(name)).unwrap();
    // The texture itself, and one texel of a height for each column of the grid.
    let rock = Rock::built_in();
    assert_eq!(picture("fig-7.2/lava-fig-7.2.png").pixels(), rock.texels.as_flattened());
    let heights = picture("fig-6.3/lava-fig-6.3-heights.png");
    assert_eq!((heights.width(), heights.height()), (16, 8));
    assert!(heights.pixels().chunks_exact(4).all(|p| p[0] == p[1] && p[1] == p[2]));
    assert!(heights.pixels().chunks_exact(4).any(|p| p[0] > 64));
}

#[test]
fn the_frame_rate_stands_beside_the_thesis_s() {
    let out = folder();
    let ended = small("experiment results --out .").args(ONCE).inside(out.path()).run().succeeded();
    assert_eq!(entries(out.path()), ["lava-results.csv", "lava-results.json", "lava-results.svg"]);
    let record = read_json(&out.path().join("lava-results.json"));
    assert_schema(&record);
    let row = &record["runs"][0]["experiment"];
    assert_eq!(row["paper"], 20.0);
    let ours = row["ours"].as_f64().unwrap();
    assert!((row["ratio"].as_f64().unwrap() - ours / 20.0).abs() < 1e-9, "{row}");
    assert!(ended.stdout.contains("the thesis: around 20"), "{}", ended.stdout);
}

/// Each by its own drawing, both by splats, both by rays: three stages and the frame of each.
#[test]
fn readbacks_are_set_against_none() {
    let out = folder();
    small("experiment readback --quiet --out .").args(ONCE).inside(out.path()).run().succeeded();
    let files = ["-stages.csv", "-tables.json", ".csv", ".json", ".svg"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("lava-readback{suffix}")));
    let record = read_json(&out.path().join("lava-readback.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let drawn: Vec<_> = runs.iter().map(|run| (&run["variant"], &run["config"]["surface_draw"])).collect();
    let [paper, driven] = [Value::from("paper"), Value::from("gpu-driven")];
    let [splats, march] = [Value::from("splats"), Value::from("march")];
    let expected = [(&paper, &splats), (&driven, &march), (&paper, &splats)];
    assert_eq!(drawn[..3], expected);
    assert_eq!(drawn[3..], [(&driven, &splats), (&paper, &march), (&driven, &march)]);
    for run in runs {
        // Nothing is made for the other way of drawing.
        let resources = run["memory"]["by_resource"].as_array().unwrap();
        for (name, drawing) in [("splats", &splats), ("patches", &march)] {
            let is_made = resources.iter().any(|resource| resource["name"] == name);
            assert_eq!(is_made, run["config"]["surface_draw"] == *drawing, "{name}: {resources:?}");
        }
    }
    let waits = |run: &Value| run["passes"].as_array().unwrap().iter().any(|pass| !pass["wait_ms"].is_null());
    assert!(waits(&runs[0]) && !waits(&runs[1]));
    let accepted: Vec<_> = runs.iter().map(|run| run["results"]["accepted_grid_points"].as_u64().unwrap()).collect();
    assert!(accepted[0] > 0 && accepted.iter().all(|&count| count == accepted[0]), "{accepted:?}");
    let stages = fs::read_to_string(out.path().join("lava-readback-stages.csv")).unwrap();
    assert_eq!(stages.lines().count(), 1 + 6 * 4, "{stages}");
}

#[test]
fn every_pass_stands_beside_the_floor_of_the_record() {
    let out = folder();
    let ended = small("experiment results --frames 2 --repeat 1 --out .").inside(out.path()).run().succeeded();
    let record = read_json(&out.path().join("lava-results.json"));
    assert_schema(&record);
    let run = &record["runs"][0];
    let header = ended.stdout.lines().find(|line| line.starts_with("pass ")).unwrap();
    // Numbers end where their headings do.
    let printed = |pass: &str, column: &str| -> String {
        let line = ended.stdout.lines().find(|line| line.split_whitespace().next() == Some(pass)).unwrap();
        let end = header.find(column).unwrap_or_else(|| panic!("no {column} in {header}")) + column.len();
        line[..end.min(line.len())].rsplit("  ").next().unwrap().trim().to_owned()
    };
    let mut with_floor = 0;
    for pass in run["passes"].as_array().unwrap() {
        let name = pass["name"].as_str().unwrap();
        let Some(floor_ms) = pass["floor_ms"].as_f64() else {
            assert_eq!(pass["kind"], "host", "{pass}");
            continue;
        };
        with_floor += 1;
        assert_eq!(printed(name, "floor ms"), format!("{floor_ms:.2}"), "{}", ended.stdout);
        let share = 100.0 * floor_ms / pass["counted_ms"].as_f64().unwrap();
        assert_eq!(printed(name, "share of limit"), format!("{share:.0} %"), "{}", ended.stdout);
    }
    assert!(with_floor >= 8, "{with_floor}");
    let points = run["results"]["points_ms"].as_object().unwrap();
    assert_eq!(points.len(), 4);
    for (pass, ms) in points {
        assert_eq!(printed(pass, "points ms"), format!("{:.2}", ms.as_f64().unwrap()), "{}", ended.stdout);
    }
}

#[test]
fn the_crossing_lies_on_the_isosurface_and_the_mean_inside() {
    let out = folder();
    small("experiment surface --border 0 --out . --quiet").inside(out.path()).run().succeeded();
    assert_eq!(entries(out.path()), ["lava-surface.csv", "lava-surface.json"]);
    let table = read_json(&out.path().join("lava-surface.json"));
    let rows = table["table"]["rows"].as_array().unwrap();
    let value = |row: usize, column: &str| rows[row][column].as_f64().unwrap_or_else(|| panic!("{column}: {table}"));
    assert_eq!(rows.len(), 3);
    // Below 0.05 of a cell.
    assert!(value(2, "at columns, p95") < 1e-3, "{table}");
    assert!(value(0, "at columns, median") > 0.5 && value(0, "between, signed mean") < -0.5, "{table}");
    assert!(value(0, "particles above") > 0.3 && value(2, "particles above") < value(0, "particles above"), "{table}");
    small("experiment surface --surface top").run().refused(2, &["--surface"]);
}

#[test]
fn lava_lies_on_a_map() {
    let out = folder();
    let map = |rows: &str| format!("ncols 5\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n{rows}");
    file(&out, "ramp.asc", map("3 2 1 0 0\n3 2 1 0 0\n3 2 1 0 0\n"));
    file(&out, "peak.asc", map("0 0 0 0 0\n0 0 900 0 0\n0 0 0 0 0\n"));
    let picture = |options: &str, name: &str| {
        let fluid = "--simulation sph --surface crossing --image";
        small("render --quiet").args(options).args(fluid).arg(name).inside(out.path()).run().succeeded();
        fs::read(out.path().join(name)).unwrap()
    };
    assert!(picture("--bed ramp.asc", "ramp.png") != picture("--slope 0", "level.png"));
    let record = small("bench --json --quiet --validate --simulation sph --bed ramp.asc").args(ONCE);
    let run = record.inside(out.path()).run().succeeded().json()["runs"][0].clone();
    assert_eq!(
        (&run["config"]["bed"], &run["config"]["slope"]),
        (&"ramp.asc".into(), &0.0.into()),
        "{}",
        run["config"]
    );
    assert!(names(&run["passes"]).contains(&"objects"), "the ground is drawn: {}", run["passes"]);
    assert!(run["results"]["particles_per_s"].as_f64().is_some_and(|rate| rate > 0.0), "{}", run["results"]);
    let refused = |options: &str, words: &[&str]| {
        small("render").args(options).inside(out.path()).run().refused(2, words);
    };
    refused("--bed ramp.asc", &["--bed ramp.asc", "--simulation sph"]);
    refused("--simulation sph --sides periodic --bed ramp.asc", &["--bed ramp.asc", "--sides walls"]);
    refused("--simulation sph --bed peak.asc", &["--bed peak.asc", "--space", "metres high"]);
    refused("--simulation sph --bed none.asc", &["none.asc"]);
}

/// Free particles run through each other, and the relief goes with none; a fluid takes it along.
#[test]
fn relief_is_carried_by_a_fluid_and_not_by_free_particles() {
    let out = folder();
    let of = |options: &str| {
        let finer = "--particles 1500 --radius 0.14 --density 60x16x16 --surface crossing";
        let motion = small("experiment motion --out . --quiet").args(finer).args(options);
        motion.inside(out.path()).run().succeeded();
        assert_eq!(entries(out.path()), ["lava-motion.csv", "lava-motion.json", "lava-motion.svg"]);
        let table = read_json(&out.path().join("lava-motion.json"));
        let rows = table["table"]["rows"].as_array().unwrap().clone();
        assert!((rows[3]["later s"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{table}");
        [0, 3].map(|row: usize| rows[row]["correlation"].as_f64().unwrap_or_else(|| panic!("{table}")))
    };
    // The fluid's block has slumped by then.
    let (free, fluid) = (of("--frame 2"), of("--frame 30 --simulation sph --viscosity 400"));
    assert!(fluid[1] > free[1] + 0.2 && fluid[1] > 0.9 && free[1] < 0.7 && free[0] > free[1], "{free:?} {fluid:?}");
    small("experiment motion --quiet --time-step 0").inside(out.path()).run().refused(2, &["--time-step"]);
}

#[test]
fn a_flow_is_followed_over_time() {
    let out = folder();
    let flow =
        "--simulation sph --effusion-rate 0.1 --vent-radius 0.3 --vent 0.6,0.5 --heat-capacity 12 --particles 400";
    small("experiment flow --frames 21 --out . --quiet").args(flow).inside(out.path()).run().succeeded();
    let files = ["-area.svg", "-effusion.svg", "-temperatures.svg", ".csv", ".json", ".svg"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("lava-flow{suffix}")));
    let table = read_json(&out.path().join("lava-flow.json"));
    let rows = table["table"]["rows"].as_array().unwrap();
    let value = |row: usize, column: &str| rows[row][column].as_f64().unwrap_or_else(|| panic!("{column}: {table}"));
    assert_eq!(rows.len(), 21);
    assert!((value(20, "time s") - 0.7).abs() < 1e-6, "{table}");
    // 0.07 of 0.72 m^3, to half a particle; no row's effusion is off by more than a particle in a step.
    let particle = 0.72 / 400.0;
    assert!((value(20, "volume m3") - 0.07).abs() <= 0.51 * particle, "{table}");
    for row in 1..21 {
        assert!((value(row, "effusion m3/s") - 0.1).abs() < 31.0 * particle, "{table}");
        assert!(value(row, "greatest K") <= 1423.01 && value(row, "skin K") <= value(row, "greatest K"), "{table}");
    }
    assert!(value(20, "mean K") < value(1, "mean K") && value(20, "area m2") > value(1, "area m2"), "{table}");
    small("experiment flow").run().refused(2, &["--simulation"]);
    small("experiment flow --frame 3 --simulation sph").run().refused(2, &["--frame", "--frames"]);
}

#[test]
fn a_march_stands_for_the_splats() {
    let record =
        small("bench --json --quiet --validate --surface-draw march --object box").args(ONCE).run().succeeded().json();
    assert_schema(&record);
    let passes = &record["runs"][0]["passes"];
    assert_eq!(names(passes)[8..], ["highest-rows", "highest", "march", "normalisation", "objects"], "{passes}");
    lava("experiment fig-8.5 --surface-draw march").run().refused(2, &["--surface-draw"]);
}

#[test]
fn options_that_a_figure_sets_itself_are_refused() {
    let figure = |name: &str, option: &str| lava("experiment").arg(name).args(option).on_test_device().run();
    figure("fig-8.5", "--splat-radius 0.01").refused(2, &["--splat-radius"]);
    figure("fig-6.4", "--shading rock").refused(2, &["--shading"]);
    figure("fig-5.2", "--object box").refused(2, &["--object box"]);
}

#[test]
fn what_cannot_be_is_refused_by_its_option() {
    for (options, parts) in [
        ("--particles 0", &["--particles 0", "1 to 16777216"][..]),
        ("--radius 0", &["--radius 0"]),
        ("--radius 1.5", &["--radius 1.5", "shortest side"]),
        ("--density 0x8x8", &["--density 0x8x8"]),
        ("--density 65536x1024x8", &["--density 65536x1024x8"]),
        ("--object no-such.obj", &["no-such.obj"]),
        ("--exposure 0", &["--exposure 0"]),
        ("--object box --shading particles", &["--object box", "--shading"]),
        ("--splats 0x10", &["--splats 0x10"]),
        ("--splat-radius 0", &["--splat-radius 0"]),
        ("--space 0x1x1", &["--space 0x1x1"]),
        ("--epsilon 0", &["--epsilon 0"]),
        ("--rho -1", &["--rho -1"]),
        ("--border -1", &["--border -1"]),
        ("--rock no-such.png", &["no-such.png"]),
        ("--size 0x0", &["--size 0x0"]),
    ] {
        lava("bench").on_test_device().args(options).args(ONCE).run().refused(2, parts);
    }
    for option in ["radius", "rho", "splat-radius", "epsilon", "border", "speed", "rock-tile", "time-step"] {
        for value in ["nan", "inf", "two", ""] {
            lava("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
    for (option, value) in
        [("color", "nan,1,1"), ("camera", "nan,1,1,0,0,0"), ("density", "nanx1x1"), ("space", "nanx1x1")]
    {
        lava("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
    }
    for (option, value) in [
        ("object", "box@1,2"),
        ("object", "box@1,2,3,0,-1"),
        ("tone", "dim"),
        ("space", "1x1"),
        ("density", "4x4"),
        ("splats", "ax4"),
        ("color", "1,2"),
        ("camera", "fig-9"),
    ] {
        lava("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
    }
}

#[test]
fn what_the_device_cannot_hold_is_refused_with_both_figures() {
    let layer = Layer::new();
    for (options, parts) in [
        ("--density 20000x4x4 --radius 0.001", &["density", "20000", "limit of 4096"][..]),
        ("--density 4x20000x4 --particles 10", &["density", "5000", "limit of 256"]),
        ("--size 20000x20", &["20000", "limit of 4096"]),
        ("--density 4096x4x1024 --radius 0.5 --splats 4x4", &["point", "limit of 64"]),
    ] {
        let program = lava("bench --quiet").on_test_device().args(options).args(ONCE);
        layer.least(program).run().refused(2, parts);
    }
}

#[test]
fn a_rock_that_is_no_rock_is_refused() {
    let out = folder();
    let whole = {
        small("render --quiet --image whole.png").inside(out.path()).run().succeeded();
        fs::read(out.path().join("whole.png")).unwrap()
    };
    fs::write(out.path().join("truncated.png"), &whole[..whole.len() / 2]).unwrap();
    file(&out, "text.png", "not a picture");
    let pixel = SMALL.replace("--size 64x48", "--size 1x1 --quiet --image pixel.png");
    lava("render").args(&pixel).on_test_device().inside(out.path()).run().succeeded();
    for (name, part) in [("truncated.png", "truncated.png"), ("text.png", "text.png"), ("pixel.png", "1x1")] {
        small("bench").arg("--rock").arg(name).args(ONCE).inside(out.path()).run().refused(2, &[part]);
    }
    small("render --quiet --rock whole.png --image rocky.png").inside(out.path()).run().succeeded();
    assert!(fs::read(out.path().join("rocky.png")).unwrap() != whole);
}

#[test]
fn the_umbrella_runs_it_too() {
    let listed = fumarole("lava passes --json").args(SMALL).arg("--device").arg(device()).run().succeeded().json();
    assert_eq!(listed[0]["paper"], "lava");
}

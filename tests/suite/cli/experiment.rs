//! `experiment`: its files, its table, and what it refuses.

use std::fs;

use super::program::{ONCE, Program, assert_schema, caustics, entries, file, folder, read_json};

const SMALL: &str = "--size 96x64 --map-size 64 --water-triangles 500";

fn sweep() -> Program {
    caustics("experiment 5-1 --quiet").args(SMALL).on_test_device()
}

#[test]
fn experiments_are_listed() {
    let ended = caustics("experiment --list").run().succeeded();
    let line = ended.stdout.lines().find(|line| line.starts_with("5-1 ")).expect("5-1 is listed");
    assert!(line.to_lowercase().contains("level map against volumetric"), "{line}");
    assert_eq!(ended.stderr, "");
}

#[test]
fn table_5_1_is_written_and_printed_with_its_ratios() {
    let out = folder();
    let program = caustics("experiment 5-1 --counts 3,5 --mesh sphere --out tables").inside(out.path());
    let ended = program.args(SMALL).args(ONCE).on_test_device().run().succeeded();
    let tables = out.path().join("tables");
    let files = ["-against-volumetric.csv", "-tables.json", ".csv", ".json", ".svg"];
    assert_eq!(entries(&tables), files.map(|suffix| format!("caustics-5-1{suffix}")));

    let record = read_json(&tables.join("caustics-5-1.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let found: Vec<(u64, &str)> =
        runs.iter().map(|run| (run["config"]["planes"].as_u64().unwrap(), run["variant"].as_str().unwrap())).collect();
    assert_eq!(found, [(3, "level-map"), (3, "volumetric"), (5, "level-map"), (5, "volumetric")]);
    for run in runs {
        assert_eq!(run["preset"], "5-1");
    }
    for (run, thesis) in [(&runs[1], 2.06), (&runs[3], 2.41)] {
        let row = &run["experiment"];
        let median = |run: &serde_json::Value| run["frame_ms"]["median"].as_f64().unwrap();
        let ours = row["ours"].as_f64().unwrap();
        let paper = row["paper"].as_f64().unwrap();
        assert!((paper - thesis).abs() < 0.01, "{row}");
        assert!((row["ratio"].as_f64().unwrap() - ours / paper).abs() < 1e-9, "{row}");
        assert!(ours > 0.0 && median(run) > 0.0, "{row}");
        assert!(row["interval"].is_null() && run["results"]["ratio_interval"].is_null(), "of two frames: {row}");
        let printed = format!("{ours:.3}");
        assert!(ended.stdout.contains(&printed), "{printed} is not printed:\n{}", ended.stdout);
    }

    let csv = fs::read_to_string(tables.join("caustics-5-1.csv")).unwrap();
    let passes: usize = runs.iter().map(|run| run["passes"].as_array().unwrap().len()).sum();
    assert_eq!(csv.lines().count(), 1 + passes);
    let svg = fs::read_to_string(tables.join("caustics-5-1.svg")).unwrap();
    assert_eq!(roxmltree::Document::parse(&svg).unwrap().root_element().tag_name().name(), "svg");
}

/// A record that finds no room takes neither the rows nor the table along.
#[test]
fn what_can_be_written_is_written() {
    let out = folder();
    let program = caustics("experiment 5-1 --counts 3 --mesh sphere --json /dev/full --out out").inside(out.path());
    let ended = program.args(SMALL).args(ONCE).on_test_device().run();
    assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("error: ") && ended.stderr.contains("/dev/full"), "{}", ended.stderr);
    let files = ["-against-volumetric.csv", "-tables.json", ".csv", ".svg"];
    assert_eq!(entries(&out.path().join("out")), files.map(|suffix| format!("caustics-5-1{suffix}")));
    assert!(ended.stdout.contains("volumetric"), "{}", ended.stdout);
}

/// Warnings of a scene are told of its pictures in an experiment as `render` tells them.
#[test]
fn pictures_of_experiments_have_their_warnings() {
    let out = folder();
    let scene = format!("{SMALL} --mesh box --planes 3");
    let render = caustics("render --image a.png --variant level-map").args(&scene).inside(out.path());
    let told = render.on_test_device().run().succeeded().stderr;
    let told: Vec<&str> = told.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert!(told.iter().any(|line| line.contains("folds light")), "{told:?}");
    let program = caustics("experiment 5-13 --out pair").args(&scene).inside(out.path()).on_test_device();
    let ended = program.run().succeeded();
    for warning in told {
        assert_eq!(ended.stdout.matches(warning).count(), 1, "{warning}: {}", ended.stdout);
    }
}

#[test]
fn chapter_6_is_set_against_the_level_map() {
    let out = folder();
    let program = caustics("experiment 6.3 --counts 9 --mesh sphere --errors 90 --sizes 16,32 --photons 20 --out .");
    let program = program.inside(out.path());
    let ended = program.args(SMALL).args(ONCE).on_test_device().run().succeeded();
    let files = ["-drawn.csv", "-smallest.csv", "-tables.json", ".csv", ".json", ".svg"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("caustics-6.3{suffix}")));
    let tables = read_json(&out.path().join("caustics-6.3-tables.json"));
    assert_eq!(tables["table"]["rows"].as_array().unwrap().len(), 3);
    // Four readings of the level map, two of culled, hit.
    assert_eq!(tables["more"]["smallest"]["rows"].as_array().unwrap().len(), 7);
    let record = read_json(&out.path().join("caustics-6.3.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let methods: Vec<&str> = runs.iter().map(|run| run["variant"].as_str().unwrap()).collect();
    assert_eq!(methods, ["level-map", "culled", "hit"]);
    let pairs = |run: &serde_json::Value| {
        let passes = run["passes"].as_array().unwrap().iter();
        let map = passes.clone().find(|pass| pass["name"] == "caustics-map").unwrap();
        map["statistics"]["primitives"].as_u64().unwrap()
    };
    let [all, kept] = [0, 1].map(|i| pairs(&runs[i]));
    assert_eq!(all, 9 * runs[0]["config"]["water_triangles"].as_u64().unwrap());
    assert!(kept > 0 && kept * 2 < all, "{kept} of {all}");
    let refined = &runs[2]["results"]["refined_triangles"];
    assert_eq!(refined, &runs[2]["config"]["water_triangles"]);
    for count in [all, kept, refined.as_u64().unwrap()] {
        assert!(ended.stdout.contains(&format!(" {count} ")), "{count} is not printed:\n{}", ended.stdout);
    }
    // Those that are drawn, and how fast: of the culled pairs what is left of them.
    for (run, count) in [(&runs[0], all), (&runs[1], kept)] {
        let results = &run["results"];
        assert_eq!(
            (results["planes_drawn"].as_u64(), results["intersection_triangles"].as_u64()),
            (Some(9), Some(count))
        );
        let map = run["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "caustics-map").unwrap();
        let rate = results["intersection_triangles_per_s"].as_f64().unwrap();
        let expected = count as f64 / map["gpu_ms"]["median"].as_f64().unwrap() * 1e3;
        assert!((rate / expected - 1.0).abs() < 1e-6, "{rate} {expected}");
    }
    assert!(runs[2]["results"].get("planes_drawn").is_none(), "hit has no planes");
    assert_eq!(drawn_of(&ended.stdout, "hit"), None, "{}", ended.stdout);
    assert_eq!(drawn_of(&ended.stdout, "culled"), Some(9), "{}", ended.stdout);
}

/// The planes drawn of a method in the first table that has it: its line is mesh, planes, method, drawn, frame ms, device MiB.
fn drawn_of(printed: &str, method: &str) -> Option<u64> {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let line = printed.lines().map(words).find(|words| words.get(2).is_some_and(|word| word == method)).unwrap();
    line[3].parse().ok()
}

/// Planes that the device places are counted as the host's are, which the same planes of the level map are.
#[test]
fn smart_culling_is_set_against_smart_slicing() {
    let out = folder();
    let program = caustics("experiment 6.3 --counts 9 --mesh teapot --smart --out .").inside(out.path());
    let ended = program.args(SMALL).args(ONCE).on_test_device().run().succeeded();
    let record = read_json(&out.path().join("caustics-6.3.json"));
    let runs = record["runs"].as_array().unwrap();
    let methods: Vec<&str> = runs.iter().map(|run| run["variant"].as_str().unwrap()).collect();
    assert_eq!(methods, ["level-map-smart", "culled", "hit"]);
    let [by_host, by_device] = [0, 1].map(|i| runs[i]["results"]["planes_drawn"].as_u64().unwrap());
    assert!(by_host == by_device && (1..9).contains(&by_host), "{by_host} {by_device}");
    assert_eq!(drawn_of(&ended.stdout, "culled"), Some(by_device), "{}", ended.stdout);
    assert!(runs[2]["warnings"].to_string().contains("hit does not heed --smart"), "{}", runs[2]["warnings"]);

    let program = caustics("experiment 6.1 --counts 9 --mesh teapot --smart --out .").inside(out.path());
    program.args(SMALL).args(ONCE).on_test_device().run().succeeded();
    let record = read_json(&out.path().join("caustics-6.1.json"));
    let rows = record["table"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &rows[0]["steps"]), (9, &serde_json::json!("level-map-smart")));
    assert!(rows[0]["culling ms"].is_null() && rows[1]["culling ms"].as_f64().unwrap() > 0.0, "{rows:?}");
    for row in rows {
        assert_eq!(row["kept"], rows[0]["kept"], "{row}");
        assert!(row["pairs"].as_u64() <= rows[0]["pairs"].as_u64(), "{row}");
    }
}

/// Photons decide between the methods: under steep water the light where it lands is nearer to them than the level map, and
/// culling changes nothing but the time.
#[test]
fn every_method_is_set_against_photons() {
    let out = folder();
    let small = "--size 96x64 --water-triangles 2000 --sizes 16,32 --counts 9,5 --photons 60 --frames 1 --repeat 1";
    let program = caustics("experiment accuracy --mesh plane --errors 90,1 --out .").inside(out.path());
    let ended = program.args(small).on_test_device().run().succeeded();
    let files = ["-smallest.csv", ".csv", ".json", ".svg"].map(|suffix| format!("caustics-accuracy{suffix}"));
    assert_eq!(entries(out.path()), files);
    let record = read_json(&out.path().join("caustics-accuracy.json"));
    let rows = record["table"]["rows"].as_array().unwrap();
    let of = |case: &str, method: &str| -> Vec<serde_json::Value> {
        let is_it = |row: &&serde_json::Value| row["case"] == case && row["method"] == method && row["map"] == 32;
        rows.iter().filter(is_it).cloned().collect()
    };
    for case in ["steep", "oblique", "point", "two lights", "murky"] {
        assert_eq!(of(case, "level-map").len(), 1, "{case}");
    }
    assert_eq!((of("as set", "level-map").len(), of("as set", "hit").len()), (2, 1));
    let number = |row: &serde_json::Value, name: &str| row[name].as_f64().unwrap();
    for row in rows {
        assert!(number(row, "halves") > 0.9 && number(row, "frame ms") > 0.0, "{row}");
        assert!((number(row, "flux") - 1.0).abs() < 0.1, "{row}");
    }
    let (level_map, hit, culled) = (&of("steep", "level-map")[0], &of("steep", "hit")[0], &of("steep", "culled")[0]);
    assert!(
        number(hit, "correlation") > 0.98 && number(hit, "rms") < 0.7 * number(level_map, "rms"),
        "{hit} {level_map}"
    );
    for name in ["correlation", "rms", "greatest", "flux", "rms seen", "picture", "picture p99"] {
        assert_eq!(number(level_map, name), number(culled, name), "{name}");
    }
    // What is seen of it: the picture by light where it lands is nearer to the photons'.
    assert!(
        0.0 < number(hit, "picture") && number(hit, "picture") < 0.7 * number(level_map, "picture"),
        "{hit} {level_map}"
    );
    assert!(number(hit, "picture p99") < number(level_map, "picture p99"), "{hit} {level_map}");
    // The smallest of those tried that reaches an error, and nothing for one that none reaches.
    let smallest = record["more"]["smallest"]["rows"].as_array().unwrap();
    let of_hit: Vec<_> = smallest.iter().filter(|row| row["method"] == "hit").collect();
    assert_eq!((of_hit[0]["map"].as_u64(), of_hit[1]["map"].as_u64()), (Some(16), None), "{of_hit:?}");
    assert!(ended.stdout.contains("halves") && ended.stdout.contains("The smallest map"), "{}", ended.stdout);

    let refused = |options: &str, name: &str| {
        let program = caustics("experiment accuracy --quiet").args(options).on_test_device();
        program.inside(out.path()).run().refused(2, &[name]);
    };
    refused("--sizes 24,32", "--sizes");
    refused("--map-size 32", "--sizes");
    refused("--coverage 2", "--coverage");
    caustics("experiment 5-1 --photons 3").run().refused(2, &["--photons"]);
}

/// Without a number of photons the truth has as many as make its halves agree, which 100 a texel do not where the light hardly folds.
#[test]
fn photons_are_as_many_as_make_the_truth_certain() {
    let out = folder();
    let alone = "--light 0,-1,0 --amplitude 0.05 --absorption 0.1";
    let small = "--size 96x64 --water-triangles 2000 --sizes 16,32 --counts 5 --frames 1 --repeat 1 --out .";
    let program = caustics("experiment accuracy --mesh sphere").args(alone).args(small).inside(out.path());
    program.on_test_device().run().succeeded();
    let record = read_json(&out.path().join("caustics-accuracy.json"));
    let rows = record["table"]["rows"].as_array().unwrap();
    assert!(!rows.is_empty());
    for row in rows {
        assert!(row["halves"].as_f64().unwrap() >= 0.999 && row["photons"].as_u64().unwrap() > 100, "{row}");
    }
}

/// Each step drops pairs, all of them together the most, and what is kept of the fragments stays the same.
#[test]
fn each_step_of_culling_is_measured() {
    let out = folder();
    let program = caustics("experiment 6.1 --counts 9 --mesh sphere --errors 90 --sizes 16,32 --photons 20 --out .");
    let ended = program.inside(out.path()).args(SMALL).args(ONCE).on_test_device().run().succeeded();
    let files = ["-smallest.csv", ".csv", ".json", ".svg"].map(|suffix| format!("caustics-6.1{suffix}"));
    assert_eq!(entries(out.path()), files);
    let record = read_json(&out.path().join("caustics-6.1.json"));
    let rows = record["table"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 9);
    let pairs = |steps: &str| {
        let row = rows.iter().find(|row| row["steps"] == steps).unwrap();
        assert_eq!(row["kept"], rows[0]["kept"], "{steps}");
        row["pairs"].as_u64().unwrap()
    };
    assert!(pairs("none") <= pairs("level-map"));
    for step in ["groups", "planes", "texels"] {
        assert!(pairs("every") <= pairs(step) && pairs(step) < pairs("none"), "{step}");
    }
    assert!(pairs("every") * 2 < pairs("none") && pairs("texels") < pairs("planes"));
    assert!(ended.stdout.contains("culling ms") && ended.stdout.contains("The smallest map"), "{}", ended.stdout);
    let smallest = record["more"]["smallest"]["rows"].as_array().unwrap();
    assert!(!smallest.is_empty() && smallest.iter().all(|row| row["mesh"] == "sphere"), "{smallest:?}");
}

/// The fewer planes, the farther from the picture with all of them.
#[test]
fn fewer_planes_change_the_picture_more() {
    let out = folder();
    let program = caustics("experiment 6.1-far --counts 32 --mesh teapot --out .").inside(out.path());
    program.args(SMALL).on_test_device().run().succeeded();
    let rows = read_json(&out.path().join("caustics-6.1-far.json"))["table"]["rows"].as_array().unwrap().clone();
    let of = |name: &str| -> Vec<f64> { rows.iter().map(|row| row[name].as_f64().unwrap()).collect() };
    assert_eq!(of("planes drawn"), [16.0, 8.0, 4.0]);
    assert!(of("mean").is_sorted() && of("mean")[0] > 0.0, "{rows:?}");
}

#[test]
fn a_table_without_times_is_written_and_printed() {
    let out = folder();
    let program = caustics("experiment memory --counts 3,5 --mesh box --out .").inside(out.path());
    let ended = program.args(SMALL).on_test_device().run().succeeded();
    assert_eq!(entries(out.path()), ["caustics-memory.csv", "caustics-memory.json", "caustics-memory.svg"]);
    let rows = read_json(&out.path().join("caustics-memory.json"))["table"]["rows"].as_array().unwrap().len();
    let csv = fs::read_to_string(out.path().join("caustics-memory.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + rows);
    assert!(ended.stdout.contains("box"), "{}", ended.stdout);
}

/// Each comes after something that would be measured for minutes, and is found before it.
#[test]
fn bad_input_is_refused_before_anything_is_measured() {
    let long = || sweep().inside(std::env::temp_dir().as_path()).args("--frames 100000 --repeat 10000");
    long().args("--counts 3,0 --mesh sphere").run().refused(2, &["--counts 3,0", "1 to 4096"]);
    long().args("--counts 3,4097 --mesh sphere").run().refused(2, &["--counts 3,4097", "1 to 4096"]);
    long().args("--counts 3 --mesh sphere --mesh no-such.obj").run().refused(2, &["no-such.obj"]);
    long().args("--counts 3 --mesh sphere --out /dev/null/out").run().refused(2, &["/dev/null/out"]);
}

#[test]
fn what_a_sweep_cannot_give_is_refused() {
    for (option, name) in [("--processes 2", "--processes"), ("--trace t", "--trace"), ("--image p.png", "--image")] {
        sweep().args(option).run().refused(2, &[name]);
    }
    sweep().args("--planes 3").run().refused(2, &["--planes", "--counts"]);
    caustics("experiment 6.1-far --planes-within 3").run().refused(2, &["--planes-within"]);
    caustics("experiment 6.1-far --smart").run().refused(2, &["--smart"]);
    caustics("experiment 5-2 --counts 3").run().refused(2, &["--counts", "--planes"]);
    sweep().args("--counts 3 --step 3").run().misused(&["--counts", "--step"]);
    caustics("experiment").run().misused(&["NAME"]);
    caustics("experiment 9-9").run().misused(&["9-9", "5-1"]);
}

#[test]
fn a_meshs_name_may_hold_a_comma() {
    let out = folder();
    let mesh = file(&out, "a,b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let program = caustics("experiment 5-2 --quiet --out tables --mesh").arg(mesh).inside(out.path());
    program.args(SMALL).on_test_device().run().succeeded();
    let csv = fs::read_to_string(out.path().join("tables/caustics-5-2.csv")).unwrap();
    assert_eq!(csv.lines().nth(1), Some("\"a,b\",1,"), "{csv}");
}

#[test]
fn meshes_of_one_name_have_files_of_their_own() {
    let out = folder();
    fs::create_dir(out.path().join("other")).unwrap();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n";
    let (first, second) = (file(&out, "part.obj", triangle), file(&out, "other/part.obj", triangle));
    let program = caustics("experiment depth-profile --quiet --out tables").inside(out.path());
    let program = program.arg("--mesh").arg(first).arg("--mesh").arg(second).args(SMALL);
    program.on_test_device().run().succeeded();
    let profiles = ["caustics-depth-profile-part-2-profile.svg", "caustics-depth-profile-part-profile.svg"];
    let expected = [&profiles[..], &["caustics-depth-profile.csv", "caustics-depth-profile.json"]].concat();
    assert_eq!(entries(&out.path().join("tables")), expected);
    let csv = fs::read_to_string(out.path().join("tables/caustics-depth-profile.csv")).unwrap();
    assert!(csv.contains("\npart,1,") && csv.contains("\npart-2,1,"), "{csv}");
}

/// lavapipe has 2048 layers for the volumetric method's slices; a device with 4096 goes on.
#[test]
fn a_sweep_that_a_limit_ends_keeps_its_rows() {
    let out = folder();
    let program = caustics("experiment 5-1 --counts 3,4096 --mesh box --out .").inside(out.path());
    let ended = program.args("--size 64x48 --map-size 16 --water-triangles 8").args(ONCE).on_test_device().run();
    let record = read_json(&out.path().join("caustics-5-1.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    if ended.status.code() != Some(0) {
        assert!(ended.stdout.contains("volumetric"), "{}", ended.stdout);
        assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
        let last = ended.stderr.lines().last().unwrap();
        assert!(last.contains("illumination-map (--planes)") && last.contains("4096"), "{last}");
        assert_eq!(runs.len(), 2);
    }
    assert_eq!(runs[0]["config"]["planes"], 3);
}

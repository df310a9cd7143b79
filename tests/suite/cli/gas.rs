//! `gas` through the binary: its passes, its record, its tables, and what it refuses.

use super::program::{ONCE, Program, assert_schema, entries, folder, gas, read_json};
use super::shaders::own_shaders;

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
    let froxels = ["density-table", "shadow-table", "froxel-inject", "froxel-integrate", "volume", "light-attenuation"];
    assert_eq!(names("froxel"), joined(&froxels));
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

/// Table 1 has a row for each time that the paper gives; figure 3's two are the only ones of one scene.
#[test]
fn table_1_is_written_with_the_ratios_beside_the_paper_s() {
    let out = folder();
    small("experiment 1 --out . --frames 1 --repeat 1 --warmup 1 --no-limits").inside(out.path()).run().succeeded();
    let record = read_json(&out.path().join("gas-1.json"));
    assert_schema(&record);
    let row = |run: &serde_json::Value| {
        assert!(run["experiment"]["interval"].is_null(), "of one frame: {}", run["experiment"]);
        let minutes = run["experiment"]["paper"].as_f64().unwrap() * 59.0;
        (run["experiment"]["row"].as_str().unwrap().to_owned(), minutes.round())
    };
    let mut rows: Vec<_> = record["runs"].as_array().unwrap().iter().map(row).collect();
    rows.sort_by(|a, b| a.0.cmp(&b.0));
    let expected = [
        ("fig-3 no-volume", 59.0),
        ("fig-3 none", 71.0),
        ("fig-4 no-volume", 105.0),
        ("fig-5 table", 260.0),
        ("fig-6 surfaces", 95.0),
        ("fig-7 surfaces", 165.0),
    ];
    assert_eq!(rows, expected.map(|(row, minutes)| (row.to_owned(), minutes)));
}

/// Every variant stands beside the paths, which have two pictures of their own and more light than what is scattered once.
#[test]
fn the_reference_is_set_beside_every_variant() {
    let out = folder();
    let small = "--size 30x20 --steps 12 --table 10 --froxels 12x8x10 --paths 6 --albedo 0.9 --quiet --out .";
    gas("experiment reference").args(small).on_test_device().inside(out.path()).run().succeeded();
    let variants = ["froxel", "none", "surfaces", "table", "traced"];
    let mut files: Vec<String> = variants.map(|variant| format!("gas-reference-{variant}-difference.png")).to_vec();
    files.extend(["-all.png", "-once.png", ".csv", ".json"].map(|suffix| format!("gas-reference{suffix}")));
    files.sort();
    assert_eq!(entries(out.path()), files);
    let table = read_json(&out.path().join("gas-reference.json"))["table"].clone();
    let rows = table["rows"].as_array().unwrap();
    let number = |gas: &str, column: &str| {
        let row = rows.iter().find(|row| row["gas"] == gas).unwrap_or_else(|| panic!("{gas}: {table}"));
        row[column].as_f64().unwrap()
    };
    assert_eq!(rows.len(), 8);
    assert!(number("scattered once", "light") < number("scattered at will", "light"), "{table}");
    let (noise, once) = (number("scattered at will", "rms"), number("scattered once", "rms"));
    assert!(noise > 0.0 && once > noise, "{table}");
    for variant in variants {
        assert!(number(variant, "rms") > noise && number(variant, "Luv mean") > 0.0, "{variant}: {table}");
    }
    assert_eq!(number("none", "rms"), number("surfaces", "rms"));
    assert!(number("traced, nearest ambient", "rms") <= number("traced", "rms") + noise, "{table}");
    let refused = |options: &str, parts: &[&str]| {
        gas("experiment reference --quiet").args(options).on_test_device().inside(out.path()).run().refused(2, parts);
    };
    refused("--preset fig-4", &["no volume"]);
    refused("--preset solid", &["solid", "--preset"]);
    refused("--paths 0", &["--paths 0"]);
    refused("--object teapot", &["--object", "no surfaces"]);
    refused("--frames 3", &["--frames", "times nothing"]);
    gas("experiment 2 --paths 3").run().refused(2, &["--paths"]);
}

/// The more froxels, the nearer to fine rays; the paper's table is measured beside them.
#[test]
fn froxels_are_swept_beside_the_table() {
    let out = folder();
    let small = "--size 60x42 --steps 12 --table 24 --froxels 60x42x48 --counts 6,1 --quiet --out .";
    let program = gas("experiment froxel").args(small).args(ONCE);
    program.on_test_device().inside(out.path()).run().succeeded();
    let files = ["-1-difference.png", "-6-difference.png", "-fine.png", "-table-difference.png", ".csv", ".json"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("gas-froxel{suffix}")));
    let table = read_json(&out.path().join("gas-froxel.json"))["table"].clone();
    let rows = table["rows"].as_array().unwrap();
    let of = |column: &str| rows.iter().map(|row| row[column].clone()).collect::<Vec<_>>();
    assert_eq!(of("variant"), ["table", "froxel", "froxel"]);
    assert_eq!(of("froxels"), [serde_json::Value::Null, "10x7x8".into(), "60x42x48".into()]);
    let means: Vec<f64> = of("Luv mean").iter().map(|mean| mean.as_f64().unwrap()).collect();
    assert!(means[2] < 0.6 * means[1] && means.iter().all(|&mean| mean > 0.0), "{table}");
    assert!(of("gas ms").iter().all(|ms| ms.as_f64().unwrap() > 0.0), "{table}");
}

/// Scales are measured in turn, by a bench and by their experiment, whose first row is what the others are set against.
#[test]
fn scales_of_the_gas_are_measured_in_turn() {
    let record = small("bench --json --variant none --volume-scale 1,3").args(ONCE).run().succeeded().json();
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let scales: Vec<u64> = runs.iter().map(|run| run["config"]["volume_scale"].as_u64().unwrap()).collect();
    assert_eq!(scales, [1, 3]);
    let samples: Vec<u64> = runs.iter().map(|run| run["results"]["samples"].as_u64().unwrap()).collect();
    assert!(samples[1] * 4 < samples[0] * 3, "{samples:?}");
    let out = folder();
    let small = "--preset fig-6 --counts 3 --size 48x32 --steps 6 --quiet --out .";
    gas("experiment volume-scale").args(small).args(ONCE).on_test_device().inside(out.path()).run().succeeded();
    let table = read_json(&out.path().join("gas-volume-scale.json"))["table"].clone();
    let rows = table["rows"].as_array().unwrap();
    let of = |column: &str| rows.iter().map(|row| row[column].as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(of("volume-scale"), [1.0, 3.0]);
    let (luv, samples) = (of("Luv mean"), of("samples"));
    assert!(luv[0] == 0.0 && luv[1] > 0.0 && samples[1] < samples[0], "{table}");
}

#[test]
fn a_sequence_is_each_picture_and_all_of_a_figure() {
    let out = folder();
    gas("experiment sequence --quiet --size 24x18 --steps 4 --out .")
        .on_test_device()
        .inside(out.path())
        .run()
        .succeeded();
    let frames = [(6, vec![0, 30, 60, 90, 120, 150]), (7, vec![0, 80, 160, 240, 320, 400, 440, 480, 520])];
    for (figure, frames) in frames {
        let strip = fumarole::image::read_png(&out.path().join(format!("gas-sequence-fig-{figure}.png"))).unwrap();
        assert_eq!((strip.width(), strip.height()), (3 * 24, frames.len() as u32 / 3 * 18));
        for (i, frame) in frames.iter().enumerate() {
            let file = out.path().join(format!("gas-sequence-fig-{figure}-{frame:04}.png"));
            let picture = fumarole::image::read_png(&file).unwrap();
            let (column, row) = (i % 3, i / 3);
            let first = 4 * ((row * 18) * 72 + column * 24);
            assert!(picture.pixels()[..4 * 24] == strip.pixels()[first..first + 4 * 24], "{}", file.display());
        }
    }
    assert_eq!(entries(out.path()).len(), 6 + 9 + 2);
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

/// Bands and vertex pulling change how the picture is made, and not what it shows; densities change the gas.
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

/// A preset's picture is its figure's: figures 3 and 5 have one scene, and differ in their shadowing.
#[test]
fn a_preset_is_drawn_in_its_figure_s_variant() {
    let out = folder();
    let drawn = |preset: &str, variant: &str| {
        small(&format!("render --quiet --out . --preset {preset}")).inside(out.path()).run().succeeded();
        std::fs::read(out.path().join(format!("gas-{variant}-0000.png"))).unwrap()
    };
    assert!(drawn("fig-3", "none") != drawn("fig-5", "table"));
    drawn("fig-4", "no-volume");
    drawn("fig-6", "surfaces");
    drawn("fig-7 --volume box,0,0.5,2,1,0.5,1", "surfaces");
    drawn("fig-4 --volume box,0,0.5,2,1,0.5,1", "table");
}

/// Each number of the gases changes the picture of a scene that has such a gas.
#[test]
fn every_number_of_the_gases_is_seen() {
    let out = folder();
    let draw = |options: &str| {
        small("render --quiet --variant none --image picture.png").args(options).inside(out.path()).run().succeeded();
        std::fs::read(out.path().join("picture.png")).unwrap()
    };
    for (scene, options) in [
        (
            "--preset fig-8",
            &[
                "--volume sphere,0.8,1,0,0.4,0.4,0.4",
                "--volume frustum,0.8,1,0,0.4,0.4,0.4,1,0.2",
                "--down 0.1",
                "--swirl-frames 90",
                "--ellipse 0.6,0.2",
                "--tau 3",
                "--albedo 0.2",
                "--falloff 0.1",
                "--phase 1,0,0,0",
                "--pixel-size 0.3",
                "--early-end 0.6",
                "--ambient 0.6,0.6,0.6",
                "--light 0,-1,0",
                "--point-light 0,3,2",
                "--camera 1,2,5,0,1,0",
                "--object teapot",
            ][..],
        ),
        (
            "--volume sphere,0.8,1,0,0.4,0.4,0.4",
            &["--gas-number 2:tau=40", "--gas-number 1:opaque=3", "--gas-number 2:density=clouds", "--tau 40"],
        ),
        ("--preset fig-4", &["--gas-number surfaces:opaque=0.4", "--gas-number surfaces:density=clouds"]),
        ("--preset fig-7", &["--front -2,0.017,2.5,0.8,0.6", "--full-fog 900", "--down 0.1"]),
        ("--density clouds", &["--frequency 9"]),
        ("--preset solid", &["--hypertexture 0.5,0.16", "--hypertexture 1.4,0.6"]),
        ("--preset fig-4", &["--volume box,0,0.5,2,1,0.5,1"]),
    ] {
        let mut pictures = vec![draw(scene)];
        for option in options {
            let picture = draw(&format!("{scene} {option}"));
            assert!(!pictures.contains(&picture), "{scene} {option}");
            pictures.push(picture);
        }
    }
}

/// The sampling of the gas and of its shadows.
#[test]
fn steps_table_and_threshold_are_seen() {
    let out = folder();
    let draw = |options: &str| {
        let render = gas("render --quiet --variant table --size 45x31 --image picture.png").args(options);
        render.on_test_device().inside(out.path()).run().succeeded();
        std::fs::read(out.path().join("picture.png")).unwrap()
    };
    let options = ["", " --shadow-threshold 0.3"].map(|o| format!("--steps 8 --table 8{o}"));
    let pictures = [&*options[0], &*options[1], "--steps 20 --table 8", "--steps 8 --table 30"].map(draw);
    for (i, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..i].contains(picture), "picture {i}");
    }
}

#[test]
fn what_no_gas_heeds_is_refused() {
    for (options, parts) in [
        ("--preset fig-4 --tau 2", &["--tau", "no volume", "--volume"][..]),
        ("--preset fig-4 --density fog", &["--density", "--volume"]),
        ("--frequency 3", &["--frequency", "--density clouds"]),
        ("--preset fig-3 --down 0.1", &["--down", "--density fog or steam"]),
        ("--front 0,1,1,1,1", &["--front", "--density fog"]),
        ("--full-fog 10", &["--full-fog", "--density fog"]),
        ("--hypertexture 1,0.2", &["--hypertexture", "--density hypertexture"]),
        ("--preset solid --phase 1,0,0,0", &["--phase", "solids have normals"]),
        ("--preset fig-7 --front 0,1,0,1,1", &["--front 0,1,0,1,1", "depth above 0"]),
        ("--preset fig-7 --full-fog -1", &["--full-fog -1"]),
        ("--swirl-frames -1", &["--swirl-frames -1"]),
        ("--ellipse 1,99999", &["--ellipse 1,99999"]),
        ("--preset solid --hypertexture 1,0", &["--hypertexture 0", "softness"]),
        ("--preset fig-4 --density-cache 8", &["--density-cache", "no volume", "--volume"]),
        ("--preset fig-4 --march delta", &["--march", "no volume", "--volume"]),
        ("--bricks 8", &["--bricks", "--skip-empty", "--march delta"]),
        ("--march delta --steps 9", &["--steps", "--march delta", "--samples"]),
        ("--march delta --jitter blue-noise", &["--jitter blue-noise", "--march delta"]),
        ("--density-cache 1", &["--density-cache 1"]),
        ("--volume-scale 0", &["--volume-scale 0", "1 to 16"]),
        ("--volume-scale 17", &["--volume-scale 17"]),
        ("--preset fig-4 --volume-scale 2", &["--volume-scale", "no volume"]),
        ("--skip-empty -1", &["--skip-empty -1"]),
        ("--gas-number 2:tau=1", &["--gas-number 2:tau=1", "no such volume", "--volume"]),
        ("--gas-number 1:tau=-1", &["--tau -1"]),
        ("--gas-number 1:frequency=2", &["--gas-number 1:frequency=2", "--frequency"]),
        ("--gas-number surfaces:opaque=1", &["--gas-number surfaces:opaque=1", "--preset fig-4"]),
        ("--preset fig-4 --gas-number surfaces:tau=1", &["no --tau"]),
        ("--volume box,0,0,0,1,0,1", &["--volume 1,0,1", "half extents"]),
        ("--volume frustum,0,0,0,1,1,1,0,0", &["--volume 0,0", "radii"]),
    ] {
        gas("render").on_test_device().args(options).run().refused(2, parts);
    }
    gas(&format!("render {}", "--volume sphere,0,0,0,1,1,1 ".repeat(8))).run().refused(2, &["--volume 9", "8"]);
    gas("render --volume ball,0,0,0,1,1,1").run().misused(&["--volume", "sphere"]);
    gas("render --gas-number 1:colour=3").run().misused(&["--gas-number", "frequency"]);
    gas("render --gas-number tau=3").run().misused(&["--gas-number", "2:tau=0.5"]);
    gas("experiment 2 --frequency 3").run().refused(2, &["--frequency"]);
}

#[test]
fn what_cannot_be_is_refused_by_its_option() {
    for (options, parts) in [
        ("--steps 0", &["--steps 0", "1 to 100000"][..]),
        ("--table 1", &["--table 1"]),
        ("--table 513", &["--table 513"]),
        ("--froxels 0x1x1", &["--froxels 0x1x1"]),
        ("--froxels 9x9x1025", &["--froxels 9x9x1025"]),
        ("--tau -1", &["--tau -1"]),
        ("--albedo 1.5", &["--albedo"]),
        ("--falloff 2", &["--falloff 2"]),
        ("--phase 0.5,0.5,0.2,0", &["--phase", "add up to 1"]),
        ("--pixel-size 0", &["--pixel-size 0"]),
        ("--shadow-threshold -1", &["--shadow-threshold -1"]),
        ("--early-end 2", &["--early-end 2"]),
        ("--light 0,0,0", &["--light 0,0,0"]),
        ("--point-light 0,1001,0", &["--point-light 0,1001,0", "1000 metres from the origin"]),
        ("--size 0x0", &["--size 0x0"]),
        ("--opaque -1", &["--opaque -1"]),
        ("--power 0", &["--power 0"]),
        ("--texture-scale 0", &["--texture-scale 0"]),
        ("--list-bytes 10", &["--list-bytes 10", "at least 4096"]),
        // A row of glass wants more than its four fragments a pixel, and a row is the least that is done at once.
        ("--preset fig-6 --size 60x8 --list-bytes 4096", &["--list-bytes allows 4096", "--size"]),
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

/// Each way to the lists has its passes; a bench measures several in turn and says which is which, other verbs take one.
#[test]
fn ways_to_the_lists_are_measured_in_turn() {
    let ended = small("bench --json --variant no-volume --lists linked,tiles,k:4").args(ONCE).run();
    let record = ended.succeeded().json();
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let lists: Vec<_> = runs.iter().map(|run| run["config"]["lists"].as_str().unwrap()).collect();
    assert_eq!(lists, ["linked", "tiles", "k:4"]);
    let names = |run: &serde_json::Value| -> Vec<String> {
        run["passes"].as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&runs[0]), ["empty-lists", "fragments", "sort", "resolve"]);
    let tiles = ["tiles-empty", "tiles-count", "tiles-sum", "tiles-fill", "tiles-pixels"];
    assert_eq!(names(&runs[1]), [&["empty-lists"], &tiles[..], &["fragments", "sort", "resolve"]].concat());
    assert_eq!(names(&runs[2]), names(&runs[1]));
    let lost: Vec<_> = runs.iter().map(|run| run["results"]["lost_pixels"].as_u64()).collect();
    assert!(matches!(lost[..], [None, None, Some(1..)]), "{lost:?}");
    let warnings = runs[2]["warnings"].to_string();
    assert!(warnings.contains(&format!("k:4: {} of 1395 pixels lose", lost[2].unwrap())), "{warnings}");
    let found: Vec<u64> = runs.iter().map(|run| run["results"]["fragments"].as_u64().unwrap()).collect();
    let slots = |run: &serde_json::Value| run["results"]["fragment_slots"].as_u64().unwrap();
    assert_eq!(slots(&runs[0]), found[0], "linked lists fill their slots");
    assert_eq!(slots(&runs[2]), 4 * 45 * 31);
    // Behind what hides all, tiles and the k-buffer keep less; neither keeps what it only reserves.
    assert!(found[1] <= found[0] && found[2] <= found[1] && found[2] > 0, "{found:?}");
    assert!(found[1] <= slots(&runs[1]) && found[2] < slots(&runs[2]), "{found:?}");
    small("bench --lists tiles,k:4,tiles").run().refused(2, &["--lists", "tiles", "twice"]);
    small("bench --density-cache 8,off,8").run().refused(2, &["--density-cache", "8", "twice"]);
    small("render --lists linked,tiles --image never.png").run().refused(2, &["give one"]);
    small("render --lists k:0 --image never.png").run().misused(&["k:1 to k:32"]);
}

/// Counts of fragments and of sections end below 2^32: what would come round to slots that others hold is refused. They begin
/// shortly before it here, which a picture of billions of fragments would take long to reach.
#[test]
fn counts_that_would_come_round_are_refused() {
    for (count, options) in [
        ("fragment_count", "--variant no-volume"),
        ("fragment_count", "--lists tiles"),
        ("section_count", "--variant none"),
    ] {
        let out = folder();
        let path = own_shaders(out.path()).join("gas/empty-lists.comp");
        let (text, zero) = (std::fs::read_to_string(&path).unwrap(), format!("{count} = 0u;"));
        assert!(text.contains(&zero), "{text}");
        std::fs::write(&path, text.replace(&zero, &format!("{count} = 0xfff00000u;"))).unwrap();
        let ended = small("render --quiet --shader-dir my-shaders").args(options).inside(out.path()).run();
        ended.refused(2, &[count.split('_').next().unwrap(), "--size"]);
    }
}

//! `burning` through the binary: its passes, its record, its experiments, and what it refuses.

use std::fs;
use std::path::Path;

use fumarole::image::{Rgba8, write_png};
use serde_json::Value;

use super::program::{ONCE, Program, assert_schema, burning, device, entries, folder, fumarole, read_json};
use crate::faults::Layer;

/// A fast fire of few triangles.
pub(super) const SMALL: &str = "--size 48x32 --blocks 3x3x3 --fire 60 --smoke 30 --speed 1 --flammability 10";
const BALL: &str = "--mesh sphere --triangles 300";
/// As `ONCE`, for what finds its frames itself.
pub(super) const BRIEF: &str = "--repeat 1 --warmup 1 --no-limits";

/// Of every tick and frame.
const SHELL: [&str; 10] = [
    "heat-boundary",
    "internal-deformation",
    "block-weights",
    "block-rotation",
    "flames",
    "vertex-mapping",
    "surface-removal",
    "normals",
    "draw",
    "draw-fire",
];

fn small(verb: &str) -> Program {
    burning(verb).args(SMALL).on_test_device()
}

fn names(passes: &Value) -> Vec<&str> {
    passes.as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap()).collect()
}

#[test]
fn the_passes_follow_the_chapters() {
    let listed = small("passes --json --variant all --levels 1").args(BALL).run().succeeded().json();
    assert_eq!(listed.as_array().unwrap().len(), 5);
    let text = small("passes --json --variant all --levels 1 --look dissertation").args(BALL).run().succeeded().json();
    for (listed, text) in listed.as_array().unwrap().iter().zip(text.as_array().unwrap()) {
        let mut passes = SHELL.to_vec();
        let variant = listed["variant"].as_str().unwrap();
        if ["low-poly", "solid", "melting"].contains(&variant) {
            passes.insert(1, "refinement");
        }
        assert_eq!(names(&text["passes"]), passes, "{variant}");
        // Ours: what nothing holds falls, onto the ground.
        let before = |name: &str| passes.iter().position(|pass| *pass == name).unwrap();
        let (flames, fire) = (before("flames"), before("draw-fire"));
        passes.insert(fire, "draw-ground");
        if variant == "melting" {
            passes.insert(fire + 1, "draw-puddle");
            passes.insert(flames, "puddle");
        }
        let draw = passes.iter().position(|pass| *pass == "draw").unwrap();
        passes.insert(draw, "flame-lights");
        passes.push("tone");
        if variant != "melting" {
            passes.splice(flames..flames, ["parts", "bending", "falling"]);
        }
        assert_eq!(names(&listed["passes"]), passes, "{variant}");
        // Everything static is uploaded once (3.7.4): no pass of a frame moves data between host and device.
        let mut kinds = listed["passes"].as_array().unwrap().iter().map(|pass| pass["kind"].as_str().unwrap());
        assert!(kinds.all(|kind| ["compute", "graphics"].contains(&kind)), "{listed}");
    }
    let loading = small("passes --json --variant shell --no-preload").args(BALL).run().succeeded().json();
    assert_eq!(names(&loading[0]["passes"])[0], "loading");
    assert_eq!(loading[0]["passes"][0]["kind"], "transfer");
    let unlit = burning("passes --json --variant shell --fire 0 --smoke 0 --size 48x32").on_test_device();
    let unlit = unlit.run().succeeded().json();
    assert!(!names(&unlit[0]["passes"]).iter().any(|name| ["flames", "flame-lights", "draw-fire"].contains(name)));
}

#[test]
fn a_bench_says_what_burns() {
    let bench = small("bench --json --quiet --validate --variant shell,low-poly,fully-subdivided --levels 1");
    let record = bench.args(BALL).args("--first-frame 30").args(ONCE).run().succeeded().json();
    assert_schema(&record);
    for run in record["runs"].as_array().unwrap() {
        assert_eq!((&run["paper"], &run["validation"]), (&"burning".into(), &"clean".into()));
        let results = &run["results"];
        let count = |name: &str| results[name].as_u64().unwrap_or_else(|| panic!("{name}: {results}"));
        assert_eq!(count("ticks"), 31);
        assert!(count("active_triangles") > 0 && count("active_triangles") <= count("finest_triangles"), "{results}");
        assert!(count("active_vertices") <= count("live_vertices") && count("live_vertices") <= count("vertices"));
        assert!(count("occupied_blocks") > 0 && count("occupied_blocks") <= 27, "{results}");
        assert!(count("fire_particles") > 0 && count("fire_particles") <= 60, "{results}");
        if run["variant"] == "low-poly" {
            assert!(count("refined_coarse_triangles") <= count("coarse_triangles"), "{results}");
        } else {
            assert!(results["refined_coarse_triangles"].is_null());
            assert_eq!(count("drawn_triangles") + count("removed_triangles"), count("finest_triangles"), "{results}");
        }
    }
}

#[test]
fn presets_are_the_dissertation_s_objects() {
    for (preset, variant, triangles, fire, smoke) in [
        ("3.8", "shell", 15_949, 3000, 1800),
        ("box", "low-poly", 12, 2000, 500),
        ("door", "low-poly", 12, 2000, 500),
        ("solid-45k", "solid", 45_000, 2000, 500),
        ("melt-40k", "melting", 40_000, 2000, 500),
    ] {
        let bench = burning("bench --json --quiet --size 16x12 --levels 0").on_test_device();
        let record = bench.args("--preset").arg(preset).args("--frames 1").args(BRIEF).run().succeeded().json();
        let run = &record["runs"][0];
        assert_eq!((&run["preset"], &run["variant"]), (&preset.into(), &variant.into()));
        let config = &run["config"];
        // Splitting and simplifying change a few triangles at a time.
        assert!(config["triangles"].as_i64().unwrap().abs_diff(triangles) <= 4, "{preset}: {}", config["triangles"]);
        assert_eq!((&config["fire"], &config["smoke"]), (&fire.into(), &smoke.into()), "{preset}");
    }
    let over = "bench --json --quiet --preset box --fire 7 --blocks 15x15x15 --levels 0 --size 16x12 --frames 1";
    let record = burning(over).args(BRIEF).on_test_device().run().succeeded().json();
    let config = &record["runs"][0]["config"];
    assert_eq!((&config["fire"], &config["smoke"]), (&7.into(), &500.into()));
    assert_eq!(config["blocks"], serde_json::json!([15, 15, 15]));
}

#[test]
fn a_preset_chooses_its_method_unless_one_is_named() {
    let out = folder();
    small("render --quiet --preset solid-45k --triangles 300 --out .").inside(out.path()).run().succeeded();
    small("render --quiet --preset solid-45k --triangles 300 --out . --variant shell")
        .inside(out.path())
        .run()
        .succeeded();
    assert_eq!(entries(out.path()), ["burning-shell-0000.png", "burning-solid-0000.png"]);
    let listed = |options: &str| {
        let listed = small(&format!("passes --json --levels 1 {options}")).run().succeeded().json();
        listed.as_array().unwrap().iter().map(|l| l["variant"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(listed("--preset door"), ["low-poly"]);
    assert_eq!(listed("--preset door --variant fully-subdivided,shell"), ["shell", "fully-subdivided"]);
    let bench = small("bench --json --quiet --preset melt-40k --triangles 300 --variant solid").args(ONCE);
    let runs = bench.run().succeeded().json()["runs"].clone();
    assert_eq!((runs.as_array().unwrap().len(), &runs[0]["variant"]), (1, &"solid".into()));
}

#[test]
fn a_picture_covers_the_mesh() {
    let out = folder();
    let picture = |width: u32, height: u32, color: [u8; 4]| {
        Rgba8::new(width, height, color.repeat((width * height) as usize)).unwrap()
    };
    let write = |name: &str, picture: &Rgba8| write_png(&out.path().join(name), picture).unwrap();
    write("blue.png", &picture(4, 4, [0, 0, 255, 255]));
    write("dot.png", &picture(1, 1, [0, 0, 255, 0]));
    write("wide.png", &picture(8193, 1, [9; 4]));
    let whole = fs::read(out.path().join("blue.png")).unwrap();
    fs::write(out.path().join("cut.png"), &whole[..whole.len() / 2]).unwrap();
    fs::write(out.path().join("no.png"), "not a picture").unwrap();
    let cold = |options: &str| {
        let render = small("render --quiet --source 900,0,0 --image out.png").args(options).inside(out.path());
        render.run().succeeded();
        fumarole::image::read_png(&out.path().join("out.png")).unwrap()
    };
    // The file's alpha does not count, and one texel is a picture.
    let blue = cold("--mesh box --texture blue.png");
    assert!(blue == cold("--mesh box --texture dot.png"));
    let count = |picture: &Rgba8| picture.pixels().chunks_exact(4).filter(|p| p[2] > 100 && p[0] == 0).count();
    assert!(count(&blue) > 300 && count(&cold("--mesh box")) == 0);
    assert_eq!(count(&cold("--mesh box --texture blue.png --albedo 1,1,0")), 0, "the albedo is a factor");
    let bench = small("bench --json --quiet --mesh box --texture blue.png").args(ONCE).inside(out.path());
    let config = bench.run().succeeded().json()["runs"][0]["config"].clone();
    assert_eq!((&config["texture"], &config["material"]), (&"blue.png".into(), &Value::Null));
    for (options, parts) in [
        ("--mesh box --texture gone.png", &["gone.png"][..]),
        ("--mesh box --texture cut.png", &["cut.png"]),
        ("--mesh box --texture no.png", &["no.png"]),
        ("--mesh box --texture .", &["opening picture ."]),
        ("--mesh box --texture wide.png", &["wide.png", "8193 x 1", "8192"]),
        ("--mesh bunny --texture blue.png", &["--texture blue.png", "bunny", "texture coordinates"]),
    ] {
        small("render").args(options).inside(out.path()).run().refused(2, parts);
    }
    small("render --texture blue.png --material wood").run().misused(&["--texture", "--material"]);
}

#[test]
fn a_picture_and_its_dumps() {
    let out = folder();
    let render = small("render --quiet --frame 40 --image fire.png --dump state=state.npy --dump depth=depth.exr");
    render.args(BALL).inside(out.path()).run().succeeded();
    assert_eq!(entries(out.path()), ["depth.exr", "fire.png", "state.npy"]);
    small("render --quiet --frame 39..41 --image of.png").args(BALL).inside(out.path()).run().succeeded();
    let read = |name: &str| fs::read(out.path().join(name)).unwrap();
    assert!(read("fire.png") == read("of-0040.png") && read("of-0039.png") != read("of-0040.png"));
}

#[test]
fn counters_and_flags_are_dumped_as_the_integers_that_they_are() {
    let out = folder();
    let kinds = [
        ("labels", "u4", 1),
        ("triangle-labels", "u4", 1),
        ("alive", "u4", 1),
        ("removed", "u4", 1),
        ("cells", "u4", 1),
        ("triangles", "u4", 3),
        ("corners", "u4", 3),
        ("welds", "u4", 1),
        ("clock", "u4", 11),
        ("stream", "u4", 3),
        ("flame-groups", "u4", 4),
        ("blocks", "i4", 8),
        ("statuses", "i4", 1),
        ("state", "f4", 4),
    ];
    let mut render = small("render --quiet --preset box --levels 2 --frame 30 --image fire.png");
    for (name, ..) in kinds {
        render = render.arg("--dump").arg(format!("{name}={name}.npy"));
    }
    render.inside(out.path()).run().succeeded();
    let values = |name: &str, kind: &str, columns: usize| -> Vec<[u8; 4]> {
        let bytes = fs::read(out.path().join(format!("{name}.npy"))).unwrap();
        let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let header = String::from_utf8_lossy(&bytes[10..end]).into_owned();
        let data: Vec<[u8; 4]> = bytes[end..].chunks_exact(4).map(|b| b.try_into().unwrap()).collect();
        let shape = format!("({}, {columns}, )", data.len() / columns);
        assert!(header.contains(&format!("'<{kind}'")) && header.contains(&shape), "{name}: {header}");
        data
    };
    let words = |name: &str, kind: &str, columns| -> Vec<i64> {
        let number =
            |b: [u8; 4]| if kind == "i4" { i32::from_le_bytes(b).into() } else { u32::from_le_bytes(b).into() };
        values(name, kind, columns).into_iter().map(number).collect()
    };
    let all: Vec<Vec<i64>> = kinds.iter().map(|(name, kind, columns)| words(name, kind, *columns)).collect();
    let [
        labels,
        triangle_labels,
        alive,
        removed,
        cells,
        triangles,
        corners,
        welds,
        clock,
        stream,
        _,
        blocks,
        statuses,
        _,
    ] = &all[..]
    else {
        panic!()
    };
    // Ticks, and of the drawn triangles, each of draw vertices, nothing beyond the object.
    let drawn = clock[8] as usize;
    assert!(clock[0] == 31 && (12..=12 * 16).contains(&drawn), "{clock:?}");
    assert!(stream[..3 * drawn].iter().all(|corner| (0..welds.len() as i64).contains(corner)));
    assert!(corners.iter().map(|corner| welds[*corner as usize]).eq(triangles.iter().copied()));
    assert!(labels.contains(&4) && labels.iter().chain(triangle_labels).all(|l| (0..=4).contains(l)));
    assert!(alive.iter().chain(removed).all(|f| (0..=1).contains(f)) && cells.iter().all(|c| (0..27).contains(c)));
    assert!((removed.len(), statuses.len()) == (12 * 16, 12 * 21) && statuses.contains(&-1) && statuses.contains(&1));
    // The sums of signs go both ways.
    assert!(blocks.iter().any(|b| *b < 0) && blocks.iter().any(|b| *b > 0), "{blocks:?}");
    let passes = small("passes --preset box --levels 2").run().succeeded();
    for part in ["labels (", " of 1 u32)", " of 8 i32)", " of 4 f32)"] {
        assert!(passes.stdout.contains(part), "{part}: {}", passes.stdout);
    }
}

#[test]
fn every_kind_of_file_burns() {
    let out = folder();
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/meshes");
    for file in [
        "spider.obj",
        "concave_polygon.obj",
        "wuson.stl",
        "cube_binary.ply",
        "Mesh_PrimitiveMode_05.gltf",
        "teapot.obj",
    ] {
        for variant in ["shell", "melting"] {
            let bench =
                small(&format!("bench --json --quiet --first-frame 20 --frames 1 --levels 0 --variant {variant}"));
            let bench = bench.arg("--mesh").arg(meshes.join(file)).args(BRIEF);
            let record = bench.inside(out.path()).run().succeeded().json();
            let results = &record["runs"][0]["results"];
            // Where the fire was lit nothing is left to burn.
            let [live, all] = ["live_vertices", "vertices"].map(|name| results[name].as_u64().expect(name));
            assert!(live < all, "{file} {variant}: {results}");
        }
    }
}

#[test]
fn a_stretched_mesh_is_another() {
    let out = folder();
    small("render --quiet --mesh box --image cube.png").inside(out.path()).run().succeeded();
    small("render --quiet --mesh box --stretch 1,2,0.1 --image door.png").inside(out.path()).run().succeeded();
    let read = |name: &str| fs::read(out.path().join(name)).unwrap();
    assert!(read("cube.png") != read("door.png"));
}

#[test]
fn a_source_too_far_away_burns_nothing_and_says_so() {
    let far = small("bench --json --quiet --source 900,0,0 --first-frame 30").args(BALL).args(ONCE);
    let run = far.run().succeeded().json()["runs"][0].clone();
    assert!(run["warnings"].to_string().contains("nothing burns"), "{}", run["warnings"]);
    assert_eq!((&run["results"]["active_vertices"], &run["results"]["removed_triangles"]), (&0.into(), &0.into()));
    // An experiment has no frame to measure then.
    let far = small("experiment 3.8 --quiet --source 900,0,0").args("--triangles 300").args(ONCE);
    far.run().refused(2, &["nothing burns", "--source"]);
}

#[test]
fn a_frame_rate_stands_beside_the_dissertation_s() {
    for (name, frames_per_s, variant) in [("3.8", 70.0, "shell"), ("5.5", 60.0, "solid"), ("6.5", 60.0, "melting")] {
        let out = folder();
        let experiment = small(&format!("experiment {name} --triangles 300 --out .")).args(ONCE).inside(out.path());
        let ended = experiment.run().succeeded();
        let file = |ending: &str| format!("burning-{name}.{ending}");
        assert_eq!(entries(out.path()), ["csv", "json", "svg"].map(file));
        let record = read_json(&out.path().join(file("json")));
        assert_schema(&record);
        let run = &record["runs"][0];
        assert_eq!((&run["variant"], &run["experiment"]["paper"]), (&variant.into(), &frames_per_s.into()));
        // At the busiest frame there is fire.
        assert!(run["results"]["fire_particles"].as_u64().unwrap() > 0, "{}", run["results"]);
        assert!(run["config"]["first_frame"].as_u64().unwrap() > 0);
        assert!(ended.stdout.contains(&format!("the dissertation: {frames_per_s}")), "{}", ended.stdout);
    }
}

#[test]
fn table_4_2_measures_until_half_is_refined() {
    let out = folder();
    let experiment = small("experiment 4.2 --levels 2 --out .").args(BRIEF).inside(out.path());
    let ended = experiment.run().succeeded();
    let files = ["-curves.csv", "-passes.csv", "-tables.json", ".csv", ".json", ".svg"];
    assert_eq!(entries(out.path()), files.map(|suffix| format!("burning-4.2{suffix}")));
    let record = read_json(&out.path().join("burning-4.2.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    // Four boxes, without and with particles, two methods.
    assert_eq!(runs.len(), 16);
    for (pair, (coarse, speed_up)) in runs.chunks(4).zip([(12, 1.96), (16, 2.09), (20, 2.43), (48, 1.25)]) {
        for (at, run) in pair.iter().enumerate() {
            assert_eq!(run["results"]["finest_triangles"], coarse * 16);
            assert_eq!(
                (&run["experiment"]["paper"], &run["config"]["fire"]),
                (&speed_up.into(), &[0, 60][at / 2].into())
            );
            assert_eq!(run["variant"], ["low-poly", "fully-subdivided"][at % 2]);
            assert_eq!(run["frames"], pair[0]["frames"]);
        }
    }
    let curves = fs::read_to_string(out.path().join("burning-4.2-curves.csv")).unwrap();
    let shares: Vec<f64> =
        curves.lines().skip(1).map(|line| line.split(',').nth(2).unwrap().parse().unwrap()).collect();
    assert_eq!(shares.iter().filter(|&&share| share >= 0.5).count(), 4, "{curves}");
    assert!(ended.stdout.contains("speed-up") && ended.stdout.contains("2.43"), "{}", ended.stdout);
}

#[test]
fn a_fire_paced_by_the_clock_records_every_frame_s_share() {
    let paced = small("experiment pace --frames 12 --frame-rate 1000 --quiet --json");
    let document = paced.args(BALL).run().succeeded().json();
    let rows = document["table"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 12);
    let mut due = 0;
    for row in rows {
        let share = row["share of a tick, 64ths"].as_u64().unwrap();
        assert!((1..=64).contains(&share), "{row}");
        due += share;
        assert_eq!(row["ticks"].as_u64().unwrap(), (due / 64).max(1), "{rows:?}");
    }
    assert!(due < 12 * 64, "no frame took a millisecond: {rows:?}");
    burning("bench --frame-rate 30").run().misused(&["--frame-rate"]);
}

#[test]
fn strips_are_pictures() {
    let out = folder();
    let strips = burning("experiment sequence --figures 3.2,5.1 --moments 2,30 --quiet --out .").args(SMALL);
    strips.args("--triangles 200").on_test_device().inside(out.path()).run().succeeded();
    assert_eq!(entries(out.path()), ["burning-sequence-3.2.png", "burning-sequence-5.1.png"]);
    let picture = fumarole::image::read_png(&out.path().join("burning-sequence-3.2.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (2 * 48, 2 * 32));
}

#[test]
fn what_cannot_be_is_refused_by_its_option() {
    for (options, parts) in [
        ("--blocks 0x1x1", &["--blocks 0x1x1"][..]),
        ("--blocks 257x1x1", &["--blocks 257x1x1"]),
        ("--flammability 0", &["--flammability 0", "1 to 1000000"]),
        ("--epsilon 0", &["--epsilon 0", "above 0 and below 1"]),
        ("--beta 1", &["--beta 1"]),
        ("--rho 1.5", &["--rho 1.5"]),
        ("--phi -0.5", &["--phi -0.5"]),
        ("--gamma 0", &["--gamma 0"]),
        ("--omega 1", &["--omega 1"]),
        ("--chi 1", &["--chi 1", "2 to 1000"]),
        ("--upsilon 0", &["--upsilon 0"]),
        ("--psi 0", &["--psi 0"]),
        ("--speed 0", &["--speed 0"]),
        ("--area-width 0", &["--area-width 0"]),
        ("--levels 6", &["--levels 6"]),
        ("--triangles 3", &["--triangles 3"]),
        ("--stretch 1,0,1", &["--stretch 1,0,1"]),
        ("--stretch 1,1,1001", &["--stretch 1,1,1001"]),
        ("--time-division 0", &["--time-division 0"]),
        ("--fire 1000001", &["--fire 1000001"]),
        ("--size 0x0", &["--size 0x0"]),
        ("--mesh no-such.obj", &["no-such.obj"]),
    ] {
        burning("bench").on_test_device().args(options).args(ONCE).run().refused(2, parts);
    }
    let fine = burning("bench --levels 5 --triangles 20000").on_test_device().args(ONCE);
    Layer::new().least(fine).run().refused(2, &["(--levels)", "limit"]);
    for option in
        ["epsilon", "beta", "rho", "phi", "gamma", "psi", "speed", "area-width", "chi", "upsilon", "time-step"]
    {
        for value in ["nan", "inf", "two", ""] {
            burning("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
    for (option, value) in [
        ("preset", "3.9"),
        ("source", "1,2"),
        ("source", "1,nan,2"),
        ("stretch", "1,2"),
        ("blocks", "6x7"),
        ("lod", "far"),
    ] {
        burning("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
    }
}

#[test]
fn an_experiment_refuses_what_it_would_not_heed() {
    for (options, part) in [
        ("3.8 --first-frame 3", "--first-frame"),
        ("3.8 --figures 3.1", "--figures"),
        ("3.8 --preset box", "--preset"),
        ("4.2 --frames 5", "--frames"),
        ("4.2 --triangles 50", "--triangles"),
        ("blocks --blocks 2x2x2", "--blocks"),
        ("limits --active-limit 5", "--active-limit"),
        ("limits --no-preload", "--no-preload"),
        ("limits --counts 5", "--counts"),
        ("active --flammability 5", "--flammability"),
        ("active --first-frame 5", "--first-frame"),
        ("laws --look dissertation", "--look"),
        ("pace --time-division 2", "--time-division"),
        ("limits --frame-rate 30", "--frame-rate"),
        ("scaling --triangles 50", "--triangles"),
        ("scaling --counts 2", "--triangles 2"),
        ("sequence --json", "--json"),
        ("sequence --moments 5,5", "--moments"),
        ("5.5 --epsilon 1", "--epsilon 1"),
    ] {
        burning(&format!("experiment {options}")).on_test_device().run().refused(2, &[part]);
    }
}

#[test]
fn the_umbrella_runs_it_too() {
    let listed =
        fumarole("burning passes --json").args(SMALL).args(BALL).arg("--device").arg(device()).run().succeeded().json();
    assert_eq!(listed[0]["paper"], "burning");
}

/// A pass of several steps has the blend states of all: a layer of fire is laid over the picture by the last of its steps.
#[test]
fn what_a_later_step_blends_is_told() {
    let listed = small("passes --json --variant shell --look dissertation").args(BALL).run().succeeded().json();
    let passes = listed[0]["passes"].as_array().unwrap();
    let fire = passes.iter().find(|pass| pass["name"] == "draw-fire").unwrap();
    assert_eq!((&fire["kind"], &fire["blend"]), (&"compute".into(), &serde_json::json!(["premultiplied over"])));
}

//! `terrain` through the binary: its passes, its record, its table, its maps, and what it refuses.

use std::collections::BTreeSet;
use std::fs;

use fumarole::image::read_png;
use fumarole::scene::random::Random;

use super::program::{ONCE, Program, assert_schema, entries, file, folder, read_json, terrain};
use crate::faults::Layer;

const SMALL: &str = "--size 64x48";

pub fn small(verb: &str) -> Program {
    terrain(verb).args(SMALL).on_test_device()
}

#[test]
fn the_passes_are_the_paper_s_in_every_variant() {
    let listed = small("passes --json --resolution 64 --variant cpu,gpu-compute,gpu-fragment").run().succeeded().json();
    for variant in listed.as_array().unwrap() {
        let names: Vec<&str> =
            variant["passes"].as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["geometric-transformation", "depth", "normal", "illumination"], "{}", variant["variant"]);
    }
}

#[test]
fn table_1_is_written_with_growth_beside_the_paper_s() {
    let out = folder();
    let sweep = "experiment 1 --counts 128,512 --variant cpu,gpu-compute --out .";
    let enough = "--frames 5 --repeat 1 --warmup 1 --no-limits";
    let ended = small(sweep).args(enough).inside(out.path()).run().succeeded();
    assert_eq!(entries(out.path()), ["terrain-1.csv", "terrain-1.json", "terrain-1.svg"]);
    let record = read_json(&out.path().join("terrain-1.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for run in runs {
        assert!(run["results"]["mrays_per_s"].as_f64().unwrap() > 0.0, "{run}");
    }
    for (run, resolution, growth) in
        [(&runs[0], 128, 1.0), (&runs[2], 512, 2033.6 / 802.65), (&runs[3], 512, 42.51 / 21.09)]
    {
        assert_eq!(run["config"]["resolution"], resolution);
        let paper = &run["results"]["growth"]["paper"];
        assert!((paper.as_f64().unwrap() - growth).abs() < 1e-9, "{paper}");
    }
    // The row of the table is the time over that of the processor, measured in turn, with its interval.
    assert_eq!(runs[2]["experiment"]["row"], "512 samples a side: growth");
    let (row, over_cpu) = (&runs[3]["experiment"], &runs[3]["results"]["over_cpu"]);
    assert_eq!(row["row"], "512 samples a side: over cpu");
    assert!((row["paper"].as_f64().unwrap() - 42.51 / 2033.6).abs() < 1e-9, "{row}");
    assert_eq!((&row["ours"], &row["interval"]), (&over_cpu["ratio"], &over_cpu["interval"]));
    assert!(row["interval"][0].as_f64().unwrap() <= row["interval"][1].as_f64().unwrap(), "{row}");
    assert!(ended.stdout.contains("growth"), "{}", ended.stdout);
}

#[test]
fn the_mesh_of_a_map_that_is_too_large_is_a_row_without_times() {
    let out = folder();
    let sweep = "experiment 1 --counts 4224 --variant gpu-compute,mesh --out .";
    let ended = small(sweep).args(ONCE).inside(out.path()).run().succeeded();
    let record = read_json(&out.path().join("terrain-1.json"));
    assert_schema(&record);
    let mesh = &record["runs"][1];
    assert_eq!((&mesh["variant"], &mesh["frame_ms"]), (&"mesh".into(), &serde_json::Value::Null));
    assert!(mesh["warnings"].to_string().contains("4096"), "{mesh}");
    assert!(ended.stdout.contains("the mesh stops at 4096"), "{}", ended.stdout);
}

#[test]
fn screens_and_interpolations_are_swept() {
    let out = folder();
    let sweep = "experiment screen --counts 32,64 --resolution 64 --variant cpu,gpu-fragment --out .";
    terrain(sweep).on_test_device().args(ONCE).inside(out.path()).run().succeeded();
    let record = read_json(&out.path().join("terrain-screen.json"));
    assert_schema(&record);
    let widths: Vec<_> = record["runs"].as_array().unwrap().iter().map(|run| run["width"].as_u64().unwrap()).collect();
    assert_eq!(widths, [32, 32, 64, 64]);
    let sweep = "experiment interpolation --resolution 64 --variant gpu-compute --out .";
    small(sweep).args(ONCE).inside(out.path()).run().succeeded();
    let record = read_json(&out.path().join("terrain-interpolation.json"));
    assert_schema(&record);
    assert_eq!(record["runs"].as_array().unwrap().len(), 4);
    let picture = |name: &str| fs::read(out.path().join(format!("terrain-interpolation-{name}.png"))).unwrap();
    assert!(picture("bilinear-exact") != picture("bicubic-exact"));
    assert!(picture("bilinear-pixel") != picture("bicubic-pixel"));
}

/// One ramp for all sizes: only a ray that took the most steps is the lightest, and rays that met no map are black.
#[test]
fn steps_are_drawn_as_heat() {
    let out = folder();
    let ended = small("experiment steps --counts 64,512 --out .").args(ONCE).inside(out.path()).run().succeeded();
    assert!(ended.stderr.contains("heat maps: black is no step"), "{}", ended.stderr);
    let mut lightest = 0;
    for side in [64, 512] {
        let picture = read_png(&out.path().join(format!("terrain-steps-{side}.png"))).unwrap();
        assert_eq!((picture.width(), picture.height()), (64, 48));
        let colors: BTreeSet<[u8; 3]> = picture.pixels().chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        assert!(colors.contains(&[0, 0, 4]) && colors.len() > 8, "{side}: {colors:?}");
        lightest += usize::from(colors.contains(&[252, 253, 191]));
    }
    assert!(lightest >= 1);
}

/// A height of 100 m over 3 x 3 samples of 10 m on a base at 0 m.
const TABLE: &str = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n100 100 100\n100 100 100\n100 100 100\n";

#[test]
fn segments_and_spheres_meet_the_land() {
    let out = folder();
    file(&out, "table.asc", TABLE);
    let bodies = "collide --map table.asc --base-level 0 --segment 1,200,2,1,0,2 --segment 1,200,2,1,150,2 \
                  --segment -50,50,0,50,50,0 --sphere 0,104,0,5 --sphere 0,106,0,5 --sphere 200,3,0,4";
    let record = terrain(bodies).arg("--json").inside(out.path()).run().succeeded().json();
    let meets: Vec<_> = record["collisions"].as_array().unwrap().iter().map(|c| &c["meets"]).collect();
    assert_eq!(meets.len(), 6);
    for (meeting, surface, point, normal) in [
        (meets[0], "terrain", [1.0, 100.0, 2.0], [0.0, 1.0, 0.0]),
        (meets[2], "west wall", [-10.0, 50.0, 0.0], [-1.0, 0.0, 0.0]),
        (meets[3], "terrain", [0.0, 100.0, 0.0], [0.0, 1.0, 0.0]),
        (meets[5], "base", [200.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
    ] {
        assert_eq!(meeting["surface"], surface, "{meeting}");
        for (found, expected) in [("point", point), ("normal", normal)] {
            for (axis, expected) in expected.into_iter().enumerate() {
                assert!((meeting[found][axis].as_f64().unwrap() - expected).abs() < 1e-2, "{found} of {meeting}");
            }
        }
    }
    assert!((meets[0]["parameter"].as_f64().unwrap() - 0.5).abs() < 1e-5, "{}", meets[0]);
    assert!(meets[0]["steps"].as_u64().unwrap() > 0);
    assert!((meets[3]["distance_m"].as_f64().unwrap() - 4.0).abs() < 1e-6, "{}", meets[3]);
    assert!(meets[1].is_null() && meets[4].is_null(), "{} {}", meets[1], meets[4]);
    let lines = terrain(bodies).inside(out.path()).run().succeeded().stdout;
    assert_eq!(lines.lines().filter(|line| line.contains("meets nothing")).count(), 2, "{lines}");
    assert!(lines.contains("meets the terrain of map 0") && lines.contains("normal 0.0000"), "{lines}");
}

/// A file of bodies gives what the same bodies do one by one.
#[test]
fn bodies_of_a_file_meet_the_land() {
    let out = folder();
    file(&out, "table.asc", TABLE);
    let lines = "x,y,z,to x,to y,to z\n1,200,2,1,0,2\n\n# a comment\n 0, 104, 0, 5\r\n-50,50,0,50,50,0\n";
    file(&out, "bodies.csv", lines);
    let of = |bodies: &str| {
        let ended = terrain("collide --map table.asc --base-level 0").args(bodies).inside(out.path()).run().succeeded();
        (ended.stdout.lines().map(str::to_owned).collect::<BTreeSet<_>>(), ended.stderr)
    };
    let (of_file, said) = of("--bodies bodies.csv");
    assert!(said.contains("3 bodies read in") && said.contains(" written in "), "{said}");
    assert_eq!(of_file, of("--segment 1,200,2,1,0,2 --sphere 0,104,0,5 --segment -50,50,0,50,50,0").0);
    assert_eq!(of_file.len(), 3);
    let record = terrain("collide --map table.asc --base-level 0 --json --bodies bodies.csv").inside(out.path()).run();
    let record = record.succeeded().json();
    assert_eq!(record["collisions"].as_array().unwrap().len(), 3);
    let distance_m = record["collisions"][1]["meets"]["distance_m"].as_f64().unwrap();
    assert!((distance_m - 4.0).abs() < 1e-6, "{distance_m}");
    for (lines, parts) in [
        ("1,2,3\n", &["line 1", "3 fields"][..]),
        ("1,2,3,4\n1,2,x,4\n", &["line 2"]),
        ("nan,2,3,4\n", &["line 1"]),
        ("0,0,0,1\n1,2,3,1,2,3\n", &["line 2", "no length"]),
        ("# nothing\n", &["no body"]),
    ] {
        file(&out, "bodies.csv", lines);
        let ended = terrain("collide --resolution 16 --bodies bodies.csv").inside(out.path()).run();
        ended.refused(2, &[&["bodies.csv"], parts].concat());
    }
    terrain("collide --resolution 16 --bodies none.csv").inside(out.path()).run().refused(2, &["none.csv"]);
}

/// 36 columns of 10 degrees go once round: at 180 degrees, between the last column and the first, there is land.
#[test]
fn a_map_of_the_whole_earth_has_no_gap_at_its_seam() {
    let out = folder();
    let row = "1000 ".repeat(36);
    let rows = format!("{row}\n").repeat(18);
    file(&out, "world.asc", format!("ncols 36\nnrows 18\nxllcorner -180\nyllcorner -90\ncellsize 10\n{rows}"));
    file(&out, "world.prj", "GEOGCS[\"WGS 84\",UNIT[\"degree\",0.0174532925199433]]");
    // From far beyond the antimeridian straight to the Earth's middle.
    let record = terrain("collide --map world.asc --base earth --base-level 0 --json --segment")
        .arg("0,-20000000,0,0,-6378137,0")
        .inside(out.path())
        .run()
        .succeeded()
        .json();
    let meets = &record["collisions"][0]["meets"];
    assert_eq!(meets["surface"], "terrain", "{record}");
    let height_m = -meets["point"][1].as_f64().unwrap() - 2.0 * 6_378_137.0;
    assert!((height_m - 1000.0).abs() < 50.0, "{height_m} m in {record}");
}

#[test]
fn bodies_that_are_none_are_refused() {
    for (body, parts) in [
        ("--segment 1,2,3,1,2,3", &["--segment", "no length"][..]),
        ("--sphere 1,2,3,0", &["--sphere", "radius"]),
        ("--sphere 1,2,3,-4", &["--sphere", "radius"]),
        ("--segment 1e9,0,0,0,0,0", &["--segment", "100000 km"]),
        ("", &["--segment", "--sphere"]),
        ("--json .", &[".: it is a directory"]),
    ] {
        terrain("collide --resolution 16").args(body).run().refused(2, parts);
    }
    let bodies = ["--segment=nan,2,3,1,2,4", "--segment=1,2,3", "--sphere=1,2,3,inf", "--sphere=a,b,c,d"];
    // Of what is seen it has nothing.
    let seen =
        ["--camera=top", "--normals=nodes", "--start=rays", "--corners=image", "--mesh-error=2", "--crease-angle=9"];
    for option in bodies.into_iter().chain(seen).chain(["--tile-memory=8"]) {
        terrain("collide --resolution 16").arg(option).run().misused(&[option.split('=').next().unwrap()]);
    }
}

#[test]
fn figures_are_one_picture() {
    let out = folder();
    for name in ["figure-1", "figure-2"] {
        let ended = small(&format!("experiment {name} --out .")).inside(out.path()).run().succeeded();
        assert!(ended.stderr.contains("synthetic"), "{}", ended.stderr);
    }
    let real = "experiment figure-2 --map maunga-whau --out real";
    assert!(!small(real).inside(out.path()).run().succeeded().stderr.contains("synthetic"));
    fs::remove_dir_all(out.path().join("real")).unwrap();
    assert_eq!(entries(out.path()), ["terrain-figure-1.png", "terrain-figure-2.png"]);
    let read = |name: &str| fs::read(out.path().join(name)).unwrap();
    assert!(read("terrain-figure-1.png") != read("terrain-figure-2.png"));
    // Of several variants the first that is named.
    let of = |variants: &str| {
        small(&format!("experiment figure-1 --variant {variants} --out .")).inside(out.path()).run().succeeded();
        read("terrain-figure-1.png")
    };
    let mesh = of("mesh");
    assert!(of("mesh,cpu") == mesh && of("gpu-compute,mesh") != mesh);
}

#[test]
fn maps_are_loaded_placed_and_united() {
    let out = folder();
    file(&out, "ramp.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 5 10\n0 5 10\n");
    let maps =
        "bench --json --quiet --variant gpu-compute --map ramp.asc --map maunga-whau --place 0,0,0 --place 500,0,-90";
    let record = small(maps).args(ONCE).inside(out.path()).run().succeeded().json();
    let maps = &record["runs"][0]["config"]["maps"];
    assert_eq!(maps[0]["samples"], serde_json::json!([3, 2]));
    assert_eq!(maps[0]["spacing"], serde_json::json!([10.0, 10.0]));
    assert_eq!(maps[1]["source"], "maunga-whau");
    assert_eq!(maps[1]["place"], serde_json::json!([500.0, 0.0, -90.0]));
}

#[test]
fn voids_are_filled_and_reported() {
    let out = folder();
    file(
        &out,
        "hole.asc",
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -1\n0 -1 9\n0 -1 9\n",
    );
    let bench =
        small("bench --json --quiet --variant cpu --map hole.asc").args(ONCE).inside(out.path()).run().succeeded();
    let run = &bench.json()["runs"][0];
    assert_eq!(run["config"]["maps"][0]["voids_filled"], 2);
    assert!(
        run["warnings"].to_string().contains("--map 1 of 1: 2 samples, 33.3 %, are void: they are filled from"),
        "{}",
        run["warnings"]
    );
    let render = small("render --map hole.asc --image hole.png").inside(out.path()).run().succeeded();
    assert!(render.stderr.contains("--map 1 of 1: 2 samples, 33.3 %, are void: they are filled"), "{}", render.stderr);
}

/// Not the paper's: they stand for nothing that was not asked for.
#[test]
fn the_variants_that_walk_from_cell_to_cell_are_asked_for_by_name() {
    for (base, kind_of_base) in [("plane", "plane"), ("earth", "curved")] {
        let list = "passes --json --resolution 64 --shadows --variant dda-compute,dda-fragment";
        let listed = small(list).args(&format!("--base {base}")).run().succeeded();
        for (variant, kind) in listed.json().as_array().unwrap().iter().zip(["compute", "graphics"]) {
            let passes = variant["passes"].as_array().unwrap();
            let depth = passes.iter().find(|pass| pass["name"] == "depth").unwrap();
            assert_eq!(depth["kind"], kind);
            let shader = format!("depth-dda-{kind_of_base}-packed16-pixel");
            assert!(depth["shaders"].to_string().contains(&shader), "{depth}");
        }
        for options in ["--corners image", "--corners auto --interpolation bicubic"] {
            let listed = small(list).args(&format!("--base {base} {options}")).run().succeeded().json();
            assert!(!listed.to_string().contains("packed"), "{options}: {listed}");
        }
    }
    let benched = small("bench --json --quiet --resolution 64").args(ONCE).run().succeeded().json();
    assert_eq!(benched["runs"].as_array().unwrap().len(), 5);
}

/// A canyon of 16,384 cells that ends at a wall, as an ESRI ASCII grid: bicubic rays along it take more iterations than lavapipe
/// gives a shader.
pub fn canyon() -> String {
    let side = 16_384;
    let mut random = Random::new(1);
    let mut row = |is_floor: bool| -> String {
        let height = |column| {
            let is_low = is_floor && column < side - 3;
            format!("{} ", if is_low { 0 } else { 90 + (random.unit() * 20.0) as u32 })
        };
        (0..side).map(height).collect::<String>() + "\n"
    };
    let rows: String = [false, false, true, false, false].map(&mut row).concat();
    format!("ncols {side}\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n{rows}")
}

/// The canyon, seen along it; the processor has no such end.
#[test]
fn rays_whose_loops_the_driver_ends_are_no_picture() {
    let out = folder();
    file(&out, "canyon.asc", canyon());
    let render = "render --quiet --map canyon.asc --lod exact --interpolation bicubic --size 33x25 --image x.png \
                  --camera=-81820,50,0,-81819,50,0 --variant";
    for variant in ["gpu-compute", "gpu-fragment", "dda-fragment"] {
        terrain(&format!("{render} {variant}"))
            .on_test_device()
            .inside(out.path())
            .run()
            .refused(1, &["depth", "rays did not end"]);
        assert_eq!(entries(out.path()), ["canyon.asc"]);
    }
    terrain(&format!("{render} cpu")).on_test_device().inside(out.path()).run().succeeded();
    // Of rays that come down to the base far behind the canyon another map has nothing to say.
    file(&out, "other.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 0\n0 0\n");
    let falling =
        render.replace("-81819,50,0", "-81720,49.99,0") + " gpu-compute --map other.asc --place 0,0,0 --place 0,500,0";
    terrain(&falling).on_test_device().inside(out.path()).run().refused(1, &["depth", "rays did not end"]);
    // Triangles are seen without rays, and lit along the canyon's floor by rays.
    let lit = format!("{render} mesh-lod --mesh-error 0.01 --shadows --sun 90,0.03");
    terrain(&lit).on_test_device().inside(out.path()).run().refused(1, &["shadow", "rays did not end"]);
}

/// An object's place follows its name; it is drawn there, and the record has it.
#[test]
fn objects_stand_where_they_are_named() {
    let out = folder();
    let picture = |object: &str, name: &str| {
        let render = format!("render --resolution 64 --camera=0,2500,6000,0,800,0 --object {object} --image {name}");
        small(&render).inside(out.path()).run().succeeded();
        read_png(&out.path().join(name)).unwrap()
    };
    let here = picture("box@0,3000,0,300", "here.png");
    assert!(here != picture("box@900,3000,0,300", "there.png"));
    assert!(here != picture("box@0,3000,30,300", "turned.png"));
    let stray =
        small("render --resolution 64 --image x.png --object box@0,9e6,0,300").inside(out.path()).run().succeeded();
    assert!(stray.stderr.contains("--object 1 of 1, box, lies off the maps: it reaches from"), "{}", stray.stderr);
    let bench =
        small("bench --json --quiet --resolution 64 --variant gpu-fragment --object box@0,3000,0,300").args(ONCE);
    let run = bench.run().succeeded().json();
    assert_eq!(run["runs"][0]["config"]["object"], serde_json::json!(["box@0,3000,0,300"]));
    for (object, part) in [("box@1,2,3", "scale"), ("box@1,2,3,0", "scale"), ("box@1,2,3,4,5", "scale")] {
        small("bench --resolution 64").arg(format!("--object={object}")).run().misused(&["--object", part]);
    }
    small("bench --object a@b.obj").args(ONCE).run().refused(2, &["a@b.obj"]);
}

/// Voids under a point of the middle column: at a level, or without terrain, so that the base is met.
#[test]
fn voids_lie_at_a_level_or_are_holes() {
    let out = folder();
    let head = "ncols 5\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    file(&out, "hole.asc", format!("{head}NODATA_value -1\n{}", "30 -1 -1 -1 90\n".repeat(5)));
    file(&out, "undeclared.asc", format!("{head}{}", "30 -9999 40 60 90\n".repeat(5)));
    for (voids, surface, height_m) in
        [("level:35.5", "terrain", 15.5), ("hole", "base", 0.0), ("level:10", "base", 0.0)]
    {
        let collide = "collide --map hole.asc --base-level 20 --json --segment 0,900,0,0,-9,0 --voids";
        let ended = terrain(collide).arg(voids).inside(out.path()).run().succeeded();
        let meets = &ended.json()["collisions"][0]["meets"];
        assert_eq!(meets["surface"], surface, "{voids}: {meets}");
        assert!((meets["point"][1].as_f64().unwrap() - height_m).abs() < 1e-3, "{voids}: {meets}");
        assert!(ended.stderr.contains("--map 1 of 1: 15 samples, 60.0 %, are void"), "{}", ended.stderr);
    }
    let drawn = small("render --image x.png --map hole.asc --voids hole").inside(out.path()).run().succeeded();
    assert!(drawn.stderr.contains("15 samples, 60.0 %, are void: there is no terrain"), "{}", drawn.stderr);
    let drawn = small("render --image x.png --map undeclared.asc").inside(out.path()).run().succeeded();
    assert!(drawn.stderr.contains("5 samples are -9999 m, the next is 30 m: they look like voids"), "{}", drawn.stderr);
    for voids in ["level", "level:", "level:nan", "level:1e38", "sea"] {
        terrain("bench").arg(format!("--voids={voids}")).run().misused(&["--voids"]);
    }
}

#[test]
fn what_cannot_be_is_refused_by_its_option() {
    for (options, parts) in [
        ("--resolution 1", &["--resolution 1", "2 to 65536"][..]),
        ("--resolution 65537", &["--resolution 65537"]),
        ("--resolution 64 --map maunga-whau", &["--resolution", "volcano"]),
        ("--spacing 0", &["--spacing 0"]),
        ("--exaggeration -1", &["--exaggeration -1"]),
        ("--base-level 1e9", &["--base-level 1000000000"]),
        ("--sun 0,-5", &["--sun"]),
        ("--haze -1", &["--haze -1"]),
        ("--camera 1,2,3,1,2,3", &["--camera 1,2,3,1,2,3"]),
        ("--place 1,2,3 --place 1,2,3", &["--place", "2 places for 1 map"]),
        ("--size 0x0", &["--size 0x0"]),
        ("--map no-such.hgt", &["no-such.hgt"]),
        ("--map no-such.xyz", &["no-such.xyz"]),
    ] {
        terrain("bench").on_test_device().args(options).args(ONCE).run().refused(2, parts);
    }
    for option in ["spacing", "exaggeration", "base-level", "haze"] {
        for value in ["nan", "inf", "two", ""] {
            terrain("bench").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
}

/// A file that is no map is refused by its name and by the field that is wrong.
#[test]
fn maps_that_contradict_themselves_are_refused_with_file_and_field() {
    let out = folder();
    let grid = |name: &str, columns: u32, rows: u32, body: &str| {
        file(&out, name, format!("ncols {columns}\nnrows {rows}\nxllcorner 0\nyllcorner 0\ncellsize 10\n{body}"));
    };
    let header = "NCOLS 3\nNROWS 3\nNBITS 16\n";
    for (name, header, bytes) in
        [("odd", header, 17), ("long", header, 20), ("wide", "NCOLS 3\nNROWS 3\nNBITS 16\nBANDROWBYTES 4\n", 18)]
    {
        file(&out, &format!("{name}.hdr"), header);
        file(&out, &format!("{name}.bil"), vec![7; bytes]);
    }
    file(&out, "voids.hdr", format!("{header}NODATA 1799\n"));
    file(&out, "voids.bil", [7; 18]);
    file(&out, "N37E140.hgt", vec![0; 2_884_801]);
    file(&out, "N38E140.hgt", "odd");
    grid("rows.asc", 3, 3, "0 5 10\n0 5 10\n");
    grid("more.asc", 2, 2, "0 5 10\n0 5 10\n");
    grid("nan.asc", 2, 2, "0 nan\n0 5\n");
    grid("none.asc", 0, 2, "");
    grid("large.asc", 65_537, 2, &"0 ".repeat(2 * 65_537));
    grid("void.asc", 2, 2, "NODATA_value -1\n-1 -1\n-1 -1\n");
    grid("high.asc", 2, 2, "0 0\n0 1e30\n");
    file(&out, "near.asc", "ncols 2\nnrows 2\ncellsize 1e-300\n0 0\n0 0\n");
    file(&out, "cut.tif", "II*\0");
    file(&out, "text.png", "no picture");
    file(&out, "map.xyz", "0 0 0");
    for (name, field) in [
        ("odd.bil", "its size is 17 bytes, but its header's SKIPBYTES 0 and NROWS 3 x NCOLS 3 x NBITS 16 make 18"),
        ("long.hdr", "its size is 20 bytes"),
        ("wide.bil", "BANDROWBYTES is 4, but NCOLS 3 x NBITS 16 needs 6"),
        ("voids.bil", "all its samples are void"),
        ("N37E140.hgt", "its size is 2884801 bytes"),
        ("N38E140.hgt", "its size is 3 bytes"),
        ("rows.asc", "6 heights for ncols x nrows = 3 x 3"),
        ("more.asc", "more than the 4 heights"),
        ("nan.asc", "row 0, column 1: its height is NaN"),
        ("none.asc", "by ncols and nrows of its header, it has 0 x 2 samples"),
        ("large.asc", "it has 65537 x 2 samples; a map has 2 to 65536 a side"),
        ("void.asc", "all its samples are void"),
        ("high.asc", "row 1, column 1: its height is 1.0000000150474662e30 m, and heights are -1000000 to 1000000 m"),
        ("near.asc", "cellsize: it makes samples lie 1e-300 x 1e-300 m apart; they have to lie 0.000001 to 1000000 m"),
        ("cut.tif", "cut.tif"),
        ("text.png", "neither TIFF nor PNG"),
        ("map.xyz", "unknown file ending \"xyz\""),
    ] {
        let stem = name.split('.').next().unwrap();
        small("bench").arg("--map").arg(name).args(ONCE).inside(out.path()).run().refused(2, &[stem, field]);
        terrain("collide --sphere 0,0,0,1 --map").arg(name).inside(out.path()).run().refused(2, &[stem, field]);
    }
}

/// A map that goes once round has columns more on the device, so this one is larger than the images of the least one.
#[test]
fn a_map_above_the_device_s_limits_is_refused_by_its_file() {
    let out = folder();
    let head = format!("ncols 4096\nnrows 2\nxllcorner -180\nyllcorner 0\ncellsize {}\n", 360.0 / 4096.0);
    file(&out, "round.asc", head + &"0 1 ".repeat(4096));
    let bench = "bench --base earth --variant gpu-compute --map round.asc";
    let layer = Layer::new();
    layer.least(small(bench).args(ONCE).inside(out.path())).run().refused(2, &["--map round.asc", "limit of 4096"]);
    let mesh = "bench --variant mesh --resolution 4097";
    small(mesh).args(ONCE).run().refused(2, &["--map volcano", "samples a side 4097", "4096"]);
}

#[test]
fn options_that_an_experiment_would_not_heed_are_refused() {
    for (arguments, part) in [
        ("experiment 1 --map maunga-whau", "--map"),
        ("experiment 1 --resolution 64", "--counts"),
        ("experiment figure-1 --counts 64", "--counts"),
        ("experiment figure-1 --json", "--json"),
        ("experiment steps --counts 64 --variant cpu", "--variant"),
        ("experiment screen --size 64x64", "--counts"),
    ] {
        terrain(arguments).run().refused(2, &[part]);
    }
}

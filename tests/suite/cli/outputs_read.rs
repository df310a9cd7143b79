//! Outputs that would replace what a run reads, itself or through another file, are refused before anything is written.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use super::program::{ONCE, Program, burning, caustics, entries, file, folder, fumarole, gas, lava, terrain};

const REPLACED: &str = "it is read, and what is written there would replace it";

/// Asserts the refusal, and that every file of the folder is as it was.
fn refused(program: Program, place: &Path, name: &str) {
    let contents = || -> Vec<_> {
        let files = entries(place).into_iter().map(|name| place.join(name)).filter(|path| path.is_file());
        files.map(|path| (fs::read(&path).unwrap(), path)).collect()
    };
    let before = (entries(place), contents());
    program.inside(place).run().refused(2, &[name, REPLACED]);
    assert!((entries(place), contents()) == before, "{name}: a file was changed");
}

#[test]
fn what_a_collision_is_of_is_kept() {
    let out = folder();
    file(&out, "f.csv", "1,2,3,4\n");
    file(&out, "x.asc", "grid");
    symlink("f.csv", out.path().join("link.csv")).unwrap();
    for options in [
        "--bodies f.csv --json f.csv",
        "--bodies f.csv --json link.csv",
        "--bodies link.csv --json ./f.csv",
        "--map x.asc --sphere 1,2,3,4 --json x.asc",
    ] {
        let name = options.rsplit([' ', '/']).next().unwrap();
        refused(terrain("collide").args(options), out.path(), name);
    }
}

#[test]
fn files_behind_other_files_are_kept() {
    let out = folder();
    let mosaic = "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Int16\" band=\"1\">\
        <SimpleSource><SourceFilename relativeToVRT=\"1\">x.asc</SourceFilename>\
        <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/>\
        <DstRect xOff=\"0\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/>\
        </SimpleSource></VRTRasterBand></VRTDataset>";
    for (name, text) in [
        ("b.hdr", "header"),
        ("b.bil", "samples"),
        ("all.vrt", mosaic),
        ("x.asc", "grid"),
        ("N00E000.hgt", "tile"),
        ("land.png", "MM\0*"),
        ("land.pgw", "place"),
        ("a.gltf", r#"{"buffers": [{"uri": "a.bin"}]}"#),
        ("a.bin", "buffer"),
        ("v.nhdr", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: v.raw\n"),
        ("v.raw", "samples"),
        ("m.mhd", "NDims = 3\nElementDataFile = m.raw\n"),
        ("m.raw", "samples"),
        ("n.hdr", "header"),
        ("n.img", "samples"),
        ("table.toml", "texture = \"map.png\"\n[[material]]\nkind = \"wood\"\n"),
        ("map.png", "colours"),
        ("land-0002.png", "picture"),
        ("main.glsl", "text"),
    ] {
        file(&out, name, text);
    }
    // Without a shader the folder itself is refused.
    std::fs::create_dir(out.path().join("common")).unwrap();
    file(&out, "common/fullscreen.vert", include_str!("../../../shaders/common/fullscreen.vert"));
    for (program, output) in [
        (terrain("bench --map b.hdr --csv b.bil"), "b.bil"),
        (terrain("bench --map all.vrt --json x.asc"), "x.asc"),
        (terrain("stress --axis screen --map . --csv N00E000.hgt"), "N00E000.hgt"),
        (terrain("bench --drape land.png --trace land.pgw"), "land.pgw"),
        (terrain("render --frame 0..4 --image land.png --drape land-0002.png"), "land-0002.png"),
        (caustics("bench --mesh a.gltf --json a.bin"), "a.bin"),
        (lava("experiment fig-4.1 --shader-dir . --json main.glsl"), "main.glsl"),
        (lava("stress --shader-dir . --json main.glsl"), "main.glsl"),
        (gas("bench --volume-file v.nhdr --json v.raw"), "v.raw"),
        (gas("bench --volume-file m.mhd --json m.raw"), "m.raw"),
        (gas("bench --volume-file n.hdr --json n.img"), "n.img"),
        (burning("bench --materials table.toml --json map.png"), "map.png"),
        (burning("render --materials table.toml --image map.png"), "map.png"),
        (fumarole("all --shader-dir . --csv main.glsl"), "main.glsl"),
        (fumarole("ab --json x.asc terrain --map x.asc"), "x.asc"),
        (fumarole("ab --json b.bil --b").arg("--map b.hdr").args("terrain"), "b.bil"),
    ] {
        refused(program, out.path(), output);
    }
}

/// Of names that begin as an experiment's own do, what it may write, and what it never writes.
#[test]
fn what_is_named_as_an_experiments_own_is_kept() {
    let out = folder();
    for name in ["terrain-screen.png", "terrain-screen-a.png"] {
        file(&out, name, "picture");
        refused(terrain("experiment screen --out . --drape").arg(name), out.path(), name);
    }
    for name in ["terrain-screen.asc", "terrain-screen-a.asc"] {
        file(&out, name, "grid");
        let experiment = terrain("experiment screen --quiet --out . --map").arg(name).on_test_device();
        let ended = experiment.inside(out.path()).run();
        assert!(!ended.stderr.contains(REPLACED), "{}", ended.stderr);
        ended.refused(2, &[name]);
    }
}

#[test]
fn what_a_page_shows_is_kept() {
    let out = folder();
    for name in ["a.json", "b.json"] {
        let bench = caustics("bench --quiet --variant level-map --image p.png --json").arg(name).args(ONCE).tiny();
        bench.inside(out.path()).run().succeeded();
    }
    symlink("a.json", out.path().join("link")).unwrap();
    for (options, name) in [
        ("a.json -o a.json", "a.json"),
        ("a.json -o link", "link"),
        (". -o a.json", "a.json"),
        ("--a a.json --b b.json -o b.json", "b.json"),
        ("a.json -o p.png", "p.png"),
    ] {
        refused(fumarole("report").args(options), out.path(), name);
    }
    fumarole("report . -o report.html").inside(out.path()).run().succeeded();
}

#[test]
fn a_joined_record_is_kept_by_what_is_published_from_it() {
    let out = folder();
    let place = |name: &str| out.path().join(name);
    let experiment = |options: &str| {
        let experiment = caustics("experiment 5-1 --quiet").args(options).args(ONCE).args("--size 32x24 --map-size 16");
        experiment.args("--water-triangles 100 --mesh box").on_test_device().inside(out.path())
    };
    experiment("--shard 0/1 --out parts").run().succeeded();
    fumarole("assemble parts --out joined --quiet").inside(out.path()).run().succeeded();
    let joined = place("joined/caustics-5-1.json");
    let before = fs::read(&joined).unwrap();
    let onto = experiment("--assembled joined/caustics-5-1.json --out joined");
    onto.run().refused(2, &["caustics-5-1.json", REPLACED]);
    assert!(fs::read(&joined).unwrap() == before);
    experiment("--assembled joined/caustics-5-1.json --out table").run().succeeded();
}

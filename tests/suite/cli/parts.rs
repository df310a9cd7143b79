//! Films in parts: every shard and every range of rows has exactly the pixels of the whole, and `assemble` takes nothing that
//! does not belong together.

use std::fs;
use std::path::Path;

use super::program::{Program, burning, caustics, entries, folder, fumarole, gas, lava, terrain};

/// A small film, whose frames depend on those before it where the paper's do.
fn film(paper: fn(&str) -> Program, scene: &str) -> impl Fn(&str) -> Program {
    let scene = scene.to_owned();
    move |options| paper("render --quiet").args(&scene).on_test_device().args(options)
}

/// The small film of the tests of one paper.
fn small(options: &str) -> Program {
    film(caustics, CAUSTICS)(options)
}

const CAUSTICS: &str = "--size 48x33 --map-size 32 --water-triangles 300 --planes 3 --variant culled";

/// Asserts that both folders hold the same pictures.
fn assert_same(whole: &Path, assembled: &Path, names: &[&str]) {
    assert_eq!(entries(assembled), names);
    for name in names {
        let [a, b] = [whole, assembled].map(|folder| fumarole::image::read_png(&folder.join(name)).unwrap());
        assert!(a == b, "{name} differs");
    }
}

/// Asserts that shards and rows of a film `height` pixels high, assembled, are the film of one process.
fn assert_whole(paper: fn(&str) -> Program, scene: &str, height: u32) {
    let (film, out) = (film(paper, scene), folder());
    let place = |name: &str| out.path().join(name);
    let whole = film("--frame 2..5 --film").arg(place("whole.y4m")).arg("--image").arg(place("whole/a.png"));
    whole.run().succeeded();
    for shard in ["1/2", "0/2"] {
        film("--frame 2..5 --shard").arg(shard).arg("--image").arg(place("parts/a.png")).run().succeeded();
    }
    let assemble = |from: &str| fumarole("assemble --quiet").arg(place(from));
    assemble("parts").arg("--out").arg(place("film")).run().succeeded();
    assert_same(&place("whole"), &place("film"), &["a-0002.png", "a-0003.png", "a-0004.png"]);
    assemble("parts").arg("--film").arg(place("film.y4m")).run().succeeded();
    assert!(fs::read(place("film.y4m")).unwrap() == fs::read(place("whole.y4m")).unwrap());
    for rows in ["0..7".to_owned(), format!("7..{height}")] {
        film("--frame 4 --rows").arg(rows).arg("--image").arg(place("rows/a-0004.png")).run().succeeded();
    }
    assemble("rows").arg("--out").arg(place("frame")).run().succeeded();
    assert_same(&place("whole"), &place("frame"), &["a-0004.png"]);
}

#[test]
fn parts_of_caustics_are_the_whole() {
    assert_whole(caustics, CAUSTICS, 33);
}

#[test]
fn parts_of_lava_are_the_whole() {
    assert_whole(lava, "--size 48x33 --particles 200 --density 12x8x8 --splats 60x15", 33);
}

#[test]
fn parts_of_gas_are_the_whole() {
    for preset in ["fig-6", "fig-7"] {
        assert_whole(gas, &format!("--size 45x31 --preset {preset} --frame-step 20"), 31);
    }
}

#[test]
fn parts_of_burning_are_the_whole() {
    assert_whole(burning, "--size 48x33 --mesh sphere --triangles 300 --first-frame 30 --speed 0.5", 33);
}

#[test]
fn parts_of_terrain_are_the_whole() {
    assert_whole(terrain, "--size 48x33 --resolution 64 --object teapot@0,0,0,500", 33);
}

#[test]
fn finished_parts_are_not_drawn_again_and_altered_ones_are() {
    let out = folder();
    let shard = || small("--frame 0..4 --shard 1/2 --out").arg(out.path());
    shard().run().succeeded();
    let picture = out.path().join("caustics-culled-0002.png");
    let drawn = || fs::metadata(&picture).unwrap().modified().unwrap();
    let first = drawn();
    shard().run().succeeded();
    assert_eq!(drawn(), first);
    // Of other settings, and of other pixels.
    shard().args("--seed 5").run().succeeded();
    let second = drawn();
    assert_ne!(second, first);
    fs::copy(out.path().join("caustics-culled-0003.png"), &picture).unwrap();
    let altered = fumarole("assemble").arg(out.path()).arg("--missing").arg("2").run();
    assert_eq!(altered.succeeded().stdout, "0,1\n");
    shard().args("--seed 5").run().succeeded();
    assert_ne!(fs::read(&picture).unwrap(), fs::read(out.path().join("caustics-culled-0003.png")).unwrap());
    fs::remove_file(&picture).unwrap();
    shard().args("--seed 5").run().succeeded();
    assert!(picture.is_file());
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let out = folder();
    let parts = out.path().join("parts");
    let draw = |options: &str| small(options).arg("--out").arg(&parts).run().succeeded();
    let assemble = || fumarole("assemble --quiet --out").arg(out.path().join("film")).arg(&parts).run();
    draw("--frame 0..4 --shard 0/2");
    assemble().refused(2, &["lack rows", "frame 2"]);
    draw("--frame 0..4 --shard 1/2 --seed 9");
    assemble().refused(2, &["--seed", "two films"]);
    draw("--frame 0..4 --shard 1/2");
    assemble().succeeded();
    // Rows that two parts have.
    let whole = out.path().join("film");
    assert_eq!(entries(&whole).len(), 4);
    draw("--frame 0..4 --rows 3..9");
    assemble().refused(2, &["both have row"]);

    let half = out.path().join("half");
    small("--frame 1 --shard 1/2 --out").arg(&half).run().succeeded();
    fumarole("assemble").arg(&half).run().refused(2, &["frame 1", "rows 0..16"]);

    let rows = out.path().join("rows");
    small("--rows 0..33 --out").arg(&rows).run().succeeded();
    let picture = rows.join("caustics-culled-0000.png");
    fs::copy(whole.join("caustics-culled-0003.png"), &picture).unwrap();
    let altered = fumarole("assemble --quiet --out").arg(&whole).arg(&rows).run();
    altered.refused(2, &["not the picture that was drawn"]);
    fs::write(rows.join("caustics-culled-0000.png.part.json"), "{}").unwrap();
    fumarole("assemble").arg(&rows).run().refused(2, &["reading the part"]);
    fumarole("assemble").arg(out.path()).run().refused(2, &["no part was found"]);
    fumarole("assemble nowhere").run().refused(2, &["the folder nowhere", "name a folder"]);
}

#[test]
fn parts_whose_pictures_do_not_go_together_are_refused() {
    let out = folder();
    let draw = |options: &str| small(options).inside(out.path()).run().succeeded();
    let assemble = |options: &str| fumarole("assemble --quiet").args(options).inside(out.path()).run();
    for (shard, name) in [("0/2", "x"), ("1/2", "y")] {
        draw(&format!("--frame 0..4 --shard {shard} --image q/{name}.png"));
    }
    assemble("q --out film").refused(2, &["x-0000.png", "y-0002.png", "--image"]);
    assemble("q --film a.y4m").succeeded();

    for shard in ["0/2", "1/2"] {
        draw(&format!("--frame 0..4 --shard {shard} --image p/x.png"));
    }
    let drawn = fs::read(out.path().join("p/x-0001.png")).unwrap();
    assemble("p --out p").refused(2, &["x-0000.png", "it is read"]);
    assert_eq!(fs::read(out.path().join("p/x-0001.png")).unwrap(), drawn);
    let description = |name: &str| out.path().join("p").join(format!("{name}.png.part.json"));
    let text = fs::read_to_string(description("x-0003")).unwrap();
    fs::write(description("x-0003"), text.replace("x-0003.png", "x-0002.png")).unwrap();
    assemble("p --out film").refused(2, &["x-0002.png.part.json", "x-0003.png.part.json", "both name the picture"]);
    // A field that an option is named like.
    fs::write(description("x-0003"), text.replace("\"device\":", "\"no-device\":")).unwrap();
    assemble("p --out film").refused(2, &["missing field \"device\""]);
    fs::write(description("x-0003"), text).unwrap();
    fs::write(out.path().join("p/x-0001.png"), &drawn[..drawn.len() / 2]).unwrap();
    assemble("p --out film").refused(2, &["x-0001.png", "render it again"]);
}

#[test]
fn wrong_shards_and_rows_are_refused() {
    let out = folder();
    let inside =
        |options: &str| caustics("render --size 48x33").args(options).inside(out.path()).on_test_device().run();
    inside("--shard 2/2").misused(&["2/2", "I/N"]);
    inside("--rows 5..5").misused(&["5..5"]);
    inside("--rows 0..3 --shard 0/2").misused(&["cannot be used"]);
    inside("--rows 0..34").refused(2, &["0..34", "0..33"]);
    inside("--rows 0..3 --dump caustics-map=a.exr").misused(&["--dump", "--rows"]);
    inside("--shard 0/2 --film a.y4m").misused(&["--film", "--shard"]);
    let idle = inside("--shard 40/50 --frame 0..2").succeeded();
    assert!(idle.stderr.contains("nothing to draw"), "{}", idle.stderr);
    assert_eq!(entries(out.path()), [""; 0]);
}

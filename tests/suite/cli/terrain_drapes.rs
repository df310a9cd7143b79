//! Drapes over the land, through the binary.

use std::collections::BTreeSet;
use std::fs;

use fumarole::image::read_png;

use super::program::{ONCE, file, folder};
use super::terrain::small;

/// A picture lies where its world file says in the map's coordinates, also where the map names its meridian otherwise; the
/// file is part of the input's identity.
#[test]
fn a_drape_lies_where_its_world_file_says() {
    let out = folder();
    file(&out, "land.asc", "ncols 3\nnrows 3\nxllcenter 10\nyllcenter 40\ncellsize 0.05\n1 1 1\n1 1 1\n1 1 1\n");
    let picture = fumarole::image::Rgba8::new(2, 2, [220, 30, 30, 255].repeat(4)).unwrap();
    fumarole::image::write_png(&out.path().join("photo.png"), &picture).unwrap();
    let draw = |options: &str, image: &str| {
        let scene = "render --quiet --camera top --haze 0 --map land.asc --variant cpu";
        small(scene).args("--image").args(image).args(options).inside(out.path()).run()
    };
    let drawn = |options: &str| {
        draw(options, "land.png").succeeded();
        read_png(&out.path().join("land.png")).unwrap()
    };
    let (bare, whole) = (drawn(""), drawn("--drape photo.png"));
    assert!(bare != whole);
    // Two texels of a quarter of a map each, from a middle of the first: the west half, a whole turn further.
    file(&out, "photo.pgw", "0.025\n0\n0\n-0.05\n370.0125\n40.075\n");
    let half = drawn("--drape photo.png");
    let row = |picture: &fumarole::image::Rgba8| picture.pixels()[24 * 64 * 4..25 * 64 * 4].to_vec();
    let (bare, whole, half) = (row(&bare), row(&whole), row(&half));
    assert!(half[..31 * 4] == whole[..31 * 4] && half[33 * 4..] == bare[33 * 4..]);
    for (world_file, expected) in [
        ("0.025\n0\n0\n-0.05\n50\n40\n", ["beside the first map", "same coordinates"]),
        ("0.025\n0\n0\n0.05\n10\n40\n", ["photo.pgw", "north up"]),
        ("1e-300\n0\n0\n-45\n10\n40\n", ["photo.pgw", "line 1: its step is 1e-300"]),
        ("0.025\n0\n0\n-5e-12\n10\n40\n", ["photo.pgw", "line 4: its step is -5e-12"]),
    ] {
        file(&out, "photo.pgw", world_file);
        draw("--drape photo.png", "none.png").refused(2, &expected);
    }
    file(&out, "photo.pgw", "1\n0\n0\n-1\n0\n0\n");
    small("render --quiet --resolution 64 --variant cpu --drape photo.png --image none.png")
        .inside(out.path())
        .run()
        .refused(2, &["photo.pgw", "no coordinates"]);
}

/// The interval that suits the map stands in the record, in true metres however much it is exaggerated; a file's name is no word.
#[test]
fn drapes_are_drawn_of_the_land_itself() {
    let out = folder();
    let rows: String =
        (0..9).map(|row| (0..9).map(|column| format!("{} ", 10 * column + row)).collect::<String>() + "\n").collect();
    file(&out, "ramp.asc", format!("ncols 9\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 10\n{rows}"));
    let config = |options: &str| {
        let bench = "bench --json --quiet --variant gpu-compute --exaggeration 3 --map ramp.asc";
        let ended = small(bench).args(ONCE).args(options).inside(out.path()).run().succeeded();
        ended.json()["runs"][0]["config"].clone()
    };
    let suiting = config("--drape contours");
    assert_eq!((&suiting["drape"], &suiting["contour_interval"]), (&"contours".into(), &5.0.into()));
    let given = config("--drape contours:2.5");
    assert_eq!((&given["drape"]["contours"], &given["contour_interval"]), (&2.5.into(), &2.5.into()));
    let draw = |options: &str| {
        let scene = "render --quiet --camera top --haze 0 --map ramp.asc --image land.png";
        small(scene).args(options).inside(out.path()).run().succeeded();
        fs::read(out.path().join("land.png")).unwrap()
    };
    let pictures = ["", "--drape contours", "--drape contours:20", "--drape slope", "--drape hypsometric"].map(draw);
    assert_eq!(pictures.iter().collect::<BTreeSet<_>>().len(), pictures.len());
    for drape in ["contours:0", "contours:-1", "contours:x"] {
        small("render --resolution 16").args(&format!("--drape={drape}")).run().misused(&["--drape"]);
    }
    small("render --resolution 16 --drape slopes").inside(out.path()).run().refused(2, &["slopes"]);
}

/// Maps can take long to make.
#[test]
fn a_picture_that_is_none_is_refused_before_the_maps_are_made() {
    let out = folder();
    file(&out, "text.png", "no picture");
    file(&out, "broken.asc", "no map");
    for options in ["", "--stream --no-cache --variant tiled-compute"] {
        let render = format!("render --quiet --map broken.asc --image none.png {options}");
        small(&render).inside(out.path()).run().refused(2, &["broken.asc"]);
        small(&render).args("--drape text.png").inside(out.path()).run().refused(2, &["text.png"]);
    }
}

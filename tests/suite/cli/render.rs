//! `render`: pictures, ranges of frames, and that a seed fixes them.

use std::path::Path;

use super::program::{Program, caustics, entries, file, folder, read_json, sha256};

fn render(folder: &Path) -> Program {
    caustics("render").inside(folder).tiny()
}

#[test]
fn a_frame_is_one_picture() {
    let out = folder();
    let ended = render(out.path()).args("--frame 0").run().succeeded();
    let name = "fumarole-out/caustics-level-map-0000.png";
    assert_eq!(ended.stdout, "");
    assert!(ended.stderr.starts_with("device: "), "{}", ended.stderr);
    assert!(ended.stderr.ends_with(&format!("wrote {name}\n")), "{}", ended.stderr);
    let picture = fumarole::image::read_png(&out.path().join(name)).unwrap();
    assert_eq!((picture.width(), picture.height()), (96, 64));
    let mut pixels = picture.pixels().chunks_exact(4);
    let first = pixels.next().unwrap();
    assert!(pixels.any(|pixel| pixel != first), "an empty picture");
}

#[test]
fn a_range_of_frames_is_a_picture_each_of_moving_water() {
    let out = folder();
    let ended = render(out.path()).args("--frame 0..3 --out a").run().succeeded();
    let names = ["caustics-level-map-0000.png", "caustics-level-map-0001.png", "caustics-level-map-0002.png"];
    assert_eq!(entries(&out.path().join("a")), names);
    assert_eq!(ended.stderr.matches("wrote ").count(), 3, "{}", ended.stderr);
    render(out.path()).args("--quiet --frame 0..3 --image b/water.png").run().succeeded();
    assert_eq!(entries(&out.path().join("b")), ["water-0000.png", "water-0001.png", "water-0002.png"]);

    let pictures = names.map(|name| sha256(&out.path().join("a").join(name)));
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2] && pictures[0] != pictures[2]);
    for (number, picture) in pictures.iter().enumerate() {
        assert_eq!(*picture, sha256(&out.path().join(format!("b/water-000{number}.png"))));
    }
    // A frame alone is what it is in a range.
    render(out.path()).args("--quiet --frame 2 --image alone.png").run().succeeded();
    assert_eq!(sha256(&out.path().join("alone.png")), pictures[2]);
}

#[test]
fn a_seed_fixes_the_picture_bit_for_bit() {
    let out = folder();
    let picture = |options: &str| {
        render(out.path()).args("--quiet --image p.png").args(options).run().succeeded();
        sha256(&out.path().join("p.png"))
    };
    for variant in ["level-map", "volumetric"] {
        let of_seed = |seed: u32| picture(&format!("--variant {variant} --seed {seed}"));
        let seven = of_seed(7);
        assert_eq!(seven, of_seed(7), "{variant}");
        assert_ne!(seven, of_seed(8), "{variant}");
    }
    // The benchmark's picture keeps to the seed as well, whatever was measured before it.
    let bench = |options: &str| {
        let program = caustics("bench --quiet --variant level-map --image b.png --json b.json").inside(out.path());
        program.tiny().args("--frames 2 --repeat 1 --no-limits").args(options).run().succeeded();
        read_json(&out.path().join("b.json"))["runs"][0]["image"]["sha256"].as_str().unwrap().to_owned()
    };
    assert_eq!(bench("--seed 7"), bench("--seed 7 --warmup 4"));
    assert_ne!(bench("--seed 7"), bench("--seed 8"));
}

#[test]
fn every_receiver_and_light_is_drawn() {
    let out = folder();
    let quad = file(&out, "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf -1 -2 -3 -4\n");
    for (name, options) in [
        ("sphere", "--mesh sphere"),
        ("several", "--mesh box --mesh plane --floor"),
        ("lights", "--mesh sphere --light 0.3,-1,0 --point-light 0,4,0"),
        ("one-plane", "--mesh sphere --planes 1"),
        ("flat", "--mesh sphere --waves 0"),
    ] {
        let program = caustics("render --quiet --image").arg(format!("{name}.png")).inside(out.path());
        program.tiny_but(options).run().succeeded();
    }
    render(out.path()).args("--quiet --image quad.png --mesh").arg(&quad).run().succeeded();
    let pictures = ["sphere", "several", "lights", "one-plane", "flat", "quad"];
    let mut found = pictures.map(|name| sha256(&out.path().join(format!("{name}.png")))).to_vec();
    found.sort();
    found.dedup();
    assert_eq!(found.len(), pictures.len(), "two of them are alike");
}

#[test]
fn contradictions_are_refused() {
    let out = folder();
    render(out.path()).args("--variant all").run().misused(&["--variant", "level-map-smart"]);
    render(out.path()).args("--frame 0..2 --dump picture=p.exr").run().refused(2, &["--dump", "--frame"]);
    render(out.path()).args("--image p.jpg").run().refused(2, &["p.jpg", "PNG"]);
    render(out.path()).args("--dump picture=p.tiff").run().refused(2, &["p.tiff", ".exr"]);
    for frames in ["3..3", "5..2", "x", "-1", "1..", "4294967295"] {
        render(out.path()).arg(format!("--frame={frames}")).run().misused(&["--frame", frames]);
    }
    for dump in ["picture", "=p.exr", "picture="] {
        render(out.path()).arg(format!("--dump={dump}")).run().misused(&["--dump", dump]);
    }
    assert!(entries(out.path()).is_empty(), "nothing was written");
}

#[test]
fn a_film_is_one_file_of_all_frames_and_an_older_one_stays_until_it_is_whole() {
    let out = folder();
    let film = out.path().join("a.y4m");
    render(out.path()).args("--frame 0..2 --film a.y4m --film-rate 25 --quiet").run().succeeded();
    let bytes = std::fs::read(&film).unwrap();
    let header = b"YUV4MPEG2 W96 H64 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    assert!(bytes.starts_with(header));
    assert_eq!(bytes.len(), header.len() + 2 * (6 + 3 * 96 * 64));
    assert_eq!(entries(out.path()), ["a.y4m"], "and no pictures");
    let ended = render(out.path()).args("--film a.y4m --image b.png").run().succeeded();
    assert_eq!(ended.stderr.matches("wrote ").count(), 2, "{}", ended.stderr);
    assert_eq!(entries(out.path()), ["a.y4m", "b.png"]);
    assert_eq!(std::fs::read(&film).unwrap().len(), header.len() + 6 + 3 * 96 * 64);

    render(out.path()).args("--film a.mp4").run().refused(2, &["a.mp4", ".y4m"]);
    render(out.path()).args("--film a.y4m --film-rate 0").run().misused(&["--film-rate", "0"]);
    render(out.path()).args("--film-rate 5").run().misused(&["--film"]);
    render(out.path()).args("--film no/such/").run().refused(2, &["no/such"]);
    // The mesh is not there: what was filmed before stays.
    render(out.path()).args("--film a.y4m --mesh no-such.obj").run().refused(2, &["no-such.obj"]);
    assert_eq!(std::fs::read(&film).unwrap().len(), header.len() + 6 + 3 * 96 * 64);
}

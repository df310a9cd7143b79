//! Destinations of results are checked before the long work, and a failed run harms no older file.

use std::fs;
use std::path::Path;

use super::program::{ONCE, Program, assert_schema, caustics, entries, file, folder, fumarole, read_json};

/// Would measure for hours, were its destination not checked first.
fn long(folder: &Path) -> Program {
    caustics("bench --frames 100000 --repeat 10000 --no-limits").inside(folder).tiny()
}

#[test]
fn a_destination_that_cannot_be_written_is_refused_before_the_work() {
    let out = folder();
    file(&out, "file", "");
    fs::create_dir(out.path().join("folder.png")).unwrap();
    let before = entries(out.path());
    for option in ["json", "csv", "trace", "image"] {
        for (path, part) in [
            ("/proc/no-such/result.png", "/proc/no-such"),
            ("/dev/null/result.png", "/dev/null"),
            ("file/result.png", "file"),
            ("folder.png", "folder.png"),
            ("new/.png/", "new"),
        ] {
            long(out.path()).arg(format!("--{option}={path}")).run().refused(2, &[part]);
        }
    }
    assert_eq!(entries(out.path()), before);
    let render = || caustics("render --frame 0..100000").inside(out.path()).tiny();
    render().args("--out /proc/no-such").run().refused(2, &["/proc/no-such"]);
    render().args("--image /dev/null/a.png").run().refused(2, &["/dev/null"]);
    let picture = caustics("render --image folder.png").inside(out.path()).tiny();
    picture.run().refused(2, &["folder.png"]);
    let dump = caustics("render --dump picture=folder.png").inside(out.path()).tiny();
    dump.run().refused(2, &["folder.png"]);
}

#[test]
fn the_main_job_names_its_pictures_itself() {
    let out = folder();
    fumarole("all --image a.png").inside(out.path()).run().refused(2, &["--image", "--out"]);
    assert!(entries(out.path()).is_empty());
}

#[test]
fn a_name_that_promises_something_else_is_refused() {
    let out = folder();
    long(out.path()).args("--image picture.exr").run().refused(2, &["--image picture.exr", "PNG"]);
    for option in ["csv", "trace"] {
        long(out.path()).args(&format!("--{option} -")).run().refused(2, &["-", "--json"]);
    }
    assert!(entries(out.path()).is_empty());
}

#[test]
fn a_failed_run_leaves_older_files_and_no_new_ones() {
    let out = folder();
    for name in ["a.json", "a.csv", "a.trace", "a.png"] {
        file(&out, name, "older");
    }
    file(&out, "bad.obj", "v 0 0 0\nf 1 2 3\n");
    let before = entries(out.path());
    let files = "--json a.json --csv a.csv --trace a.trace --image a.png";
    for (fault, part) in [
        ("--mesh bad.obj", "bad.obj"),
        ("--device no-such", "no-such"),
        ("--planes 0", "--planes 0"),
        ("--map-size 100000", "limit"),
        ("--shader-dir bad.obj", "bad.obj"),
    ] {
        let program = caustics("bench --quiet").inside(out.path()).tiny_but(fault).args(ONCE).args(files);
        program.run().refused(2, &[part]);
    }
    let render = caustics("render --quiet --image a.png --dump no-such=a.json.npy").inside(out.path()).tiny();
    render.run().refused(2, &["no-such"]);
    assert_eq!(entries(out.path()), before);
    for name in ["a.json", "a.csv", "a.trace", "a.png"] {
        assert_eq!(fs::read_to_string(out.path().join(name)).unwrap(), "older", "{name}");
    }
}

#[test]
fn a_run_replaces_older_files_and_makes_folders() {
    let out = folder();
    file(&out, "a.json", "older");
    let program = caustics("bench --quiet --json a.json --csv deep/er/a.csv").inside(out.path()).tiny().args(ONCE);
    program.run().succeeded();
    assert!(fs::read_to_string(out.path().join("a.json")).unwrap().starts_with("{\n"));
    assert_eq!(entries(out.path()), ["a.json", "deep"]);
    assert_eq!(entries(&out.path().join("deep/er")), ["a.csv"]);
}

#[test]
fn a_picture_that_cannot_be_written_throws_no_measurement_away() {
    let out = folder();
    std::os::unix::fs::symlink("/dev/full", out.path().join("full.png")).unwrap();
    let program = caustics("bench --json a.json --csv a.csv --image full.png").args(ONCE).inside(out.path()).tiny();
    let ended = program.run();
    assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("full.png"), "{}", ended.stderr);
    let record = read_json(&out.path().join("a.json"));
    assert_schema(&record);
    let run = &record["runs"][0];
    assert!(run["image"].is_null() && run["warnings"].to_string().contains("without a picture"), "{run}");
    assert!(out.path().join("a.csv").is_file());
}

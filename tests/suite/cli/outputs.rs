//! Destinations of results are checked before the long work, and a failed run harms no older file.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use fumarole::image::{Rgba8, write_png};

use super::program::{ONCE, Program, assert_schema, caustics, entries, file, folder, fumarole, read_json, terrain};
use crate::common::beside_others;

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

/// Its longest name, too, that of the part beside the last picture.
#[test]
fn a_name_that_is_too_long_is_refused_before_the_work() {
    let out = folder();
    let name = |length: usize| format!("{}.png", "n".repeat(length - 4));
    for option in ["json", "csv", "trace", "image"] {
        for path in [name(256), format!("new/{}", name(256)), format!("{}/a.png", name(256))] {
            let told = "longer than the system takes; shorten ";
            long(out.path()).arg(format!("--{option}={path}")).run().refused(2, &[told, &path]);
        }
    }
    for (options, length) in [("--frame 0..100000", 251), ("--rows 0..4", 240)] {
        let program = caustics("render --device none").args(options).arg("--image").arg(name(length));
        program.inside(out.path()).run().refused(2, &["longer than the system takes"]);
    }
    assert!(entries(out.path()).is_empty());
}

/// A file would else take the place of one that was written before it, or that was read.
#[test]
fn outputs_that_are_one_file_or_an_input_are_refused() {
    let out = folder();
    fs::create_dir(out.path().join("sub")).unwrap();
    let picture = Rgba8::new(2, 2, [90, 120, 60, 255].repeat(4)).unwrap();
    write_png(&out.path().join("land.png"), &picture).unwrap();
    let before = fs::read(out.path().join("land.png")).unwrap();
    for options in [
        "--json a --csv a",
        "--csv a.png --trace sub/../a.png --json b",
        "--image a.png --trace ./a.png",
        "--json new/a --csv new/er/../a",
    ] {
        long(out.path()).args(options).run().refused(2, &["two outputs"]);
    }
    for options in ["--json new/a --csv new", "--csv new --trace sub/../new/er/a"] {
        long(out.path()).args(options).run().refused(2, &["new: one output", "another below it"]);
    }
    // Files that no option names are among them.
    let own = "experiment 5-1 --out . --json caustics-5-1.csv";
    caustics(own).inside(out.path()).on_test_device().run().refused(2, &["caustics-5-1.csv", "two outputs"]);
    fumarole("ab --out . --json ab-b.json lava").inside(out.path()).run().refused(2, &["ab-b.json", "two outputs"]);
    let variants = "--variant level-map,volumetric --image a.png --csv a-volumetric.png";
    long(out.path()).args(variants).run().refused(2, &["a-volumetric.png", "two outputs"]);
    let dumps = "--dump caustics-map=a.png --dump position-map=./a.png";
    for options in [dumps, "--dump caustics-map=b.png --image b.png"] {
        let render = caustics("render --image c.png").args(options).inside(out.path()).tiny();
        render.run().refused(2, &["two outputs"]);
    }
    for verb in ["render --image sub/../land.png", "render --dump depth=land.png", "bench --csv land.png"] {
        let program = terrain(verb).args("--drape land.png --size 32x24").inside(out.path()).on_test_device();
        program.run().refused(2, &["land.png", "it is read"]);
    }
    assert_eq!(fs::read(out.path().join("land.png")).unwrap(), before);
    // Devices take what comes.
    let quiet = "--quiet --csv /dev/null --trace /dev/null";
    caustics("bench").args(quiet).args(ONCE).inside(out.path()).tiny().run().succeeded();
    let record = "bench --quiet --json a.json";
    caustics(record).args(ONCE).inside(out.path()).tiny().run().succeeded();
    fumarole("compare a.json a.json --json sub/../a.json")
        .inside(out.path())
        .run()
        .refused(2, &["a.json", "it is read"]);
    assert_schema(&read_json(&out.path().join("a.json")));
}

/// Its reader is there once, and gets all of the record.
#[test]
fn a_pipe_that_has_a_name_is_opened_once() {
    let out = folder();
    let pipe = out.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().unwrap();
    caustics("bench --quiet --json pipe").args(ONCE).inside(out.path()).tiny().run().succeeded();
    let read = reader.wait_with_output().unwrap();
    assert_schema(&serde_json::from_slice(&read.stdout).unwrap());
}

/// The system would wait for its reader, without a word and deaf to signals.
#[test]
fn a_pipe_that_no_one_reads_is_refused() {
    let out = folder();
    let pipe = out.path().join("pipe.png");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    long(out.path()).args("--image pipe.png").run().refused(2, &["pipe.png", "no one reads"]);
    caustics("render --image pipe.png").inside(out.path()).tiny().run().refused(2, &["pipe.png", "no one reads"]);
}

/// A limit of the shell on the size of files would else end the program by a signal.
#[test]
fn a_file_beyond_the_limit_of_its_size_is_told() {
    let out = folder();
    let program = caustics("bench --quiet --json a.json").args(ONCE).tiny().for_shell();
    let limited = format!("ulimit -f 1; exec {program}");
    let ended = Command::new("sh").args(["-c", &limited]).current_dir(out.path()).stdin(Stdio::null()).output();
    let ended = ended.unwrap();
    let stderr = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), stderr.lines().count()), (Some(2), 1), "{stderr}");
    assert!(stderr.contains("a.json") && entries(out.path()).is_empty(), "{stderr}");
}

#[test]
fn the_main_job_names_its_pictures_itself() {
    let out = folder();
    fumarole("all --image a.png").inside(out.path()).run().refused(2, &["--image", "--out"]);
    for named in ["--csv terrain.png", "--report=fumarole.json"] {
        let all = fumarole("all --out . --device no-such").args(named).inside(out.path());
        all.run().refused(2, &["two outputs"]);
    }
    assert!(entries(out.path()).is_empty());
    // Of the last paper, too, before the first is measured.
    fs::create_dir(out.path().join("terrain.png")).unwrap();
    fumarole("all --out . --device no-such").inside(out.path()).run().refused(2, &["terrain.png"]);
}

/// The picture of the second paper cannot be written any more, and the rest is interrupted.
#[test]
fn the_main_job_keeps_what_it_has_measured() {
    let out = folder();
    let ended = beside_others(|| {
        let mut running = fumarole("all --out .").on_test_device().inside(out.path()).start();
        let begun = Instant::now();
        while !out.path().join("lava.png").exists() && !running.has_ended() {
            assert!(begun.elapsed() < Duration::from_secs(100), "lava takes long");
            thread::sleep(Duration::from_millis(20));
        }
        fs::create_dir(out.path().join("gas.png")).unwrap();
        thread::sleep(Duration::from_secs(2));
        assert!(Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap().success());
        running.end()
    });
    let record = read_json(&out.path().join("fumarole.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    let of = |paper: &str| runs.iter().filter(|run| run["paper"] == paper).collect::<Vec<_>>();
    assert!(!of("lava").is_empty(), "{record}");
    // Interrupted before a frame of it was finished, it has none.
    if let Some(first) = of("gas").first() {
        assert!(first["image"].is_null() && first["warnings"].to_string().contains("without a picture"), "{first}");
        assert_eq!(ended.status.code(), Some(2), "{}", ended.stderr);
    }
}

#[test]
fn a_name_that_promises_something_else_is_refused() {
    let out = folder();
    long(out.path()).args("--image picture.exr").run().refused(2, &["--image picture.exr", "PNG"]);
    for option in ["csv", "trace"] {
        long(out.path()).args(&format!("--{option} -")).run().refused(2, &["-", "--json"]);
    }
    fumarole("report a.json -o -").inside(out.path()).run().refused(2, &["-o -", "a report is a file"]);
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

/// Of a run that is refused after its destinations were found to be good.
#[test]
fn a_refused_run_makes_no_folders() {
    let out = folder();
    for (program, part) in [
        (caustics("bench --json new/a.json --csv new/er/a.csv --image other/a.png --device no-such"), "no-such"),
        (caustics("experiment 5-1 --out new --device no-such"), "no-such"),
        (caustics("render --out new --dump caustics-map=other/a.exr --mesh no-such.obj"), "no-such.obj"),
    ] {
        program.inside(out.path()).run().refused(2, &[part]);
        assert_eq!(entries(out.path()), [""; 0]);
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

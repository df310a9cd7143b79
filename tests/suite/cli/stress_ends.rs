//! Ends of a series of `stress` by itself on a real device: loops that the driver cut, a lost device; and several devices in
//! one call.

use std::fs::File;
use std::process::Command;
use std::time::{Duration, Instant};

use super::program::{Program, caustics, device, entries, file, folder, fumarole, gas, lava, read_json, terrain};
use super::stress::{assert_schema, kinds, record, steps};
use super::terrain::canyon;
use crate::drivers::driver_manifest;
use crate::faults::Layer;

/// One step of 60 planes: the next would have more than the axis.
fn one_step() -> Program {
    caustics("stress --axis planes --from 60 --factor 100 --budget 60 --quiet")
        .args("--size 32x24 --map-size 16 --water-triangles 100")
}

#[test]
fn loops_that_the_driver_cut_stop_it_for_correctness() {
    let out = folder();
    file(&out, "canyon.asc", canyon());
    let scene = "stress --axis screen --from 825 --variants gpu-compute --map canyon.asc --lod exact --interpolation bicubic \
                 --budget 60 --camera=-81820,50,0,-81819,50,0";
    let climb = || terrain(scene).args("--out climb").on_test_device().inside(out.path()).run().succeeded();
    let ended = climb();
    assert!(ended.stdout.contains("stopped by correctness"), "{}", ended.stdout);
    let first = record(&out.path().join("climb"));
    assert_eq!(kinds(&first), ["correctness"]);
    let reason = first["series"][0]["stop"]["reason"].as_str().unwrap();
    assert!(reason.contains("depth") && reason.contains("rays did not end"), "{reason}");
    // What is wrong stays wrong: a second call does not try it.
    climb();
    assert_eq!(record(&out.path().join("climb"))["series"], first["series"]);
}

#[test]
fn a_lost_device_ends_its_series_and_the_record_says_so() {
    let (layer, out) = (Layer::new(), folder());
    let climb = |failing: &str| {
        let program = one_step().args("--anew --out").arg(out.path()).on_test_device();
        let ended = layer.before(program, false).env("FUMAROLE_LAYER_FAIL", failing).run().succeeded();
        (record(out.path()), layer.report(&ended))
    };
    let (whole, report) = climb("");
    assert_eq!((kinds(&whole), steps(&whole).len()), (vec!["end"], 1));
    // The report is that of the last process, the step's; late in it frames are drawn.
    let (_, submissions) = report.calls.iter().find(|(name, _)| name == "vkQueueSubmit2").unwrap();
    let (lost, report) = climb(&format!("vkQueueSubmit2@{}:lost", submissions * 3 / 4));
    assert!(report.failed.is_some());
    assert_eq!((kinds(&lost), steps(&lost).len()), (vec!["device"], 0));
    let reason = lost["series"][0]["stop"]["reason"].as_str().unwrap();
    assert!(reason.contains("device") && reason.contains("lost"), "{reason}");
}

/// It takes one record, and that of a step would be its end: said before the first step.
#[test]
fn a_pipe_is_no_place_for_what_is_written_after_every_step() {
    let out = folder();
    assert!(Command::new("mkfifo").arg(out.path().join("pipe")).status().unwrap().success());
    // Open at both ends, so that neither waits.
    let _held = File::options().read(true).write(true).open(out.path().join("pipe")).unwrap();
    for anew in ["", "--anew"] {
        let program = one_step().args("--json pipe").args(anew).on_test_device().inside(out.path());
        program.run().refused(2, &["writing pipe: it is a pipe", "one record", "name a regular file", "--json -"]);
    }
    assert_eq!(entries(out.path()), ["pipe"]);
}

#[test]
fn a_device_that_is_not_there_is_told_before_the_steps_on_another() {
    let out = folder();
    let program = one_step().args("--out . --devices").arg(format!("{},no-such", device())).inside(out.path());
    program.run().refused(2, &["\"no-such\" names none of"]);
    assert_eq!(entries(out.path()), [""; 0]);
}

#[test]
fn a_file_in_place_of_the_folder_is_no_record_to_go_on_with() {
    let out = folder();
    file(&out, "file", "");
    for program in [one_step(), fumarole("stress")] {
        let ended = program.args("--device none --out file").inside(out.path()).run();
        assert!(!ended.stderr.contains("--anew"), "{}", ended.stderr);
        ended.refused(2, &["cannot create the directory file"]);
    }
}

/// A mesh that no device of the least heap holds is refused before a mesh is divided, which would take gigabytes.
#[test]
fn triangles_beyond_the_device_stop_it_before_the_work() {
    let layer = Layer::new();
    for (program, axis) in [
        (caustics("stress"), "receiver-triangles"),
        (lava("stress"), "object-triangles"),
        (terrain("stress"), "object-triangles"),
        (gas("stress"), "surface-triangles"),
    ] {
        let out = folder();
        let program =
            program.args("--from 190000000 --budget 60 --quiet --axis").arg(axis).arg("--out").arg(out.path());
        let begun = Instant::now();
        layer.least(program.on_test_device()).run().succeeded();
        let record = record(out.path());
        assert_eq!((kinds(&record), steps(&record).len()), (vec!["memory"], 0), "{record}");
        let reason = record["series"][0]["stop"]["reason"].as_str().unwrap();
        assert!(reason.contains("--mesh") || reason.contains("--object"), "{reason}");
        assert!(begun.elapsed() < Duration::from_secs(15), "{axis}: {:?}", begun.elapsed());
    }
}

#[test]
fn each_device_has_a_record() {
    let out = folder();
    let devices = format!("{},SwiftShader", device());
    let program = one_step().env("VK_ADD_DRIVER_FILES", driver_manifest(&out)).arg("--devices").arg(devices);
    program.arg("--out").arg(out.path().join("climb")).run().succeeded();
    let names: Vec<String> =
        entries(&out.path().join("climb")).into_iter().filter(|name| name.ends_with(".json")).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    let mut drawn = Vec::new();
    for name in names {
        let record = read_json(&out.path().join("climb").join(name));
        assert_schema(&record);
        assert_eq!((kinds(&record), steps(&record).len()), (vec!["end"], 1));
        drawn.push(record["environment"]["device"]["name"].as_str().unwrap().to_owned());
    }
    assert!(drawn[0] != drawn[1] && drawn.iter().any(|name| name.contains("SwiftShader")), "{drawn:?}");
}

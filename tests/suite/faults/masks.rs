//! Every feature of the capability report taken away: each paper falls back and says so, or refuses by name. Devices of fewer
//! bits, queues and versions, and of limits that cut what is drawn into pieces; see `limits` for each limit.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{Layer, PAPERS, Paper};
use crate::cli::program;
use crate::cli::program::{Ended, ONCE, fumarole};

/// One frame of each kind.
pub const ONE_FRAME: &str = "--frames 1 --repeat 1 --warmup 1 --no-limits";

/// A run of every variant on the lesser device, under validation of it.
fn run_all(paper: &Paper, layer: &Layer, variable: &str, value: &str) -> Ended {
    let program = paper.run("bench --variant all --quiet --json").args(ONE_FRAME);
    // Of a device without this one, which Vulkan 1.3 does not allow, layer 1.3.239 warns that a stage writes what the next
    // does not read (UNASSIGNED-CoreValidation-Shader-OutputNotConsumed), which is allowed:
    // github.com/KhronosGroup/Vulkan-ValidationLayers/issues/4579.
    layer.before(program, value != "maintenance4").env(variable, value).run()
}

/// Warnings of all runs of a record.
fn warnings(record: &Value) -> String {
    record["runs"].as_array().unwrap().iter().map(|run| run["warnings"].to_string()).collect()
}

fn features() -> Vec<String> {
    let listed = fumarole("devices --json").run().succeeded().json();
    listed[0]["features"].as_object().unwrap().keys().cloned().collect()
}

/// Warning that a record must have, where a paper goes on without a feature.
fn said(paper: &str, feature: &str) -> Option<&'static str> {
    match (paper, feature) {
        ("lava" | "gas", "geometry-shader") => Some("no geometry stage"),
        (_, "timestamps") => Some("no timestamps"),
        (_, "pipeline-statistics") => Some("no pipeline statistics"),
        (_, "precise-occlusion") => Some("no exact counts of samples"),
        _ => None,
    }
}

/// Features whose lack is the only one of a run: what stands in for one hides another's, or is not validated.
const ALONE: [&str; 3] = ["maintenance4", "pipeline-statistics", "precise-occlusion"];

/// Runs a paper without each feature: refused without one that it needs, and without the others told of what they cost it.
fn assert_without(paper: &Paper) {
    let layer = Layer::new();
    let mut together = Vec::new();
    for feature in features() {
        let devices = layer.before(fumarole("devices --json"), false).env("FUMAROLE_LAYER_LACKS", &feature);
        let devices = devices.run().succeeded().json();
        assert_eq!(devices[0]["features"][&feature], false, "{feature}");
        let lacks = &devices[0]["papers"][paper.name]["lacks"];
        if !lacks.as_array().unwrap().is_empty() {
            assert_eq!(lacks, &serde_json::json!([feature]));
            run_all(paper, &layer, "FUMAROLE_LAYER_LACKS", &feature).refused(3, &[&feature, "lacks"]);
        } else if ALONE.contains(&feature.as_str()) {
            assert_goes_on_without(paper, &layer, &[feature]);
        } else {
            together.push(feature);
        }
    }
    assert_goes_on_without(paper, &layer, &together);
}

fn assert_goes_on_without(paper: &Paper, layer: &Layer, features: &[String]) {
    let record = run_all(paper, layer, "FUMAROLE_LAYER_LACKS", &features.join(",")).succeeded().json();
    let warnings = warnings(&record);
    for said in features.iter().filter_map(|feature| said(paper.name, feature)) {
        assert!(warnings.contains(said), "{} without {features:?}: {warnings}", paper.name);
    }
}

#[test]
fn lava_without_each_feature() {
    assert_without(&PAPERS[0]);
}

#[test]
fn gas_without_each_feature() {
    assert_without(&PAPERS[1]);
}

#[test]
fn caustics_without_each_feature() {
    assert_without(&PAPERS[2]);
}

#[test]
fn burning_without_each_feature() {
    assert_without(&PAPERS[3]);
}

#[test]
fn terrain_without_each_feature() {
    assert_without(&PAPERS[4]);
}

#[test]
fn narrow_time_stamps_are_read_as_such() {
    let ended = run_all(&PAPERS[2], &Layer::new(), "FUMAROLE_LAYER_LIMITS", "timestamp-valid-bits=36");
    let record = ended.succeeded().json();
    assert_eq!(record["environment"]["device"]["timestamp_bits"], 36);
}

/// Timestamps of 12 bits come round every 4 microseconds here, which no frame of these keeps to: of passes on the host beside
/// those of the device, and of a variant on the host alone.
#[test]
fn times_that_time_stamps_cannot_tell_are_absent_and_said_so() {
    let layer = Layer::new();
    for paper in [&PAPERS[0], &PAPERS[4]] {
        let ended = run_all(paper, &layer, "FUMAROLE_LAYER_LIMITS", "timestamp-valid-bits=12");
        let record = ended.succeeded().json();
        for run in record["runs"].as_array().unwrap() {
            let passes = run["passes"].as_array().unwrap().iter();
            let device: Vec<_> = passes.filter(|pass| pass["kind"] != "host").collect();
            if device.is_empty() {
                continue;
            }
            let warnings = run["warnings"].to_string();
            let name = device[0]["name"].as_str().unwrap();
            assert!(device.iter().all(|pass| pass["gpu_ms"].is_null()), "{} {name}", paper.name);
            assert!(run["overlap_ms"].is_null() && run["unaccounted_ms"].is_null(), "{} {name}", paper.name);
            assert!(warnings.contains("runs longer than they count") && warnings.contains(name), "{warnings}");
        }
    }
}

#[test]
fn a_device_of_the_portability_subset_is_used_and_its_lacks_are_named() {
    let layer = Layer::new();
    let devices =
        |arguments: &str| layer.before(fumarole(arguments), false).env("FUMAROLE_LAYER_LACKS", "whole-vulkan");
    let listed = devices("devices --json").run().succeeded().json();
    let lacks = listed[0]["portability_lacks"].as_array().unwrap();
    assert!(lacks.contains(&"triangle-fans".into()) && lacks.len() == 15, "{lacks:?}");
    let text = devices("devices").run().succeeded().stdout;
    assert!(text.contains("triangle-fans"), "{text}");
    for paper in &PAPERS {
        // The layer refuses to open the device without the subset's extension.
        let program = paper.run("bench --quiet --json").args(ONCE);
        layer.before(program, false).env("FUMAROLE_LAYER_LACKS", "whole-vulkan").run().succeeded();
    }
}

/// A trace of a device whose clock cannot be read beside the host's: the work of a submission begins where it was handed in, and
/// takes as long as the timestamps say.
#[test]
fn work_that_no_calibrated_clock_places_begins_where_it_was_submitted() {
    let layer = Layer::new();
    let path = layer.folder.path().join("trace.json");
    let begins_with_wait = |lacks: &str| {
        let program = program::caustics("bench --variant level-map --quiet --trace").arg(&path).tiny().args(ONCE);
        layer.before(program, false).env("FUMAROLE_LAYER_LACKS", lacks).run().succeeded();
        let trace = program::read_json(&path);
        let spans = trace["traceEvents"].as_array().unwrap().iter().filter(|event| event["ph"] == "X");
        let mut first = BTreeMap::<_, [f64; 2]>::new();
        for span in spans {
            let (arguments, start) = (&span["args"], span["ts"].as_f64().unwrap());
            let track = ["GPU", "wait"].into_iter().position(|track| span["cat"] == track);
            let frame = ["mode", "repetition", "frame"].map(|name| arguments[name].to_string());
            if let Some(track) = track {
                let earliest = &mut first.entry(frame).or_insert([f64::INFINITY; 2])[track];
                *earliest = earliest.min(start);
            }
        }
        let timed: Vec<_> = first.into_iter().filter(|(frame, _)| frame[0] != "\"plain\"").collect();
        assert_eq!(timed.len(), 4, "two frames, timestamped and bracketed");
        assert!(timed.iter().all(|(_, [gpu, wait])| gpu.is_finite() && wait.is_finite()));
        timed.iter().filter(|(_, [gpu, wait])| gpu == wait).count()
    };
    assert_eq!(begins_with_wait("whole-vulkan"), 4, "the subset's device has no other extension");
    assert!(begins_with_wait("") < 4);
}

#[test]
fn a_device_without_the_queue_is_named() {
    let layer = Layer::new();
    for paper in &PAPERS {
        let ended = run_all(paper, &layer, "FUMAROLE_LAYER_LACKS", "compute-queue");
        ended.refused(3, &["a queue with graphics and compute"]);
    }
}

/// It is asked for nothing that its version lacks, lists no feature, and no paper takes it.
#[test]
fn a_device_of_an_older_vulkan_is_listed_and_refused() {
    let layer = Layer::new();
    for version in ["1.0", "1.1", "1.2"] {
        let devices = layer.before(fumarole("devices --json"), false).env("FUMAROLE_LAYER_VULKAN", version);
        let devices = devices.run().succeeded().json();
        assert!(devices[0]["api_version"].as_str().unwrap().starts_with(version), "{version}: {}", devices[0]);
        let features = devices[0]["features"].as_object().unwrap();
        assert!(features.values().all(|has| has == false), "{version}: {features:?}");
        for paper in &PAPERS {
            assert_eq!(devices[0]["papers"][paper.name]["lacks"][0], "Vulkan 1.3", "{version}: {}", paper.name);
            run_all(paper, &layer, "FUMAROLE_LAYER_VULKAN", version).refused(3, &["lacks Vulkan 1.3"]);
        }
    }
}

/// A ball of triangles as a binary STL file.
fn ball(side: u32) -> Vec<u8> {
    let mesh = fumarole::scene::shapes::sphere(side, side);
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangle_count() as u32).to_le_bytes());
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = triangle.iter().flat_map(|&corner| mesh.positions[corner as usize].to_array());
        bytes.extend([0.0; 3].into_iter().chain(corners).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Bound storage buffers of 64 KiB at most: meshes and lists are cut, and nothing of the picture changes.
#[test]
fn pictures_in_pieces_are_those_in_one() {
    let layer = Layer::new();
    let folder = program::folder();
    let object = program::file(&folder, "ball.stl", ball(60));
    let object = object.to_str().unwrap();
    let scenes = [
        ("lava", format!("--object {object}"), None),
        ("gas", format!("--object {object} --variant table"), Some("triangles-1")),
        ("gas", format!("--object {object} --no-geometry-stage --variant no-volume"), Some("vertices-1")),
        ("caustics", format!("--mesh {object} --variant level-map"), Some("tree-1")),
        ("caustics", format!("--mesh {object} --variant level-map --camera below"), Some("tree-1")),
        ("terrain", format!("--object {object}@0,0,0,500 --shadows --variant gpu-compute"), Some("tree-1")),
        ("terrain", format!("--object {object}@0,0,0,500 --shadows --variant gpu-fragment"), Some("tree-1")),
        // Its lists fit, and are not cut.
        ("lava", "--variant gpu-driven".to_owned(), None),
    ];
    for (number, (name, scene, cut)) in scenes.iter().enumerate() {
        let paper = PAPERS.iter().find(|paper| paper.name == *name).unwrap();
        let picture = |limits: Option<&str>| {
            let path = folder.path().join(format!("{number}.png"));
            let kept = paper.scene.replace("--mesh box", "").replace("--mesh sphere --triangles 100", "");
            let program =
                (paper.program)("bench --quiet --json").args(&kept).args(scene).args(ONE_FRAME).on_test_device();
            let program = layer.before(program.arg("--image").arg(&path), false);
            let program = limits.into_iter().fold(program, |program, l| program.env("FUMAROLE_LAYER_LIMITS", l));
            let record = program.run().succeeded().json();
            (std::fs::read(path).unwrap(), record["runs"][0]["memory"]["by_resource"].to_string())
        };
        let (whole, all) = picture(None);
        let (pieced, resources) = picture(Some("max-storage-buffer-range=65536"));
        if let Some(cut) = cut {
            assert!(resources.contains(cut) && !all.contains(cut), "{name} {scene}: {resources}");
        }
        assert!(whole == pieced, "{name} {scene}");
    }
}

/// Forty workgroups along an axis at most: what is dispatched by elements lies in rows, and nothing of the picture changes.
#[test]
fn pictures_in_rows_of_workgroups_are_those_in_one() {
    let layer = Layer::new();
    let folder = program::folder();
    let fire = "--size 24x16 --blocks 2x2x2 --fire 20 --smoke 10 --flammability 10 --mesh sphere --triangles 12000 --speed 1 \
                --first-frame 40";
    let water = "--size 32x24 --map-size 64 --planes 5 --mesh box --water-triangles 12000";
    let flow = "--size 32x24 --particles 4000 --radius 0.1 --density 8x4x4 --splats 10x5 --splat-radius 0.2";
    let scenes = [
        ("burning", format!("{fire} --variant shell")),
        ("burning", format!("{fire} --variant solid")),
        ("burning", format!("{fire} --variant melting")),
        ("burning", format!("{fire} --variant shell --look dissertation")),
        ("caustics", format!("{water} --variant culled")),
        (
            "caustics",
            format!("{} --variant culled --smart --water-map volcano --water-map-range 0.1", water.replace("64", "32")),
        ),
        ("caustics", format!("{water} --variant hit")),
        ("caustics", format!("{water} --variant hit --water-map volcano --water-map-range 0.1")),
        ("lava", format!("{flow} --variant gpu-driven")),
        ("lava", format!("{flow} --variant gpu-driven --simulation sph")),
    ];
    for (number, (name, scene)) in scenes.iter().enumerate() {
        let paper = PAPERS.iter().find(|paper| paper.name == *name).unwrap();
        let picture = |limits: Option<&str>| {
            let path = folder.path().join(format!("{number}.png"));
            let program = (paper.program)("render --quiet --frame 1").args(scene).on_test_device();
            let program = layer.before(program.arg("--image").arg(&path), false);
            limits.into_iter().fold(program, |program, l| program.env("FUMAROLE_LAYER_LIMITS", l)).run().succeeded();
            std::fs::read(path).unwrap()
        };
        assert!(picture(None) == picture(Some("max-compute-work-group-count=40")), "{name} {scene}");
    }
}

/// A device without `fullDrawIndexUint32`: a kernel keeps indices at its largest, which meshes that fit never reach, and what
/// does not fit is refused.
#[test]
fn pictures_with_fewer_indices_are_those_with_all() {
    let layer = Layer::new();
    let folder = program::folder();
    let object = program::file(&folder, "ball.stl", ball(8));
    let object = format!("--object {}", object.display());
    for (name, scene) in [
        ("burning", "--variant shell"),
        ("caustics", "--variant culled"),
        ("lava", object.as_str()),
        ("terrain", "--variant mesh"),
    ] {
        let paper = PAPERS.iter().find(|paper| paper.name == name).unwrap();
        let picture = |limits: Option<&str>| {
            let path = folder.path().join(format!("{name}.png"));
            let program = paper.run("render --quiet --frame 1").args(scene).arg("--image").arg(&path);
            let program = layer.before(program, limits.is_some());
            let lesser = |program: program::Program, limits: &str| {
                program.env("FUMAROLE_LAYER_LACKS", "full-draw-index").env("FUMAROLE_LAYER_LIMITS", limits)
            };
            (limits.into_iter().fold(program, lesser).run(), path)
        };
        let read = |(ended, path): (Ended, std::path::PathBuf)| {
            ended.succeeded();
            std::fs::read(path).unwrap()
        };
        let all = read(picture(None));
        assert!(all == read(picture(Some("max-draw-indexed-index-value=16777215"))), "{name} {scene}");
        if matches!(name, "caustics" | "lava") {
            let (ended, _) = picture(Some("max-draw-indexed-index-value=5"));
            ended.refused(2, &["index of a vertex", "limit of 5"]);
        }
    }
}

/// A device whose heaps hold less than they say, as where other programs have the rest.
#[test]
fn memory_that_is_gone_is_told() {
    for paper in &PAPERS {
        let layer = Layer::new();
        let program = layer.before(paper.run("render --quiet --image a.png"), false);
        let ended = program.env("FUMAROLE_LAYER_HEAPS", "10000").run();
        assert_eq!(layer.report(&ended).alive, [""; 0], "{}: {}", paper.name, ended.stderr);
        ended.refused(1, &["out of memory"]);
    }
}

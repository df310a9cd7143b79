//! Every variant's picture on SwiftShader against that of the device of the tests, and what the papers do without its
//! geometry stage and statistics.

use std::fs;

use fumarole::image::{Rgba8, read_png};
use tempfile::TempDir;

use super::{BURNING, CAUSTICS, CAUSTICS_SMART, GAS, LAVA, Paper, TERRAIN, driver_manifest};
use crate::cli::program::{ONCE, Program, SCENE, burning, caustics, folder, fumarole, lava, terrain};

/// Most that the pictures of two drivers differ on average, of 255: edges of triangles and points fall on other pixels, since
/// SwiftShader rounds places to 16ths of a pixel, as coarsely as Vulkan allows, and lavapipe to 256ths; filters have other fractions.
const MEAN: f64 = 0.30;
/// Most at the 99th percentile, of 255.
const P99: u8 = 2;

fn on_swiftshader(program: Program, folder: &TempDir) -> Program {
    let manifest = driver_manifest(folder);
    program.env("VK_DRIVER_FILES", &manifest).env("VK_ICD_FILENAMES", &manifest).args("--device SwiftShader")
}

/// Mean and 99th percentile of the differences of all colour channels.
fn difference(a: &Rgba8, b: &Rgba8) -> (f64, u8) {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()));
    let channels = a.pixels().iter().zip(b.pixels()).map(|(a, b)| a.abs_diff(*b));
    let mut colors: Vec<u8> = channels.enumerate().filter(|(i, _)| i % 4 != 3).map(|(_, differs)| differs).collect();
    colors.sort_unstable();
    let sum: u64 = colors.iter().map(|&differs| u64::from(differs)).sum();
    (sum as f64 / colors.len() as f64, colors[colors.len() * 99 / 100])
}

fn assert_same_pictures(paper: &Paper) {
    let folder = folder();
    let picture = |program: Program, variant: &str| {
        let path = folder.path().join("picture.png");
        program.args("--quiet --variant").arg(variant).arg("--image").arg(&path).run().succeeded();
        read_png(&path).unwrap()
    };
    for variant in paper.variants() {
        let expected = picture(paper.run("render").on_test_device(), &variant);
        for compiler in ["glslang", "naga"] {
            let program = paper.run("render").args("--shader-compiler").arg(compiler);
            let program = paper.under_current_layer(on_swiftshader(program, &folder), &folder);
            let (mean, p99) = difference(&expected, &picture(program, &variant));
            assert!(mean <= MEAN && p99 <= P99, "{variant}, {compiler}: {mean:.3} on average, {p99} at p99");
        }
    }
}

#[test]
fn lava_looks_the_same() {
    assert_same_pictures(&LAVA);
}

#[test]
fn gas_looks_the_same() {
    assert_same_pictures(&GAS);
}

#[test]
fn caustics_looks_the_same() {
    assert_same_pictures(&CAUSTICS);
    assert_same_pictures(&CAUSTICS_SMART);
}

#[test]
fn burning_looks_the_same() {
    assert_same_pictures(&BURNING);
}

#[test]
fn terrain_looks_the_same() {
    assert_same_pictures(&TERRAIN);
}

#[test]
fn grid_points_on_the_radius_of_a_splat_count_on_both() {
    let folder = folder();
    let sums = |program: Program| {
        let [dump, picture] = ["sums.npy", "picture.png"].map(|name| folder.path().join(name));
        let program =
            program.args("--variant paper --quiet --dump").arg(format!("accumulated-depths={}", dump.display()));
        program.arg("--image").arg(&picture).run().succeeded();
        words(&fs::read(&dump).unwrap()).into_iter().map(f32::from_bits).collect::<Vec<f32>>()
    };
    // A radius of two columns.
    let scene = || lava("render --size 32x24 --particles 2000 --radius 0.16 --density 50x12x12 --splats 10x5");
    let [ours, theirs] = [scene().on_test_device(), on_swiftshader(scene(), &folder)].map(sums);
    let apart = ours.iter().zip(&theirs).filter(|(a, b)| (**a - **b).abs() > 1e-3 * a.abs()).count();
    assert!(ours.iter().filter(|sum| **sum > 0.0).count() > 100 && apart == 0, "{apart} of {} sums", ours.len());
}

#[test]
fn no_light_of_volumes_of_a_few_pixels_is_lost_on_either() {
    let folder = folder();
    let picture = |program: Program| {
        let path = folder.path().join("picture.png");
        program.args("--variant stencil --quiet --image").arg(&path).run().succeeded();
        read_png(&path).unwrap()
    };
    let still = || caustics("render --waves 0 --mesh plane --camera=0.3,-0.2,2.5,0,-3,0 --size 32x24 --samples 1");
    let [ours, theirs] = [still().on_test_device(), on_swiftshader(still(), &folder)].map(picture);
    let apart = ours.pixels().iter().zip(theirs.pixels()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(apart <= Some(2), "{apart:?} of 255");
}

/// Its compiler inlines every call, and rays in a round frame ask for places in many.
#[test]
fn land_over_a_round_base_looks_the_same() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    for options in [
        "--variant gpu-compute --base earth --interpolation bicubic",
        "--variant dda-fragment --base cylinder:20000 --shadows",
    ] {
        let picture = |program: Program| {
            let program = program.args("--resolution 128 --size 96x64 --quiet").args(options);
            program.arg("--image").arg(&path).run().succeeded();
            read_png(&path).unwrap()
        };
        let expected = picture(terrain("render").on_test_device());
        let (mean, p99) = difference(&expected, &picture(on_swiftshader(terrain("render"), &folder)));
        assert!(mean <= MEAN && p99 <= P99, "{options}: {mean:.3} on average, {p99} at p99");
    }
}

/// The fluid with its heat and its crust, in two processes on each driver.
#[test]
fn a_fluid_is_the_same_to_the_bit_on_every_run() {
    let folder = folder();
    let moved = |program: Program| {
        let [dump, picture] = ["positions.npy", "picture.png"].map(|name| folder.path().join(name));
        let program = program.args("--simulation sph --rheology basalt --heat-capacity 12 --frame 8 --quiet --dump");
        program.arg(format!("positions={}", dump.display())).arg("--image").arg(&picture).run().succeeded();
        fs::read(&dump).unwrap()
    };
    let small =
        || lava("render --size 32x24 --particles 300 --radius 0.3 --density 16x8x8 --splats 10x5 --splat-radius 0.2");
    let of_tests = [(); 2].map(|()| moved(small().on_test_device()));
    let of_swiftshader = [(); 2].map(|()| moved(on_swiftshader(small(), &folder)));
    assert!(of_tests[0] == of_tests[1] && of_swiftshader[0] == of_swiftshader[1]);
    assert!(of_tests[0].len() == of_swiftshader[0].len() && of_tests[0].len() > 300 * 16);
}

/// Numbers of a dump, as bits.
fn words(dump: &[u8]) -> Vec<u32> {
    let start = 10 + usize::from(u16::from_le_bytes([dump[8], dump[9]]));
    dump[start..].chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
}

/// A spider whose legs bend and come off, in two processes on each driver. Positions and what is left to burn are the same on
/// both; sines and cosines differ in their last bits, and so does what bends.
#[test]
fn what_bends_and_falls_is_the_same_to_the_bit_on_every_run() {
    let folder = folder();
    let burnt = |program: Program| {
        let [state, bends, parts] = ["state", "bends", "parts"].map(|name| (name, folder.path().join(name)));
        let dumps = [state, bends, parts].map(|(name, path)| (name, path.with_extension("npy")));
        let fire = "--speed 0.3 --flammability 30 --fire 0 --smoke 0 --size 32x24 --frame 90 --quiet --image";
        let mut program = program.args(fire).arg(folder.path().join("picture.png"));
        for (name, path) in &dumps {
            program = program.arg("--dump").arg(format!("{name}={}", path.display()));
        }
        program.run().succeeded();
        dumps.map(|(_, path)| fs::read(path).unwrap())
    };
    let spider = || burning("render --mesh").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/spider.obj"));
    let of_tests = [(); 2].map(|()| burnt(spider().on_test_device()));
    let of_swiftshader = [(); 2].map(|()| burnt(on_swiftshader(spider(), &folder)));
    assert!(of_tests[0] == of_tests[1] && of_swiftshader[0] == of_swiftshader[1]);
    let [[state, bends, _], [their_state, their_bends, _]] = [&of_tests[0], &of_swiftshader[0]];
    assert!(state == their_state);
    let numbers = |dump: &[u8]| words(dump).into_iter().map(f32::from_bits).collect::<Vec<f32>>();
    let (bends, their_bends) = (numbers(bends), numbers(their_bends));
    // The scalar parts of the quaternions, 1 of what has not bent.
    assert!(bends.chunks_exact(8).filter(|bend| bend[3] < 0.9999).count() > 20, "nothing bends");
    let apart = bends.iter().zip(&their_bends).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart < 1e-3, "bent otherwise by {apart}");
}

/// A driver against another: a side's environment and device are its own.
#[test]
fn it_may_be_a_side_of_ab() {
    let folder = folder();
    let manifest = driver_manifest(&folder);
    let mut program = fumarole("ab --blocks 2 --quiet --json --out").arg(folder.path());
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        program = program.arg("--env").arg(format!("B:{variable}={}", manifest.display()));
    }
    let program = program.arg("--b").arg("--device SwiftShader").args("caustics --variant level-map");
    let report = program.on_test_device().args(SCENE).args(ONCE).run().succeeded().json();
    let differences = report["differences"].as_array().unwrap();
    let name = differences.iter().find(|difference| difference["what"] == "device.name").expect("two devices");
    assert!(name["a"].to_string().contains("llvmpipe") && name["b"].to_string().contains("SwiftShader"), "{name}");
}

#[test]
fn what_it_lacks_is_listed() {
    let manifest = folder();
    let path = driver_manifest(&manifest);
    let listed = fumarole("devices --json").env("VK_DRIVER_FILES", &path).env("VK_ICD_FILENAMES", &path);
    let listed = listed.run().succeeded().json();
    let [found] = listed.as_array().unwrap().as_slice() else { panic!("{listed}") };
    let features = found["features"].as_object().unwrap().iter();
    let lacks: Vec<&str> = features.filter(|(_, has)| *has == false).map(|(name, _)| name.as_str()).collect();
    assert_eq!(lacks, ["geometry-shader", "pipeline-statistics"]);
    for (paper, capable) in found["papers"].as_object().unwrap() {
        assert_eq!(capable["capable"], true, "{paper}");
    }
}

#[test]
fn without_a_geometry_stage_and_statistics_a_record_says_so() {
    let manifest = folder();
    for (paper, pass) in [(LAVA, "blending"), (GAS, "fragments")] {
        let program = on_swiftshader(paper.run("bench --quiet --json").args(ONCE), &manifest);
        let record = program.run().succeeded().json();
        let run = &record["runs"][0];
        let warnings = run["warnings"].to_string();
        for part in ["no geometry stage", "no pipeline statistics"] {
            assert!(warnings.contains(part), "{warnings}");
        }
        let passes = run["passes"].as_array().unwrap();
        let statistics = &passes.iter().find(|found| found["name"] == pass).unwrap()["statistics"];
        assert!(statistics["vertices"].is_null() && statistics["compute_invocations"].is_null(), "{statistics}");
        assert!(statistics["samples_passed"].as_u64().is_some_and(|samples| samples > 0), "{statistics}");
    }
}

/// A loader hides a driver of the portability subset, as MoltenVK's manifest calls it, from programs that do not ask for such.
#[test]
fn a_driver_of_the_portability_subset_is_listed() {
    let folder = folder();
    let path = driver_manifest(&folder);
    let mut manifest: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    manifest["ICD"]["is_portability_driver"] = true.into();
    fs::write(&path, manifest.to_string()).unwrap();
    let listed = fumarole("devices --json").env("VK_DRIVER_FILES", &path).env("VK_ICD_FILENAMES", &path);
    let listed = listed.run().succeeded().json();
    assert!(listed[0]["name"].as_str().unwrap().contains("SwiftShader"), "{listed}");
}

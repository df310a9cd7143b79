//! Exit code 3 where the machine lacks something; and the validation layer.

use std::process::Command;

use super::program::{ONCE, Program, caustics, device, file, folder, fumarole};

/// Every verb that needs a device.
fn all_verbs() -> Vec<Program> {
    let own = ["bench", "bench --processes 2", "render", "passes", "experiment 5-1"].map(caustics);
    own.into_iter().chain([fumarole("devices"), fumarole("all"), fumarole("")]).collect()
}

#[test]
fn without_a_loader_every_verb_ends_with_3() {
    for bytes in [&b""[..], b"this is no library"] {
        let out = folder();
        file(&out, "libvulkan.so.1", bytes);
        for program in all_verbs() {
            let ended = program.inside(out.path()).env("LD_LIBRARY_PATH", out.path()).run();
            ended.refused(3, &["Vulkan loader", "install"]);
        }
    }
}

#[test]
fn without_a_driver_every_verb_ends_with_3() {
    let out = folder();
    for program in all_verbs() {
        let program = program.inside(out.path());
        let program = program.env("VK_DRIVER_FILES", "/no-such").env("VK_ICD_FILENAMES", "/no-such");
        program.run().refused(3, &["driver"]);
    }
}

/// A driver that finds too little memory is none to the loader.
#[test]
fn a_limit_of_memory_is_told_where_there_is_no_driver() {
    let out = folder();
    let limited = format!("ulimit -v 8388608; exec {}", fumarole("devices").for_shell());
    let mut shell = Command::new("sh");
    shell.args(["-c", &limited]).env("VK_DRIVER_FILES", "/no-such").env("VK_ICD_FILENAMES", "/no-such");
    let ended = shell.current_dir(out.path()).output().unwrap();
    let stderr = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), stderr.lines().count()), (Some(3), 1), "{stderr}");
    assert!(stderr.contains("driver") && stderr.contains("8192 MiB (ulimit -v)"), "{stderr}");
}

#[test]
fn without_the_layer_validation_ends_with_3() {
    let out = folder();
    let program = caustics("bench --validate").tiny().args(ONCE).env("VK_LAYER_PATH", out.path());
    program.run().refused(3, &["VK_LAYER_KHRONOS_validation", "--validate"]);
}

#[test]
fn a_run_under_validation_is_clean() {
    let options = "--validate --json --quiet --floor --mesh box --point-light 1,4,0 --light 0,-1,0";
    let ended = caustics("bench").tiny().args(ONCE).args(options).run().succeeded();
    assert_eq!(ended.stderr, "");
    let record = ended.json();
    assert_eq!(record["environment"]["layers"][0], "VK_LAYER_KHRONOS_validation");
    for run in record["runs"].as_array().unwrap() {
        assert_eq!(run["validation"], "clean");
        let warnings = run["warnings"].to_string();
        assert!(warnings.contains("validation layer is on"), "{warnings}");
    }
    let device = device();
    for verb in ["render --quiet", "passes", "experiment 5-1 --quiet --counts 3 --mesh box --no-limits"] {
        let out = folder();
        let program = caustics(verb).inside(out.path()).args("--size 96x64 --map-size 64 --water-triangles 500");
        program.args("--validate --device").arg(&device).run().succeeded();
    }
}

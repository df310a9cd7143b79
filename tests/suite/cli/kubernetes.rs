//! The Kubernetes manifest: by the schema of a Job, and by what the program makes of their command.

use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use super::program::{device, entries, folder};

fn source(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

fn manifest() -> Value {
    serde_json::from_str(&source("dist/kubernetes/film.json")).unwrap()
}

/// The schema's objections to a manifest.
fn wrong(manifest: &Value) -> Vec<String> {
    let schema: Value = serde_json::from_str(&source("tests/data/kubernetes-job.json")).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    validator.iter_errors(manifest).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

#[test]
fn the_manifest_is_an_indexed_job() {
    let job = manifest();
    assert_eq!(wrong(&job), [""; 0]);
    let spec = &job["spec"];
    assert_eq!(spec["completionMode"], "Indexed");
    let container = &spec["template"]["spec"]["containers"][0];
    // The shards are as many as the pods.
    assert_eq!(container["env"][0], json!({"name": "FUMAROLE_SHARDS", "value": spec["completions"].to_string()}));
    assert!(spec["backoffLimit"].as_u64() >= spec["completions"].as_u64());
    // What is mounted is a volume.
    let pod = &spec["template"]["spec"];
    assert_eq!(container["volumeMounts"][0]["name"], pod["volumes"][0]["name"]);
}

#[test]
fn the_schema_refuses_what_the_server_would() {
    let changed = |pointer: &str, value: Value| {
        let mut job = manifest();
        *job.pointer_mut(pointer).unwrap() = value;
        job
    };
    for (pointer, value) in [
        ("/apiVersion", json!("batch/v1beta1")),
        ("/spec/completionMode", json!("indexed")),
        ("/spec/completions", json!("6")),
        ("/spec/template/spec/restartPolicy", json!("Always")),
        ("/spec/template/spec/containers/0/env/0/value", json!(6)),
        ("/spec/template/spec/containers/0/resources/requests/memory", json!("2 GB")),
        ("/spec/template/spec/containers/0/volumeMounts/0", json!({"name": "film", "path": "/film"})),
        ("/spec/template/spec/volumes/0", json!({"name": "film", "persistentVolume": {"claimName": "film"}})),
    ] {
        assert_ne!(wrong(&changed(pointer, value)), [""; 0], "{pointer}");
    }
}

/// The container's command, as a shell of a pod would run it, draws its shard.
#[test]
fn the_command_of_a_pod_draws_its_shard() {
    let out = folder();
    let job = manifest();
    let container = &job["spec"]["template"]["spec"]["containers"][0];
    let mut words = container["command"].as_array().unwrap().iter().chain(container["args"].as_array().unwrap());
    let mut command = Command::new(words.next().unwrap().as_str().unwrap());
    for word in words {
        // Smaller, and where this test may write.
        let word = word.as_str().unwrap().replace("/film", &out.path().display().to_string());
        command.arg(
            word.replace("--frame 0..24", "--frame 0..6 --size 30x21 --device {device}").replace("{device}", &device()),
        );
    }
    let program = Path::new(env!("CARGO_BIN_EXE_fumarole"));
    let path = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    command.env("PATH", path).env("FUMAROLE_SHARDS", "6").env("JOB_COMPLETION_INDEX", "4");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(entries(&out.path().join("parts")), ["gas-surfaces-0004.png", "gas-surfaces-0004.png.part.json"]);
}

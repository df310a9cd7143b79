//! Records for the tests of everything that reads one.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::record::*;
use super::tables::{Row, Rows, SCHEMA, Tables};
use crate::measure::statistics::summarize;

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        other => panic!("not an object: {other}"),
    }
}

pub fn environment() -> Environment {
    Environment {
        date: "2026-01-31T12:00:00Z".to_owned(),
        device: Device {
            name: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
            kind: DeviceKind::Cpu,
            uuid: None,
            driver: None,
            driver_version: None,
            api_version: "1.3.230".to_owned(),
            timestamp_period: None,
            timestamp_bits: None,
        },
        host: Host {
            os: "Debian GNU/Linux 12 (bookworm)".to_owned(),
            kernel: None,
            cpu: None,
            logical_cores: Some(2),
            lp_num_threads: None,
            cpu_governor: None,
            variables: BTreeMap::new(),
        },
        loader: None,
        layers: vec![],
        build: Build {
            version: "0.1.0".to_owned(),
            git_commit: None,
            dirty: None,
            rustc: None,
            profile: None,
            executable_sha256: None,
        },
    }
}

/// A run of which nothing was measured.
pub fn run() -> Run {
    Run {
        paper: "gas".to_owned(),
        variant: "slices".to_owned(),
        preset: None,
        config: Map::new(),
        inputs: vec![],
        width: 800,
        height: 600,
        seed: 1,
        warmup: 0,
        frames: 0,
        repeat: 1,
        process: 0,
        started: None,
        frame_ms: None,
        passes: vec![],
        overlap_ms: None,
        unaccounted_ms: None,
        stamp_floor_ms: None,
        load_ms: None,
        loading: None,
        pipeline_ms: None,
        memory: Memory::default(),
        limits: None,
        results: Map::new(),
        experiment: None,
        profile: None,
        validation: Validation::Off,
        warnings: vec![],
        image: None,
    }
}

pub fn pass(name: &str, kind: PassKind) -> Pass {
    Pass {
        name: name.to_owned(),
        section: None,
        kind,
        calls: 1,
        submission: None,
        shader_compiler: None,
        shaders: vec![],
        gpu_ms: None,
        host_ms: None,
        wait_ms: None,
        statistics: None,
        bytes: None,
        counted_ms: None,
        floor_ms: None,
        bound: None,
        floors: BTreeMap::new(),
    }
}

pub fn minimal() -> Record {
    Record::new(environment(), vec![], vec![run()])
}

pub fn full() -> Record {
    let mut environment = environment();
    environment.device.uuid = Some("6d657361-3232-2e33-2e36-000000000000".to_owned());
    environment.device.driver = Some("llvmpipe".to_owned());
    environment.device.driver_version = Some("Mesa 22.3.6".to_owned());
    environment.device.timestamp_period = Some(1.0);
    environment.device.timestamp_bits = Some(64);
    environment.loader = Some("1.3.239".to_owned());
    environment.layers = vec!["VK_LAYER_KHRONOS_validation".to_owned()];
    environment.host.lp_num_threads = Some(2);
    let cluster = Pass {
        section: Some("4.1".to_owned()),
        host_ms: summarize(&[0.5, 0.5, 0.75]),
        wait_ms: summarize(&[0.25, 0.25, 0.25]),
        ..pass("cluster", PassKind::Host)
    };
    let splat = Pass {
        section: Some("4.2, \"splats\"".to_owned()),
        calls: 30,
        submission: Some(0),
        shader_compiler: Some("glslang".to_owned()),
        shaders: vec![ShaderBinary {
            name: "lava/splat.vert".to_owned(),
            sha256: "1".repeat(64),
            bytes: Some(420),
            instructions: Some(40),
        }],
        gpu_ms: summarize(&[1.5, 2.0, 2.5]),
        statistics: Some(Statistics { vertices: Some(90_000), fragments: Some(1_600_000), ..Statistics::default() }),
        bytes: Some(Bytes {
            read: 1024,
            written: 2048,
            at_most: Some(BytesAtMost { read: 4096, written: 2048 }),
            uncertain: vec!["density".to_owned()],
        }),
        counted_ms: Some(2.5),
        floor_ms: Some(0.5),
        bound: Some("vertices".to_owned()),
        floors: BTreeMap::from([("vertices".to_owned(), 0.5), ("memory".to_owned(), 0.25)]),
        ..pass("splat", PassKind::Graphics)
    };
    let run = Run {
        preset: Some("figure-7".to_owned()),
        config: object(json!({"planes": 30, "shadow": true, "density": [100, 24, 24]})),
        inputs: vec![InputFile { path: "bunny.ply".to_owned(), sha256: "2".repeat(64) }],
        started: Some("2026-01-31T12:00:01.500000Z".to_owned()),
        warmup: 2,
        frames: 3,
        frame_ms: summarize(&[5.0, 4.0, 6.0]),
        passes: vec![cluster, splat],
        overlap_ms: Some(0.1),
        unaccounted_ms: Some(2.5),
        stamp_floor_ms: Some(0.01),
        load_ms: Some(12.0),
        loading: Some(Loading {
            bytes: 1 << 22,
            read_ms: 4.0,
            weld_ms: 3.0,
            normals_ms: 2.0,
            optimise_ms: 2.5,
            cache_ms: 0.5,
            from_cache: 1,
        }),
        pipeline_ms: Some(80.0),
        memory: Memory {
            device_bytes: Some(1 << 20),
            host_bytes: Some(1 << 10),
            peak_bytes: Some(1 << 21),
            by_resource: vec![ResourceMemory { name: "density".to_owned(), bytes: 1 << 19 }],
        },
        limits: Some(Limits {
            copy_gb_s: Some(6.5),
            samples: summarize(&[6.0, 6.5, 7.0]).into_iter().map(|rates| ("copy_gb_s".to_owned(), rates)).collect(),
            ..Limits::default()
        }),
        results: object(json!({"fps": 200.0})),
        experiment: Some(ExperimentRow {
            row: "30 planes".to_owned(),
            paper: Some(40.0),
            ours: Some(5.0),
            ratio: Some(0.125),
            interval: Some([4.0, 6.0]),
        }),
        validation: Validation::Clean,
        warnings: vec!["LP_NUM_THREADS is not set".to_owned()],
        image: Some(ImageFile { path: "fumarole-out/gas.png".to_owned(), sha256: "0".repeat(64) }),
        ..run()
    };
    let command = vec!["gas".to_owned(), "bench".to_owned()];
    Record::new(environment, command, vec![run])
}

/// An experiment's tables.
pub fn tables() -> Tables {
    let row = |value| Row(object(value));
    let table = Rows {
        title: "Table 5-2: polygons of the models".to_owned(),
        columns: ["mesh", "triangles", "thesis", "note"].map(str::to_owned).to_vec(),
        rows: vec![
            row(json!({"mesh": "teapot", "triangles": 6320, "thesis": 6320.5, "note": null})),
            row(json!({"mesh": "sphere", "triangles": 960, "thesis": null, "note": null})),
        ],
    };
    let smallest = Rows {
        title: "The smallest".to_owned(),
        columns: vec!["frame ms".to_owned()],
        rows: vec![row(json!({"frame ms": 0.125}))],
    };
    Tables {
        schema: SCHEMA.to_owned(),
        paper: "caustics".to_owned(),
        experiment: "5-2".to_owned(),
        environment: environment(),
        command: ["fumarole", "caustics", "experiment", "5-2"].map(str::to_owned).to_vec(),
        table,
        more: BTreeMap::from([("smallest".to_owned(), smallest)]),
        warnings: vec!["the validation layer is on: times include it".to_owned()],
    }
}

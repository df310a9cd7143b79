//! Meshes that cannot be used: exit code 2 and one line that names the file and the place.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::Instant;

use fumarole::scene::random::Random;
use tempfile::TempDir;

use super::program::{Ended, ONCE, burning, caustics, entries, file, folder, gas, lava, terrain};
use crate::common::beside_others;
use crate::faults::Layer;

fn refuse(path: &Path, parts: &[&str]) {
    let name = path.file_name().unwrap().to_str().unwrap();
    let parts: Vec<&str> = parts.iter().copied().chain([name]).collect();
    caustics("bench --mesh").arg(path).tiny().args(ONCE).run().refused(2, &parts);
}

#[test]
fn an_obj_with_a_fault_is_refused_with_its_line() {
    let out = folder();
    for (name, text, parts) in [
        ("empty.obj", "", &["no faces"][..]),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["no faces"]),
        ("truncated.obj", "v 0 0 0\nv 1 0 0\nv 0 1", &["line 3"]),
        ("cut-face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", &["no faces"]),
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", &["line 4", "9"]),
        ("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["line 4"]),
        ("relative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n", &["line 4", "-9"]),
        ("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", &["line 2"]),
        ("infinite.obj", "v 0 0 0\nv 0 0 inf\nv 0 1 0\nf 1 2 3\n", &["line 2"]),
        ("words.obj", "v a b c\n", &["line 1"]),
        ("point.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", &["area"]),
        ("tiny.obj", "v 0 0 0\nv 1e-44 0 0\nv 0 1e-44 0\nf 1 2 3\n", &["1e-18", "has to be scaled up"]),
        ("vast.obj", "v -3e38 0 0\nv 3e38 0 0\nv 0 -3e38 0\nf 1 2 3\n", &["vertex 0", "1e18", "scaled down"]),
    ] {
        refuse(&file(&out, name, text), parts);
    }
}

#[test]
fn random_bytes_under_every_ending_are_refused() {
    let out = folder();
    let mut random = Random::new(5);
    for ending in ["obj", "ply", "stl", "gltf", "glb"] {
        let noise: Vec<u8> = (0..4096).map(|_| (random.next_u32() >> 24) as u8).collect();
        refuse(&file(&out, &format!("noise.{ending}"), &noise), &[]);
        refuse(&file(&out, &format!("nothing.{ending}"), ""), &[]);
        refuse(&file(&out, &format!("zeros.{ending}"), [0; 1024]), &[]);
        refuse(&file(&out, &format!("capitals.{}", ending.to_uppercase()), &noise), &[]);
    }
}

/// Every header claims far more than its file holds, or than any machine has.
#[test]
fn a_mesh_that_is_too_large_is_refused_unread() {
    let out = folder();
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
               property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n";
    refuse(&file(&out, "claims.ply", ply), &["4000000000"]);
    refuse(&file(&out, "claims.stl", [&[0; 80][..], &[0xff; 4]].concat()), &["84 bytes"]);
    refuse(&file(&out, "claims.glb", [&b"glTF\x02\0\0\0"[..], &[0xff; 4]].concat()), &["12"]);
    for ending in ["obj", "ply", "stl"] {
        let path = out.path().join(format!("sparse.{ending}"));
        File::create(&path).unwrap().set_len(1 << 42).unwrap();
        refuse(&path, &["4398046511104"]);
    }
}

#[test]
fn what_is_no_mesh_file_is_refused_with_what_is_known() {
    let out = folder();
    refuse(&out.path().join("missing.obj"), &["No such file"]);
    fs::create_dir(out.path().join("folder.obj")).unwrap();
    refuse(&out.path().join("folder.obj"), &["regular file"]);
    let endings = [".obj", ".ply", ".stl", ".gltf", ".glb"];
    refuse(&file(&out, "mesh.xyz", ""), &endings);
    refuse(&file(&out, "mesh", ""), &endings);
    caustics("bench --mesh").arg("").tiny().args(ONCE).run().refused(2, &endings);
    caustics("passes --mesh no-such.obj").tiny().run().refused(2, &["no-such.obj"]);
    caustics("render --mesh sphere --mesh no-such.obj").tiny().run().refused(2, &["no-such.obj"]);
}

/// Triangles as thin as needles along one diagonal: no box parts them from a ray, which so visits all of them. lavapipe
/// would end its loop without a word.
#[test]
fn rays_that_do_not_end_fail_the_picture() {
    let out = folder();
    let mut needles = String::new();
    for i in 0..20_000 {
        let aside = 1e-3 * f64::from(i % 200);
        let along = 1e-3 * f64::from(i / 200);
        needles += &format!(
            "v {} -1 {along}\nv {} 1 {along}\nv {} 1 {}\n",
            aside - 1.0,
            aside + 1.0,
            aside + 1.0,
            along + 1e-4
        );
        needles += "f -3 -2 -1\n";
    }
    let mesh = file(&out, "needles.obj", needles);
    let scene = "render --quiet --size 16x12 --map-size 16 --planes 2 --water-triangles 50 --image a.png --mesh";
    let drawn = |samples: &str| caustics(scene).arg(&mesh).args(samples).on_test_device().inside(out.path()).run();
    drawn("--samples 4").refused(1, &["view", "rays of", "--samples", "--mesh"]);
    assert_eq!(entries(out.path()), ["needles.obj"]);
    drawn("--samples 1").succeeded();
}

/// Nothing but the start of a file and its size: what the device cannot hold is refused by the file's own count, unread.
#[test]
fn files_beyond_the_device_are_refused_unread() {
    let out = folder();
    let sparse = |count: u32| {
        let path = out.path().join(format!("{count}.stl"));
        let mut file = File::create(&path).unwrap();
        file.write_all(&[0; 80]).unwrap();
        file.write_all(&count.to_le_bytes()).unwrap();
        file.set_len(84 + 50 * u64::from(count)).unwrap();
        path
    };
    let layer = Layer::new();
    let started = Instant::now();
    let program = burning("bench --variant shell --mesh").arg(sparse(12_000_000)).on_test_device();
    layer.least(program).run().refused(2, &["--triangles", "144000000", "limit of 134217728"]);
    let program = burning("render --variant low-poly --mesh").arg(sparse(1_100_000)).on_test_device();
    layer.least(program).run().refused(2, &["--levels", "limit of"]);
    let program = gas("bench --object").arg(sparse(85_000_000)).on_test_device();
    layer.least(program).run().refused(2, &["--object", "2720000000", "limit of"]);
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 100000000\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = file(&out, "many.ply", header);
    File::options().append(true).open(&ply).unwrap().set_len(header.len() as u64 + 36 + 13 * 100_000_000).unwrap();
    let drawn = [(caustics("bench"), "--mesh"), (lava("bench"), "--object"), (terrain("bench"), "--object")];
    for (program, option) in drawn {
        let program = program.arg(option).arg(&ply).on_test_device();
        layer.least(program).run().refused(2, &[option, "2400000000", "limit of"]);
    }
    // A GLB file's document tells before its data; what claims data that is not there is a fault of the file.
    let glb = |triangles: u64, has_data: bool| {
        let bytes = 12 * triangles;
        let mut document = serde_json::json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": bytes + 36}],
            "bufferViews": [{"buffer": 0, "byteLength": 36},
                            {"buffer": 0, "byteOffset": 36, "byteLength": bytes}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, 0], "max": [1, 1, 1]},
                          {"bufferView": 1, "componentType": 5125, "count": 3 * triangles, "type": "SCALAR"}],
        })
        .to_string();
        document += &" ".repeat(document.len().next_multiple_of(4) - document.len());
        let length = 28 + document.len() as u64 + if has_data { bytes + 36 } else { 0 };
        let words = |words: &[u64]| words.iter().flat_map(|word| (*word as u32).to_le_bytes()).collect::<Vec<u8>>();
        let start = [&b"glTF"[..], &words(&[2, length, document.len() as u64]), b"JSON", document.as_bytes()].concat();
        let start = [&start[..], &words(&[length - 28 - document.len() as u64]), b"BIN\0"].concat();
        let path = file(&out, &format!("{triangles}-{has_data}.glb"), start);
        File::options().append(true).open(&path).unwrap().set_len(length).unwrap();
        path
    };
    let program = burning("bench --variant shell --mesh").arg(glb(12_000_000, true)).on_test_device();
    layer.least(program).run().refused(2, &["--triangles", "144000000", "limit of 134217728"]);
    let program = gas("bench --object").arg(glb(85_000_000, true)).on_test_device();
    layer.least(program).run().refused(2, &["--object", "2720000000", "limit of"]);
    let program = gas("bench --object").arg(glb(85_000_000, false)).on_test_device();
    layer.least(program).run().refused(2, &["buffer 0"]);
    // Reading them would take many times as long.
    assert!(started.elapsed().as_secs_f64() < 10.0, "{:?}", started.elapsed());
}

/// A ball as a binary STL file of more than a MiB, which is kept in the cache of meshes.
fn kept_ball(out: &TempDir) -> PathBuf {
    let mesh = fumarole::scene::shapes::sphere(120, 120);
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangle_count() as u32).to_le_bytes());
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = triangle.iter().flat_map(|&corner| mesh.positions[corner as usize].to_array());
        bytes.extend([0.0; 3].into_iter().chain(corners).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    file(out, "ball.stl", bytes)
}

/// Processes that load one mesh at once, and after one that was killed at any moment, leave one sound entry and nothing else.
#[test]
fn processes_share_the_cache_and_a_killed_one_leaves_no_rest() {
    let out = folder();
    let path = kept_ball(&out);
    let load = |cache: &Path| {
        let program = caustics("bench --quiet --json --variant level-map --mesh").arg(&path).tiny().args(ONCE);
        program.env("XDG_CACHE_HOME", cache)
    };
    let from_cache = |ended: Ended| ended.succeeded().json()["runs"][0]["loading"]["from_cache"].as_u64().unwrap();
    let assert_kept = |cache: &Path, when: &str| {
        let kept = entries(&cache.join("fumarole/meshes"));
        assert!(kept.len() == 1 && kept[0].ends_with(".mesh"), "{when}: {kept:?}");
        assert_eq!(from_cache(load(cache).run()), 1, "{when}");
    };
    beside_others(|| {
        let shared = out.path().join("shared");
        let begun = Instant::now();
        let together = [(); 3].map(|()| load(&shared).start());
        together.into_iter().for_each(|running| drop(running.end().succeeded()));
        let whole_run = begun.elapsed();
        assert_kept(&shared, "three at once");
        for part in 0..8 {
            let cache = out.path().join(format!("killed-{part}"));
            let running = load(&cache).start();
            thread::sleep(whole_run * part / 16);
            // It may have ended by itself.
            let _ = Command::new("kill").args(["-KILL", &running.id().to_string()]).status().unwrap();
            running.end();
            load(&cache).run().succeeded();
            assert_kept(&cache, &format!("killed after {:?}", whole_run * part / 16));
        }
    });
}

/// Notes of a reader are told each time, also of a file that is large enough for the cache.
#[test]
fn what_is_passed_over_is_warned_of() {
    let out = folder();
    let path = kept_ball(&out);
    File::options().append(true).open(&path).unwrap().write_all(&[0; 7]).unwrap();
    let note =
        format!("mesh {}: 7 bytes behind the 28560 triangles that its header counts are left out", path.display());
    let run = |verb: &str| {
        let program = caustics(verb).arg("--mesh").arg(&path).tiny().inside(out.path());
        program.env("XDG_CACHE_HOME", out.path()).run().succeeded()
    };
    for _ in 0..2 {
        let told = run("render --image a.png").stderr;
        assert_eq!(told.matches(&note).count(), 1, "{told}");
    }
    assert_eq!(run("render --quiet --image a.png").stderr, "");
    let record = run(&format!("bench --quiet --json --variant level-map {ONCE}")).json();
    let warnings = record["runs"][0]["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|warning| *warning == note.as_str()), "{warnings:?}");
}

/// `--no-cache` leaves the folder alone; without it the second load is the first one's mesh, and the record says so.
#[test]
fn large_meshes_are_kept_for_the_next_run() {
    let out = folder();
    let path = kept_ball(&out);
    let loading = |options: &str| {
        let program =
            caustics("bench --quiet --json --variant level-map --mesh").arg(&path).tiny().args(ONCE).args(options);
        let record = program.env("XDG_CACHE_HOME", out.path()).run().succeeded().json();
        (record["runs"][0]["loading"].clone(), record["runs"][0]["load_ms"].as_f64().unwrap())
    };
    let kept = || fs::read_dir(out.path().join("fumarole/meshes")).map_or(0, |entries| entries.count());
    let (first, _) = loading("--no-cache");
    assert_eq!((first["from_cache"].as_u64(), kept()), (Some(0), 0));
    let (first, load_ms) = loading("");
    assert_eq!((first["from_cache"].as_u64(), kept()), (Some(0), 1));
    let parts = ["read_ms", "weld_ms", "normals_ms", "optimise_ms", "cache_ms"];
    let sum: f64 = parts.iter().map(|part| first[part].as_f64().unwrap()).sum();
    assert!(parts.iter().all(|part| first[part].as_f64().unwrap() > 0.0) && sum <= load_ms, "{first} {load_ms}");
    let (second, _) = loading("");
    assert_eq!((second["from_cache"].as_u64(), second["bytes"].as_u64(), kept()), (Some(1), Some(0), 1));
    let (other, _) = loading("--crease-angle 5");
    assert_eq!((other["from_cache"].as_u64(), kept()), (Some(0), 2));
}

//! CPU time of the papers' inputs: loading the shipped meshes and height maps, tessellating, computing normals, ordering
//! for the vertex cache (and what a device's vertex stage runs before and after), sampling the volcano, building a pyramid
//! of maxima, also on the device and beside a copy of the map, a million segments that meet the land, clustering particles.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use fumarole::gpu::Mode;
use fumarole::measure::bench::build;
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::study::Study;
use fumarole::measure::{Error, Paper};
use fumarole::papers::caustics::setup::{Scene, Setup};
use fumarole::papers::caustics::{ReceiverInput, Variant};
use fumarole::papers::{lava, terrain};
use fumarole::scene::loading::{Conditions, LoadParts};
use fumarole::scene::random::Random;
use fumarole::scene::{HeightMapSource, Mesh, MeshOptions, MeshSource, shapes, volcano};
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

fn files(criterion: &mut Criterion) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let mut group = criterion.benchmark_group("load");
    for name in [
        "meshes/bunny.obj",
        "meshes/spider.obj",
        "meshes/wuson.stl",
        "meshes/cube_binary.ply",
        "meshes/Mesh_PrimitiveMode_11.gltf",
        "fetched/dragon_vrip_res3.ply",
    ] {
        let path = assets.join(name);
        if !path.exists() {
            eprintln!("SKIPPED: {} is absent; run assets/fetch.sh", path.display());
            continue;
        }
        let source = MeshSource::File(path);
        group.bench_function(name, |bencher| {
            bencher.iter(|| source.load().expect("a shipped mesh loads"));
        });
    }
}

fn maps(criterion: &mut Criterion) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps");
    let mut group = criterion.benchmark_group("load map");
    for name in
        ["jacksboro.tif", "lidar-dem.tif", "topobathy-int16.asc", "topobathy-int16.bil", "topobathy-2000m-uint16.png"]
    {
        let source = HeightMapSource::File(assets.join(name));
        group.bench_function(name, |bencher| {
            bencher.iter(|| source.load().expect("a shipped map loads"));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("volcano");
    group.sample_size(10);
    for side in [1_024, 4_096] {
        group.bench_function(format!("sample {side} x {side}"), |bencher| {
            bencher.iter(|| volcano(black_box(side), 1).expect("a valid side"));
        });
    }
    // Another seed each time, so that the terrain itself is made.
    let mut seed = 0;
    group.bench_function("make the terrain", |bencher| {
        bencher.iter(|| {
            seed += 1;
            volcano(2, seed).expect("a valid side")
        });
    });
}

fn pyramids(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pyramid");
    group.sample_size(10);
    for side in [1_024, 4_096] {
        let map = volcano(side, 1).expect("a valid side");
        let samples: &[u16] = terrain::Texel::samples_of(&map);
        let shape = terrain::Shape::new(map.width(), map.height());
        group.bench_function(format!("maxima of {side} x {side}"), |bencher| {
            bencher.iter(|| terrain::Pyramid::build(shape, black_box(samples), terrain::Bound::Highest));
        });
    }
}

/// Samples a side of the largest pyramid, and the copies of its map that may be made while the processor builds it.
const LARGE_SIDE: u32 = 8_192;
const MOST_COPIES: f64 = 10.0;

/// Milliseconds that `work` takes.
fn ms<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}

/// The levels of a large map in turn with one copy of it: by the processor, of both kinds of texels, and by the device, which has
/// a copy of the map made as well.
///
/// # Panics
/// The processor takes longer than [`MOST_COPIES`].
fn large_pyramid(_: &mut Criterion) {
    let map = volcano(LARGE_SIDE, 1).expect("a valid side");
    let samples: &[u16] = terrain::Texel::samples_of(&map);
    let mut copy = samples.to_vec();
    let shape = terrain::Shape::new(map.width(), map.height());
    let machine = Machine::open(&MachineOptions::default(), &terrain::NEEDS);
    let cells = terrain::Cover::Cells(terrain::Interpolation::Bilinear);
    let names = ["copy", "nodes", "cells", "upload", "device, nodes", "device, cells"];
    let mut times = names.map(|_| Vec::new());
    let highest = terrain::Bound::Highest;
    for _ in 0..LOADS {
        let mut row = vec![ms(|| copy.copy_from_slice(black_box(samples)))];
        for cover in [terrain::Cover::Nodes, cells] {
            row.push(ms(|| terrain::Pyramid::covering(shape, black_box(samples), (highest, cover))));
        }
        if let Ok(machine) = &machine {
            for (bounds, cover) in
                [(&[][..], terrain::Cover::Nodes), (&[highest], terrain::Cover::Nodes), (&[highest], cells)]
            {
                row.push(ms(|| terrain::Levels::new(&machine.shaders, "bench", &map, bounds, cover).expect("levels")));
            }
        }
        times.iter_mut().zip(row).for_each(|(times, time)| times.push(time));
    }
    let medians = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    });
    let copy_ms = medians[0].expect("a copy was timed");
    for (name, median) in names.iter().zip(medians) {
        match median {
            Some(ms) => {
                eprintln!("maxima of {LARGE_SIDE} x {LARGE_SIDE}, {name}: {ms:.1} ms, {:.1} copies", ms / copy_ms)
            }
            None => eprintln!("SKIPPED: {name}: no device opens"),
        }
    }
    for ms in medians[1..3].iter().flatten() {
        assert!(ms / copy_ms <= MOST_COPIES, "a pyramid takes {:.1} copies of its map", ms / copy_ms);
    }
}

/// Segments of a file.
const SEGMENTS: usize = 1_000_000;

/// A million segments over the volcano, from a file to lines: the program says how long it reads, meets and writes them.
fn bodies(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for the files");
    let path = folder.path().join("bodies.csv");
    let mut random = Random::new(1);
    let mut text = String::with_capacity(SEGMENTS * 48);
    for _ in 0..SEGMENTS {
        let [x, z] = [(); 2].map(|()| random.range(-5500.0, 5500.0));
        let [east, south] = [(); 2].map(|()| random.range(-300.0, 300.0));
        let [high, low] = [random.range(800.0, 2500.0), random.range(0.0, 900.0)];
        let _ = writeln!(text, "{x:.1},{high:.1},{z:.1},{:.1},{low:.1},{:.1}", x + east, z + south);
    }
    std::fs::write(&path, text).expect("room for the file");
    let mut said = String::new();
    let mut group = criterion.benchmark_group("collide");
    group.sample_size(10).throughput(Throughput::Elements(SEGMENTS as u64));
    group.bench_function(format!("{SEGMENTS} segments of a file, the land made as well"), |bencher| {
        bencher.iter(|| {
            let mut program = Command::new(env!("CARGO_BIN_EXE_fumarole"));
            let program = program.args(["terrain", "collide", "--bodies"]).arg(&path).stdout(Stdio::null());
            let output = program.output().expect("the program runs");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        });
    });
    eprintln!("the last of them: {said}");
}

fn clustering(criterion: &mut Criterion) {
    let parameters = lava::Parameters::default();
    let particles = lava::Particles::seeded(&parameters);
    let positions: Vec<[f32; 4]> = particles.positions.iter().map(|p| p.extend(0.0).to_array()).collect();
    let mut clusters = lava::Clusters::new(&parameters);
    criterion.bench_function(&format!("cluster {} particles", positions.len()), |bencher| {
        bencher.iter(|| clusters.classify(black_box(&positions)));
    });
}

fn tessellation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tessellate");
    group.bench_function("teapot", |bencher| bencher.iter(shapes::teapot));
    group.bench_function("sphere 32 x 32", |bencher| {
        bencher.iter(|| shapes::sphere(black_box(32), black_box(32)));
    });
}

/// A ball of some 52,000 triangles in rows, as shapes are made, and with its triangles in no order, as files may have them.
fn balls() -> [(&'static str, Mesh); 2] {
    let rows = shapes::sphere(128, 203);
    let mut shuffled = rows.clone();
    let count = shuffled.triangle_count();
    // A prime that the count has not: each triangle comes once.
    const STEP: usize = 7_919;
    let corners = |place: usize| rows.indices[3 * (place * STEP % count)..][..3].to_owned();
    shuffled.indices = (0..count).flat_map(corners).collect();
    [("in rows", rows), ("in no order", shuffled)]
}

/// Invocations of the vertex stage of each pass that draws a receiver of `caustics`.
fn vertex_invocations(mesh: Mesh) -> Result<Vec<(&'static str, u64)>, Error> {
    let mut machine = Machine::open(&MachineOptions::default(), Setup::NEEDS)?;
    let setup = Setup::default();
    let lift = glam::Mat4::from_translation(glam::Vec3::NEG_Y * (setup.parameters.water_depth_m - 1.0));
    let receiver = ReceiverInput { mesh: mesh.placed(&lift), albedo: glam::Vec3::ONE };
    let scene = Scene { receivers: vec![receiver] };
    let mut built = build(&machine, &setup, &scene, Variant::LevelMap)?;
    machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0))?;
    let sample = machine.recorder.run(Mode::Counted, |frame| built.paper.record(frame, 0))?;
    let drawn = sample.passes.iter().filter(|pass| ["position-diffuse-map", "cast"].contains(&pass.info.name));
    Ok(drawn.filter_map(|pass| Some((pass.info.name, pass.counts?.vertices?))).collect())
}

fn vertex_order(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("optimise order");
    for (name, ball) in balls() {
        let mut optimised = ball.clone();
        optimised.optimise_order();
        match (vertex_invocations(ball.clone()), vertex_invocations(optimised)) {
            (Ok(before), Ok(after)) => eprintln!(
                "vertex stage of {} triangles {name}: {before:?} as they are, {after:?} optimised",
                ball.triangle_count()
            ),
            (Err(error), _) | (_, Err(error)) => eprintln!("SKIPPED: the vertex stage is not counted: {error}"),
        }
        group.bench_function(format!("{} triangles {name}", ball.triangle_count()), |bencher| {
            bencher.iter_batched_ref(|| ball.clone(), Mesh::optimise_order, BatchSize::LargeInput);
        });
    }
}

/// Bytes a second at which binary files are read, before anything is joined, at least.
const LEAST_READ: f64 = 500e6;
/// Loads whose medians count.
const LOADS: usize = 9;

/// A mesh as a binary STL file.
fn stl(mesh: &Mesh) -> Vec<u8> {
    let corners = |triangle: &[u32]| -> Vec<u8> {
        let places = triangle.iter().flat_map(|&corner| mesh.positions[corner as usize].to_array());
        [0.0; 3].into_iter().chain(places).flat_map(f32::to_le_bytes).chain([0; 2]).collect()
    };
    let start = [&[0; 80][..], &(mesh.triangle_count() as u32).to_le_bytes()].concat();
    start.into_iter().chain(mesh.indices.chunks_exact(3).flat_map(corners)).collect()
}

/// A mesh as a binary PLY file.
fn ply(mesh: &Mesh) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangle_count()
    );
    let places = mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes);
    let faces = mesh.indices.chunks_exact(3);
    let faces =
        faces.flat_map(|t| std::iter::once(3).chain(t.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>()));
    header.into_bytes().into_iter().chain(places).chain(faces).collect()
}

/// The median of a part of some loads, milliseconds.
fn median(loads: &[LoadParts], part: impl Fn(&LoadParts) -> f64) -> f64 {
    let mut times: Vec<f64> = loads.iter().map(part).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A large ball as a binary STL and PLY file, in the system's cache: reading and joining, with normals and order, and from the
/// cache of meshes.
///
/// # Panics
/// A file is read at less than [`LEAST_READ`].
fn large(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for the files");
    let ball = shapes::sphere(1_000, 501);
    let mut group = criterion.benchmark_group("load large");
    for (ending, bytes) in [("stl", stl(&ball)), ("ply", ply(&ball))] {
        let path = folder.path().join(format!("ball.{ending}"));
        std::fs::write(&path, &bytes).expect("room for the file");
        let source = MeshSource::File(path);
        group.sample_size(10).throughput(Throughput::Bytes(bytes.len() as u64));
        let (plain, drawn) = (Conditions::plain(), MeshOptions::to_draw(30.0));
        let cached = Conditions { cache: Some(folder.path().join("cache")), ..Conditions::plain() };
        for (name, options, conditions) in [
            ("in the file's order", MeshOptions::default(), &plain),
            ("to draw", drawn, &plain),
            ("from the cache", drawn, &cached),
        ] {
            let load = || source.load_under(&options, conditions).expect("it loads");
            group.bench_function(format!("{} triangles of {ending} {name}", ball.triangle_count()), |bencher| {
                bencher.iter(load);
            });
            load();
            let loads: Vec<LoadParts> = (0..LOADS)
                .map(|_| {
                    LoadParts::take();
                    load();
                    LoadParts::take()
                })
                .collect();
            let rate = |ms: f64| bytes.len() as f64 / 1e3 / ms;
            let [read, weld, normals, optimise, cache] = [
                median(&loads, |l| l.read_ms),
                median(&loads, |l| l.weld_ms),
                median(&loads, |l| l.normals_ms),
                median(&loads, |l| l.optimise_ms),
                median(&loads, |l| l.cache_ms),
            ];
            if loads.iter().all(|load| load.from_cache == 1) {
                eprintln!("medians: cache {cache:.0} ms ({:.0} MB/s of the file)", rate(cache));
                continue;
            }
            eprintln!(
                "medians: reading {read:.0} ms ({:.0} MB/s), joining {weld:.0} ms ({:.0} MB/s), normals {normals:.0} ms, \
                 ordering {optimise:.0} ms",
                rate(read),
                rate(weld)
            );
            assert!(rate(read) >= LEAST_READ / 1e6, "{ending} is read at {:.0} MB/s", rate(read));
        }
    }
}

fn normals(criterion: &mut Criterion) {
    let mut mesh = shapes::sphere(256, 256);
    let name = format!("smooth normals of {} triangles", mesh.triangle_count());
    criterion.bench_function(&name, |bencher| {
        bencher.iter(|| {
            mesh.smooth_normals();
            black_box(&mesh);
        });
    });
}

criterion_group!(
    benches,
    files,
    large,
    vertex_order,
    maps,
    pyramids,
    large_pyramid,
    bodies,
    clustering,
    tessellation,
    normals
);
criterion_main!(benches);

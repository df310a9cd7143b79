//! How long the CPU takes for what the papers are given: loading the shipped meshes and height maps, tessellating,
//! computing normals, sampling the volcano, building a pyramid of maxima, clustering particles.

use criterion::{Criterion, criterion_group, criterion_main};
use fumarole::papers::{lava, terrain};
use fumarole::scene::{HeightMapSource, MeshSource, shapes, volcano};
use std::hint::black_box;
use std::path::Path;

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
    // Another seed each time, so that the land itself is made.
    let mut seed = 0;
    group.bench_function("make the land", |bencher| {
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

criterion_group!(benches, files, maps, pyramids, clustering, tessellation, normals);
criterion_main!(benches);

//! How long the CPU takes to make meshes: loading the shipped files, tessellating, computing normals.

use criterion::{Criterion, criterion_group, criterion_main};
use fumarole::scene::{MeshSource, shapes};
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

criterion_group!(benches, files, tessellation, normals);
criterion_main!(benches);

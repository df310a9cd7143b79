//! What the CPU does for a frame: recording the caustics passes, submitting them and waiting. The maps are tiny and the
//! water coarse, so that the device has next to nothing to do.

use criterion::{Criterion, criterion_group, criterion_main};
use fumarole::gpu::Mode;
use fumarole::measure::bench::build;
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::study::Study;
use fumarole::measure::{Paper, Variant as _};
use fumarole::papers::caustics::setup::Setup;
use fumarole::papers::caustics::{NEEDS, Parameters, Variant};
use fumarole::scene::MeshSource;

fn recording(criterion: &mut Criterion) {
    let mut machine = match Machine::open(&MachineOptions::default(), &NEEDS) {
        Ok(machine) => machine,
        Err(error) => {
            eprintln!("recording is not measured: {error}");
            return;
        }
    };
    let parameters =
        Parameters { planes: 101, map_size: 1, water_triangles: 2, width: 1, height: 1, ..Parameters::default() };
    let meshes = vec![MeshSource::Box];
    let setup = Setup { parameters, meshes, ..Setup::default() };
    let scene = setup.load().expect("the box loads");
    for variant in [Variant::LevelMap, Variant::Volumetric] {
        let mut built = build(&machine, &setup, &scene, variant).expect("it builds");
        criterion.bench_function(&format!("frame of 101 planes, {}", variant.as_str()), |bencher| {
            bencher.iter(|| {
                let frame = machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0));
                frame.expect("it runs").frame_ms
            });
        });
    }
}

criterion_group!(benches, recording);
criterion_main!(benches);

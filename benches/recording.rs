//! CPU time of a frame of every paper and variant: recording the passes, submitting them, waiting. The scenes are
//! so small that the device has next to nothing to do.

use std::ffi::OsStr;

use criterion::{Criterion, criterion_group, criterion_main};
use fumarole::gpu::Mode;
use fumarole::measure::bench::{build, load};
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::study::{Study, Visitor};
use fumarole::measure::{Error, Paper, Variant};
use fumarole::papers;

/// Names and values of the parameters that make a paper's frame small.
fn small(paper: &str) -> &'static [(&'static str, &'static str)] {
    match paper {
        "burning" => &[("size", "8x8"), ("mesh", "box"), ("first-frame", "0"), ("blocks", "2x2x2")],
        "caustics" => {
            &[("size", "8x8"), ("mesh", "box"), ("planes", "101"), ("map-size", "1"), ("water-triangles", "2")]
        }
        "gas" => &[("size", "8x8"), ("steps", "1"), ("table", "2")],
        "lava" => &[("size", "8x8"), ("particles", "100"), ("density", "8x8x8"), ("splats", "8x8")],
        "terrain" => &[("size", "8x8"), ("resolution", "64")],
        _ => &[("size", "8x8")],
    }
}

struct Recording<'a>(&'a mut Criterion);

impl Visitor for Recording<'_> {
    type Error = Error;

    fn visit<S: Study>(&mut self) -> Result<(), Error> {
        let mut setup = S::default();
        for parameter in S::parameters() {
            for (_, value) in small(S::PAPER).iter().filter(|(name, _)| *name == parameter.name) {
                parameter.set(&mut setup, &[OsStr::new(value)]).map_err(Error::Input)?;
            }
        }
        let mut machine = Machine::open(&MachineOptions::default(), S::NEEDS)?;
        let scene = load(&setup)?.scene;
        let mut group = self.0.benchmark_group(format!("frame of {}", S::PAPER));
        for &variant in S::Variant::ALL {
            let mut built = build(&machine, &setup, &scene, variant)?;
            let mut number = 0;
            group.bench_function(variant.as_str(), |bencher| {
                bencher.iter(|| {
                    let frame = machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, number));
                    number += 1;
                    frame.expect("it runs").frame_ms
                });
            });
        }
        Ok(())
    }
}

fn recording(criterion: &mut Criterion) {
    if let Err(error) = papers::each(&mut Recording(criterion)) {
        eprintln!("recording is not measured: {error}");
    }
}

criterion_group!(benches, recording);
criterion_main!(benches);

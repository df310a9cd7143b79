//! `all`: every paper's quick benchmark, a record and a picture each.

use clap::{Args, Parser};

use super::bench;
use super::failure::Failure;
use super::options::{MachineArgs, OutputArgs};
use super::outcome;
use super::watch::{interrupted, progress_bar};
use crate::experiment::caustics::{self, PAPER, Setup};
use crate::experiment::limits;
use crate::experiment::machine::Machine;
use crate::experiment::measure::{Schedule, Watch};
use crate::papers::caustics::{NEEDS, Parameters, Variant};
use crate::report::Record;
use crate::scene::MeshSource;

#[derive(Debug, Clone, Args)]
pub struct AllArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl AllArgs {
    /// What `fumarole all` without options says.
    pub fn plain() -> Self {
        #[derive(Parser)]
        struct Plain {
            #[command(flatten)]
            arguments: AllArgs,
        }
        Plain::parse_from(["fumarole"]).arguments
    }
}

const SCHEDULE: Schedule = Schedule { warmup: 3, frames: 10, repeat: 3, min_time_s: 0.0 };

pub fn run(arguments: &AllArgs) -> Result<(), Failure> {
    let output = &arguments.output;
    let json = output.json.clone().unwrap_or_else(|| output.out.join("fumarole.json"));
    let picture = output.image.clone().unwrap_or_else(|| output.out.join(format!("{PAPER}.png")));
    let output = OutputArgs { json: Some(json), image: Some(picture.clone()), ..output.clone() };
    outcome::check(&output)?;

    let mut machine = Machine::open(&arguments.machine.resolve(), &NEEDS)?;
    outcome::say_device(&output, &machine);
    let limits = limits::measure(&mut machine)?;
    let setup = Setup {
        parameters: Parameters::default(),
        meshes: vec![MeshSource::Bunny],
        floor: true,
        preset: None,
        process: 0,
    };
    let scene = setup.load()?;
    let bar = progress_bar(output.quiet, PAPER);
    let mut watch = Watch {
        interrupted: interrupted(),
        progress: &mut |done, expected| {
            bar.set_length(expected);
            bar.set_position(done);
        },
    };
    // The stencil method takes seconds a frame without a GPU; `bench --variant stencil` measures it.
    let variants = [Variant::LevelMap, Variant::LevelMapSmart, Variant::Volumetric];
    let measured = caustics::bench(&mut machine, &setup, &scene, &variants, SCHEDULE, Some(&limits), &mut watch)?;
    bar.finish_and_clear();
    let (mut runs, traces): (Vec<_>, Vec<_>) = measured.into_iter().map(|m| (m.run, m.trace)).unzip();
    if let (Some(&variant), Some(run)) = (variants.first(), runs.first_mut()) {
        run.image = Some(bench::write_picture(&mut machine, &setup, &scene, variant, 0, &picture)?);
        outcome::wrote(&output, &picture);
    }
    let record = Record::new(machine.environment(), std::env::args().collect(), runs);
    outcome::publish(&output, &record, &traces)
}

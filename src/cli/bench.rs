//! `bench`: one configuration in one or more variants, interleaved.

use std::path::Path;

use clap::Args;

use super::caustics::{SceneArgs, VariantWord};
use super::failure::Failure;
use super::options::{MachineArgs, MeasureArgs, OutputArgs};
use super::outcome;
use super::processes;
use super::watch::{interrupted, progress_bar};
use crate::experiment::caustics::{self, PAPER, Setup};
use crate::experiment::machine::Machine;
use crate::experiment::measure::{Schedule, Watch};
use crate::experiment::{limits, picture};
use crate::papers::caustics::{NEEDS, Variant};
use crate::report::Record;
use crate::report::record::{ImageFile, Run};
use crate::report::trace::TraceRun;

#[derive(Debug, Clone, Args)]
pub struct BenchArgs {
    /// Variants to measure, comma-separated, or all
    #[arg(long, value_enum, value_delimiter = ',', default_value = "level-map,level-map-smart,volumetric")]
    variant: Vec<VariantWord>,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// Frames and repetitions of a bench that names none.
const FRAMES: u32 = 10;
const REPEAT: u32 = 3;

pub fn run(arguments: &BenchArgs) -> Result<(), Failure> {
    outcome::check(&arguments.output)?;
    if arguments.measure.processes > 1 {
        let output = &arguments.output;
        let record = processes::run(arguments.measure.processes, output.quiet)?;
        // The first process has written the picture and the trace.
        output.image.iter().chain(&output.trace).for_each(|path| outcome::wrote(output, path));
        return outcome::publish(&OutputArgs { trace: None, ..output.clone() }, &record, &[]);
    }
    let setup = arguments.scene.resolve(arguments.measure.process)?;
    let variants = VariantWord::resolve(&arguments.variant);
    let schedule = arguments.measure.schedule(FRAMES, REPEAT);
    let (record, traces) = measure(arguments, &setup, &variants, schedule)?;
    outcome::publish(&arguments.output, &record, &traces)
}

fn measure(
    arguments: &BenchArgs,
    setup: &Setup,
    variants: &[Variant],
    schedule: Schedule,
) -> Result<(Record, Vec<TraceRun>), Failure> {
    let scene = setup.load()?;
    let mut machine = Machine::open(&arguments.machine.resolve(), &NEEDS)?;
    // The table names the device itself.
    if arguments.output.json_to_stdout() {
        outcome::say_device(&arguments.output, &machine);
    }
    let limits = if arguments.measure.no_limits { None } else { Some(limits::measure(&mut machine)?) };
    let bar = progress_bar(arguments.output.quiet, PAPER);
    let mut watch = Watch {
        interrupted: interrupted(),
        progress: &mut |done, expected| {
            bar.set_length(expected);
            bar.set_position(done);
        },
    };
    let measured = caustics::bench(&mut machine, setup, &scene, variants, schedule, limits.as_ref(), &mut watch)?;
    bar.finish_and_clear();
    let (mut runs, traces): (Vec<Run>, Vec<TraceRun>) = measured.into_iter().map(|m| (m.run, m.trace)).unzip();
    if let (Some(path), Some(&variant), Some(run)) = (&arguments.output.image, variants.first(), runs.first_mut()) {
        let last = schedule.frames - 1;
        run.image = Some(write_picture(&mut machine, setup, &scene, variant, last, path)?);
        outcome::wrote(&arguments.output, path);
    }
    Ok((Record::new(machine.environment(), std::env::args().collect(), runs), traces))
}

/// Renders a frame after the measurement and writes it.
pub fn write_picture(
    machine: &mut Machine,
    setup: &Setup,
    scene: &caustics::Scene,
    variant: Variant,
    number: u32,
    path: &Path,
) -> Result<ImageFile, Failure> {
    let mut built = caustics::build(machine, setup, scene, variant)?;
    let picture = picture::render(machine, &mut built.paper, number)?;
    crate::image::write_png(path, &picture)?;
    machine.check_validation()?;
    Ok(ImageFile { path: path.display().to_string(), sha256: picture::file_sha256(path)? })
}

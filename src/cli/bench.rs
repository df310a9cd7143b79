//! `bench`: one configuration in one or more variants, interleaved.

use std::path::Path;

use super::failure::Failure;
use super::options::{CommonArgs, MeasureArgs, OutputArgs};
use super::outcome;
use super::processes;
use super::spelling;
use super::watch::{patiently, watched};
use crate::content;
use crate::measure::bench::{Bench, Loaded, build, load};
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::report::record::{ImageFile, Run};
use crate::report::trace::TraceRun;
use crate::report::{Record, environment};

/// Frames and repetitions of a bench that names none.
const FRAMES: u32 = 10;
const REPEAT: u32 = 3;

/// Measures `variants` of a study, or has fresh processes measure them, and publishes the record where `common` says, which
/// has been checked.
pub fn publish<S: Study>(common: &CommonArgs, study: &S, variants: &[S::Variant]) -> Result<(), Failure> {
    let CommonArgs { measure: MeasureArgs { processes, .. }, output, .. } = common;
    if *processes > 1 {
        let record = processes::run(*processes, output.quiet)?;
        // The first process has written the picture and the trace.
        output.image.iter().chain(&output.trace).for_each(|path| outcome::wrote(output, path));
        return outcome::publish(&OutputArgs { trace: None, ..output.clone() }, &record, &[]);
    }
    let (record, traces, failed) = measure(study, variants, common)?;
    outcome::publish(output, &record, &traces)?;
    failed.map_or(Ok(()), Err)
}

fn measure<S: Study>(
    study: &S,
    variants: &[S::Variant],
    common: &CommonArgs,
) -> Result<(Record, Vec<TraceRun>, Option<Failure>), Failure> {
    let CommonArgs { machine, measure, output } = common;
    let schedule = measure.schedule(FRAMES, REPEAT);
    let loaded = patiently(output.quiet, "loading the scene", || load(study))?;
    let mut machine = Machine::open(&machine.resolve(measure.process), S::NEEDS)?;
    // The table names the device itself.
    if output.json_to_stdout() {
        outcome::say_device(output, &machine);
    }
    for &variant in variants {
        outcome::foretell(output, &study.estimate(&machine.device, &loaded.scene, variant), &machine);
    }
    let limits = measure.limits(&mut machine)?;
    let bench = Bench { study, loaded: &loaded, variants, schedule, limits: limits.as_ref() };
    let measured = watched(output.quiet, S::PAPER, |watch| bench.measure(&mut machine, watch))?;
    let (mut runs, traces): (Vec<Run>, Vec<TraceRun>) = measured.into_iter().map(|m| (m.run, m.trace)).unzip();
    for warning in runs.iter_mut().flat_map(|run| &mut run.warnings) {
        *warning = spelling::options(warning);
    }
    // A picture that fails throws no measurement away.
    let mut failed = None;
    if let (Some(path), Some(&variant), Some(run)) = (&output.image, variants.first(), runs.first_mut()) {
        match write_picture(&mut machine, study, &loaded, variant, schedule.frames - 1, path) {
            Ok(image) => {
                run.image = Some(image);
                outcome::wrote(output, path);
            }
            Err(failure) => {
                run.warnings.push(format!("without a picture: {failure}"));
                failed = Some(failure);
            }
        }
    }
    Ok((Record::new(machine.environment(), environment::command(), runs), traces, failed))
}

fn file_sha256(path: &Path) -> Result<String, Failure> {
    content::file_sha256(path).map_err(|e| Failure::Running(format!("reading {} again: {e}", path.display())))
}

/// Renders a frame after the measurement and writes it.
pub fn write_picture<S: Study>(
    machine: &mut Machine,
    study: &S,
    loaded: &Loaded<S>,
    variant: S::Variant,
    number: u32,
    path: &Path,
) -> Result<ImageFile, Failure> {
    let mut built = build(machine, study, &loaded.scene, variant)?;
    let picture = picture::render(machine, &mut built.paper, number)?;
    crate::image::write_png(path, &picture)?;
    machine.check_validation()?;
    Ok(ImageFile { path: path.display().to_string(), sha256: file_sha256(path)? })
}

//! `bench`: one configuration in one or more variants, interleaved.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use super::failure::Failure;
use super::options::{CaptureTool, CommonArgs, DepthArgs, FRAMES, MeasureArgs, OutputArgs, REPEAT};
use super::outcome;
use super::processes;
use super::reading;
use super::spelling;
use super::watch::{interrupted, patiently, watched};
use crate::gpu::{Mode, RenderDoc};
use crate::image::{suffixed, write_png_hashed};
use crate::measure::bench::{Bench, Loaded, build, load_for};
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::picture;
use crate::measure::profile::{self, profile};
use crate::measure::study::Study;
use crate::measure::{Error, Paper, Variant};
use crate::report::record::{ImageFile, Run};
use crate::report::trace::TraceRun;
use crate::report::{Record, environment};

/// Fails before long work where a picture cannot be written, or a file would take another's place; the files that are written.
pub fn check<S: Study>(common: &CommonArgs, study: &S, variants: &[S::Variant]) -> Result<Vec<PathBuf>, Failure> {
    let output = &common.output;
    let pictures: Vec<PathBuf> = output.image.iter().flat_map(|named| picture_files(named, variants)).collect();
    pictures.iter().try_for_each(|path| outcome::check_file(path))?;
    let documents = output.files().filter(|path| Some(*path) != output.image.as_ref());
    let written: Vec<PathBuf> = documents.cloned().chain(pictures).collect();
    outcome::check_apart(&written, &reading::by_study(study, &common.machine))?;
    Ok(written)
}

/// Measures `variants` of a study, or has fresh processes measure them, and publishes the record where `common` says, which
/// has been checked.
pub fn publish<S: Study>(
    common: &CommonArgs,
    depth: &DepthArgs,
    study: &S,
    variants: &[S::Variant],
) -> Result<(), Failure> {
    let CommonArgs { measure: MeasureArgs { processes, .. }, output, .. } = common;
    check(common, study, variants)?;
    if *processes > 1 {
        let (record, failed) = processes::run(*processes, output.quiet)?;
        // The first process has written the pictures and the trace.
        let pictures = record.runs.iter().filter_map(|run| Some(Path::new(&run.image.as_ref()?.path)));
        pictures.chain(output.trace.as_deref()).for_each(|path| outcome::wrote(output, path));
        let published = outcome::publish(&OutputArgs { trace: None, ..output.clone() }, &record, &[]);
        return failed.map_or(published, Err);
    }
    let (record, traces, failed) = measure(study, variants, common, depth)?;
    outcome::publish(output, &record, &traces)?;
    failed.map_or(Ok(()), Err)
}

fn measure<S: Study>(
    study: &S,
    variants: &[S::Variant],
    common: &CommonArgs,
    depth: &DepthArgs,
) -> Result<(Record, Vec<TraceRun>, Option<Failure>), Failure> {
    let CommonArgs { machine, measure, output } = common;
    let schedule = measure.schedule(FRAMES, REPEAT);
    // RenderDoc is there from the start, or never.
    let capture = depth.capture.map(|CaptureTool::Renderdoc| RenderDoc::attach()).transpose()?;
    let options = MachineOptions { is_profiled: depth.profile.is_some(), ..machine.resolve(measure.process) };
    let open = || Machine::open(&options, S::NEEDS);
    let (loaded, mut machine) = patiently(output.quiet, "loading the scene", || load_for(study, variants, open))?;
    // The table names the device itself.
    if output.json_to_stdout() {
        outcome::say_device(output, &machine);
    }
    let alternatives = study.alternatives();
    for (&variant, study) in variants.iter().flat_map(|variant| alternatives.iter().map(move |study| (variant, study)))
    {
        outcome::foretell(output, &study.estimate(&machine.device, &loaded.scene, variant), &machine);
    }
    let profiled = match &depth.profile {
        Some(pass) => having_pass(&mut machine, study, &loaded, variants, pass)?,
        None => Vec::new(),
    };
    let limits = measure.limits(&mut machine)?;
    let bench = Bench { study, loaded: &loaded, variants, schedule, limits: limits.as_ref() };
    let (mut runs, traces) = measured(&bench, &mut machine, output)?;
    // What fails from here on throws no measurement away.
    let mut failed = None;
    let mut without = |what: &str, run: &mut Run, failure: Failure| {
        run.warnings.push(format!("without {what}: {failure}"));
        failed.get_or_insert(failure);
    };
    for (&variant, run) in variants.iter().zip(runs.iter_mut().step_by(alternatives.len().max(1))) {
        if let Some(pass) = depth.profile.as_deref().filter(|_| profiled.contains(&variant)) {
            let title = format!("{} {pass}, both compilers", S::PAPER);
            let profiled = watched(output.quiet, &title, |watch| {
                profile(&mut machine, &options, (study, &loaded), (variant, pass), schedule, watch)
            });
            match profiled {
                Ok(profile) => run.profile = profile,
                Err(Error::Interrupted) => run.warnings.push(format!("interrupted before {pass} was profiled")),
                Err(error) => without("a profile", run, error.into()),
            }
        }
        if let Some(capture) = &capture {
            match capture_frame(&mut machine, capture, study, &loaded, variant, &output.out) {
                Ok(file) => outcome::wrote(output, &file),
                Err(failure) => without("a capture", run, failure),
            }
        }
    }
    let files = output.image.iter().flat_map(|named| picture_files(named, variants));
    let first_runs = runs.iter_mut().step_by(alternatives.len().max(1));
    for (index, ((&variant, file), run)) in variants.iter().zip(files).zip(first_runs).enumerate() {
        if index > 0 && interrupted().load(Ordering::Relaxed) {
            break;
        }
        // Of an interrupted run the last that was measured: a state that goes step by step may be hours from the end.
        let measured = run.frame_ms.as_ref().map_or(1, |times| times.samples.len());
        let last = schedule.frames.min(u32::try_from(measured).unwrap_or(u32::MAX)) - 1;
        match write_picture(&mut machine, study, &loaded, variant, last, &file) {
            Ok(image) => {
                run.image = Some(image);
                outcome::wrote(output, &file);
            }
            Err(failure) => without("a picture", run, failure),
        }
    }
    Ok((Record::new(machine.environment(), environment::command(), runs), traces, failed))
}

/// Measures under a bar of progress; warnings name options.
///
/// # Errors
/// As [`Bench::measure`].
pub fn measured<S: Study>(
    bench: &Bench<'_, S>,
    machine: &mut Machine,
    output: &OutputArgs,
) -> Result<(Vec<Run>, Vec<TraceRun>), Error> {
    let measured = watched(output.quiet, S::PAPER, |watch| bench.measure(machine, watch))?;
    let (mut runs, traces): (Vec<Run>, Vec<TraceRun>) = measured.into_iter().map(|m| (m.run, m.trace)).unzip();
    for warning in runs.iter_mut().flat_map(|run| &mut run.warnings) {
        *warning = spelling::options(warning);
    }
    Ok((runs, traces))
}

/// The variants with a pass of that name.
///
/// # Errors
/// [`Failure::Input`] with the names that there are where none has it.
fn having_pass<S: Study>(
    machine: &mut Machine,
    study: &S,
    loaded: &Loaded<S>,
    variants: &[S::Variant],
    pass: &str,
) -> Result<Vec<S::Variant>, Failure> {
    let (mut having, mut known) = (Vec::new(), Vec::new());
    for &variant in variants {
        let passes = profile::passes(machine, study, loaded, variant)?;
        if passes.contains(&pass) {
            having.push(variant);
        }
        known.extend(passes.into_iter().filter(|name| !known.contains(name)).collect::<Vec<_>>());
    }
    if having.is_empty() {
        let known = known.join(", ");
        return Err(Failure::Input(format!("--profile {pass}: no such pass with shaders here; there are {known}")));
    }
    Ok(having)
}

/// Captures frame 0 of a variant, after a frame that compiles its pipelines.
fn capture_frame<S: Study>(
    machine: &mut Machine,
    capture: &RenderDoc,
    study: &S,
    loaded: &Loaded<S>,
    variant: S::Variant,
    folder: &Path,
) -> Result<PathBuf, Failure> {
    let mut built = build(machine, study, &loaded.scene, variant)?;
    let recorder = &mut machine.recorder;
    recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0))?;
    built.paper.restart()?;
    fs::create_dir_all(folder)
        .map_err(|e| Failure::Input(format!("making the folder {} for captures: {e}", folder.display())))?;
    let name = folder.join(format!("{}-{}", S::PAPER, variant.as_str()));
    let file =
        capture.capture(Some(&name), || recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0)).map(|_| ()))?;
    machine.check_validation()?;
    Ok(file)
}

/// Files of the variants' pictures: the first gets the name that was given, the others' have the variant before its ending.
pub fn picture_files<V: Variant>(named: &Path, variants: &[V]) -> Vec<PathBuf> {
    let others = variants.iter().skip(1).map(|variant| suffixed(named, &format!("-{}", variant.as_str())));
    variants.first().map(|_| named.to_owned()).into_iter().chain(others).collect()
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
    let sha256 = write_png_hashed(path, &picture)?;
    machine.check_validation()?;
    Ok(ImageFile { path: path.display().to_string(), sha256 })
}

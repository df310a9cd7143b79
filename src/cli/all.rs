//! `all`: every paper's quick benchmark, one record and a picture of each variant.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::{Args, Parser};

use super::bench;
use super::failure::Failure;
use super::options::{MachineArgs, OutputArgs};
use super::outcome;
use super::pool;
use super::reading;
use super::report;
use super::shader_folder;
use super::watch::interrupted;
use crate::measure::Error;
use crate::measure::bench::{Bench, load};
use crate::measure::limits;
use crate::measure::machine::Machine;
use crate::measure::measure::Schedule;
use crate::measure::study::{Study, Visitor};
use crate::papers;
use crate::report::record::{Limits, Pass, Run};
use crate::report::trace::TraceRun;
use crate::report::{Record, environment};

#[derive(Debug, Clone, Args)]
pub struct AllArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    output: OutputArgs,
    /// Write the page of the report [default of FILE: report.html in --out]
    #[arg(long, value_name = "FILE")]
    report: Option<Option<PathBuf>>,
}

impl AllArgs {
    /// The arguments of `fumarole` alone: of `fumarole all --report`.
    pub fn plain() -> Self {
        #[derive(Parser)]
        struct Plain {
            #[command(flatten)]
            arguments: AllArgs,
        }
        Plain::parse_from(["fumarole", "--report"]).arguments
    }
}

/// Short, so that all papers together take less than three minutes on two cores without a GPU.
const SCHEDULE: Schedule = Schedule { warmup: 2, frames: 3, repeat: 3, min_time_s: 0.0 };

/// The runs measured so far.
#[derive(Default)]
struct Measured {
    /// The device's own, measured once.
    limits: Option<Limits>,
    runs: Vec<Run>,
    traces: Vec<TraceRun>,
    /// The first of what failed and kept no other paper from being measured.
    failed: Option<Failure>,
}

pub fn run(arguments: &AllArgs) -> Result<(), Failure> {
    if arguments.output.image.is_some() {
        let message = "--image: every variant has a picture; they go into --out, and render writes one by name";
        return Err(Failure::Input(message.into()));
    }
    let json = arguments.output.json.clone().unwrap_or_else(|| arguments.output.out.join("fumarole.json"));
    let output = OutputArgs { json: Some(json), ..arguments.output.clone() };
    outcome::check(&output)?;
    let page = arguments.report.clone().map(|page| page.unwrap_or_else(|| output.out.join("report.html")));
    page.iter().try_for_each(|page| outcome::check_file(page))?;

    pool::start()?;
    let read = reading::by_machine(&arguments.machine);
    let mut pictures = Pictures { folder: &output.out, files: Vec::new(), read };
    papers::each(&mut pictures)?;
    outcome::check_apart(output.files().chain(&page).chain(&pictures.files), &pictures.read)?;

    shader_folder::check(arguments.machine.shader_dir())?;
    // Every paper runs on one device, so that their figures compare.
    let mut machine = Machine::open(&arguments.machine.resolve(0), &[])?;
    outcome::say_device(&output, &machine);
    let mut measured = Measured::default();
    let ended = papers::each(&mut All { machine: &mut machine, output: &output, measured: &mut measured });
    // A paper that fails throws away no other's measurement.
    let failed = measured.failed.or(ended.err());
    if measured.runs.is_empty()
        && let Some(failed) = failed
    {
        return Err(failed);
    }
    let record = Record::new(machine.environment(), environment::command(), measured.runs);
    outcome::publish(&output, &record, &measured.traces)?;
    if let Some(page) = &page {
        let name = output.json.as_deref().filter(|_| !output.json_to_stdout()).unwrap_or(Path::new("fumarole all"));
        report::write_record(&record, name, page, output.quiet)?;
    }
    if !output.quiet {
        summary(&record, &output, page.as_deref()).iter().for_each(|line| outcome::say(line));
    }
    failed.map_or(Ok(()), Err)
}

/// Checks before the long work that the pictures can be written.
struct Pictures<'a> {
    folder: &'a Path,
    /// Those of the papers so far.
    files: Vec<PathBuf>,
    /// Files that the papers so far read, and the shaders.
    read: Vec<PathBuf>,
}

impl Visitor for Pictures<'_> {
    type Error = Failure;

    fn visit<S: Study>(&mut self) -> Result<(), Failure> {
        let files = pictures::<S>(self.folder);
        files.iter().try_for_each(|picture| outcome::check_file(picture))?;
        self.files.extend(files);
        self.read.extend(reading::named(&S::parameters(), &S::quick()));
        Ok(())
    }
}

/// Files of the pictures of a paper's variants.
fn pictures<S: Study>(folder: &Path) -> Vec<PathBuf> {
    bench::picture_files(&folder.join(format!("{}.png", S::PAPER)), S::BENCHED)
}

/// The papers with the slowest pass of every variant, the files, and what to try next; a line each.
fn summary(record: &Record, output: &OutputArgs, page: Option<&Path>) -> Vec<String> {
    let mut papers: Vec<&str> = record.runs.iter().map(|run| run.paper.as_str()).collect();
    papers.dedup();
    let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
    let (papers, variants) = (count(papers.len(), "paper"), count(record.runs.len(), "variant"));
    let mut lines = vec![format!("{papers} in {variants}; the slowest pass of each")];
    lines.extend(record.runs.iter().filter_map(|run| {
        let (pass, ms) = slowest(run)?;
        let near = pass.fraction_of_limit().zip(pass.bound.as_ref());
        let near = near
            .map_or_else(String::new, |(fraction, bound)| format!(", {:.0} % of limit ({bound})", 100.0 * fraction));
        Some(format!("  {} {}: {}, {ms:.1} ms{near}", run.paper, run.variant, pass.name))
    }));
    let pictures = record.runs.iter().filter_map(|run| Some(run.image.as_ref()?.path.clone()));
    let json = output.json.as_deref().filter(|_| !output.json_to_stdout());
    let files = [json, output.csv.as_deref(), output.trace.as_deref(), page];
    let files = files.into_iter().flatten().map(|path| path.display().to_string()).chain(pictures);
    lines.push(format!("files: {}", files.collect::<Vec<_>>().join(", ")));
    lines.push(
        "next: fumarole PAPER bench --preset NAME, fumarole PAPER bench --profile PASS, fumarole PAPER experiment --list, \
         fumarole report DIR"
            .into(),
    );
    lines
}

fn slowest(run: &Run) -> Option<(&Pass, f64)> {
    let times = run.passes.iter().filter_map(|pass| {
        let time = pass.gpu_ms.as_ref().or(pass.host_ms.as_ref())?;
        Some((pass, time.median))
    });
    times.max_by(|a, b| a.1.total_cmp(&b.1))
}

struct All<'a> {
    machine: &'a mut Machine,
    output: &'a OutputArgs,
    measured: &'a mut Measured,
}

impl Visitor for All<'_> {
    type Error = Failure;

    fn visit<S: Study>(&mut self) -> Result<(), Failure> {
        measure_quick(&S::quick(), self.machine, self.output, self.measured)
    }
}

fn measure_quick<S: Study>(
    study: &S,
    machine: &mut Machine,
    output: &OutputArgs,
    measured: &mut Measured,
) -> Result<(), Failure> {
    let variants = S::BENCHED;
    if interrupted().load(Ordering::Relaxed) && !measured.runs.is_empty() {
        return Ok(());
    }
    let paper = S::PAPER;
    let lacks = machine.device.physical().lacks(S::NEEDS);
    if !lacks.is_empty() {
        outcome::say(&format!("{paper}: left out, the device lacks {}", lacks.join(", ")));
        return Ok(());
    }
    if measured.limits.is_none() {
        measured.limits = Some(limits::measure(machine)?);
    }
    let loaded = load(study)?;
    let limits = measured.limits.as_ref();
    let bench = Bench { study, loaded: &loaded, variants, schedule: SCHEDULE, limits };
    let (mut runs, traces) = match bench::measured(&bench, machine, output) {
        Err(Error::Interrupted) if !measured.runs.is_empty() => return Ok(()),
        found => found?,
    };
    let pictures = pictures::<S>(&output.out);
    for (index, ((&variant, picture), run)) in variants.iter().zip(&pictures).zip(&mut runs).enumerate() {
        if index > 0 && interrupted().load(Ordering::Relaxed) {
            break;
        }
        match bench::write_picture(machine, study, &loaded, variant, 0, picture) {
            Ok(image) => {
                run.image = Some(image);
                outcome::wrote(output, picture);
            }
            Err(failure) => {
                run.warnings.push(format!("without a picture: {failure}"));
                measured.failed.get_or_insert(failure);
            }
        }
    }
    measured.runs.extend(runs);
    measured.traces.extend(traces);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    #[test]
    fn the_end_names_slowest_passes_files_and_what_to_try() {
        let output = OutputArgs { json: Some("out/fumarole.json".into()), ..AllArgs::plain().output };
        let lines = summary(&example::full(), &output, Some(Path::new("out/report.html")));
        assert_eq!(lines[0], "1 paper in 1 variant; the slowest pass of each");
        assert_eq!(lines[1], "  gas slices: splat, 2.0 ms, 20 % of limit (vertices)");
        assert_eq!(lines[2], "files: out/fumarole.json, out/report.html, fumarole-out/gas.png");
        assert!(lines[3].starts_with("next: fumarole PAPER bench"), "{lines:?}");
        let output = OutputArgs { json: Some("-".into()), ..output };
        assert_eq!(summary(&example::full(), &output, None)[2], "files: fumarole-out/gas.png");
    }
}

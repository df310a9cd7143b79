//! `stress`: grows an axis of a paper until a limit stops it, each step in a process of its own.

mod all;
mod climber;
mod identity;
mod record;
mod step;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};

pub use self::all::{StressAllArgs, run as run_all};
use self::climber::Children;
pub use self::record::File;
pub use self::step::StepArgs;
use super::failure::Failure;
use super::options::{MachineArgs, number_in};
use super::outcome;
use super::processes::without;
use super::reading;
use super::watch::interrupted;
use crate::file::{check_writable, is_pipe};
use crate::measure::Variant;
use crate::measure::measure::Schedule;
use crate::measure::parameter::Given;
use crate::measure::shard::Shard;
use crate::measure::stress::console::{Form, tables};
use crate::measure::stress::{Axis, Climb, Ladder, plots};
use crate::measure::study::Study;
use crate::report::stress::{StopKind, StressRecord};

#[derive(Debug, Clone, Args)]
pub struct StressArgs {
    /// Axis that grows; `--list` names the paper's [default: the first of them]
    #[arg(long, value_name = "NAME")]
    axis: Option<String>,
    /// List the axes
    #[arg(long)]
    list: bool,
    /// Cross two axes: for each value of B the steps of A
    #[arg(long, value_name = "A,B", conflicts_with = "axis")]
    matrix: Option<String>,
    /// Of the series, one of each variant and value of a matrix's second axis, the part I of N; assemble joins the records
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// First value of the axis [default: the axis's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    from: Option<u64>,
    #[command(flatten)]
    limits: LimitArgs,
    /// Measure on each of these devices, one after the other: indices, parts of names or UUIDs, comma-separated
    #[arg(long, value_name = "DEVICE,..", value_delimiter = ',', conflicts_with = "device", help_heading = "Device")]
    devices: Vec<String>,
    #[command(flatten)]
    machine: MachineArgs,
    /// Frames before anything counts, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Measuring")]
    warmup: u32,
    /// Frames in one repetition, 1 to 100000
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Measuring")]
    frames: u32,
    /// Repetitions of those frames, 1 to 10000
    #[arg(long, value_name = "R", default_value_t = 3,
        value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Measuring")]
    repeat: u32,
    #[command(flatten)]
    output: StressOutput,
    /// The record, which a second call goes on with; to standard output as well without a file [default: in --out]
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", help_heading = "Output")]
    json: Option<PathBuf>,
    /// One row for each step and pass [default: in --out]
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    step: StepArgs,
}

/// Options that end the steps.
#[derive(Debug, Clone, Args)]
struct LimitArgs {
    /// Factor from step to step, 1.05 to 100
    #[arg(long, value_name = "F", default_value_t = 2.0, value_parser = parse_factor)]
    factor: f64,
    /// Seconds for all steps together, 1 to 1000000 [default: 120; of all papers 600]
    #[arg(long, value_name = "S", value_parser = parse_budget)]
    budget: Option<f64>,
    /// Limit to look for; for memory and device each step draws as few frames as it can, so that the budget reaches further
    #[arg(long, value_name = "LIMIT", value_enum)]
    until: Option<Until>,
    /// Measure every step anew, whatever the record holds
    #[arg(long)]
    anew: bool,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
struct StressOutput {
    /// Folder of record, rows and plots
    #[arg(long, value_name = "DIR", default_value = "fumarole-out")]
    out: PathBuf,
    /// Print the tables as Markdown, to paste
    #[arg(long)]
    markdown: bool,
    /// Print nothing but errors and what was asked for on standard output
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Until {
    Time,
    Memory,
    Device,
}

impl Until {
    fn kind(self) -> StopKind {
        match self {
            Until::Time => StopKind::Time,
            Until::Memory => StopKind::Memory,
            Until::Device => StopKind::Device,
        }
    }

    fn as_str(self) -> &'static str {
        self.kind().as_str()
    }
}

fn parse_factor(text: &str) -> Result<f64, String> {
    number_in(text, 1.05..=100.0, "a factor of 1.05 to 100")
}

fn parse_budget(text: &str) -> Result<f64, String> {
    number_in(text, 1.0..=1e6, "a time of 1 to 1000000 seconds")
}

/// Seconds of a paper without `--budget`.
const BUDGET_S: f64 = 120.0;

/// Options that a step's process does not get, and whether a value follows.
const OURS: [(&str, bool); 11] = [
    ("--shard", true),
    ("--devices", true),
    ("--device", true),
    ("--csv", true),
    ("--out", true),
    ("--budget", true),
    ("--factor", true),
    ("--from", true),
    ("--markdown", false),
    ("--anew", false),
    ("--quiet", false),
];

/// Steps of one paper on one device.
struct Ascent<'a, S: Study> {
    setup: S,
    variants: Vec<S::Variant>,
    axis: Axis<S>,
    across: Option<Axis<S>>,
    from: Option<u64>,
    shard: Option<Shard>,
    schedule: Schedule,
    limits: &'a LimitArgs,
    output: &'a StressOutput,
    machine: &'a MachineArgs,
    json: Option<PathBuf>,
    csv: Option<PathBuf>,
    /// Arguments of a step's process, without the step itself.
    child_arguments: Vec<OsString>,
    /// Goes after the names of files.
    suffix: String,
}

/// Runs the verb for a paper: its steps, or in a process of its own the one step that it was started for.
pub fn run<S: Study>(
    arguments: &StressArgs,
    setup: S,
    variants: Vec<S::Variant>,
    given: &Given,
) -> Result<(), Failure> {
    if arguments.list {
        let line = |axis: Axis<S>| format!("{:20}{}\n", axis.name, axis.help);
        return outcome::print(&S::axes().into_iter().map(line).collect::<String>());
    }
    arguments.check(given)?;
    let (axis, across) = arguments.axes::<S>()?;
    if let Some(axis) = [Some(&axis), across.as_ref()].into_iter().flatten().find(|axis| given.has(axis.parameter)) {
        let name = axis.parameter;
        return Err(Failure::Input(format!(
            "--{name}: the axis sets it; --from says where it begins, or leave it out"
        )));
    }
    if arguments.step.is_step() {
        let axes = (&axis, across.as_ref());
        let until = arguments.limits.until;
        return step::run(&arguments.step, &arguments.machine, axes, setup, &variants, arguments.schedule(until));
    }
    let child_arguments = without(&OURS, std::env::args_os().skip(1));
    let devices: Vec<Option<&String>> =
        if arguments.devices.is_empty() { vec![None] } else { arguments.devices.iter().map(Some).collect() };
    let of_device = |machine: &MachineArgs| child_arguments.iter().cloned().chain(machine.device_arguments()).collect();
    // One that is not there is told before the steps on another.
    for device in &arguments.devices {
        let arguments_there: Vec<OsString> = of_device(&arguments.machine.on(device));
        Children::new(&arguments_there, arguments.output.quiet)?.environment()?;
    }
    let started = Instant::now();
    let budget_s = arguments.limits.budget.unwrap_or(BUDGET_S);
    for (number, device) in devices.iter().enumerate() {
        let left_s = (budget_s - started.elapsed().as_secs_f64()).max(0.0);
        let (axis, across) = arguments.axes::<S>()?;
        let machine = device.map_or_else(|| arguments.machine.clone(), |device| arguments.machine.on(device));
        let ascent = Ascent {
            setup: setup.clone(),
            variants: variants.clone(),
            axis,
            across,
            from: arguments.from,
            shard: arguments.shard,
            schedule: arguments.schedule(arguments.limits.until),
            limits: &arguments.limits,
            output: &arguments.output,
            child_arguments: of_device(&machine),
            machine: &machine,
            json: arguments.json.clone(),
            csv: arguments.csv.clone(),
            suffix: device.map_or_else(String::new, |device| format!("-{}", slug(device))),
        };
        ascent.publish(left_s / (devices.len() - number) as f64)?;
    }
    Ok(())
}

/// A text as a part of a file's name.
fn slug(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
}

impl StressArgs {
    fn schedule(&self, until: Option<Until>) -> Schedule {
        let StressArgs { warmup, frames, repeat, .. } = *self;
        schedule(until, Schedule { warmup, frames, repeat, min_time_s: 0.0 })
    }

    /// Refuses options that would do nothing beside others.
    fn check(&self, given: &Given) -> Result<(), Failure> {
        let files = [("json", "a record", self.json.is_some()), ("csv", "rows", self.csv.is_some())];
        if let Some((name, what, _)) = files.into_iter().find(|(.., is_set)| *is_set && self.devices.len() > 1) {
            return Err(Failure::Input(format!(
                "--{name}: each of several devices has {what} of its own in --out; leave --{name} out"
            )));
        }
        let overridden = ["warmup", "frames", "repeat"].into_iter().find(|name| given.has(name));
        match (self.limits.until, overridden) {
            (Some(until @ (Until::Memory | Until::Device)), Some(name)) => Err(Failure::Input(format!(
                "--{name}: with --until {} each step draws as few frames as it can; leave --{name} out",
                until.as_str()
            ))),
            _ => Ok(()),
        }
    }

    /// The axis, and in a matrix the second one.
    fn axes<S: Study>(&self) -> Result<(Axis<S>, Option<Axis<S>>), Failure> {
        let named = |option: &str, name: &str| {
            let mut axes = S::axes();
            let names: Vec<&str> = axes.iter().map(|axis| axis.name).collect();
            let found = names.iter().position(|known| *known == name);
            found.map(|at| axes.swap_remove(at)).ok_or_else(|| {
                Failure::Input(format!("--{option} {name}: no such axis; {} has {}", S::PAPER, names.join(", ")))
            })
        };
        match (&self.matrix, &self.axis) {
            (Some(matrix), _) => match matrix.split(',').collect::<Vec<_>>()[..] {
                [a, b] if a != b => Ok((named("matrix", a)?, Some(named("matrix", b)?))),
                _ => Err(Failure::Input(format!("--matrix {matrix}: give two different axes, as A,B"))),
            },
            (None, Some(name)) => Ok((named("axis", name)?, None)),
            (None, None) => Ok((default_axis()?, None)),
        }
    }
}

fn default_axis<S: Study>() -> Result<Axis<S>, Failure> {
    let none = || Failure::Input(format!("stress: {} declares no axis that could grow", S::PAPER));
    S::axes().into_iter().next().ok_or_else(none)
}

/// The schedule of a step: the shortest where a limit is looked for that frames say nothing of.
fn schedule(until: Option<Until>, usual: Schedule) -> Schedule {
    match until {
        Some(Until::Memory | Until::Device) => Schedule { warmup: 1, frames: 1, repeat: 1, min_time_s: 0.0 },
        None | Some(Until::Time) => usual,
    }
}

impl<S: Study> Ascent<'_, S> {
    /// Takes the steps, and publishes record, rows, plots and tables.
    fn publish(self, budget_s: f64) -> Result<(), Failure> {
        let file = |ending: &str| self.output.out.join(format!("{}{ending}", self.stem()));
        let is_printed = self.json.as_deref().is_some_and(|path| path.as_os_str() == "-");
        let json = self.json.clone().filter(|_| !is_printed).unwrap_or_else(|| file(".json"));
        let csv = self.csv.clone().unwrap_or_else(|| file(".csv"));
        outcome::check_apart([&json, &csv], &reading::by_study(&self.setup, self.machine))?;
        // Before a device is opened.
        if is_pipe(&json) {
            return Err(Failure::Input(format!(
                "writing {}: it is a pipe, which takes one record, and stress writes one after every step; name a regular \
                 file, or give --json - to have the last one printed",
                json.display()
            )));
        }
        // Where there can be no record, none is gone on with.
        check_writable(&json)?;
        outcome::check_file(&csv)?;
        let file = File::new(json.clone());
        let left = file.left(self.limits.anew)?;
        let record = self.climb(file, left, budget_s)?;

        let files = outcome_files(&record, &self.stem(), &self.output.out, csv);
        let printed = match (is_printed, self.output.markdown) {
            (true, _) => outcome::print(&outcome::text(&record)?),
            (_, true) => outcome::print(&tables(&record, Form::Markdown)),
            _ if self.output.quiet => Ok(()),
            _ => outcome::print(&tables(&record, Form::Console(outcome::style()))),
        };
        let mut written = vec![json];
        for (path, text) in files {
            crate::file::write(&path, text.as_bytes())?;
            written.push(path);
        }
        if !self.output.quiet {
            self.limits.until.iter().for_each(|until| say_unmet(&record, *until));
            written.iter().for_each(|path| outcome::say(&format!("wrote {}", path.display())));
        }
        printed
    }

    fn stem(&self) -> String {
        let across = self.across.as_ref().map_or_else(String::new, |across| format!("-{}", across.name));
        let shard = self.shard.map_or_else(String::new, |shard| format!("-{shard}"));
        format!("stress-{}-{}{across}{}{shard}", S::PAPER, self.axis.name, self.suffix)
    }

    fn climb(&self, file: File, left: Option<StressRecord>, budget_s: f64) -> Result<StressRecord, Failure> {
        let ladder = |axis: &Axis<S>, from: Option<u64>| Ladder {
            from: from.unwrap_or(axis.start),
            factor: self.limits.factor,
            most: axis.most,
        };
        let climb = Climb {
            ladder: ladder(&self.axis, self.from),
            across: self.across.as_ref().map(|across| ladder(across, None)),
            variants: self.variants.iter().map(|variant| variant.as_str().to_owned()).collect(),
            counts_values: self.axis.counts_values(),
            shard: self.shard.unwrap_or(Shard::ALONE),
            budget_s,
        };
        let (first, row) = (climb.ladder.from, climb.across.map(|across| across.from));
        // What is wrong from the beginning is said before a process is started.
        let mut setup = self.setup.clone();
        if let (Some(across), Some(row)) = (&self.across, row) {
            across.set(&mut setup, row)?;
        }
        self.axis.set(&mut setup, first)?;
        let started = Instant::now();
        let children = Children::new(&self.child_arguments, self.output.quiet)?;
        let template = self.template(&children)?;
        let known = file.known(left, &template)?;
        let mut climber = climber::MachineClimber {
            children,
            template,
            file,
            started,
            unit: self.axis.unit,
            interrupted: interrupted(),
            has_steps: false,
        };
        let series = climb.run(&mut climber, known)?;
        Ok(climber.record(&series))
    }
}

/// Rows and plots, with their files.
pub fn outcome_files(record: &StressRecord, stem: &str, folder: &Path, csv: PathBuf) -> Vec<(PathBuf, String)> {
    let mut files = vec![(csv, record.csv())];
    let has_steps = record.series.iter().any(|series| !series.steps.is_empty());
    // A chart without a point is none.
    let mut plot = |name: String, svg: Result<String, _>| {
        if let Ok(svg) = svg {
            files.push((folder.join(name), svg));
        }
    };
    if has_steps && record.series.len() > 1 {
        plot(format!("{stem}.svg"), plots::frames(record));
    }
    for series in &record.series {
        let across = series.across.map_or_else(String::new, |value| format!("-{value}"));
        let alone = record.series.len() == 1;
        // A record's text is no path.
        let name = if alone { format!("{stem}.svg") } else { format!("{stem}-{}{across}.svg", slug(&series.variant)) };
        plot(name, plots::series(record, series));
    }
    files
}

fn say_unmet(record: &StressRecord, until: Until) {
    let is_met = |stop: &crate::report::stress::Stop| stop.kind == until.kind();
    for series in record.series.iter().filter(|series| !series.stop.as_ref().is_some_and(is_met)) {
        let end = series.stop.as_ref().map_or("nothing", |stop| stop.kind.as_str());
        let variant = &series.variant;
        outcome::say(&format!("{variant}: the limit of {} was not met; what stopped it was {end}", until.as_str()));
    }
}

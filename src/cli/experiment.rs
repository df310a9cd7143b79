//! The verb `experiment`, the same for every paper: names, machine, sweep, and the files and tables that
//! are published.

use std::fmt::Debug;
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::options::{CommonArgs, OutputArgs};
use super::outcome;
use super::watch::watched;
use crate::image::{Rgba8, write_png};
use crate::measure::machine::Machine;
use crate::measure::study::Study;
use crate::measure::sweep::{Plan, Point, Swept};
use crate::report::output::check_writable;
use crate::report::record::Run;
use crate::report::{Record, csv};
use clap::{Args, ValueEnum};

/// Name of the experiment, or the list of all.
#[derive(Debug, Clone, Args)]
pub struct NameArgs<N: ValueEnum + Send + Sync + 'static> {
    /// Table or figure of the paper
    #[arg(value_enum, required_unless_present = "list")]
    name: Option<N>,
    /// List the experiments
    #[arg(long)]
    list: bool,
}

/// The options of a paper's verb `experiment`, and what each of its experiments does.
pub trait ExperimentArgs: Args + Debug + 'static {
    type Study: Study;
    /// The tables and figures that are reproduced, with one line on each.
    type Name: ValueEnum + Send + Sync + 'static;

    /// Frames at each point of a sweep that names none.
    const FRAMES: u32;
    /// Repetitions at each point of a sweep that names none.
    const REPEAT: u32;

    fn asked(&self) -> &NameArgs<Self::Name>;

    fn common(&self) -> &CommonArgs;

    /// Options that other verbs know and this experiment would not heed: whether each was given, and what to say then.
    fn unsuited(&self, name: Self::Name) -> Vec<(bool, &'static str)>;

    /// Reproduces the table or figure.
    fn perform(&self, name: Self::Name, publication: &Publication<'_>) -> Result<(), Failure>;

    /// Runs the verb: the list, or one experiment once its options and files are checked.
    fn run(&self) -> Result<(), Failure> {
        let (Some(name), false) = (&self.asked().name, self.asked().list) else { return list::<Self::Name>() };
        let publication = Publication { output: &self.common().output, paper: Self::Study::PAPER, name: name_of(name) };
        refuse(self.common(), &self.unsuited(name.clone()))?;
        publication.check()?;
        self.perform(name.clone(), &publication)
    }

    /// Opens the machine and says which it is.
    fn open(&self) -> Result<Machine, Failure> {
        let machine = Machine::open(&self.common().machine.resolve(self.common().measure.process), Self::Study::NEEDS)?;
        outcome::say_device(&self.common().output, &machine);
        Ok(machine)
    }

    /// Measures the points under a progress bar.
    fn sweep(
        &self,
        publication: &Publication<'_>,
        machine: &mut Machine,
        points: &[Point<Self::Study>],
    ) -> Result<Swept, Failure> {
        let CommonArgs { measure, output, .. } = self.common();
        let limits = measure.limits(machine)?;
        let plan = Plan { schedule: measure.schedule(Self::FRAMES, Self::REPEAT), limits: limits.as_ref() };
        let what = format!("{} {}", publication.paper, publication.name);
        Ok(watched(output.quiet, &what, |watch| plan.measure(points, machine, watch))?)
    }
}

/// The experiment's name as it is typed.
pub fn name_of(name: &impl ValueEnum) -> String {
    name.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
}

/// Prints the experiments with one line on each.
fn list<N: ValueEnum>() -> Result<(), Failure> {
    let line = |name: &N| {
        let value = name.to_possible_value()?;
        Some(format!("{:14}{}\n", value.get_name(), value.get_help().map(ToString::to_string).unwrap_or_default()))
    };
    outcome::print(&N::value_variants().iter().filter_map(line).collect::<String>())
}

/// Fails for the first option that was given and would not be heeded: those of `unsuited`, and those that no experiment
/// heeds.
fn refuse(common: &CommonArgs, unsuited: &[(bool, &str)]) -> Result<(), Failure> {
    let CommonArgs { measure, output, .. } = common;
    let never = [
        (measure.processes > 1, "--processes: an experiment runs in one process; bench takes several"),
        (output.trace.is_some(), "--trace: an experiment has no trace; bench writes one"),
        (output.image.is_some(), "--image: an experiment names its own pictures; render writes one"),
    ];
    match never.iter().chain(unsuited).find(|(is_given, _)| *is_given) {
        Some((_, message)) => Err(Failure::Input((*message).to_owned())),
        None => Ok(()),
    }
}

/// Destination of an experiment's results.
pub struct Publication<'a> {
    /// Folder and files that the user named.
    pub output: &'a OutputArgs,
    /// Name of the paper's command, as `gas`.
    pub paper: &'static str,
    /// Name of the experiment as it is typed.
    pub name: String,
}

impl Publication<'_> {
    /// Fails before long work if a file could not be written after it.
    pub fn check(&self) -> Result<(), Failure> {
        outcome::check(self.output)?;
        // One file of the experiment's own stands for all: they go to one folder.
        Ok(check_writable(&self.file(".json"))?)
    }

    /// A file of the experiment's own, in the folder for files that are not named.
    pub fn file(&self, suffix: &str) -> PathBuf {
        self.output.out.join(format!("{}-{}{suffix}", self.paper, self.name))
    }

    pub fn save(&self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        outcome::save(self.output, path, bytes)
    }

    pub fn picture(&self, suffix: &str, picture: &Rgba8) -> Result<(), Failure> {
        let path = self.file(suffix);
        write_png(&path, picture)?;
        outcome::wrote(self.output, &path);
        Ok(())
    }

    /// A measured table: the record, its rows and the plots, each with its file's suffix, as files, and `table` or the
    /// record on standard output.
    pub fn runs(
        &self,
        machine: &Machine,
        runs: Vec<Run>,
        table: String,
        plots: &[(String, String)],
    ) -> Result<(), Failure> {
        let record = Record::new(machine.environment(), std::env::args().collect(), runs);
        let text = outcome::text(&record)?;
        self.save(&self.json_file(), text.as_bytes())?;
        self.save(&self.csv_file(), csv::to_string(&record).as_bytes())?;
        for (suffix, svg) in plots {
            self.save(&self.file(suffix), svg.as_bytes())?;
        }
        self.print(if self.output.json_to_stdout() { text } else { table })
    }

    fn json_file(&self) -> PathBuf {
        self.output.json.clone().filter(|_| !self.output.json_to_stdout()).unwrap_or_else(|| self.file(".json"))
    }

    fn csv_file(&self) -> PathBuf {
        self.output.csv.clone().unwrap_or_else(|| self.file(".csv"))
    }

    /// Prints after the files: they are kept even when nothing can be printed.
    fn print(&self, text: String) -> Result<(), Failure> {
        if self.output.json_to_stdout() || !self.output.quiet { outcome::print(&text) } else { Ok(()) }
    }
}

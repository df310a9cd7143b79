//! The command line, resolved into work to do, and the exit codes.

mod ab;
mod all;
mod assemble;
mod bench;
mod compare;
mod declared;
mod devices;
mod failure;
mod film;
mod help;
mod loading;
mod options;
mod outcome;
mod page;
mod part;
mod passes;
mod pool;
mod processes;
mod reading;
mod render;
mod report;
mod shader_folder;
mod spelling;
mod stress;
#[cfg(feature = "window")]
mod view;
mod watch;
#[cfg(feature = "window")]
mod worker;

use std::convert::Infallible;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

pub use self::assemble::{Film, Shards, missing_parts, shards_in_folders};
pub use self::failure::Failure;
pub use self::page::{axes_table, options_table};
pub use self::part::{in_folder as parts_in_folder, read as read_part};
pub use self::stress::File as StressFile;
#[cfg(feature = "window")]
pub use self::view::reordered as view_reordered;
use crate::measure::study::{Study, Visitor};
use crate::{gpu, papers};

/// Rendering papers on Vulkan, pass by pass, every pass measured.
#[derive(Debug, Parser)]
#[command(name = "fumarole", version, propagate_version = true)]
struct Umbrella {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the Vulkan devices and which papers they can run
    Devices(devices::DevicesArgs),
    /// Every paper's quick benchmark; also what plain `fumarole` runs
    All(all::AllArgs),
    /// Compare records: is B faster or slower than A?
    Compare(compare::CompareArgs),
    /// Records, pictures and plots as one page that opens without a network
    Report(report::ReportArgs),
    /// Put together what several processes drew or measured
    Assemble(assemble::AssembleArgs),
    /// Grow every paper's first axis until a limit stops it
    Stress(stress::StressAllArgs),
    /// Open a window on a paper: `fumarole view [PAPER] [OPTIONS]`, as `fumarole PAPER view`
    #[cfg(feature = "window")]
    View,
    /// Measure two sides in turn, in fresh processes, until it is certain which is faster
    Ab(ab::AbArgs),
}

/// The command lines of the listed papers, in the list's order.
struct Papers(Vec<Paper>);

/// A paper's command line.
struct Paper {
    name: &'static str,
    /// Its verbs and their options.
    command: fn() -> clap::Command,
    /// Runs one of its verbs.
    run: fn(&ArgMatches) -> Result<(), Failure>,
    /// Checks its bench as far as that goes without a device, and lists the files that it writes.
    check: fn(&ArgMatches) -> Result<Vec<PathBuf>, Failure>,
    /// Lists the files that its bench reads.
    read: fn(&ArgMatches) -> Vec<PathBuf>,
}

impl Paper {
    fn of<S: Study>() -> Paper {
        Paper {
            name: S::PAPER,
            command: declared::command::<S>,
            run: declared::run::<S>,
            check: declared::check_bench::<S>,
            read: declared::read_by_bench::<S>,
        }
    }

    /// Runs the paper with `arguments`, the first of which is the program's name, and gives the exit code.
    fn run_with(&self, arguments: impl IntoIterator<Item = OsString>) -> u8 {
        let command = (self.command)().version(env!("CARGO_PKG_VERSION")).propagate_version(true);
        spelling::learn(&command);
        match command.try_get_matches_from::<_, OsString>(arguments) {
            Ok(matches) => code((self.run)(&matches)),
            Err(error) => outcome::usage(&error),
        }
    }
}

impl Visitor for Papers {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        self.0.push(Paper::of::<S>());
        Ok(())
    }
}

/// The command line of `fumarole`, parsed; the first of `arguments` is the program's name.
///
/// # Errors
/// Help that was asked for, and what the parser refuses.
pub fn parsed(arguments: impl IntoIterator<Item = OsString>) -> Result<ArgMatches, clap::Error> {
    let papers = listed();
    umbrella_command(&papers).try_get_matches_from(ab::reordered(arguments.into_iter().collect(), &papers))
}

fn listed() -> Vec<Paper> {
    let mut papers = Papers(Vec::new());
    let Ok(()) = papers::each(&mut papers);
    papers.0
}

/// The command with every paper below it.
fn umbrella_command(papers: &[Paper]) -> clap::Command {
    let program = help::whole(Umbrella::command()).mut_subcommands(|verb| {
        match help::OF_PROGRAM.iter().find(|(name, _)| *name == verb.get_name()) {
            Some((_, everyday)) => help::shortened(verb, everyday),
            None => help::whole(verb),
        }
    });
    #[cfg(feature = "window")]
    let program = program.mut_subcommand("view", |view| view::before_paper(view, papers));
    program.subcommands(papers.iter().map(|paper| (paper.command)()))
}

/// Names of papers as a message lists them.
fn paper_names<'a>(papers: impl IntoIterator<Item = &'a Paper>) -> String {
    papers.into_iter().map(|paper| paper.name).collect::<Vec<_>>().join(", ")
}

/// The refusal of a verb of papers that no paper was named for.
fn without_paper(verb: &OsStr, papers: &[Paper]) -> Option<Failure> {
    let verb = verb.to_str()?;
    let has_verb = |paper: &&Paper| (paper.command)().find_subcommand(verb).is_some_and(|found| !found.is_hide_set());
    let names = paper_names(papers.iter().filter(has_verb));
    let message = format!("{verb}: give a paper first: fumarole PAPER {verb}; PAPER is one of {names}");
    (!names.is_empty()).then_some(Failure::Input(message))
}

/// Runs `fumarole`.
pub fn umbrella() -> ExitCode {
    gpu::keep_errors_untraced();
    if let Some(code) = shader_folder::answer() {
        return code;
    }
    watch::keep_ignored();
    gpu::pin_software_threads();
    let papers = listed();
    let command = umbrella_command(&papers);
    spelling::learn(&command);
    let arguments = std::env::args_os().collect();
    #[cfg(feature = "window")]
    let arguments: Vec<OsString> = match view::reordered(arguments) {
        Ok(arguments) => arguments,
        Err(failure) => return end(Err(failure)),
    };
    let arguments = ab::reordered(arguments, &papers);
    let first = arguments.get(1).cloned().unwrap_or_default();
    let matches = match command.try_get_matches_from(arguments) {
        Ok(matches) => matches,
        Err(error) => {
            let misplaced = Some(first).filter(|_| error.kind() == ErrorKind::InvalidSubcommand);
            return match misplaced.and_then(|verb| without_paper(&verb, &papers)) {
                Some(failure) => end(Err(failure)),
                None => ExitCode::from(outcome::usage(&error)),
            };
        }
    };
    if let Some((name, matches)) = matches.subcommand()
        && let Some(paper) = papers.iter().find(|paper| paper.name == name)
    {
        return end((paper.run)(matches));
    }
    let parsed = match Umbrella::from_arg_matches(&matches) {
        Ok(parsed) => parsed,
        Err(error) => return ExitCode::from(outcome::usage(&error)),
    };
    end(match &parsed.command {
        None => all::run(&all::AllArgs::plain()),
        Some(Command::All(arguments)) => all::run(arguments),
        Some(Command::Devices(arguments)) => devices::run(arguments),
        Some(Command::Compare(arguments)) => compare::run(arguments),
        Some(Command::Ab(arguments)) => ab::run(arguments),
        Some(Command::Assemble(arguments)) => assemble::run(arguments),
        Some(Command::Stress(arguments)) => stress::run_all(arguments),
        // Reordered before it was parsed.
        #[cfg(feature = "window")]
        Some(Command::View) => Ok(()),
        Some(Command::Report(arguments)) => report::run(arguments),
    })
}

/// Runs the own binary of a listed paper.
pub fn binary<S: Study>() -> ExitCode {
    gpu::keep_errors_untraced();
    if let Some(code) = shader_folder::answer() {
        return code;
    }
    watch::keep_ignored();
    gpu::pin_software_threads();
    // Found by its name: were `Paper::of::<S>` named here, each binary would compile the whole paper once more.
    let Some(paper) = listed().into_iter().find(|paper| paper.name == S::PAPER) else {
        outcome::say(&format!("{} is not in the list of papers; add it there (src/papers/mod.rs)", S::PAPER));
        return ExitCode::FAILURE;
    };
    ExitCode::from(paper.run_with(std::env::args_os()))
}

/// Runs a paper with `arguments`, the first of which is the program's name, and gives the exit code.
pub fn paper_from<S: Study>(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    Paper::of::<S>().run_with(arguments)
}

fn end(result: Result<(), Failure>) -> ExitCode {
    ExitCode::from(code(result))
}

fn code(result: Result<(), Failure>) -> u8 {
    result.map_or_else(Failure::report, |()| 0)
}

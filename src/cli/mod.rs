//! What the user typed, resolved into an experiment; exit codes.

mod all;
mod bench;
mod caustics;
mod compare;
mod devices;
mod experiment;
mod failure;
mod options;
mod outcome;
mod passes;
mod processes;
mod render;
mod watch;

use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use self::failure::Failure;

/// Rendering papers on Vulkan, pass by pass, every pass measured.
#[derive(Debug, Parser)]
#[command(name = "fumarole", version, propagate_version = true)]
struct Umbrella {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the Vulkan devices and which papers they are capable of
    Devices(devices::DevicesArgs),
    /// Every paper's quick benchmark; also what plain `fumarole` runs
    All(all::AllArgs),
    /// Compare records: is B faster or slower than A?
    Compare(compare::CompareArgs),
    /// Refractive water caustics with level maps (Tipprasert)
    Caustics(CausticsArgs),
}

#[derive(Debug, Args)]
struct CausticsArgs {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Parser)]
#[command(name = "caustics", version, propagate_version = true)]
/// Refractive water caustics with level maps (Tipprasert), pass by pass
struct CausticsBinary {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List the passes in the paper's order
    Passes(Box<passes::PassesArgs>),
    /// Time one configuration in one or more variants, interleaved
    Bench(Box<bench::BenchArgs>),
    /// Reproduce one table or figure, ours beside the paper's
    Experiment(Box<experiment::ExperimentArgs>),
    /// Write pictures and intermediate targets
    Render(Box<render::RenderArgs>),
}

impl Verb {
    fn run(&self) -> Result<(), Failure> {
        match self {
            Verb::Passes(arguments) => passes::run(arguments),
            Verb::Bench(arguments) => bench::run(arguments),
            Verb::Experiment(arguments) => experiment::run(arguments),
            Verb::Render(arguments) => render::run(arguments),
        }
    }
}

/// Runs `fumarole`.
pub fn umbrella() -> ExitCode {
    let parsed = Umbrella::parse();
    end(match &parsed.command {
        None => all::run(&all::AllArgs::plain()),
        Some(Command::All(arguments)) => all::run(arguments),
        Some(Command::Devices(arguments)) => devices::run(arguments),
        Some(Command::Compare(arguments)) => compare::run(arguments),
        Some(Command::Caustics(arguments)) => arguments.verb.run(),
    })
}

/// Runs the paper's own binary `caustics`.
pub fn caustics() -> ExitCode {
    end(CausticsBinary::parse().verb.run())
}

fn end(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

//! What the user typed, resolved into an experiment; exit codes.

mod all;
mod bench;
mod burning;
mod caustics;
mod compare;
mod devices;
mod experiment;
mod failure;
mod gas;
mod lava;
mod options;
mod outcome;
mod paper;
mod passes;
mod processes;
mod render;
mod terrain;
mod watch;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use self::burning::BurningArgs;
use self::caustics::CausticsArgs;
use self::failure::Failure;
use self::gas::GasArgs;
use self::lava::LavaArgs;
use self::paper::PaperCommand;
use self::terrain::TerrainArgs;

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
    /// Lava: particles to density to isosurface to splats (Unnthorsson)
    Lava(PaperCommand<LavaArgs>),
    /// Gas: A-buffer surfaces and volume-traced gases in one picture (Ebert, Parent)
    Gas(PaperCommand<GasArgs>),
    /// Refractive water caustics with level maps (Tipprasert)
    Caustics(PaperCommand<CausticsArgs>),
    /// Burning, deforming and melting meshes (Amarasinghe)
    Burning(PaperCommand<BurningArgs>),
    /// The volcano paper's terrain, ray-cast from a shape texture (Vyatkin)
    Terrain(PaperCommand<TerrainArgs>),
}

/// Runs `fumarole`.
pub fn umbrella() -> ExitCode {
    let parsed = Umbrella::parse();
    end(match &parsed.command {
        None => all::run(&all::AllArgs::plain()),
        Some(Command::All(arguments)) => all::run(arguments),
        Some(Command::Devices(arguments)) => devices::run(arguments),
        Some(Command::Compare(arguments)) => compare::run(arguments),
        Some(Command::Lava(arguments)) => arguments.run(),
        Some(Command::Gas(arguments)) => arguments.run(),
        Some(Command::Caustics(arguments)) => arguments.run(),
        Some(Command::Burning(arguments)) => arguments.run(),
        Some(Command::Terrain(arguments)) => arguments.run(),
    })
}

/// Runs the paper's own binary `lava`.
pub fn lava() -> ExitCode {
    end(paper::binary::<LavaArgs>())
}

/// Runs the paper's own binary `gas`.
pub fn gas() -> ExitCode {
    end(paper::binary::<GasArgs>())
}

/// Runs the paper's own binary `caustics`.
pub fn caustics() -> ExitCode {
    end(paper::binary::<CausticsArgs>())
}

/// Runs the paper's own binary `burning`.
pub fn burning() -> ExitCode {
    end(paper::binary::<BurningArgs>())
}

/// Runs the paper's own binary `terrain`.
pub fn terrain() -> ExitCode {
    end(paper::binary::<TerrainArgs>())
}

fn end(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

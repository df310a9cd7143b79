//! `experiment NAME`: one table or figure of the paper, ours beside the paper's.

use clap::{Args, ValueEnum};

use super::caustics::SceneArgs;
use super::failure::Failure;
use super::options::{MachineArgs, MeasureArgs, OutputArgs};
use super::outcome;
use super::watch::{interrupted, progress_bar};
use crate::experiment::caustics::{PAPER, table_5_1};
use crate::experiment::limits;
use crate::experiment::machine::Machine;
use crate::experiment::measure::Watch;
use crate::papers::caustics::NEEDS;
use crate::report::{Record, csv};

/// The tables and figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Table 5-1 and figure 5-10: level map against volumetric by number of planes
    #[value(name = "5-1")]
    Table51,
}

#[derive(Debug, Clone, Args)]
pub struct ExperimentArgs {
    /// Table or figure of the paper
    #[arg(value_enum, required_unless_present = "list")]
    name: Option<Name>,
    /// List the experiments
    #[arg(long)]
    list: bool,
    /// Plane counts of a sweep, comma-separated [default: 3,11,31,101]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    /// Sweep 3 to 101 planes by this step instead: 1 is the thesis's full table
    #[arg(long, value_name = "N", conflicts_with = "counts", value_parser = clap::value_parser!(u32).range(1..=98))]
    step: Option<u32>,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    output: OutputArgs,
}

const FRAMES: u32 = 3;
const REPEAT: u32 = 3;

pub fn run(arguments: &ExperimentArgs) -> Result<(), Failure> {
    let (Some(name), false) = (arguments.name, arguments.list) else {
        for name in Name::value_variants() {
            if let Some(value) = name.to_possible_value() {
                let help = value.get_help().map(ToString::to_string).unwrap_or_default();
                println!("{:12} {help}", value.get_name());
            }
        }
        return Ok(());
    };
    match name {
        Name::Table51 => table51(arguments),
    }
}

fn table51(arguments: &ExperimentArgs) -> Result<(), Failure> {
    let output = &arguments.output;
    let file = |ending: &str| output.out.join(format!("{PAPER}-5-1.{ending}"));
    outcome::check(output)?;
    for ending in ["json", "csv", "svg"] {
        crate::report::output::check_writable(&file(ending))?;
    }
    let counts = match arguments.step {
        Some(step) => (3..=101).step_by(step as usize).collect(),
        None if arguments.counts.is_empty() => vec![3, 11, 31, 101],
        None => arguments.counts.clone(),
    };
    let setup = arguments.scene.resolve(arguments.measure.process);
    let meshes = if arguments.scene.names_meshes() { setup.meshes.clone() } else { table_5_1::default_meshes() };
    let mut machine = Machine::open(&arguments.machine.resolve(), &NEEDS)?;
    if !output.quiet {
        eprintln!("device: {}", machine.description());
    }
    let limits = if arguments.measure.no_limits { None } else { Some(limits::measure(&mut machine)?) };
    let bar = progress_bar(output.quiet, "caustics 5-1");
    let mut watch = Watch {
        interrupted: interrupted(),
        progress: &mut |done, expected| {
            bar.set_length(expected);
            bar.set_position(done);
        },
    };
    let schedule = arguments.measure.schedule(FRAMES, REPEAT);
    let sweep = table_5_1::Sweep { setup, meshes, counts, schedule, limits };
    let table = sweep.run(&mut machine, &mut watch)?;
    bar.finish_and_clear();

    let record = Record::new(machine.environment(), std::env::args().collect(), table.runs.clone());
    if output.json_to_stdout() {
        print!("{}", outcome::text(&record)?);
    } else if !output.quiet {
        print!("{}", table.render(outcome::style()));
    }
    let json = output.json.clone().filter(|_| !output.json_to_stdout()).unwrap_or_else(|| file("json"));
    outcome::save(output, &json, outcome::text(&record)?.as_bytes())?;
    outcome::save(output, &output.csv.clone().unwrap_or_else(|| file("csv")), csv::to_string(&record).as_bytes())?;
    outcome::save(output, &file("svg"), table.plot()?.as_bytes())
}

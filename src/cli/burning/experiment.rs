//! `experiment NAME`: one figure of the dissertation.

use clap::{Args, ValueEnum};

use super::BurningArgs;
use crate::cli::experiment::{Publication, list, refuse, word};
use crate::cli::failure::Failure;
use crate::cli::options::{MachineArgs, MeasureArgs, OutputArgs};
use crate::cli::outcome;
use crate::cli::paper::{ExperimentArgs, PaperArgs, variant_word};
use crate::experiment::burning::{Setup, strips};
use crate::experiment::machine::Machine;
use crate::papers::burning::{NEEDS, Variant};

/// The figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Pictures of one object at several moments, side by side
    Sequence,
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    /// Table or figure of the paper
    #[arg(value_enum, required_unless_present = "list")]
    name: Option<Name>,
    /// List the experiments
    #[arg(long)]
    list: bool,
    /// Variant of a sequence
    #[arg(long, default_value = "shell", value_parser = variant_word::<Variant>())]
    variant: Variant,
    /// Frames of a sequence, comma-separated and rising, each 0 to 100000
    #[arg(long = "moments", value_name = "N,N,..", value_delimiter = ',', default_value = "60,200,400,800",
        value_parser = clap::value_parser!(u32).range(0..=100_000))]
    moments: Vec<u32>,
    #[command(flatten)]
    scene: BurningArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl ExperimentArgs for Experiments {
    fn run(&self) -> Result<(), Failure> {
        let (Some(name), false) = (self.name, self.list) else { return list::<Name>() };
        let publication = Publication { output: &self.output, paper: "burning", name: word(&name) };
        let unsuited = [
            (self.output.json.is_some(), "--json: a sequence is a picture; bench has a record"),
            (self.output.csv.is_some(), "--csv: a sequence is a picture; bench has rows"),
            (!self.moments.is_sorted_by(|a, b| a < b), "--moments: the frames must rise"),
        ];
        refuse(&self.measure, &self.output, &unsuited)?;
        publication.check()?;
        let setup: Setup = self.scene.resolve(self.measure.process)?;
        setup.check().map_err(Failure::from)?;
        let mut machine = Machine::open(&self.machine.resolve(), &NEEDS)?;
        outcome::say_device(&self.output, &machine);
        let pictures = strips::draw(&mut machine, &setup, self.variant, &self.moments)?;
        machine.check_validation()?;
        publication
            .picture(&format!("-{}.png", crate::papers::Variant::word(self.variant)), &strips::side_by_side(&pictures)?)
    }
}

//! `experiment NAME`: one figure of the dissertation.

use clap::{Args, ValueEnum};

use super::BurningArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::paper::{PaperArgs, variant_word};
use crate::experiment::burning::{Setup, strips};
use crate::papers::burning::Variant;

/// The figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Pictures of one object at several moments, side by side
    Sequence,
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
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
    common: CommonArgs,
}

impl ExperimentArgs for Experiments {
    type Study = Setup;
    type Name = Name;

    const FRAMES: u32 = 3;
    const REPEAT: u32 = 3;

    fn asked(&self) -> &NameArgs<Name> {
        &self.asked
    }

    fn common(&self) -> &CommonArgs {
        &self.common
    }

    fn unsuited(&self, _: Name) -> Vec<(bool, &'static str)> {
        let output = &self.common.output;
        vec![
            (output.json.is_some(), "--json: a sequence is a picture; bench has a record"),
            (output.csv.is_some(), "--csv: a sequence is a picture; bench has rows"),
            (!self.moments.is_sorted_by(|a, b| a < b), "--moments: the frames must rise"),
        ]
    }

    fn perform(&self, _: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        let setup: Setup = self.scene.resolve(self.common.measure.process)?;
        setup.check().map_err(Failure::from)?;
        let mut machine = self.open()?;
        let pictures = strips::draw(&mut machine, &setup, self.variant, &self.moments)?;
        machine.check_validation()?;
        publication
            .picture(&format!("-{}.png", crate::papers::Variant::word(self.variant)), &strips::side_by_side(&pictures)?)
    }
}

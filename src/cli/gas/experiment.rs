//! `experiment NAME`: the paper's tables, its sequences, and what table size and steps buy.

use clap::{Args, ValueEnum};
use serde_json::json;

use super::GasArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::outcome;
use crate::image::contact_sheet::{below_each_other, side_by_side};
use crate::measure::Error;
use crate::measure::bench::{build, load};
use crate::measure::picture;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::Point;
use crate::papers::gas::Variant;
use crate::papers::gas::experiments::tables::{Number, Outcome, Trade};
use crate::papers::gas::model::DensityFunction;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::setup::Setup;

/// The tables and figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Table 1: times of figures 3 to 7, with and without the volume
    #[value(name = "1")]
    Table1,
    /// Table 2: times of figure 8 by shadowing
    #[value(name = "2")]
    Table2,
    /// Shadow table of 16 to 128 entries a side: cost against the difference from tracing
    TableSize,
    /// Steps along a volume: cost against the difference from the most
    Steps,
    /// The share of turbulence in the volume's time
    Noise,
    /// The picture strips of figures 6 and 7
    Sequence,
}

/// Of the six pictures of figure 6 and the nine of figure 7.
const PICTURES_A_ROW: usize = 3;

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
    /// Table sizes or steps of a sweep, comma-separated [default: 16,32,64,96,128, or 10,20,40,80,160]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    #[command(flatten)]
    scene: GasArgs,
    #[command(flatten)]
    common: CommonArgs,
}

impl ExperimentArgs for Experiments {
    type Study = Setup;
    type Name = Name;

    const FRAMES: u32 = 1;
    const REPEAT: u32 = 5;

    fn asked(&self) -> &NameArgs<Name> {
        &self.asked
    }

    fn common(&self) -> &CommonArgs {
        &self.common
    }

    fn unsuited(&self, name: Name) -> Vec<(bool, &'static str)> {
        let has_counts = matches!(name, Name::TableSize | Name::Steps);
        let has_scenes = matches!(name, Name::Table1 | Name::Table2 | Name::Sequence);
        let is_pictures = name == Name::Sequence;
        let output = &self.common.output;
        vec![
            (!has_counts && !self.counts.is_empty(), "--counts: this experiment has none"),
            (has_scenes && self.scene.names_scene(), "--preset: this experiment has its own scenes"),
            (
                name == Name::TableSize && self.scene.table.is_some(),
                "--table: this experiment sweeps it; give --counts",
            ),
            (name == Name::Steps && self.scene.steps.is_some(), "--steps: this experiment sweeps them; give --counts"),
            (name == Name::Noise && self.scene.volumes.names_density(), "--density: this experiment compares two"),
            (is_pictures && self.scene.first_frame.is_some(), "--first-frame: the strips have the paper's frames"),
            (is_pictures && output.json.is_some(), "--json: a strip is pictures; `1` has a record"),
            (is_pictures && output.csv.is_some(), "--csv: a strip is pictures; `1` has rows"),
        ]
    }

    fn perform(&self, name: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        match name {
            Name::Table1 => self.table(publication, Number::One),
            Name::Table2 => self.table(publication, Number::Two),
            Name::TableSize => self.trade(publication, Trade::TableSize, Variant::Table),
            Name::Steps => self.trade(publication, Trade::Steps, Variant::None),
            Name::Noise => self.noise(publication),
            Name::Sequence => self.sequence(publication),
        }
    }
}

impl Experiments {
    fn table(&self, publication: &Publication<'_>, number: Number) -> Result<(), Failure> {
        let points = number.points(&|setup| self.scene.over(setup));
        self.scene.check(points.iter().map(|point| &point.study))?;
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = self.open()?;
        let swept = self.sweep(publication, &mut machine, &points)?;
        let outcome = Outcome::new(number, swept.rows);
        let (table, plots) = (outcome.render(outcome::style()), [(".svg".to_owned(), outcome.plot()?)]);
        publication.runs(&machine, outcome.into_runs(), table, &plots)?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    fn trade(&self, publication: &Publication<'_>, trade: Trade, variant: Variant) -> Result<(), Failure> {
        let setup = self.scene.over(Setup::of(self.scene.scene()));
        self.scene.check([&setup])?;
        let counts = if self.counts.is_empty() { trade.counts() } else { self.counts.clone() };
        let points = trade.points(&setup, &counts, variant);
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = self.open()?;
        let swept = self.sweep(publication, &mut machine, &points)?;
        let facts = trade.table(&mut machine, &setup, &swept.rows, variant)?;
        publication.save(&publication.file(".svg"), trade.plot(&swept.rows)?.as_bytes())?;
        publication.facts(&machine, &facts)?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    /// The volume's time with the scene's density function, and with a constant in its place: what is left is turbulence.
    fn noise(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setup = self.scene.over(Setup::of(self.scene.scene()));
        self.scene.check([&setup])?;
        let mut constant = setup.clone();
        for volume in &mut constant.parameters.volumes {
            volume.texture.function = DensityFunction::Constant;
        }
        let point = |label: &str, study| Point {
            label: label.to_owned(),
            x: 0.0,
            study,
            variants: vec![Variant::None],
            left_out: Vec::new(),
        };
        let points = [point("turbulent", setup), point("constant", constant)];
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = self.open()?;
        let swept = self.sweep(publication, &mut machine, &points)?;
        let volume_ms = |label: &str| {
            let row = swept.rows.iter().find(|row| row.label == label)?;
            row.run.passes.iter().find(|p| p.name == "volume")?.gpu_ms.as_ref().map(|s| s.median)
        };
        let (turbulent, constant) = (volume_ms("turbulent"), volume_ms("constant"));
        let share = turbulent.zip(constant).map(|(t, c)| (t - c) / t);
        let facts = ResultTable {
            title: "The share of turbulence in the volume's time",
            columns: &["turbulent ms", "constant ms", "share", "paper"],
            rows: vec![vec![json!(turbulent), json!(constant), json!(share), json!(0.65)]],
        };
        publication.facts(&machine, &facts)?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    fn sequence(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setups = [Preset::Fig6, Preset::Fig7].map(|scene| self.scene.over(Setup::of(scene)));
        self.scene.check(&setups)?;
        let mut machine = self.open()?;
        for mut setup in setups {
            let scene = setup.scene;
            let surfaces = setup.load()?;
            let mut pictures = Vec::new();
            for frame in scene.frames() {
                setup.parameters.first_frame = frame;
                let mut built = build(&machine, &setup, &surfaces, scene.variant())?;
                let drawn = picture::render(&mut machine, &mut built.paper, 0)?;
                publication.picture(&format!("-{}-{frame:04}.png", scene.as_str()), &drawn)?;
                pictures.push(drawn);
            }
            let rows = pictures.chunks(PICTURES_A_ROW).map(side_by_side).collect::<Result<Vec<_>, _>>();
            let strip = rows.and_then(|rows| below_each_other(&rows)).map_err(Error::from)?;
            publication.picture(&format!("-{}.png", scene.as_str()), &strip)?;
        }
        machine.check_validation()?;
        Ok(())
    }
}

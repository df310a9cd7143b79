//! `experiment NAME`: the paper's table, its figures, and what its conclusion claims.

use clap::{Args, ValueEnum};

use super::TerrainArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::outcome;
use crate::cli::paper::{PaperArgs, VariantWord, resolve, variant_words};
use crate::measure::study::Study;
use crate::measure::sweep::Point;
use crate::papers::terrain::experiments::table::{self, Axis, Outcome};
use crate::papers::terrain::{Variant, View};
use crate::papers::terrain::{experiments::figures, setup::Setup};

/// The figures and tables that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Table 1: time by samples a side of the map, all variants
    #[value(name = "1")]
    Table1,
    /// Figure 1: the volcano from above
    #[value(name = "figure-1")]
    Figure1,
    /// Figure 2: the volcano from the side
    #[value(name = "figure-2")]
    Figure2,
    /// Section 5's claim: time by the screen's size
    Screen,
    /// Steps of each ray by samples a side of the map; a heat map of each
    Steps,
    /// Bilinear and bicubic interpolation at both levels of detail: time, and the pictures
    Interpolation,
}

impl Name {
    /// What it sweeps; nothing for a figure.
    fn axis(self) -> Option<Axis> {
        match self {
            Name::Table1 | Name::Steps => Some(Axis::Map),
            Name::Screen => Some(Axis::Screen),
            Name::Interpolation => Some(Axis::Interpolation),
            Name::Figure1 | Name::Figure2 => None,
        }
    }
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
    /// Samples a side in table 1, or widths of the screen in pixels, comma-separated
    /// [default: 128,256,512,1024,2048,4096,8192,16384, or 200,400,800,1200,1600]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    /// Variants of a sweep, comma-separated, or all; a figure shows the first
    #[arg(long, value_delimiter = ',', default_value = "all", value_parser = variant_words::<Variant>())]
    variant: Vec<VariantWord<Variant>>,
    #[command(flatten)]
    scene: TerrainArgs,
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

    fn unsuited(&self, name: Name) -> Vec<(bool, &'static str)> {
        let axis = name.axis();
        let has_counts = matches!(axis, Some(Axis::Map | Axis::Screen));
        let is_table = axis == Some(Axis::Map);
        let (scene, output) = (&self.scene, &self.common.output);
        vec![
            (!has_counts && !self.counts.is_empty(), "--counts: this experiment has none"),
            (is_table && scene.names_maps(), "--map: table 1 takes the synthetic volcano, which has any size"),
            (is_table && scene.names_resolution(), "--resolution: table 1 sweeps it; give --counts"),
            (axis == Some(Axis::Screen) && scene.names_size(), "--size: this experiment sweeps it; give --counts"),
            (axis.is_none() && output.json.is_some(), "--json: a figure is a picture; `1` has a record"),
            (axis.is_none() && output.csv.is_some(), "--csv: a figure is a picture; `1` has rows"),
        ]
    }

    fn perform(&self, name: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        let mut setup = self.scene.resolve()?;
        setup.preset = Some(publication.name.clone());
        let variants = resolve(&self.variant);
        match name.axis() {
            None => self.draw(publication, name, setup, &variants),
            // Every variant takes the same steps; the paper's second application stands for all.
            Some(axis) if name == Name::Steps => {
                let points = self.tabulate(publication, axis, &setup, &[Variant::GpuCompute])?;
                self.heat_maps(publication, &points)
            }
            Some(axis) => self.tabulate(publication, axis, &setup, &variants).map(drop),
        }
    }
}

impl Experiments {
    fn draw(
        &self,
        publication: &Publication<'_>,
        name: Name,
        mut setup: Setup,
        variants: &[Variant],
    ) -> Result<(), Failure> {
        if !self.scene.names_resolution() {
            setup.resolution = figures::SIDE;
        }
        if !self.scene.names_camera() {
            setup.parameters.view = if name == Name::Figure1 { View::Top } else { View::Side };
        }
        // All variants show one surface; of all, the paper's second application stands for them.
        let variant = match variants {
            [only] => *only,
            _ => Variant::GpuCompute,
        };
        setup.load()?;
        let mut machine = self.open()?;
        let picture = figures::draw(&mut machine, &setup, variant)?;
        machine.check_validation()?;
        if !self.common.output.quiet && !self.scene.names_maps() {
            outcome::say(&format!(
                "{}: the synthetic volcano stands for Bandai; --map names another",
                publication.name
            ));
        }
        publication.picture(".png", &picture)
    }

    /// Measures and publishes a sweep along the axis.
    fn tabulate(
        &self,
        publication: &Publication<'_>,
        axis: Axis,
        setup: &Setup,
        variants: &[Variant],
    ) -> Result<Vec<Point<Setup>>, Failure> {
        let counts = |default: &[u32]| if self.counts.is_empty() { default.to_vec() } else { self.counts.clone() };
        let points = match axis {
            Axis::Map => table::by_map(setup, &counts(&table::SIDES), variants),
            Axis::Screen => table::by_screen(setup, &counts(&table::WIDTHS), variants),
            Axis::Interpolation => table::by_interpolation(setup, variants),
        };
        check(&points)?;
        let mut machine = self.open()?;
        let swept = self.sweep(publication, &mut machine, &points)?;
        let outcome = Outcome::new(axis, swept.rows);
        let (table, plots) = (outcome.render(outcome::style()), [(".svg".to_owned(), outcome.plot()?)]);
        publication.runs(&machine, outcome.into_runs(), table, &plots)?;
        if axis == Axis::Interpolation {
            for point in &points {
                let picture = figures::draw(&mut machine, &point.study, Variant::GpuCompute)?;
                publication.picture(&format!("-{}.png", point.label.replace(' ', "-")), &picture)?;
            }
        }
        machine.check_validation()?;
        swept.stopped.map_or(Ok(points), |error| Err(error.into()))
    }

    fn heat_maps(&self, publication: &Publication<'_>, points: &[Point<Setup>]) -> Result<(), Failure> {
        let mut machine = self.open()?;
        let (most, pictures) = figures::heat_maps(&mut machine, points.iter().map(|point| &point.study))?;
        for (point, picture) in points.iter().zip(&pictures) {
            publication.picture(&format!("-{}.png", point.label), picture)?;
        }
        if !self.common.output.quiet {
            outcome::say(&format!("heat maps: black is no step, nearly white {most} steps, by logarithm"));
        }
        machine.check_validation()?;
        Ok(())
    }
}

/// Checks what can be checked of every point before the first is measured; a map that is larger than the others is made
/// when its turn comes.
fn check(points: &[Point<Setup>]) -> Result<(), Failure> {
    for point in points {
        point.study.check().map_err(Failure::from)?;
    }
    Ok(())
}

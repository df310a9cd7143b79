//! The paper's tables 1 and 2, ours beside the paper's.

use super::Context;
use crate::measure::bench::load;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::sweep::{Point, Row};
use crate::measure::{Error, Variant as _};
use crate::papers::gas::Variant;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::setup::Setup;
use crate::report::plot::{BarChart, BarSeries};
use crate::report::record::{ExperimentRow, Run};
use crate::report::table::{Align, Style, Table, interval, number};

/// A row of one of the paper's tables: scene, variant, minutes on an HP 9000/370.
type PaperRow = (Preset, Variant, f64);

/// One of the paper's tables.
pub struct PaperTable {
    title: &'static str,
    rows: &'static [PaperRow],
    /// Index of the row that the others are set against.
    base: usize,
}

/// Figure 3 is printed twice, with its volume and without.
pub static TABLE_1: PaperTable = PaperTable {
    title: "Table 1: figures 3 to 7",
    rows: &[
        (Preset::Fig3, Variant::None, 71.0),
        (Preset::Fig3, Variant::NoVolume, 59.0),
        (Preset::Fig4, Variant::NoVolume, 105.0),
        (Preset::Fig5, Variant::Table, 260.0),
        (Preset::Fig6, Variant::Surfaces, 95.0),
        (Preset::Fig7, Variant::Surfaces, 165.0),
    ],
    base: 1,
};

/// It exchanges (c) and (d) against the caption of figure 8; rows are taken by their names.
pub static TABLE_2: PaperTable = PaperTable {
    title: "Table 2: figure 8 by shadowing",
    rows: &[
        (Preset::Fig8, Variant::None, 80.0),
        (Preset::Fig8, Variant::Surfaces, 101.0),
        (Preset::Fig8, Variant::Traced, 1800.0),
        (Preset::Fig8, Variant::Table, 127.0),
    ],
    base: 0,
};

impl PaperTable {
    /// Measures the table and publishes it.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`], [`Error::Scene`], [`Error::Gpu`], [`Error::Plot`], [`Error::Output`].
    pub fn run(&'static self, context: &mut Context<'_>) -> Result<(), Error> {
        let points = self.points(&context.setup)?;
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = context.open()?;
        let swept = context.sweep(&mut machine, &points)?;
        let outcome = Outcome::new(self, swept.rows);
        let (table, plots) = (outcome.render(context.console.style()), [(".svg".to_owned(), outcome.plot()?)]);
        context.publish_runs(&machine, outcome.into_runs(), table, &plots)?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), Err)
    }

    /// One point a scene, its variants interleaved, with what was given over each figure's numbers.
    fn points(&self, given: &Setup) -> Result<Vec<Point<Setup>>, Error> {
        let scenes: Vec<Preset> = self.rows.iter().map(|(scene, ..)| *scene).collect();
        let scenes: Vec<Preset> = scenes.chunk_by(|a, b| a == b).map(|rows| rows[0]).collect();
        let setups = given.in_scenes(&scenes)?;
        let point = |(index, study): (usize, Setup)| {
            let rows = self.rows.iter().filter(|(scene, ..)| *scene == study.scene);
            Point {
                label: study.scene.as_str().to_owned(),
                x: index as f64,
                variants: rows.map(|(_, variant, _)| *variant).collect(),
                study,
                left_out: Vec::new(),
            }
        };
        Ok(setups.into_iter().enumerate().map(point).collect())
    }

    /// The row of the paper that a measured one reproduces.
    fn minutes(&self, row: &Row) -> Option<f64> {
        self.rows.iter().find(|paper| is_of(row, paper)).map(|(_, _, minutes)| *minutes)
    }

    fn base(&self) -> &PaperRow {
        &self.rows[self.base]
    }
}

/// Tests a measured row against one of the paper's.
fn is_of(row: &Row, (scene, variant, _): &PaperRow) -> bool {
    row.label == scene.as_str() && row.run.variant == variant.as_str()
}

/// A table's rows with what they are compared with.
struct Outcome {
    paper: &'static PaperTable,
    rows: Vec<Row>,
}

impl Outcome {
    /// Notes the ratio to the base row in every run's record, beside the paper's.
    fn new(paper: &'static PaperTable, rows: Vec<Row>) -> Self {
        let mut outcome = Outcome { paper, rows };
        for index in 0..outcome.rows.len() {
            let row = &outcome.rows[index];
            let (ratio, paper) = (outcome.ratio(row).map(|r| r.ratio), outcome.paper_ratio(row));
            let entry = ExperimentRow {
                row: format!("{} {}", row.label, row.run.variant),
                paper,
                ours: ratio,
                ratio: ratio.zip(paper).map(|(ours, paper)| ours / paper),
            };
            outcome.rows[index].run.experiment = Some(entry);
        }
        outcome
    }

    /// Time over that of the base row. Rows of one scene were measured interleaved; those of another scene one after
    /// the other.
    fn ratio(&self, row: &Row) -> Option<Ratio> {
        let base = self.rows.iter().find(|row| is_of(row, self.paper.base()))?;
        ratio_within_process(base.run.frame_samples(), row.run.frame_samples())
    }

    fn paper_ratio(&self, row: &Row) -> Option<f64> {
        Some(self.paper.minutes(row)? / self.paper.base().2)
    }

    /// The runs, for the record.
    fn into_runs(self) -> Vec<Run> {
        self.rows.into_iter().map(|row| row.run).collect()
    }

    /// The table, ours beside the paper's.
    fn render(&self, style: Style) -> String {
        let mut table = Table::new(&[
            ("scene", Align::Left),
            ("variant", Align::Left),
            ("size", Align::Right),
            ("frame ms", Align::Right),
            ("ratio", Align::Right),
            ("95 % interval", Align::Left),
            ("paper min", Align::Right),
            ("paper ratio", Align::Right),
            ("ours / paper", Align::Right),
        ]);
        for row in &self.rows {
            let (ratio, paper) = (self.ratio(row), self.paper_ratio(row));
            table.push(vec![
                row.label.clone(),
                row.run.variant.clone(),
                format!("{}x{}", row.run.width, row.run.height),
                number(row.run.median_frame_ms(), 1),
                number(ratio.as_ref().map(|r| r.ratio), 3),
                interval(ratio.as_ref().map(|r| r.interval)),
                number(self.paper.minutes(row), 0),
                number(paper, 3),
                number(ratio.as_ref().zip(paper).map(|(r, p)| r.ratio / p), 2),
            ]);
        }
        let (scene, variant, _) = self.paper.base();
        let base = format!("ratio: frame time over that of {} {}\n", scene.as_str(), variant.as_str());
        format!("{}\n{}{base}", style.bold(self.paper.title), table.render(style))
    }

    /// Ratios to the base row, ours beside the paper's.
    ///
    /// # Errors
    /// [`Error::Plot`].
    fn plot(&self) -> Result<String, Error> {
        let chart = BarChart {
            title: self.paper.title.to_owned(),
            y_label: "time over the base row's".to_owned(),
            groups: self.rows.iter().map(|row| format!("{} {}", row.label, row.run.variant)).collect(),
            series: vec![
                BarSeries {
                    name: "ours".to_owned(),
                    values: self.rows.iter().map(|row| self.ratio(row).map(|r| r.ratio)).collect(),
                },
                BarSeries {
                    name: "paper".to_owned(),
                    values: self.rows.iter().map(|row| self.paper_ratio(row)).collect(),
                },
            ],
        };
        Ok(chart.to_svg()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_s_variants_are_interleaved() {
        let points = TABLE_1.points(&Setup::default()).unwrap();
        let labels: Vec<&str> = points.iter().map(|point| point.label.as_str()).collect();
        assert_eq!(labels, ["fig-3", "fig-4", "fig-5", "fig-6", "fig-7"]);
        assert_eq!(points[0].variants, [Variant::None, Variant::NoVolume]);
        assert_eq!(TABLE_2.points(&Setup::default()).unwrap()[0].variants.len(), 4);
    }
}

//! The paper's tables 1 and 2, ours beside the paper's.

use super::{Context, samples};
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::sweep::{Point, Row};
use crate::measure::{Error, Variant as _};
use crate::papers::gas::Variant;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::setup::Setup;
use crate::report::plot::{BarChart, BarSeries, PlotError};
use crate::report::record::ExperimentRow;
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
    pub fn run(&self, context: &mut Context<'_>) -> Result<(), Error> {
        let points = self.points(&context.setup)?;
        let (machine, swept) = context.sweep_loaded(&points)?;
        let rows = self.compared(swept.rows);
        let (table, plots) = (self.render(&rows, context.console.style()), [(".svg".to_owned(), self.plot(&rows)?)]);
        context.publish_runs(
            &machine,
            rows.into_iter().map(|compared| compared.row.run).collect(),
            table,
            &plots,
            &[],
        )?;
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
}

/// Tests a measured row against one of the paper's.
fn is_of(row: &Row, (scene, variant, _): &PaperRow) -> bool {
    row.label == scene.as_str() && row.run.variant == variant.as_str()
}

/// A measured row with what it is compared with.
struct Compared {
    row: Row,
    /// Time over that of the base row. It has an interval where both were measured in turn: between other variants of the
    /// base's scene. Scenes were measured one after the other, and drift is no noise of frames.
    ratio: Option<Ratio>,
    minutes: Option<f64>,
    paper_ratio: Option<f64>,
}

impl Compared {
    fn name(&self) -> String {
        format!("{} {}", self.row.label, self.row.run.variant)
    }

    fn ours(&self) -> Option<f64> {
        self.ratio.as_ref().map(|ratio| ratio.ratio)
    }

    /// Ours over the paper's.
    fn ours_over_paper(&self) -> Option<f64> {
        self.ours().zip(self.paper_ratio).map(|(ours, paper)| ours / paper)
    }
}

impl PaperTable {
    /// Notes the ratio to the base row in every run's record, beside the paper's.
    fn compared(&self, rows: Vec<Row>) -> Vec<Compared> {
        let base = &self.rows[self.base];
        let samples = rows.iter().find(|row| is_of(row, base)).map(|row| row.run.frame_samples().to_vec());
        let compared = |row: Row| {
            let ratio = samples.as_ref().and_then(|base| ratio_within_process(base, row.run.frame_samples()));
            let is_in_turn = row.label == base.0.as_str() && !is_of(&row, base);
            let ratio = ratio.map(|ratio| Ratio { interval: ratio.interval.filter(|_| is_in_turn), ..ratio });
            let minutes = self.rows.iter().find(|paper| is_of(&row, paper)).map(|(_, _, minutes)| *minutes);
            let mut compared = Compared { ratio, minutes, paper_ratio: minutes.map(|m| m / base.2), row };
            compared.row.run.experiment = Some(ExperimentRow {
                row: compared.name(),
                paper: compared.paper_ratio,
                ours: compared.ours(),
                interval: compared.ratio.and_then(|ratio| ratio.interval),
                ratio: compared.ours_over_paper(),
            });
            compared
        };
        rows.into_iter().map(compared).collect()
    }

    /// The table, ours beside the paper's.
    fn render(&self, rows: &[Compared], style: Style) -> String {
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
            ("samples", Align::Right),
        ]);
        for compared in rows {
            let Row { label, run, .. } = &compared.row;
            table.push(vec![
                label.clone(),
                run.variant.clone(),
                format!("{}x{}", run.width, run.height),
                number(run.median_frame_ms(), 1),
                number(compared.ours(), 3),
                interval(compared.ratio.and_then(|ratio| ratio.interval)),
                number(compared.minutes, 0),
                number(compared.paper_ratio, 3),
                number(compared.ours_over_paper(), 2),
                samples(&compared.row).as_u64().map_or_else(String::new, |count| count.to_string()),
            ]);
        }
        let (scene, variant, _) = &self.rows[self.base];
        let base = format!(
            "ratio: frame time over that of {} {}; an interval where both were measured in turn\n",
            scene.as_str(),
            variant.as_str()
        );
        format!("{}\n{}{base}", style.bold(self.title), table.render(style))
    }

    /// Ratios to the base row, ours beside the paper's.
    fn plot(&self, rows: &[Compared]) -> Result<String, PlotError> {
        let bars = |name: &str, values: fn(&Compared) -> Option<f64>| BarSeries {
            name: name.to_owned(),
            values: rows.iter().map(values).collect(),
        };
        let chart = BarChart {
            title: self.title.to_owned(),
            y_label: "time over the base row's".to_owned(),
            groups: rows.iter().map(Compared::name).collect(),
            series: vec![bars("ours", Compared::ours), bars("paper", |compared| compared.paper_ratio)],
        };
        chart.to_svg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::record::Run;

    #[test]
    fn a_scene_s_variants_are_interleaved() {
        let points = TABLE_1.points(&Setup::default()).unwrap();
        let labels: Vec<&str> = points.iter().map(|point| point.label.as_str()).collect();
        assert_eq!(labels, ["fig-3", "fig-4", "fig-5", "fig-6", "fig-7"]);
        assert_eq!(points[0].variants, [Variant::None, Variant::NoVolume]);
        assert_eq!(TABLE_2.points(&Setup::default()).unwrap()[0].variants.len(), 4);
    }

    #[test]
    fn an_interval_is_of_rows_that_were_measured_in_turn() {
        let row = |scene: &Preset, variant: &Variant| {
            let frame_ms = summarize(&[1.0, 1.1, 0.9, 1.05, 0.95]);
            let run = Run { variant: variant.as_str().to_owned(), frame_ms, ..example::run() };
            Row { label: scene.as_str().to_owned(), x: 0.0, run }
        };
        let rows = |table: &PaperTable| table.rows.iter().map(|(scene, variant, _)| row(scene, variant)).collect();
        let with_interval = |table: &PaperTable| -> Vec<String> {
            let compared = table.compared(rows(table));
            for one in &compared {
                let row = one.row.run.experiment.as_ref().unwrap();
                assert_eq!((row.ours, row.interval), (Some(1.0), one.ratio.unwrap().interval), "{}", row.row);
            }
            let has_interval = compared.iter().filter(|one| one.ratio.unwrap().interval.is_some());
            has_interval.map(Compared::name).collect()
        };
        assert_eq!(with_interval(&TABLE_1), ["fig-3 none"]);
        assert_eq!(with_interval(&TABLE_2), ["fig-8 surfaces", "fig-8 traced", "fig-8 table"]);
    }
}

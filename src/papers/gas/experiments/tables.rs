//! The paper's tables 1 and 2, ours beside the paper's, and how cost and picture follow table size and steps.

use glam::Vec3;
use serde_json::json;

use super::super::setup::Setup;
use crate::image::{Rgba8, compare};
use crate::measure::Error;
use crate::measure::Variant as _;
use crate::measure::bench::build;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::{Point, Row};
use crate::papers::gas::Variant;
use crate::papers::gas::scenes::Preset;
use crate::report::plot::{BarChart, BarSeries, LineChart, Scale, Series};
use crate::report::record::{ExperimentRow, Run};
use crate::report::table::{Align, Style, Table, interval, number};
use crate::scene::Light;

/// A row of one of the paper's tables: scene, variant, minutes on an HP 9000/370.
type PaperRow = (Preset, Variant, f64);

/// Table 1. Figure 3 is printed twice, with its volume and without.
const TABLE_1: [PaperRow; 6] = [
    (Preset::Fig3, Variant::None, 71.0),
    (Preset::Fig3, Variant::NoVolume, 59.0),
    (Preset::Fig4, Variant::NoVolume, 105.0),
    (Preset::Fig5, Variant::Table, 260.0),
    (Preset::Fig6, Variant::Surfaces, 95.0),
    (Preset::Fig7, Variant::Surfaces, 165.0),
];

/// Table 2. It exchanges (c) and (d) against the caption of figure 8; rows are taken by their words.
const TABLE_2: [PaperRow; 4] = [
    (Preset::Fig8, Variant::None, 80.0),
    (Preset::Fig8, Variant::Surfaces, 101.0),
    (Preset::Fig8, Variant::Traced, 1800.0),
    (Preset::Fig8, Variant::Table, 127.0),
];

/// One of the two tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    One,
    Two,
}

impl Number {
    fn rows(self) -> &'static [PaperRow] {
        match self {
            Number::One => &TABLE_1,
            Number::Two => &TABLE_2,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Number::One => "Table 1: figures 3 to 7",
            Number::Two => "Table 2: figure 8 by shadowing",
        }
    }

    /// The row that the others are set against.
    fn base(self) -> PaperRow {
        match self {
            Number::One => TABLE_1[1],
            Number::Two => TABLE_2[0],
        }
    }

    /// One point a scene, its variants interleaved; `change` goes over each figure's numbers.
    pub fn points(self, change: &dyn Fn(Setup) -> Setup) -> Vec<Point<Setup>> {
        let mut points: Vec<Point<Setup>> = Vec::new();
        for &(scene, variant, _) in self.rows() {
            match points.iter_mut().find(|point| point.label == scene.as_str()) {
                Some(point) => point.variants.push(variant),
                None => points.push(Point {
                    label: scene.as_str().to_owned(),
                    x: points.len() as f64,
                    study: change(Setup::of(scene)),
                    variants: vec![variant],
                    left_out: Vec::new(),
                }),
            }
        }
        points
    }

    fn minutes(self, row: &Row) -> Option<f64> {
        let found =
            |(scene, variant, _): &&PaperRow| row.label == scene.as_str() && row.run.variant == variant.as_str();
        self.rows().iter().find(found).map(|(_, _, minutes)| *minutes)
    }
}

/// A linear brightness of 1 % as the picture holds it.
const ONE_PERCENT_SRGB: u8 = 25;

/// A table's rows with what they are compared with.
pub struct Outcome {
    number: Number,
    rows: Vec<Row>,
}

impl Outcome {
    /// Notes the ratio to the base row in every run's record, beside the paper's.
    pub fn new(number: Number, rows: Vec<Row>) -> Self {
        let mut outcome = Outcome { number, rows };
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

    /// Time over that of the base row. Rows of one scene were measured in turn; those of another scene one after the other.
    fn ratio(&self, row: &Row) -> Option<Ratio> {
        let (scene, variant, _) = self.number.base();
        let base = self.rows.iter().find(|r| r.label == scene.as_str() && r.run.variant == variant.as_str())?;
        ratio_within_process(base.run.frame_samples(), row.run.frame_samples())
    }

    fn paper_ratio(&self, row: &Row) -> Option<f64> {
        Some(self.number.minutes(row)? / self.number.base().2)
    }

    /// The runs, for the record.
    pub fn into_runs(self) -> Vec<Run> {
        self.rows.into_iter().map(|row| row.run).collect()
    }

    /// The table, ours beside the paper's.
    pub fn render(&self, style: Style) -> String {
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
                number(self.number.minutes(row), 0),
                number(paper, 3),
                number(ratio.as_ref().zip(paper).map(|(r, p)| r.ratio / p), 2),
            ]);
        }
        let (scene, variant, _) = self.number.base();
        let base = format!("ratio: frame time over that of {} {}\n", scene.as_str(), variant.as_str());
        format!("{}\n{}{base}", style.bold(self.number.title()), table.render(style))
    }

    /// Ratios to the base row, ours beside the paper's.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plot(&self) -> Result<String, Error> {
        let chart = BarChart {
            title: self.number.title().to_owned(),
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

/// What is traded against the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trade {
    /// Entries a side of the shadow table, against tracing.
    TableSize,
    /// Steps along the longest side, against the most.
    Steps,
}

impl Trade {
    /// What is swept without counts named.
    pub fn counts(self) -> Vec<u32> {
        match self {
            Trade::TableSize => vec![16, 32, 64, 96, 128],
            Trade::Steps => vec![10, 20, 40, 80, 160],
        }
    }

    fn as_str(self) -> &'static str {
        match self {
            Trade::TableSize => "entries a side",
            Trade::Steps => "steps",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Trade::TableSize => "Shadow table: cost and Luv difference from tracing, by entries a side",
            Trade::Steps => "Volume: cost and Luv difference from the most steps, by steps",
        }
    }

    fn set(self, setup: &mut Setup, count: u32) {
        match self {
            Trade::TableSize => setup.parameters.table_size = count,
            Trade::Steps => setup.parameters.steps = count,
        }
    }

    /// One point a count.
    pub fn points(self, setup: &Setup, counts: &[u32], variant: Variant) -> Vec<Point<Setup>> {
        let point = |&count: &u32| {
            let mut study = setup.clone();
            self.set(&mut study, count);
            Point {
                label: count.to_string(),
                x: f64::from(count),
                study,
                variants: vec![variant],
                left_out: Vec::new(),
            }
        };
        counts.iter().map(point).collect()
    }

    /// The rows' times beside the Luv difference (eq. 2-9 of the caustics thesis) of their pictures from the reference, over
    /// the pixels in which the gas is denser than 1 % opacity.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Image`].
    pub fn table(
        self,
        machine: &mut Machine,
        setup: &Setup,
        rows: &[Row],
        variant: Variant,
    ) -> Result<ResultTable, Error> {
        let counts: Vec<u32> = rows.iter().map(|row| row.x as u32).collect();
        let draw = |machine: &mut Machine, variant, count: Option<u32>| -> Result<Rgba8, Error> {
            let mut study = setup.clone();
            count.into_iter().for_each(|count| self.set(&mut study, count));
            let scene = study.load()?;
            let mut built = build(machine, &study, &scene, variant)?;
            picture::render(machine, &mut built.paper, 0)
        };
        let reference = match self {
            Trade::TableSize => draw(machine, Variant::Traced, None)?,
            Trade::Steps => draw(machine, variant, counts.iter().max().copied())?,
        };
        let mask = gas_mask(machine, setup)?;
        let mut table = Vec::new();
        for (row, &count) in rows.iter().zip(&counts) {
            let difference = compare(&draw(machine, variant, Some(count))?, &reference, Some(&mask))?;
            let passes = |names: &[&str]| -> f64 {
                let of = row.run.passes.iter().filter(|p| names.contains(&p.name.as_str()));
                of.filter_map(|p| p.gpu_ms.as_ref().map(|s| s.median)).sum()
            };
            table.push(vec![
                json!(count),
                json!(row.run.median_frame_ms()),
                json!(passes(&["density-table", "shadow-table"])),
                json!(passes(&["volume"])),
                json!(difference.mean),
                json!(difference.p99),
                json!(difference.pixels),
            ]);
        }
        Ok(ResultTable {
            title: self.title(),
            columns: &["count", "frame ms", "tables ms", "volume ms", "Luv mean", "Luv p99", "pixels"],
            rows: table,
        })
    }

    /// Frame time by count.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plot(self, rows: &[Row]) -> Result<String, Error> {
        let points = rows.iter().filter_map(|row| Some((row.x, row.run.median_frame_ms()?))).collect();
        let chart = LineChart {
            title: self.title().to_owned(),
            x_label: self.as_str().to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: Scale::Log,
            y_scale: Scale::Log,
            series: vec![Series { name: "frame".to_owned(), points, reference: false }],
        };
        Ok(chart.to_svg()?)
    }
}

/// The pixels in which the gas that is seen has an opacity of more than 1 %: it shines with it, between black surfaces.
fn gas_mask(machine: &mut Machine, setup: &Setup) -> Result<Vec<bool>, Error> {
    let mut study = setup.clone();
    let parameters = &mut study.parameters;
    parameters.volumes.iter_mut().for_each(|volume| volume.albedo = Vec3::ONE);
    parameters.lights = vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }];
    (parameters.ambient, parameters.background) = (Vec3::ONE, Vec3::ZERO);
    let mut scene = study.load()?;
    for object in &mut scene.objects {
        (object.color, object.checker, object.highlight.strength) = (Vec3::ZERO, None, 0.0);
    }
    let mut built = build(machine, &study, &scene, Variant::None)?;
    let opacity = picture::render(machine, &mut built.paper, 0)?;
    Ok(opacity.pixels().chunks_exact(4).map(|texel| texel[0] > ONE_PERCENT_SRGB).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_s_variants_are_measured_in_turn() {
        let points = Number::One.points(&|setup| setup);
        let labels: Vec<&str> = points.iter().map(|point| point.label.as_str()).collect();
        assert_eq!(labels, ["fig-3", "fig-4", "fig-5", "fig-6", "fig-7"]);
        assert_eq!(points[0].variants, [Variant::None, Variant::NoVolume]);
        assert_eq!(Number::Two.points(&|setup| setup)[0].variants.len(), 4);
    }
}

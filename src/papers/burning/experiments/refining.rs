//! Table 4.2: refining where it burns against subdividing everything beforehand, from ignition until half of the coarse
//! triangles are refined.

use serde_json::json;

use super::super::setup::Setup;
use super::presets;
use super::timeline::Snapshot;
use crate::measure::Error;
use crate::measure::Variant as _;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::burning::Variant;
use crate::report::plot::{LineChart, Scale, Series};
use crate::report::record::ExperimentRow;
use crate::report::table::{Align, Style, Table, interval, number};

/// A row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Triangles of the box.
    pub coarse: u32,
    /// The dissertation's speed-up.
    speed_up: f64,
}

/// Table 4.2; its counts are 4^5 times those of its boxes.
pub const TABLE: [Line; 4] = [
    Line { coarse: 12, speed_up: 1.96 },
    Line { coarse: 16, speed_up: 2.09 },
    Line { coarse: 20, speed_up: 2.43 },
    Line { coarse: 48, speed_up: 1.25 },
];

/// The loads that each box is measured under.
const LOADS: [&str; 2] = ["without particles", "with particles"];

impl Line {
    /// The box, drawn at its finest by both methods.
    pub fn setup(&self) -> Setup {
        let mut setup = presets::BOX.setup();
        setup.triangles = Some(self.coarse);
        setup.parameters.level_of_detail = Some(5);
        setup
    }

    /// Without particles and with them, the two methods interleaved.
    pub fn points(&self, setup: &Setup) -> Vec<Point<Setup>> {
        let point = |load: &str| {
            let mut study = setup.clone();
            if load == LOADS[0] {
                (study.parameters.fire, study.parameters.smoke) = (0, 0);
            }
            Point {
                label: format!("{} coarse triangles {load}", self.coarse),
                x: f64::from(self.coarse),
                study,
                variants: vec![Variant::LowPoly, Variant::FullySubdivided],
                left_out: Vec::new(),
            }
        };
        LOADS.map(point).into()
    }
}

/// True once half of the coarse triangles are refined.
pub fn is_half_refined(snapshot: &Snapshot) -> bool {
    2 * snapshot.refined.unwrap_or(0) >= snapshot.coarse
}

/// One box, measured.
pub struct Measured {
    line: Line,
    /// A snapshot of each frame that was measured.
    snapshots: Vec<Snapshot>,
    rows: Vec<Row>,
}

/// Frame times of the two methods, of the same frames.
struct Pair<'a> {
    adaptive: &'a [f64],
    subdivided: &'a [f64],
}

impl Pair<'_> {
    /// Time of the subdivided object over that of the refined one. Sums over every tenth frame are its samples: each
    /// spans the whole fire.
    fn speed_up(&self) -> Option<Ratio> {
        let sums = |samples: &[f64]| -> Vec<f64> {
            let parts = samples.len().clamp(1, 10);
            (0..parts).map(|part| samples.iter().skip(part).step_by(parts).sum()).collect()
        };
        ratio_within_process(&sums(self.adaptive), &sums(self.subdivided))
    }

    /// The ratio frame by frame over repetitions.
    fn of_frame(&self, frame: usize, frames: usize) -> Option<f64> {
        let sum = |samples: &[f64]| samples.iter().skip(frame).step_by(frames.max(1)).sum::<f64>();
        let (adaptive, subdivided) = (sum(self.adaptive), sum(self.subdivided));
        (adaptive > 0.0 && subdivided > 0.0).then(|| subdivided / adaptive)
    }
}

fn mean(samples: &[f64]) -> Option<f64> {
    (!samples.is_empty()).then(|| samples.iter().sum::<f64>() / samples.len() as f64)
}

impl Measured {
    /// Notes the speed-up of every pair in its record, beside the dissertation's.
    pub fn new(line: Line, snapshots: Vec<Snapshot>, rows: Vec<Row>) -> Self {
        let mut measured = Measured { line, snapshots, rows };
        for load in LOADS {
            let speed_up = measured.pair(load).and_then(|pair| pair.speed_up());
            let ours = speed_up.as_ref().map(|r| r.ratio);
            let name = format!("{} triangles {load}", measured.finest());
            let row = ExperimentRow::new(name, line.speed_up, ours, speed_up.and_then(|r| r.interval));
            let noted = measured.rows.iter_mut().filter(|r| r.label.ends_with(load));
            noted.for_each(|r| r.run.experiment = Some(row.clone()));
        }
        measured
    }

    fn finest(&self) -> u64 {
        let of = |row: &Row| row.run.results.get("finest_triangles")?.as_u64();
        self.rows.iter().find_map(of).unwrap_or(0)
    }

    fn pair(&self, load: &str) -> Option<Pair<'_>> {
        let of = |variant: Variant| {
            let row = self.rows.iter().find(|r| r.label.ends_with(load) && r.run.variant == variant.as_str())?;
            Some(row.run.frame_samples())
        };
        Some(Pair { adaptive: of(Variant::LowPoly)?, subdivided: of(Variant::FullySubdivided)? })
    }

    /// The measured rows, for the record.
    pub fn into_rows(self) -> Vec<Row> {
        self.rows
    }
}

/// The table, ours beside the dissertation's.
pub fn render(measured: &[Measured], style: Style) -> String {
    let mut table = Table::new(&[
        ("triangles", Align::Right),
        ("coarse", Align::Right),
        ("frames", Align::Right),
        ("load", Align::Left),
        ("subdivided ms", Align::Right),
        ("refined ms", Align::Right),
        ("speed-up", Align::Right),
        ("95 % interval", Align::Left),
        ("dissertation", Align::Right),
    ]);
    for one in measured {
        for load in LOADS {
            let pair = one.pair(load);
            let speed_up = pair.as_ref().and_then(Pair::speed_up);
            table.push(vec![
                one.finest().to_string(),
                one.line.coarse.to_string(),
                one.snapshots.len().to_string(),
                load.to_owned(),
                number(pair.as_ref().and_then(|p| mean(p.subdivided)), 2),
                number(pair.as_ref().and_then(|p| mean(p.adaptive)), 2),
                number(speed_up.as_ref().map(|r| r.ratio), 2),
                interval(speed_up.and_then(|r| r.interval)),
                number(Some(one.line.speed_up), 2),
            ]);
        }
    }
    let note = "mean frame times from ignition until half of the coarse triangles are refined\n";
    format!("{}\n{}{note}", style.bold("Table 4.2: refined where it burns, against subdivided"), table.render(style))
}

/// Time of each pass under both methods: which of them a shortfall comes from.
pub fn passes(measured: &[Measured]) -> ResultTable {
    let mut rows = Vec::new();
    for one in measured {
        for row in &one.rows {
            for pass in &row.run.passes {
                let mean_ms = pass.gpu_ms.as_ref().and_then(|s| mean(&s.samples));
                rows.push(vec![
                    json!(one.finest()),
                    json!(if row.label.ends_with(LOADS[0]) { LOADS[0] } else { LOADS[1] }),
                    json!(row.run.variant),
                    json!(pass.name),
                    json!(mean_ms),
                ]);
            }
        }
    }
    ResultTable {
        title: "Table 4.2: mean time of each pass",
        columns: &["triangles", "load", "variant", "pass", "ms"],
        rows,
    }
}

/// The ratio of every frame without particles over the fraction of coarse triangles that are refined.
pub fn curves(measured: &[Measured]) -> ResultTable {
    let mut rows = Vec::new();
    for one in measured {
        let Some(pair) = one.pair(LOADS[0]) else { continue };
        for (frame, snapshot) in one.snapshots.iter().enumerate() {
            let fraction = snapshot.refined_fraction();
            let ratio = pair.of_frame(frame, one.snapshots.len());
            rows.push(vec![json!(one.finest()), json!(frame), json!(fraction), json!(ratio), json!(one.line.speed_up)]);
        }
    }
    ResultTable {
        title: "Table 4.2: speed-up by the fraction of coarse triangles that are refined",
        columns: &["triangles", "frame", "refined share", "speed-up", "dissertation"],
        rows,
    }
}

/// [`curves`] as lines: for each fraction the mean over its frames, the dissertation's as dashes.
///
/// # Errors
/// [`Error::Plot`].
pub fn plot(measured: &[Measured]) -> Result<String, Error> {
    let mut series = Vec::new();
    for one in measured {
        let Some(pair) = one.pair(LOADS[0]) else { continue };
        let points: Vec<(f64, f64)> = one
            .snapshots
            .chunk_by(|a, b| a.refined == b.refined)
            .scan(0, |next, snapshots| {
                let frames = *next..*next + snapshots.len();
                *next = frames.end;
                let ratios: Vec<f64> = frames.filter_map(|frame| pair.of_frame(frame, one.snapshots.len())).collect();
                Some(mean(&ratios).map(|ratio| (snapshots[0].refined_fraction(), ratio)))
            })
            .flatten()
            .collect();
        let ends =
            points.first().zip(points.last()).map(|(a, b)| vec![(a.0, one.line.speed_up), (b.0, one.line.speed_up)]);
        series.push(Series { name: format!("{} triangles", one.finest()), points, reference: false });
        let name = format!("dissertation {}", one.line.speed_up);
        series.push(Series { name, points: ends.unwrap_or_default(), reference: true });
    }
    let chart = LineChart {
        title: "Refined against subdivided".to_owned(),
        x_label: "fraction of the coarse triangles that are refined".to_owned(),
        y_label: "speed-up".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    };
    Ok(chart.to_svg()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_up_is_that_of_the_whole_fire() {
        let adaptive: Vec<f64> = (0..200).map(|frame| 1.0 + f64::from(frame) / 100.0).collect();
        let subdivided = [4.0; 200];
        let pair = Pair { adaptive: &adaptive, subdivided: &subdivided };
        let of_totals = 4.0 * 200.0 / adaptive.iter().sum::<f64>();
        assert!((pair.speed_up().unwrap().ratio / of_totals - 1.0).abs() < 0.02);
        assert_eq!(pair.of_frame(0, 200), Some(4.0));
        // Two repetitions of a hundred frames.
        assert!((pair.of_frame(0, 100).unwrap() - 8.0 / 3.0).abs() < 1e-12);
        assert!(Pair { adaptive: &[], subdivided: &[] }.speed_up().is_none());
    }

    #[test]
    fn half_is_half() {
        let snapshot = |refined| Snapshot { counts: Default::default(), refined, coarse: 12 };
        assert!(
            !is_half_refined(&snapshot(Some(5)))
                && is_half_refined(&snapshot(Some(6)))
                && !is_half_refined(&snapshot(None))
        );
    }
}

//! The paper's table 1 and what else is swept: time by the size of the map, of the screen, by interpolation; ours beside
//! the paper's.

use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::measure::Error;
use crate::measure::Variant as _;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::experiment::NamedTable;
use crate::measure::parameter::Choice;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::terrain::{Interpolation, Lod, Variant};
use crate::report::plot::{LineChart, Scale, Series};
use crate::report::record::{ExperimentRow, Run};
use crate::report::table::{Align, Style, Table, interval, number};

/// Samples a side that are swept without others named: the paper's three, and on to where a map no longer fits elsewhere.
pub const SIDES: [u32; 8] = [128, 256, 512, 1024, 2048, 4096, 8192, 16_384];
/// Widths of the screen, 4 : 3.
pub const WIDTHS: [u32; 5] = [200, 400, 800, 1200, 1600];
/// The mesh of a larger map has more indices than a reasonable buffer holds.
const MESH_SIDE: u32 = 4096;

/// Table 1, milliseconds: an E8400 by the first application, a 9800 GT and a 470 GTX by the second.
const PAPER_MS: [(u32, [f64; 3]); 3] =
    [(128, [802.65, 177.03, 21.09]), (512, [2033.6, 368.9, 42.51]), (1024, [3275.6, 680.46, 72.35])];

/// The paper's time of a variant on a map of that size; of its two GPUs the later one.
fn paper_ms(variant: &str, side: f64) -> Option<f64> {
    let (_, [cpu, _, gpu]) = PAPER_MS.iter().find(|(paper, _)| f64::from(*paper) == side)?;
    match variant {
        "cpu" => Some(*cpu),
        "gpu-compute" | "gpu-fragment" => Some(*gpu),
        _ => None,
    }
}

/// Growth of a run's time since the first point, or of the paper's.
fn growth(run: &Run, whose: &str) -> Option<f64> {
    run.results.get("growth")?.get(whose)?.as_f64()
}

/// The share of each level in what a run read.
fn fractions_of(run: &Run) -> Option<Vec<f64>> {
    run.results.get("levels")?.as_array()?.iter().map(Value::as_f64).collect()
}

/// The levels that a run read, from the data, 0, on, with their shares; of patches their number.
fn levels(run: &Run) -> String {
    let fractions = fractions_of(run).unwrap_or_default();
    let used = fractions.iter().enumerate().filter(|(_, fraction)| **fraction > 0.0);
    let used: Vec<String> = used.map(|(level, fraction)| format!("{level}: {:.0} %", 100.0 * fraction)).collect();
    match run.results.get("patches").and_then(Value::as_u64) {
        Some(patches) => format!("{} of {patches} patches", used.join(", ")),
        None => used.join(", "),
    }
}

/// The axis of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Samples a side of the synthetic volcano.
    Map,
    /// Width of the screen in pixels.
    Screen,
    /// Interpolation and level of detail.
    Interpolation,
}

impl Axis {
    fn title(self) -> &'static str {
        match self {
            Axis::Map => "Table 1: time by samples a side of the map",
            Axis::Screen => "Section 5: time by the screen's width",
            Axis::Interpolation => "Section 3: bilinear and bicubic interpolation, by level of detail",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Axis::Map => "samples a side",
            Axis::Screen => "pixels a row",
            Axis::Interpolation => "surface",
        }
    }
}

/// The volcano at each number of samples a side. The mesh is left out beyond 4096.
pub fn by_map(setup: &Setup, sides: &[u32], variants: &[Variant]) -> Vec<Point<Setup>> {
    let point = |&side: &u32| {
        let is_left_out = |variant: &Variant| *variant == Variant::Mesh && side > MESH_SIDE;
        let reason = format!("the mesh stops at {MESH_SIDE} samples a side");
        Point {
            label: side.to_string(),
            x: f64::from(side),
            study: Setup { resolution: side, ..setup.clone() },
            variants: variants.iter().copied().filter(|v| !is_left_out(v)).collect(),
            left_out: variants.iter().copied().filter(is_left_out).map(|v| (v, reason.clone())).collect(),
        }
    };
    sides.iter().map(point).collect()
}

/// One map on screens of each width, 4 : 3.
pub fn by_screen(setup: &Setup, widths: &[u32], variants: &[Variant]) -> Vec<Point<Setup>> {
    let point = |&width: &u32| {
        let mut study = setup.clone();
        (study.parameters.width, study.parameters.height) = (width, (width * 3).div_ceil(4));
        let label = format!("{width}x{}", study.parameters.height);
        Point { label, x: f64::from(width), study, variants: variants.to_vec(), left_out: Vec::new() }
    };
    widths.iter().map(point).collect()
}

/// One map by both interpolations at both levels of detail.
pub fn by_interpolation(setup: &Setup, variants: &[Variant]) -> Vec<Point<Setup>> {
    let mut points = Vec::new();
    for &lod in Lod::ALL {
        for &interpolation in Interpolation::ALL {
            let mut study = setup.clone();
            (study.parameters.lod, study.parameters.interpolation) = (lod, interpolation);
            let label = format!("{} {}", interpolation.name(), lod.name());
            let x = points.len() as f64;
            points.push(Point { label, x, study, variants: variants.to_vec(), left_out: Vec::new() });
        }
    }
    points
}

/// A sweep's rows with what they are compared with.
pub struct Outcome {
    axis: Axis,
    rows: Vec<Row>,
}

impl Outcome {
    /// Notes in every run's record how it grew since the first point, and its time over that of `cpu`, measured in turn,
    /// beside the paper's where it prints them. The row of the table is the latter where there is one: it has an interval.
    pub fn new(axis: Axis, mut rows: Vec<Row>) -> Self {
        let firsts: Vec<(String, f64, Option<f64>)> = rows
            .iter()
            .filter(|row| row.label == rows[0].label)
            .map(|row| (row.run.variant.clone(), row.x, row.run.median_frame_ms()))
            .collect();
        for row in &mut rows {
            let Some((variant, first_x, Some(first_ms))) =
                firsts.iter().find(|(variant, ..)| *variant == row.run.variant)
            else {
                continue;
            };
            let ours = row.run.median_frame_ms().map(|ms| ms / first_ms);
            let paper_of = |x| paper_ms(variant, x).filter(|_| axis == Axis::Map);
            let paper = paper_of(row.x).zip(paper_of(*first_x)).map(|(ms, first)| ms / first);
            row.run.results.insert("growth".into(), json!({"ours": ours, "paper": paper}));
            let name = format!("{} {}: growth", row.label, axis.label());
            row.run.experiment = Some(ExperimentRow::new(name, paper, ours, None));
        }
        let mut outcome = Outcome { axis, rows };
        for index in 0..outcome.rows.len() {
            let row = &outcome.rows[index];
            let (against, paper) = (outcome.against_cpu(row), outcome.paper_over_cpu(row));
            let label = format!("{} {}: over cpu", row.label, axis.label());
            let run = &mut outcome.rows[index].run;
            let value = against.as_ref().map(|ratio| json!({"ratio": ratio.ratio, "interval": ratio.interval}));
            run.results.insert("over_cpu".into(), json!(value));
            if let Some(Ratio { ratio: ours, interval, .. }) = against {
                run.experiment = Some(ExperimentRow::new(label, paper, Some(ours), interval));
            }
        }
        outcome
    }

    /// The paper's time of a variant over that of `cpu`; of table 1 alone.
    fn paper_over_cpu(&self, row: &Row) -> Option<f64> {
        let (ours, cpu) = paper_ms(&row.run.variant, row.x).zip(paper_ms("cpu", row.x))?;
        (self.axis == Axis::Map).then_some(ours / cpu)
    }

    /// A variant's time over that of `cpu` at the same point.
    fn against_cpu(&self, row: &Row) -> Option<Ratio> {
        let cpu = self.rows.iter().find(|r| r.label == row.label && r.run.variant == Variant::Cpu.as_str())?;
        if row.run.variant == cpu.run.variant {
            return None;
        }
        ratio_within_process(cpu.run.frame_samples(), row.run.frame_samples())
    }

    /// The runs, for the record.
    pub fn into_runs(self) -> Vec<Run> {
        self.rows.into_iter().map(|row| row.run).collect()
    }

    /// The table, ours beside the paper's.
    pub fn render(&self, style: Style) -> String {
        let mut table = Table::new(&[
            (self.axis.label(), Align::Right),
            ("variant", Align::Left),
            ("frame ms", Align::Right),
            ("growth", Align::Right),
            ("paper", Align::Right),
            ("over cpu", Align::Right),
            ("95 % interval", Align::Left),
            ("paper", Align::Right),
            ("Mrays/s", Align::Right),
            ("steps/ray", Align::Right),
            ("rays that hit", Align::Right),
            ("levels read", Align::Left),
            ("device MiB", Align::Right),
            ("", Align::Left),
        ]);
        for row in &self.rows {
            let run = &row.run;
            let figure = |name: &str| run.results.get(name).and_then(Value::as_f64);
            let against = self.against_cpu(row);
            let paper = self.paper_over_cpu(row).filter(|_| against.is_some());
            let device_mib = run.memory.device_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20));
            table.push(vec![
                row.label.clone(),
                run.variant.clone(),
                number(run.median_frame_ms(), 2),
                number(growth(run, "ours"), 2),
                number(growth(run, "paper"), 2),
                number(against.as_ref().map(|r| r.ratio), 3),
                interval(against.and_then(|r| r.interval)),
                number(paper, 3),
                number(figure("mrays_per_s"), 2),
                number(figure("steps_per_ray"), 1),
                figure("hit_share").map_or(String::new(), |fraction| format!("{:.1} %", fraction * 100.0)),
                levels(run),
                number(device_mib, 1),
                if run.frame_ms.is_none() { run.warnings.last().cloned().unwrap_or_default() } else { String::new() },
            ]);
        }
        let mut text = format!("{}\n{}", style.bold(self.axis.title()), table.render(style));
        text.push_str("growth: frame time over that of the first row; over cpu: frame time over that of variant cpu\n");
        if self.axis == Axis::Map {
            text.push_str("the paper's: an E8400 for cpu, a 470 GTX for the GPU\n");
        }
        text
    }

    /// The time of triangles over that of rays at each point, and the points at which the level of detail changes nothing.
    pub fn tables(&self) -> Vec<NamedTable> {
        let of = |variant: Variant| self.rows.iter().filter(move |row| row.run.variant == variant.as_str());
        let mut triangles = ResultTable {
            title: "Triangles beside rays, measured in turn: their time over that of the rays, with the ends of its 95 % interval",
            columns: &["triangles", "rays", "at", "ratio", "from", "to"],
            rows: Vec::new(),
        };
        for rays in [Variant::GpuCompute, Variant::GpuFragment] {
            for mesh in [Variant::Mesh, Variant::MeshLod] {
                let pairs = of(mesh).filter_map(|row| {
                    let other = of(rays).find(|other| other.label == row.label)?;
                    let ratio = ratio_within_process(other.run.frame_samples(), row.run.frame_samples())?;
                    Some((row.label.as_str(), ratio))
                });
                triangles.rows.extend(pairs.map(|(label, Ratio { ratio, interval, .. })| {
                    let [low, high] = [0, 1].map(|end| interval.map(|ends| ends[end]));
                    let (mesh, rays) = (mesh.as_str(), rays.as_str());
                    vec![json!(mesh), json!(rays), json!(label), json!(ratio), json!(low), json!(high)]
                }));
            }
        }
        let is_finest = |row: &&Row| matches!(fractions_of(&row.run).as_deref(), Some([_]));
        let finest = of(Variant::GpuCompute).filter(|row| self.axis == Axis::Map && is_finest(row));
        let finest = ResultTable {
            title: "Where rays read the data alone, so that the level of detail does nothing",
            columns: &["samples a side"],
            rows: finest.map(|row| vec![json!(row.label)]).collect(),
        };
        let tables = [("triangles", triangles), ("finest", finest)];
        tables.into_iter().filter(|(_, table)| !table.rows.is_empty()).collect()
    }

    /// Frame time along the axis; the paper's growth is dashed, from our first row on: shapes compare, machines do not.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plot(&self) -> Result<String, Error> {
        let mut series: Vec<Series> = Vec::new();
        for variant in Variant::ALL {
            let rows: Vec<&Row> = self.rows.iter().filter(|row| row.run.variant == variant.as_str()).collect();
            let points = |of: &dyn Fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
                rows.iter().filter_map(|row| Some((row.x, of(row)?))).collect()
            };
            let first_ms = rows.first().and_then(|row| row.run.median_frame_ms());
            series.push(Series {
                name: variant.as_str().to_owned(),
                points: points(&|row| row.run.median_frame_ms()),
                reference: false,
            });
            series.push(Series {
                name: format!("{}, the paper's growth", variant.as_str()),
                points: points(&|row| Some(growth(&row.run, "paper")? * first_ms?)),
                reference: true,
            });
        }
        series.retain(|series| !series.points.is_empty());
        let scale = if self.axis == Axis::Interpolation { Scale::Linear } else { Scale::Log };
        let chart = LineChart {
            title: self.axis.title().to_owned(),
            x_label: self.axis.label().to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: scale,
            y_scale: scale,
            series,
        };
        Ok(chart.to_svg()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;

    #[test]
    fn the_paper_s_own_table_grows_more_than_threefold() {
        let growth = |variant| paper_ms(variant, 1024.0).unwrap() / paper_ms(variant, 128.0).unwrap();
        assert!((growth("cpu") - 4.08).abs() < 0.01);
        assert!((growth("gpu-compute") - 3.43).abs() < 0.01);
        assert_eq!(paper_ms("mesh", 128.0), None);
        assert_eq!(paper_ms("cpu", 2048.0), None);
    }

    #[test]
    fn triangles_stand_beside_rays_of_their_point() {
        let row = |label: &str, variant: Variant, ms: f64, count: usize| {
            let samples: Vec<f64> = (0..count).map(|i| ms * (0.99 + 0.005 * i as f64)).collect();
            let frame_ms = summarize(&samples);
            let run = Run { variant: variant.as_str().to_owned(), frame_ms, ..example::run() };
            Row { label: label.to_owned(), x: label.parse().unwrap(), run }
        };
        let rows = [("128", 5.0, 5), ("512", 20.0, 5), ("1024", 10.0, 5), ("2048", 5.0, 3)];
        let rows = rows.into_iter().flat_map(|(label, ms, count)| {
            [row(label, Variant::GpuCompute, 10.0, count), row(label, Variant::Mesh, ms, count)]
        });
        let mut rows: Vec<Row> = rows.collect();
        rows[0].run.results.insert("levels".into(), json!([1.0]));
        rows[2].run.results.insert("levels".into(), json!([0.5, 0.5]));
        let tables = Outcome::new(Axis::Map, rows).tables();
        assert_eq!(tables.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["triangles", "finest"]);
        let expected = [("128", 0.5), ("512", 2.0), ("1024", 1.0), ("2048", 0.5)];
        for (row, (at, expected)) in tables[0].1.rows.iter().zip(expected) {
            let [ratio, low, high] = [3, 4, 5].map(|cell| row[cell].as_f64());
            assert_eq!((row.len(), row[2].as_str()), (6, Some(at)));
            assert!(ratio.is_some_and(|ratio| (ratio - expected).abs() < 0.01), "{row:?}");
            assert!(low <= ratio && (high.is_none() || ratio <= high), "{row:?}");
        }
        assert!(tables[0].1.rows[3][4].is_null() && tables[0].1.rows[3][3].is_f64());
        assert_eq!(tables[1].1.rows, [[json!("128")]]);
    }

    #[test]
    fn the_mesh_stops_at_4096_and_says_so() {
        let points = by_map(&Setup::default(), &[4096, 8192], Variant::PAPER);
        assert_eq!((points[0].variants.len(), points[0].left_out.len()), (5, 0));
        assert!(!points[1].variants.contains(&Variant::Mesh));
        assert_eq!(points[1].left_out[0].0, Variant::Mesh);
    }
}

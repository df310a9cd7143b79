//! Methods of the lists of fragments, by the fragments of a pixel.

use serde_json::json;

use super::{Context, gpu_ms};
use crate::image::compare;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Value as _;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::{Point, Row};
use crate::measure::{Error, picture};
use crate::papers::gas::setup::{LIST_PASSES, Setup};
use crate::papers::gas::{Lists, Variant};
use crate::report::plot::{LineChart, Scale, Series};

/// Sheets behind the scene of a sweep that names none: fragments a pixel beside the scene's own.
const SHEETS: [u32; 4] = [2, 8, 32, 128];
/// So many together let a fourteenth of the light through, whatever their number is.
const ALL_OPACITY: f32 = 0.93;
/// Fragments that the k-buffer keeps of a pixel.
const NEAREST: u32 = 8;

const METHODS: [Lists; 3] = [Lists::Linked, Lists::Tiles, Lists::Nearest(NEAREST)];

/// Measures the three methods in turn behind ever more sheets, and compares their pictures with that of linked lists.
///
/// # Errors
/// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
pub fn run(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.setup.named();
    let given = context.options.counts.as_slice();
    let counts = if given.is_empty() { &SHEETS } else { given };
    let points: Vec<Point<Setup>> = counts
        .iter()
        .map(|&count| Point {
            label: count.to_string(),
            x: f64::from(count),
            study: behind_sheets(&setup, count),
            variants: vec![Variant::NoVolume],
            left_out: Vec::new(),
        })
        .collect();
    let (mut machine, swept) = context.sweep_loaded(&points)?;
    let table = table(&mut machine, &points, &swept.rows)?;
    let series = |(at, lists): (usize, &Lists)| {
        let rows = swept.rows.iter().skip(at).step_by(METHODS.len());
        let points = rows.map(|row| (row.x, gpu_ms(row, &LIST_PASSES))).collect();
        Series { name: lists.text(), points, reference: false }
    };
    let chart = LineChart {
        title: table.title.to_owned(),
        x_label: "sheets behind the scene".to_owned(),
        y_label: "passes of the surfaces, ms".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series: METHODS.iter().enumerate().map(series).collect(),
    };
    context.keep_warnings(swept.rows);
    context.publish_plotted(&machine, &table, chart.to_svg())?;
    swept.stopped.map_or(Ok(()), Err)
}

fn behind_sheets(setup: &Setup, count: u32) -> Setup {
    let layer_opacity = 1.0 - (1.0 - ALL_OPACITY).powf(1.0 / count.max(1) as f32);
    let mut behind = setup.clone();
    (behind.layers, behind.layer_opacity, behind.alternatives.lists) = (count, layer_opacity, METHODS.to_vec());
    behind
}

/// Rows stand point after point, each in the order of [`METHODS`].
fn table(machine: &mut Machine, points: &[Point<Setup>], rows: &[Row]) -> Result<ResultTable, Error> {
    let mut cells = Vec::new();
    for (point, rows) in points.iter().zip(rows.chunks(METHODS.len())) {
        let scene = point.study.load()?;
        let mut linked = None;
        for (study, row) in point.study.alternatives().iter().zip(rows) {
            let mut built = build(machine, study, &scene, Variant::NoVolume)?;
            let drawn = picture::render(machine, &mut built.paper, 0)?;
            let difference = compare(&drawn, linked.get_or_insert_with(|| drawn.clone()), None)?;
            cells.push(vec![
                json!(row.x as u32),
                study.parameters.lists.json(),
                json!(row.run.median_frame_ms()),
                json!(gpu_ms(row, &LIST_PASSES)),
                row.run.results.get("fragments").cloned().unwrap_or_default(),
                row.run.results.get("lost_pixels").cloned().unwrap_or_default(),
                json!(row.run.memory.device_bytes),
                json!(difference.mean),
                json!(difference.p99),
            ]);
        }
    }
    Ok(ResultTable {
        title: "Lists of fragments: cost and Luv difference from linked ones, by sheets behind the scene",
        columns: &[
            "sheets",
            "lists",
            "frame ms",
            "surfaces ms",
            "fragments",
            "lost pixels",
            "bytes",
            "Luv mean",
            "Luv p99",
        ],
        rows: cells,
    })
}

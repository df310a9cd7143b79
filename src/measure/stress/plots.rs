//! Times over amounts, both axes logarithmic.

use super::costs::{pass_ms, passes};
use crate::report::plot::{LineChart, PlotError, Scale};
use crate::report::stress::{Series, StressRecord};

/// The frame of every series, in one chart.
///
/// # Errors
/// [`PlotError::NoData`] without a step.
pub fn frames(record: &StressRecord) -> Result<String, PlotError> {
    let line = |series: &Series| Line {
        name: series_name(record, series),
        points: series.steps.iter().filter_map(|step| Some((step.amount, step.run.median_frame_ms()?))).collect(),
        reference: false,
    };
    chart(record, format!("{} stress: {}", record.paper, record.axis.name), record.series.iter().map(line).collect())
}

/// The frame and the passes of one series.
///
/// # Errors
/// [`PlotError::NoData`] without a step.
pub fn series(record: &StressRecord, series: &Series) -> Result<String, PlotError> {
    let times = |name: &str, clock: &str| -> Vec<(f64, f64)> {
        series.steps.iter().filter_map(|step| Some((step.amount, pass_ms(&step.run, name, clock)?))).collect()
    };
    let frame = series.steps.iter().filter_map(|step| Some((step.amount, step.run.median_frame_ms()?))).collect();
    let mut lines = vec![Line { name: "frame".to_owned(), points: frame, reference: true }];
    lines.extend(passes(series).into_iter().map(|(name, clock)| Line {
        name: if clock == "host" { format!("{name} (host)") } else { name.to_owned() },
        points: times(name, clock),
        reference: false,
    }));
    chart(record, format!("{} stress: {}, {}", record.paper, record.axis.name, series_name(record, series)), lines)
}

type Line = crate::report::plot::Series;

fn chart(record: &StressRecord, title: String, series: Vec<Line>) -> Result<String, PlotError> {
    LineChart {
        title,
        x_label: record.axis.amount_unit.clone(),
        y_label: "milliseconds".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series,
    }
    .to_svg()
}

/// The variant, and in a matrix the value of the second axis.
pub fn series_name(record: &StressRecord, series: &Series) -> String {
    match (&record.across, series.across) {
        (Some(across), Some(value)) => format!("{}, {value} {}", series.variant, across.unit),
        _ => series.variant.clone(),
    }
}

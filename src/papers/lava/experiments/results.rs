//! Chapter 8: the frame rate beside the thesis's, and where a frame's time goes.

use super::points;
use crate::measure::Error;
use crate::report::plot::{BarChart, BarSeries};
use crate::report::record::{ExperimentRow, Run};
use crate::report::table::{Align, Style, Table, number};

/// "Around 20 frames per second", by a GeForce GT 330M.
const THESIS_FRAMES_PER_S: f64 = 20.0;

/// Notes the thesis's figure beside ours.
pub fn beside_the_thesis(run: &mut Run) {
    let ours = run.median_frame_ms().map(|ms| 1e3 / ms);
    run.experiment = Some(ExperimentRow::new("frames per second".to_owned(), THESIS_FRAMES_PER_S, ours, None));
}

/// The table: passes with their times, their counted work, its floor and what their points alone take, then the frame rate
/// beside the thesis's.
pub fn render(run: &Run, style: Style) -> String {
    let mut table = Table::new(&[
        ("pass", Align::Left),
        ("section", Align::Left),
        ("calls", Align::Right),
        ("gpu ms", Align::Right),
        ("host ms", Align::Right),
        ("wait ms", Align::Right),
        ("vertices", Align::Right),
        ("fragments", Align::Right),
        ("samples", Align::Right),
        ("floor ms", Align::Right),
        ("share of limit", Align::Right),
        ("points ms", Align::Right),
    ]);
    let ms = |summary: &Option<crate::report::record::Summary>| {
        summary.as_ref().map_or(String::new(), |s| format!("{:.2}", s.median))
    };
    let count = |count: Option<u64>| count.map_or(String::new(), |count| count.to_string());
    for pass in &run.passes {
        let counts = pass.statistics.clone().unwrap_or_default();
        table.push(vec![
            pass.name.clone(),
            pass.section.clone().unwrap_or_default(),
            pass.calls.to_string(),
            ms(&pass.gpu_ms),
            ms(&pass.host_ms),
            ms(&pass.wait_ms),
            count(counts.vertices),
            count(counts.fragments),
            count(counts.samples_passed),
            number(pass.floor_ms, 2),
            pass.fraction_of_limit().map_or(String::new(), |fraction| format!("{:.0} %", 100.0 * fraction)),
            number(points::points_ms(run, pass), 2),
        ]);
    }
    let ours = run.experiment.as_ref().and_then(|row| row.ours).unwrap_or(f64::NAN);
    let frame = ms(&run.frame_ms);
    format!(
        "{}\n{}points: the pass's points or splats with an empty fragment stage\n\
         frame {frame} ms, {ours:.1} frames a second; the thesis: around {THESIS_FRAMES_PER_S} (GeForce GT 330M)\n",
        style.bold("Chapter 8: results"),
        table.render(style)
    )
}

/// Milliseconds of every pass.
///
/// # Errors
/// [`Error::Plot`].
pub fn plot(run: &Run) -> Result<String, Error> {
    let median = |s: &Option<crate::report::record::Summary>| s.as_ref().map(|s| s.median);
    let series = |name: &str, of: &dyn Fn(&crate::report::record::Pass) -> Option<f64>| BarSeries {
        name: name.to_owned(),
        values: run.passes.iter().map(of).collect(),
    };
    let chart = BarChart {
        title: "Lava: where a frame's time goes".to_owned(),
        y_label: "ms".to_owned(),
        groups: run.passes.iter().map(|p| p.name.clone()).collect(),
        series: vec![series("gpu", &|p| median(&p.gpu_ms)), series("host", &|p| median(&p.host_ms))],
    };
    Ok(chart.to_svg()?)
}

//! The passes of a frame as bars: one row each, beginning where the one before ends.

use maud::{Markup, html};

use crate::report::record::{Pass, PassKind, Run};

/// Width of the drawing in its own units; the page scales it.
const WIDTH: f64 = 1000.0;
const ROW: f64 = 22.0;
/// Room for the names left of the bars.
const NAMES: f64 = 210.0;
/// Room for the numbers right of the longest bar.
const NUMBERS: f64 = 130.0;

/// Milliseconds of a pass that the bars show: its time on the device, or of host work.
pub(super) fn milliseconds(pass: &Pass) -> Option<f64> {
    pass.gpu_ms.as_ref().or(pass.host_ms.as_ref()).map(|time| time.median)
}

/// The bars; empty where no pass was timed.
pub(super) fn bars(run: &Run) -> Markup {
    let timed: Vec<(&Pass, f64)> = run.passes.iter().filter_map(|pass| Some((pass, milliseconds(pass)?))).collect();
    let total: f64 = timed.iter().map(|(_, ms)| ms).sum();
    if timed.is_empty() || total <= 0.0 {
        return html! {};
    }
    let scale = (WIDTH - NAMES - NUMBERS) / total;
    let height = ROW * timed.len() as f64 + 6.0;
    let mut start = 0.0;
    let rows: Vec<(f64, f64, &Pass, f64)> = timed
        .into_iter()
        .enumerate()
        .map(|(row, (pass, ms))| {
            let x = NAMES + start * scale;
            start += ms;
            (x, ROW * row as f64 + 4.0, pass, ms)
        })
        .collect();
    html! {
        svg.bars viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="times of the passes in their order" {
            @for (x, y, pass, ms) in &rows {
                text x=(NAMES - 8.0) y=(y + 13.0) text-anchor="end" { (pass.name) }
                rect class=(kind(pass.kind)) x=(format!("{x:.2}")) y=(y) width=(format!("{:.2}", (ms * scale).max(0.5)))
                    height=(ROW - 5.0) {
                    title { (pass.name) ": " (format!("{ms:.4} ms")) }
                }
                text.number x=(format!("{:.2}", x + ms * scale + 6.0)) y=(y + 13.0) {
                    (format!("{ms:.3} ms, {:.1} %", 100.0 * ms / total))
                }
            }
        }
    }
}

fn kind(kind: PassKind) -> &'static str {
    kind.name()
}

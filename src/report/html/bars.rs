//! The passes of a frame drawn: stacked into one bar, and as a timeline with a row each, which begins where the one before
//! ends.

use maud::{Markup, html};

use crate::report::record::{Pass, PassKind, Run};

/// Width of a drawing in its own units; the page scales it.
const WIDTH: f64 = 1000.0;
const ROW: f64 = 22.0;
/// Height of the stacked bar.
const BAR: f64 = 34.0;
/// Room for the names left of the timeline.
const NAMES: f64 = 210.0;
/// Room for the numbers right of its longest bar.
const NUMBERS: f64 = 130.0;
/// Width of a letter in a bar, about.
const LETTER: f64 = 7.0;

/// Milliseconds of a pass that the drawings show: its time on the device, or of host work.
pub(super) fn milliseconds(pass: &Pass) -> Option<f64> {
    pass.gpu_ms.as_ref().or(pass.host_ms.as_ref()).map(|time| time.median)
}

struct Timed<'a> {
    pass: &'a Pass,
    start_ms: f64,
    ms: f64,
}

/// Both drawings; empty where no pass was timed.
pub(super) fn drawings(run: &Run) -> Markup {
    let mut total_ms = 0.0;
    let timed: Vec<Timed> = run
        .passes
        .iter()
        .filter_map(|pass| {
            let ms = milliseconds(pass)?;
            let start_ms = total_ms;
            total_ms += ms;
            Some(Timed { pass, start_ms, ms })
        })
        .collect();
    if timed.is_empty() || total_ms <= 0.0 {
        return html! {};
    }
    html! {
        figure { (stacked(&timed, total_ms)) figcaption { "The passes of a frame, stacked" } }
        figure.timeline { (timeline(&timed, total_ms)) figcaption { "The same as a timeline, one after the other" } }
    }
}

fn stacked(timed: &[Timed], total_ms: f64) -> Markup {
    let scale = WIDTH / total_ms;
    html! {
        svg.bars.stacked viewBox=(format!("0 0 {WIDTH} {BAR}")) preserveAspectRatio="none" role="img"
            aria-label="times of the passes, stacked" {
            @for one in timed {
                rect class=(kind(one.pass.kind)) x=(format!("{:.2}", one.start_ms * scale)) y="0"
                    width=(format!("{:.2}", (one.ms * scale).max(0.5))) height=(BAR) { (hint(one)) }
                @if one.ms * scale > LETTER * (one.pass.name.len() + 2) as f64 {
                    text.inside x=(format!("{:.2}", one.start_ms * scale + LETTER)) y=(BAR * 0.62) { (one.pass.name) }
                }
            }
        }
    }
}

fn timeline(timed: &[Timed], total_ms: f64) -> Markup {
    let scale = (WIDTH - NAMES - NUMBERS) / total_ms;
    let height = ROW * timed.len() as f64 + 6.0;
    html! {
        svg.bars viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="times of the passes in their order" {
            @for (index, one) in timed.iter().enumerate() {
                @let (x, y) = (NAMES + one.start_ms * scale, ROW * index as f64 + 4.0);
                text x=(NAMES - 8.0) y=(y + 13.0) text-anchor="end" { (one.pass.name) }
                rect class=(kind(one.pass.kind)) x=(format!("{x:.2}")) y=(y) width=(format!("{:.2}", (one.ms * scale).max(0.5)))
                    height=(ROW - 5.0) { (hint(one)) }
                text.number x=(format!("{:.2}", x + one.ms * scale + 6.0)) y=(y + 13.0) {
                    (format!("{:.3} ms, {:.1} %", one.ms, 100.0 * one.ms / total_ms))
                }
            }
        }
    }
}

fn hint(one: &Timed) -> Markup {
    html! { title { (one.pass.name) ": " (format!("{:.4} ms", one.ms)) } }
}

fn kind(kind: PassKind) -> &'static str {
    kind.name()
}

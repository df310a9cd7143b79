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
/// Width of the narrowest bar.
const NARROW: f64 = 0.5;
/// Width of the line between two passes of the stacked bar.
const GAP: f64 = 1.5;

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
            let ms = pass.busy_ms()?;
            let start_ms = total_ms;
            total_ms += ms;
            Some(Timed { pass, start_ms, ms })
        })
        .collect();
    if timed.is_empty() || total_ms <= 0.0 || !total_ms.is_finite() {
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
            // Narrow ones over what comes after them.
            @for one in timed.iter().filter(|one| one.ms * scale >= NARROW).chain(timed.iter().filter(|one| one.ms * scale < NARROW)) {
                rect class=(kind(one.pass.kind)) x=(format!("{:.2}", one.start_ms * scale)) y="0"
                    width=(format!("{:.2}", (one.ms * scale).max(NARROW))) height=(BAR) { (hint(one)) }
                @if one.ms * scale > LETTER * (one.pass.name.len() + 2) as f64 {
                    text.inside x=(format!("{:.2}", one.start_ms * scale + LETTER)) y=(BAR * 0.62) { (one.pass.name) }
                }
            }
            @for neighbours in timed.windows(2) {
                @if let Some(x) = gap(neighbours[0].ms * scale, neighbours[1].ms * scale) {
                    @let x = format!("{:.2}", neighbours[1].start_ms * scale + x);
                    line x1=(x) y1="0" x2=(x) y2=(BAR) {}
                }
            }
        }
    }
}

/// Place of the line between two passes of these widths, from their border: on the wider one, so that it hides none that
/// is narrow; nowhere between two that are.
fn gap(left: f64, right: f64) -> Option<f64> {
    let is_on_left = left > right;
    let wider = if is_on_left { left } else { right };
    (wider >= 2.0 * GAP).then_some(if is_on_left { -0.5 * GAP } else { 0.5 * GAP })
}

fn timeline(timed: &[Timed], total_ms: f64) -> Markup {
    let scale = (WIDTH - NAMES - NUMBERS) / total_ms;
    let height = ROW * timed.len() as f64 + 6.0;
    html! {
        svg.bars viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="times of the passes in their order" {
            @for (index, one) in timed.iter().enumerate() {
                @let (x, y) = (NAMES + one.start_ms * scale, ROW * index as f64 + 4.0);
                text x=(NAMES - 8.0) y=(y + 13.0) text-anchor="end" { (one.pass.name) }
                rect class=(kind(one.pass.kind)) x=(format!("{x:.2}")) y=(y) width=(format!("{:.2}", (one.ms * scale).max(NARROW)))
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
    kind.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_hides_a_narrow_pass() {
        assert_eq!(gap(300.0, 0.5), Some(-0.75));
        assert_eq!(gap(0.5, 300.0), Some(0.75));
        assert_eq!(gap(2.0, 2.5), None);
    }
}

//! A comparison for people.

use std::fmt::Write;

use super::{Clock, Comparison, Ratio, RunComparison, Verdict};
use crate::report::table::{Align, Style, Table};

/// Every run with its verdict, the ratio B / A with its interval, and the table of passes; then what only one side has,
/// and the warnings.
pub fn render(comparison: &Comparison, style: Style) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    for run in &comparison.runs {
        let _ = writeln!(text, "{}", style.bold(&title(run)));
        let _ = writeln!(text, "{}", verdict(run, comparison, style));
        if !run.passes.is_empty() {
            text.push_str(&passes(run).render(style));
        }
        text.push('\n');
    }
    for (side, names) in [("A", &comparison.only_in_a), ("B", &comparison.only_in_b)] {
        for name in names {
            let _ = writeln!(text, "only in {side}: {name}");
        }
    }
    for warning in &comparison.warnings {
        let _ = writeln!(text, "{} {warning}", style.yellow("warning:"));
    }
    let _ = writeln!(
        text,
        "B / A is a ratio of medians with its {:.0} % interval; SAME means within ± {} %",
        100.0 * comparison.confidence,
        percent(comparison.same_margin)
    );
    text
}

fn title(run: &RunComparison) -> String {
    let preset = run.preset.as_ref();
    let preset = preset.map_or_else(String::new, |preset| format!(", {preset}"));
    format!("{} {}{preset}: {} × {}", run.paper, run.variant, run.width, run.height)
}

fn verdict(run: &RunComparison, comparison: &Comparison, style: Style) -> String {
    let mut text = match run.verdict {
        Verdict::Same => style.green("SAME"),
        Verdict::Faster => style.green("FASTER"),
        Verdict::Slower => style.red("SLOWER"),
        Verdict::Unclear => style.yellow("UNCLEAR"),
    };
    if let Some(frame) = &run.frame {
        let _ = write!(
            text,
            ": frame B / A {:.4} {}, A {:.3} ms ({}), B {:.3} ms ({})",
            frame.ratio,
            interval(frame),
            frame.a_median_ms,
            processes(run.a_processes),
            frame.b_median_ms,
            processes(run.b_processes),
        );
    }
    if let Some(limit) = comparison.fail_above.filter(|_| run.regression) {
        let message = format!("regression beyond {} %", percent(limit));
        let _ = write!(text, "; {}", style.red(&message));
    }
    if let Some(reason) = &run.reason {
        let _ = write!(text, "; {reason}");
    }
    text
}

fn processes(count: usize) -> String {
    match count {
        1 => "1 process".to_owned(),
        more => format!("{more} processes"),
    }
}

fn passes(run: &RunComparison) -> Table {
    let mut table = Table::new(&[
        ("pass", Align::Left),
        ("clock", Align::Left),
        ("A ms", Align::Right),
        ("B ms", Align::Right),
        ("B / A", Align::Right),
        ("interval", Align::Left),
    ]);
    for pass in &run.passes {
        let cell = |text: fn(&Ratio) -> String| pass.ratio.as_ref().map_or("-".to_owned(), text);
        table.push(vec![
            pass.name.clone(),
            match pass.clock {
                Clock::Gpu => "GPU".to_owned(),
                Clock::Host => "host".to_owned(),
            },
            cell(|ratio| format!("{:.3}", ratio.a_median_ms)),
            cell(|ratio| format!("{:.3}", ratio.b_median_ms)),
            cell(|ratio| format!("{:.4}", ratio.ratio)),
            cell(interval),
        ]);
    }
    table
}

fn interval(ratio: &Ratio) -> String {
    let [low, high] = ratio.interval;
    format!("[{low:.4}, {high:.4}]")
}

/// A fraction in percent, without needless digits.
fn percent(part: f64) -> String {
    let text = format!("{:.3}", 100.0 * part);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

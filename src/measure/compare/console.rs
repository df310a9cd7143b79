//! A comparison for people: on the terminal, and as Markdown for a pull request.

use std::fmt::Write;

use super::{Clock, Comparison, Design, Difference, Gate, Quantity, RunComparison, Verdict};
use crate::report::html::Section;
use crate::report::table::{Align, Style, Table, markdown_text};
use crate::report::text::one_line;

/// Passes with the same value of what differs are shown as one line from this many on.
const MANY: usize = 4;

/// Differences between the sides, every run with the verdicts on frame and passes, runs of one side alone, warnings.
pub fn render(comparison: &Comparison, style: Style) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = writeln!(text, "{}", style.bold("what is compared"));
    for line in differences(comparison) {
        let _ = writeln!(text, "  {}", one_line(&line));
    }
    text.push('\n');
    for run in &comparison.runs {
        let _ = writeln!(text, "{}", style.bold(&one_line(&title(run))));
        let _ = writeln!(text, "{}", headline(run, comparison, style));
        if !run.passes.is_empty() {
            text.push_str(&passes(run).render(style));
        }
        text.push('\n');
    }
    for line in missing(comparison) {
        let _ = writeln!(text, "{}", one_line(&line));
    }
    for warning in &comparison.warnings {
        let _ = writeln!(text, "{} {}", style.yellow("warning:"), one_line(warning));
    }
    let _ = writeln!(text, "{}", legend(comparison));
    text
}

/// The same as tables of Markdown.
pub fn markdown(comparison: &Comparison) -> String {
    let mut text = String::from("**What is compared**\n\n");
    for line in differences(comparison) {
        let _ = writeln!(text, "- {}", markdown_text(&line));
    }
    for run in &comparison.runs {
        let _ = writeln!(text, "\n### {}\n", markdown_text(&title(run)));
        let _ = writeln!(text, "{}\n", markdown_text(&headline(run, comparison, Style::default())));
        text.push_str(&passes(run).markdown());
    }
    text.push('\n');
    for line in missing(comparison).chain(comparison.warnings.iter().map(|warning| format!("warning: {warning}"))) {
        let _ = writeln!(text, "- {}", markdown_text(&line));
    }
    let _ = writeln!(text, "\n{}", markdown_text(&legend(comparison)));
    text
}

/// The same for the page of a report.
pub fn sections(comparison: &Comparison) -> Vec<Section> {
    let side = |name: &'static str, commands: &[Vec<String>]| -> Vec<_> {
        commands.iter().map(|command| (name.to_owned(), command.clone())).collect()
    };
    let whole = (!comparison.command.is_empty()).then(|| ("Compared by".to_owned(), comparison.command.clone()));
    let sides = [side("A by", &comparison.a_commands), side("B by", &comparison.b_commands)].concat();
    let compared = Section {
        title: "What is compared".to_owned(),
        commands: whole.into_iter().chain(sides).collect(),
        lines: differences(comparison),
        table: None,
    };
    let runs = comparison.runs.iter().map(|run| Section {
        title: title(run),
        commands: vec![],
        lines: vec![headline(run, comparison, Style::default())],
        table: (!run.passes.is_empty()).then(|| passes(run)),
    });
    let rest = missing(comparison).chain(comparison.warnings.iter().map(|warning| format!("Warning: {warning}")));
    let legend = Section {
        title: "How to read it".to_owned(),
        commands: vec![],
        lines: rest.chain([legend(comparison)]).collect(),
        table: None,
    };
    std::iter::once(compared).chain(runs).chain([legend]).collect()
}

fn differences(comparison: &Comparison) -> Vec<String> {
    let line = |what: &str, difference: &Difference| {
        format!("{what}: A {}, B {}", values(&difference.a), values(&difference.b))
    };
    let mut lines: Vec<String> = vec![];
    let kinds = [("SPIR-V of ", "shaders"), ("shader_compiler of ", "shader compilers"), ("picture of ", "pictures")];
    for (prefix, plural) in kinds {
        let same_kind: Vec<&Difference> =
            comparison.differences.iter().filter(|difference| difference.what.starts_with(prefix)).collect();
        if same_kind.len() >= MANY {
            let [first, ..] = same_kind[..] else { continue };
            // Every pass has another digest, but most often all have one compiler.
            let are_alike = same_kind.iter().all(|one| (&one.a, &one.b) == (&first.a, &first.b));
            lines.push(match are_alike && plural == "shader compilers" {
                true => line(&format!("{plural} of {} passes", same_kind.len()), first),
                false => {
                    let places = same_kind.iter().take(MANY).map(|one| &one.what[prefix.len()..]).collect::<Vec<_>>();
                    let more = same_kind.len() - places.len();
                    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                    format!("{plural}: {} differ: {}{more}", same_kind.len(), places.join(", "))
                }
            });
        } else if prefix != "shader_compiler of " {
            // As of a stage that the pass has on one side.
            let alone = |side: &str, difference: &Difference| format!("{}: {side} alone has one", difference.what);
            lines.extend(same_kind.iter().map(|difference| match (difference.a.is_empty(), difference.b.is_empty()) {
                (_, true) => alone("A", difference),
                (true, _) => alone("B", difference),
                _ => format!("{} differs", difference.what),
            }));
        } else {
            lines.extend(same_kind.iter().map(|difference| line(&difference.what, difference)));
        }
    }
    let others = comparison.differences.iter().filter(|difference| !difference.what.contains(" of "));
    lines.extend(others.map(|difference| line(&difference.what, difference)));
    if lines.is_empty() {
        lines.push("nothing that the records tell of program, shaders and environment differs".to_owned());
    }
    lines
}

fn values(values: &[String]) -> String {
    // Digests are told apart by their beginning.
    let short = |value: &String| match value.as_str() {
        digest if digest.len() >= 40 && digest.chars().all(|c| c.is_ascii_hexdigit()) => digest[..12].to_owned(),
        "" => "none".to_owned(),
        other => other.to_owned(),
    };
    if values.is_empty() { "unset".to_owned() } else { values.iter().map(short).collect::<Vec<_>>().join(" and ") }
}

fn missing(comparison: &Comparison) -> impl Iterator<Item = String> {
    let runs = [("A", &comparison.only_in_a), ("B", &comparison.only_in_b)];
    let alone =
        runs.into_iter().flat_map(|(side, names)| names.iter().map(move |name| format!("only in {side}: {name}")));
    let passes = comparison.runs.iter().filter(|run| !run.missing_passes.is_empty());
    alone.chain(passes.map(move |run| format!("B lacks passes of {}: {}", title(run), run.missing_passes.join(", "))))
}

/// A run's name: paper, variant, preset, what tells it from others of these, size.
fn title(run: &RunComparison) -> String {
    let preset = run.preset.as_ref();
    let preset = preset.map_or_else(String::new, |preset| format!(", {preset}"));
    format!("{} {}{preset}{}: {} × {}", run.paper, run.variant, run.alternative, run.width, run.height)
}

fn headline(run: &RunComparison, comparison: &Comparison, style: Style) -> String {
    let Quantity { a_median_ms, b_median_ms, ratio, .. } = run.frame;
    let mut text = verdict(&run.frame, style);
    if let (Some(a), Some(b), Some(ratio)) = (a_median_ms, b_median_ms, ratio) {
        let (a_count, b_count) = (processes(run.a_processes), processes(run.b_processes));
        let interval = run.frame.interval.map_or_else(String::new, |ends| format!(" {}", between(ends)));
        let (ratio, a, b) = (digits(ratio, 4), digits(a, 3), digits(b, 3));
        let _ = write!(text, ": frame B / A {ratio}{interval}, A {a} ms ({a_count}), B {b} ms ({b_count})");
    }
    if let Some(limit) = comparison.fail_above {
        let gates = || run.passes.iter().map(|pass| (pass.name.as_str(), &pass.time)).chain([("frame", &run.frame)]);
        for (gate, says) in [(Gate::Failed, "regression beyond"), (Gate::Undecided, "undecided against")] {
            let found = gates().filter(|(_, time)| time.gate == Some(gate));
            let names: Vec<String> = found
                .map(|(name, time)| match &time.gate_reason {
                    Some(reason) => format!("{name} ({reason})"),
                    None => name.to_owned(),
                })
                .collect();
            if !names.is_empty() {
                let message = format!("{says} {} %: {}", percent(limit), names.join(", "));
                let message = if gate == Gate::Failed { style.red(&message) } else { style.yellow(&message) };
                let _ = write!(text, "; {message}");
            }
        }
    }
    if let Some(reason) = &run.frame.reason {
        let _ = write!(text, "; {reason}");
    }
    text
}

fn verdict(quantity: &Quantity, style: Style) -> String {
    match quantity.verdict {
        Verdict::Same => style.green("SAME"),
        Verdict::Faster => style.green("FASTER"),
        Verdict::Slower => style.red("SLOWER"),
        Verdict::Unclear => style.yellow("UNCLEAR"),
    }
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
        ("share", Align::Right),
        ("B / A", Align::Right),
        ("interval", Align::Left),
        ("verdict", Align::Left),
    ]);
    for pass in &run.passes {
        let time = &pass.time;
        let number = |value: Option<f64>, count: usize| value.map_or("-".to_owned(), |value| digits(value, count));
        table.push(vec![
            pass.name.clone(),
            match pass.clock {
                Clock::Gpu => "GPU",
                Clock::Host => "host",
                Clock::Wait => "wait",
            }
            .to_owned(),
            number(time.a_median_ms, 3),
            number(time.b_median_ms, 3),
            time.share.map_or("-".to_owned(), |share| format!("{} %", digits(100.0 * share, 1))),
            number(time.ratio, 4),
            time.interval.map_or_else(|| "-".to_owned(), between),
            match &time.reason {
                // What holds for the frame too is said once, with it.
                Some(reason) if run.frame.reason.as_ref() != Some(reason) => {
                    format!("{}: {reason}", verdict(time, Style::default()))
                }
                _ => verdict(time, Style::default()),
            },
        ]);
    }
    table
}

fn between([low, high]: [f64; 2]) -> String {
    format!("[{}, {}]", digits(low, 4), digits(high, 4))
}

/// A number with so many digits behind the point; beyond a billion, as no time of a frame is, by its power of ten.
fn digits(value: f64, count: usize) -> String {
    if value.abs() < 1e9 { format!("{value:.count$}") } else { format!("{value:.count$e}") }
}

fn legend(comparison: &Comparison) -> String {
    let test = match comparison.design {
        Design::Processes => "processes compared by Welch's t-test",
        Design::Blocks => "blocks A B B A compared by signed ranks",
    };
    format!(
        "B / A is a ratio of medians with its {} % interval, {test}; SAME means within ± {} %, FASTER and SLOWER are \
         corrected for the number of passes",
        percent(comparison.confidence),
        percent(comparison.margin)
    )
}

/// A fraction in percent, without needless digits.
fn percent(part: f64) -> String {
    let text = format!("{:.3}", 100.0 * part);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

//! A run as a table for people.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use super::alternative::alternatives;
use super::limits::Limit;
use super::profile::profile;
use super::record::{Limits, Pass, Record, Run, Summary};
use super::table::{Align, Style, Table};
use super::text::one_line;

/// The device, then every run: see [`run`]; then the device's limits, and every warning once with the number of runs that
/// it concerns.
pub fn record(record: &Record, style: Style) -> String {
    let device = &record.environment.device;
    let mut text = format!("device: {} ({})\n", one_line(&device.name), device.kind.as_str());
    for (item, alternative) in record.runs.iter().zip(alternatives(&record.runs)) {
        text.push('\n');
        text.push_str(&run(item, &alternative, style));
        text.push_str(&profile(item, style));
    }
    if let Some(limits) = record.runs.iter().find_map(|run| run.limits.as_ref()) {
        text.push_str(&limits_line(limits));
    }
    let warnings = counted_warnings(record.runs.iter().map(|run| run.warnings.as_slice()));
    text.push_str(&warning_lines(&warnings, style));
    text
}

/// Warnings, a line each.
pub fn warning_lines(warnings: &[String], style: Style) -> String {
    warnings.iter().map(|warning| format!("{} {warning}\n", style.yellow("warning:"))).collect()
}

/// Begin of the warning of a noisy run; the percentage follows.
pub const SCATTERS_BY: &str = "noisy: repetitions of one frame scatter by ";

/// Every warning of runs once, with the number of runs that it concerns; of noise the greatest.
pub fn counted_warnings<'a>(of_runs: impl IntoIterator<Item = &'a [String]>) -> Vec<String> {
    let percent = |warning: &str| warning.strip_prefix(SCATTERS_BY)?.strip_suffix(" %")?.parse::<u64>().ok();
    let mut warnings: Vec<(&str, usize)> = vec![];
    // Noise of every percentage is one kind.
    let mut places: HashMap<Option<&str>, usize> = HashMap::new();
    let mut count_of_runs = 0;
    for run in of_runs {
        count_of_runs += 1;
        // Twice in one run is one run.
        let mut known = HashSet::new();
        for warning in run.iter().filter(|warning| known.insert(warning.as_str())) {
            let kind = if percent(warning).is_some() { None } else { Some(warning.as_str()) };
            let place = *places.entry(kind).or_insert(warnings.len());
            match warnings.get_mut(place) {
                Some((known, count)) => {
                    *count += 1;
                    if percent(warning) > percent(known) {
                        *known = warning;
                    }
                }
                None => warnings.push((warning, 1)),
            }
        }
    }
    let counted = |(warning, count): (&str, usize)| {
        let runs = if count > 1 { format!(" ({count} of {count_of_runs} runs)") } else { String::new() };
        let text = match percent(warning).filter(|_| count > 1) {
            Some(most) => format!("{SCATTERS_BY}up to {most} %"),
            None => one_line(warning),
        };
        text + &runs
    };
    warnings.into_iter().map(counted).collect()
}

/// The device's own limits with the spread of their samples.
fn limits_line(limits: &Limits) -> String {
    let text = |limit: Limit| {
        let spread = limit.mad.filter(|_| limit.value > 0.0).map(|mad| format!("± {:.0} %", 100.0 * mad / limit.value));
        let parts = [one_line(limit.what), significant(limit.value), limit.unit.to_owned(), spread.unwrap_or_default()];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let known: Vec<String> = limits.listed().map(text).collect();
    if known.is_empty() { String::new() } else { format!("\nlimits of the device: {}\n", known.join(", ")) }
}

/// Three digits that say something.
fn significant(value: f64) -> String {
    let before = value.abs().max(f64::MIN_POSITIVE).log10().floor();
    format!("{value:.*}", (2.0 - before).clamp(0.0, 9.0) as usize)
}

/// One run: its name, the table of passes in the paper's order, the frame, and what the passes leave
/// unaccounted. Times are `median ± MAD` in milliseconds; `fraction` is the pass's GPU and host time over the median
/// frame. Columns that no pass has are left out; a time that was not measured is a dash.
pub fn run(run: &Run, alternative: &str, style: Style) -> String {
    let mut text = title(run, alternative, style);
    if !run.passes.is_empty() {
        text.push_str(&passes(run).render(style));
    }
    text.push_str(&frame(run, style));
    text
}

fn title(run: &Run, alternative: &str, style: Style) -> String {
    let preset = run.preset.as_ref().map_or_else(String::new, |preset| format!(", {preset}"));
    let repeat = if run.repeat > 1 { format!(" × {} repetitions", run.repeat) } else { String::new() };
    let process = if run.process > 0 { format!(", process {}", run.process) } else { String::new() };
    format!(
        "{}\n",
        style.bold(&one_line(&format!(
            "{} {}{preset}{alternative}: {} × {}, {} frames{repeat}, seed {}{process}",
            run.paper, run.variant, run.width, run.height, run.frames, run.seed
        )))
    )
}

fn passes(run: &Run) -> Table {
    let mut table = Table::new(&[
        ("pass", Align::Left),
        ("section", Align::Left),
        ("kind", Align::Left),
        ("calls", Align::Right),
        ("submission", Align::Right),
        ("gpu ms", Align::Right),
        ("fraction", Align::Right),
        ("share of limit", Align::Right),
        ("host ms", Align::Right),
        ("wait ms", Align::Right),
    ]);
    // Which submission a pass belongs to only says something when there are several.
    let submissions = run.passes.iter().filter_map(|pass| pass.submission).max() > Some(0);
    let measured = |time: fn(&Pass) -> &Option<Summary>| {
        let any = run.passes.iter().any(|pass| time(pass).is_some());
        move |pass: &Pass| match time(pass) {
            Some(summary) => median_and_mad(summary),
            None if any => "-".to_owned(),
            None => String::new(),
        }
    };
    let gpu = measured(|pass| &pass.gpu_ms);
    let host = measured(|pass| &pass.host_ms);
    let wait = measured(|pass| &pass.wait_ms);
    for pass in &run.passes {
        table.push(vec![
            pass.name.clone(),
            pass.section.clone().unwrap_or_default(),
            pass.kind.as_str().to_owned(),
            pass.calls.to_string(),
            pass.submission.filter(|_| submissions).map_or_else(String::new, |index| index.to_string()),
            gpu(pass),
            fraction(pass, run).map_or_else(String::new, |fraction| format!("{:.1} %", 100.0 * fraction)),
            pass.fraction_of_limit().map_or_else(String::new, |fraction| {
                format!("{:.0} % {}", 100.0 * fraction, pass.bound.as_deref().unwrap_or_default())
            }),
            host(pass),
            wait(pass),
        ]);
    }
    table
}

fn fraction(pass: &Pass, run: &Run) -> Option<f64> {
    Some(pass.busy_ms()? / run.median_frame_ms().filter(|ms| *ms > 0.0)?)
}

fn frame(run: &Run, style: Style) -> String {
    let Some(frame) = &run.frame_ms else {
        return format!("{}\n", style.dim("frame: not measured"));
    };
    let mut text = format!("frame {} ms (min {}", median_and_mad(frame), milliseconds(frame.min));
    let percentiles = [("p95", frame.p95), ("p99", frame.p99)];
    for (name, value) in percentiles {
        if let Some(value) = value {
            let _ = write!(text, ", {name} {}", milliseconds(value));
        }
    }
    let _ = write!(text, ", max {})", milliseconds(frame.max));
    if frame.median > 0.0 {
        let _ = write!(text, ", {:.1} frames/s", 1000.0 / frame.median);
    }
    let rest =
        [("unaccounted", run.unaccounted_ms), ("overlap", run.overlap_ms), ("timestamp floor", run.stamp_floor_ms)];
    for (name, value) in rest {
        if let Some(value) = value {
            let _ = write!(text, "; {name} {} ms", milliseconds(value));
        }
    }
    text.push('\n');
    text
}

fn median_and_mad(summary: &Summary) -> String {
    let median = milliseconds(summary.median);
    match summary.mad {
        Some(mad) => format!("{median} ± {}", milliseconds(mad)),
        None => median,
    }
}

/// Milliseconds to a microsecond, or to four digits where there are more before the point.
fn milliseconds(value: f64) -> String {
    let digits = match value.abs() {
        large if large >= 1000.0 => 0,
        large if large >= 100.0 => 1,
        large if large >= 10.0 => 2,
        _ => 3,
    };
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    #[test]
    fn the_table_shows_every_pass_with_its_times() {
        let text = record(&example::full(), Style::default());
        let line = |name: &str| {
            text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no line {name} in\n{text}"))
        };
        assert_eq!(line("gas slices"), "gas slices, figure-7: 800 × 600, 3 frames, seed 1");
        for part in ["2.000 ± 0.500", "40.0 %", "graphics", "30"] {
            assert!(line("splat").contains(part), "{part} in\n{text}");
        }
        for part in ["host", "-", "10.0 %", "0.500 ± 0.000", "0.250 ± 0.000"] {
            assert!(line("cluster").contains(part), "{part} in\n{text}");
        }
        assert_eq!(
            line("frame"),
            "frame 5.000 ± 1.000 ms (min 4.000, max 6.000), 200.0 frames/s; unaccounted 2.500 ms; overlap 0.100 ms; \
             timestamp floor 0.010 ms"
        );
        assert_eq!(line("warning"), "warning: LP_NUM_THREADS is not set");
        let limits = line("limits of the device: ");
        assert!(limits.contains("6.50 GB/s ± 8 %"), "{limits}");
        assert!(!text.contains("submission"), "one submission only\n{text}");
    }

    #[test]
    fn a_warning_of_several_runs_stands_once_at_the_end_with_their_number() {
        let mut full = example::full();
        let mut other = full.runs[0].clone();
        other.warnings.push("another doubt".to_owned());
        full.runs.push(other);
        let text = record(&full, Style::default());
        let warnings: Vec<&str> = text.lines().filter(|line| line.starts_with("warning: ")).collect();
        assert_eq!(warnings, ["warning: LP_NUM_THREADS is not set (2 of 2 runs)", "warning: another doubt"]);
        assert!(text.ends_with("warning: another doubt\n"), "{text}");
    }

    #[test]
    fn what_was_not_measured_is_not_shown_as_zero() {
        let text = record(&example::minimal(), Style::default());
        assert!(text.contains("frame: not measured"), "{text}");
        assert!(!text.contains("0.0"), "{text}");
    }

    #[test]
    fn submissions_are_shown_when_there_are_several() {
        let mut run = example::full().runs.remove(0);
        run.passes[1].submission = Some(1);
        assert!(super::run(&run, "", Style::default()).contains("submission"));
    }
}

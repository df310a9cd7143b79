//! One pass in depth for people: the distribution of its times, counters, bytes, floor, and both compilers' binaries.

use std::fmt::Write;

use super::record::{CounterReadings, Pass, Profile, Run, Summary};
use super::table::{Align, Style, Table};
use super::text::one_line;

/// Bins of the drawn distribution.
const BINS: usize = 10;
/// Characters of the longest bar.
const BAR: usize = 40;

/// The profiled pass of a run; empty where it has none.
pub fn profile(run: &Run, style: Style) -> String {
    let Some(profile) = &run.profile else { return String::new() };
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = writeln!(text, "{}", style.bold(&one_line(&format!("{} {}: {}", run.paper, run.variant, profile.pass))));
    if let Some(pass) = run.passes.iter().find(|pass| pass.name == profile.pass) {
        if let Some(time) = &pass.gpu_ms {
            text.push_str(&drawn(time));
        }
        push_lines(&mut text, properties(pass));
    }
    text.push_str(&binaries(profile).render(style));
    for compiled in &profile.compilers {
        if let Some(reason) = &compiled.fallback {
            let _ = writeln!(text, "{}: {}", compiled.compiler, one_line(reason));
        }
    }
    compiled_stages(&mut text, profile);
    push_lines(&mut text, told_of_stages(profile).map(str::to_owned));
    push_lines(&mut text, told_of_counters(profile));
    if let Some(shown) = readings(profile) {
        text.push_str(&counter_table(profile, shown).render(style));
        push_lines(&mut text, left_out(shown));
    }
    text
}

fn push_lines(text: &mut String, lines: impl IntoIterator<Item = String>) {
    lines.into_iter().for_each(|line| text.push_str(&format!("{}\n", one_line(&line))));
}

/// Counters, bytes and floor of a pass, a line each.
pub(super) fn properties(pass: &Pass) -> Vec<String> {
    let counts = pass.statistics.clone().unwrap_or_default();
    let counters = [
        ("vertices", counts.vertices),
        ("primitives", counts.primitives),
        ("clipped primitives", counts.clipped_primitives),
        ("fragments", counts.fragments),
        ("invocations", counts.compute_invocations),
        ("samples passed", counts.samples_passed),
    ];
    let counters = counters.into_iter().filter_map(|(name, count)| Some(format!(", {name} {}", count?)));
    let mut lines = vec![format!("counters: calls {}{}", pass.calls, counters.collect::<String>())];
    if let Some(bytes) = &pass.bytes {
        let mut line = format!("bytes: read {}, written {}", bytes.read, bytes.written);
        if let Some(most) = bytes.at_most.filter(|most| (most.read, most.written) != (bytes.read, bytes.written)) {
            line.push_str(&format!("; with all that is bound at most {} and {}", most.read, most.written));
        }
        if !bytes.uncertain.is_empty() {
            line.push_str(&format!("; not certain: {}", bytes.uncertain.join(", ")));
        }
        lines.push(line);
    }
    lines.push(match (pass.floor_ms, &pass.bound) {
        (Some(floor), Some(bound)) => {
            let share = pass
                .fraction_of_limit()
                .map_or_else(String::new, |fraction| format!(", {:.0} % of its time", 100.0 * fraction));
            let terms: Vec<String> = pass.floors.iter().map(|(name, ms)| format!("{name} {ms:.4}")).collect();
            format!("floor: {floor:.4} ms{share}, bound by {bound} (ms at the limits: {})", terms.join(", "))
        }
        _ => "floor: not known; the limits or the counters were not measured".to_owned(),
    });
    lines
}

/// Number of frames, median and spread.
pub(super) fn spread(time: &Summary) -> String {
    let mut text =
        format!("GPU time of {} frames, ms: min {:.4}, median {:.4}", time.samples.len(), time.min, time.median);
    for (name, value) in [("MAD", time.mad), ("p95", time.p95), ("p99", time.p99), ("max", Some(time.max))] {
        if let Some(value) = value {
            let _ = write!(text, ", {name} {value:.4}");
        }
    }
    text
}

/// Histogram of the times: the beginning of each bin, and its samples. Empty where all are alike.
pub(super) fn bins(time: &Summary) -> Vec<(f64, usize)> {
    let width = (time.max - time.min) / BINS as f64;
    if width <= 0.0 {
        return vec![];
    }
    let mut counts = [0usize; BINS];
    for sample in &time.samples {
        counts[(((sample - time.min) / width) as usize).min(BINS - 1)] += 1;
    }
    counts.into_iter().enumerate().map(|(bin, count)| (time.min + bin as f64 * width, count)).collect()
}

/// [`spread`] and a drawing of [`bins`].
fn drawn(time: &Summary) -> String {
    let mut text = format!("{}\n", spread(time));
    let bins = bins(time);
    let most = bins.iter().map(|(_, count)| *count).max().unwrap_or(1).max(1);
    for (start, count) in bins {
        let bar = "#".repeat((count * BAR).div_ceil(most));
        let _ = writeln!(text, "  {start:>10.4}  {count:>5}  {bar}");
    }
    text
}

fn binaries(profile: &Profile) -> Table {
    let mut table = Table::new(&[
        ("compiler", Align::Left),
        ("shader", Align::Left),
        ("instructions", Align::Right),
        ("bytes", Align::Right),
        ("gpu ms of the pass", Align::Right),
    ]);
    let count = |value: Option<u64>| value.map_or_else(|| "-".to_owned(), |value| value.to_string());
    for compiled in &profile.compilers {
        for (index, binary) in compiled.binaries.iter().enumerate() {
            let time = compiled.gpu_ms.as_ref().filter(|_| index == 0).map_or_else(String::new, |time| {
                let mad = time.mad.map_or_else(String::new, |mad| format!(" ± {mad:.4}"));
                format!("{:.4}{mad}", time.median)
            });
            let compiler = if index == 0 { compiled.compiler.clone() } else { String::new() };
            table.push(vec![compiler, binary.name.clone(), count(binary.instructions), count(binary.bytes), time]);
        }
    }
    table
}

/// Readings of the device's own counters, in so far as one compiler's were read.
pub(super) fn readings(profile: &Profile) -> Option<&CounterReadings> {
    profile.compilers.iter().find_map(|compiled| compiled.counters.as_ref())
}

/// Lines that say if the device has counters, and if they were read.
pub(super) fn told_of_counters(profile: &Profile) -> Vec<String> {
    let Some(names) = &profile.performance_counters else {
        return vec!["performance counters (VK_KHR_performance_query): the device has none".to_owned()];
    };
    let unread = profile.counters_unread.as_ref();
    let mut lines: Vec<String> = unread
        .map(|reason| format!("performance counters that the device has, not read: {reason}"))
        .into_iter()
        .collect();
    lines.push(match readings(profile) {
        None => {
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            format!("performance counters that the device has: {names}")
        }
        Some(CounterReadings { replays, recordings, .. }) => format!(
            "performance counters (VK_KHR_performance_query) of frame 0, replayed {replays} times; the pass is recorded \
             {recordings} times in it"
        ),
    });
    lines
}

/// Counters that were not read.
pub(super) fn left_out(shown: &CounterReadings) -> Option<String> {
    let names = shown.left_out.join(", ");
    (!names.is_empty()).then(|| format!("left out, for they take too many replays: {names}"))
}

/// Says so where the driver's compiler tells nothing of the stages.
pub(super) fn told_of_stages(profile: &Profile) -> Option<&'static str> {
    let is_silent = profile.compilers.iter().any(|compiled| compiled.stages.is_none());
    is_silent.then_some(
        "the driver's compiler (VK_KHR_pipeline_executable_properties): the device tells neither registers, spills, \
         occupancy nor instructions",
    )
}

fn counter_table(profile: &Profile, shown: &CounterReadings) -> Table {
    let mut columns =
        vec![("counter", Align::Left), ("group", Align::Left), ("scope", Align::Left), ("unit", Align::Left)];
    columns.extend(profile.compilers.iter().map(|compiled| (compiled.compiler.as_str(), Align::Right)));
    let mut table = Table::new(&columns);
    for (index, counter) in shown.counters.iter().enumerate() {
        let unit = if counter.is_mean { format!("{}, mean", counter.unit) } else { counter.unit.clone() };
        let mut row = vec![counter.name.clone(), counter.category.clone(), counter.scope.clone(), unit];
        row.extend(profile.compilers.iter().map(|compiled| {
            let of_compiler = compiled.counters.as_ref().and_then(|readings| readings.counters.get(index));
            of_compiler.and_then(|counter| counter.value.as_ref()).map_or_else(|| "-".to_owned(), ToString::to_string)
        }));
        table.push(row);
    }
    table
}

fn compiled_stages(text: &mut String, profile: &Profile) {
    for compiled in &profile.compilers {
        for stage in compiled.stages.iter().flatten() {
            let values: Vec<String> =
                stage.statistics.iter().map(|one| format!("{} {}", one.name, one.value)).collect();
            let line = format!(
                "{}, {}: subgroups of {}; {}",
                compiled.compiler,
                stage.name,
                stage.subgroup_size,
                values.join(", ")
            );
            let _ = writeln!(text, "{}", one_line(&line));
            for (name, listing) in &stage.texts {
                let _ = writeln!(text, "  {}: {} lines, in the record", one_line(name), listing.lines().count());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::record::{CompiledPass, CompiledStage, CounterReading, StageStatistic};

    #[test]
    fn a_profile_tells_all_that_is_known_and_what_is_not() {
        let mut run = example::full().runs.remove(0);
        assert_eq!(profile(&run, Style::default()), "");
        run.passes[1].statistics.as_mut().unwrap().clipped_primitives = Some(29_000);
        let compiled = |compiler: &str, stages| CompiledPass {
            compiler: compiler.to_owned(),
            fallback: (compiler == "naga").then(|| "lava/splat.vert: an atomic".to_owned()),
            gpu_ms: summarize(&[1.0, 2.0]),
            binaries: run.passes[1].shaders.clone(),
            stages,
            counters: None,
        };
        let stage = CompiledStage {
            name: "vertex".to_owned(),
            description: String::new(),
            subgroup_size: 32,
            statistics: vec![StageStatistic { name: "Register Count".to_owned(), value: "24".to_owned() }],
            texts: BTreeMap::from([("SASS".to_owned(), "MOV\nEXIT".to_owned())]),
        };
        let [glslang, naga] = [compiled("glslang", None), compiled("naga", None)];
        run.profile = Some(Profile {
            pass: "splat".to_owned(),
            compilers: vec![glslang, naga],
            performance_counters: None,
            counters_unread: None,
        });
        let text = profile(&run, Style::default());
        for part in [
            "gas slices: splat",
            "min 1.5000, median 2.0000",
            "vertices 90000, clipped primitives 29000, fragments 1600000",
            "at most 4096 and 2048; not certain: density",
            "floor: 0.5000 ms, 20 % of its time, bound by vertices",
            "1.5000 ± 0.5000",
            "naga: lava/splat.vert: an atomic",
            "tells neither registers",
            "the device has none",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        let told = run.profile.as_mut().unwrap();
        told.compilers[0].stages = Some(vec![stage]);
        told.performance_counters = Some(vec!["cycles".to_owned()]);
        let text = profile(&run, Style::default());
        for part in ["subgroups of 32; Register Count 24", "SASS: 2 lines", "that the device has: cycles"] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        let told = run.profile.as_mut().unwrap();
        told.counters_unread = Some("the lock is taken".to_owned());
        assert!(profile(&run, Style::default()).contains("not read: the lock is taken"));
        let told = run.profile.as_mut().unwrap();
        told.counters_unread = None;
        let reading = |name: &str, unit: &str, is_mean, value: Option<serde_json::Number>| CounterReading {
            name: name.to_owned(),
            category: "shader".to_owned(),
            description: String::new(),
            unit: unit.to_owned(),
            scope: "command".to_owned(),
            is_mean,
            value,
        };
        told.compilers[0].counters = Some(CounterReadings {
            replays: 3,
            recordings: 2,
            counters: vec![reading("cycles", "cycles", false, Some(u64::MAX.into())), reading("busy", "%", true, None)],
            left_out: vec!["rare".to_owned()],
        });
        let text = profile(&run, Style::default());
        for part in ["replayed 3 times", "recorded 2 times", "18446744073709551615", "%, mean", "replays: rare"] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
    }
}

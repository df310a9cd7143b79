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
        describe(&mut text, pass);
    }
    text.push_str(&binaries(profile).render(style));
    for compiled in &profile.compilers {
        if let Some(reason) = &compiled.fallback {
            let _ = writeln!(text, "{}: {}", compiled.compiler, one_line(reason));
        }
    }
    compiled_stages(&mut text, profile);
    counters(&mut text, profile, style);
    text
}

fn describe(text: &mut String, pass: &Pass) {
    if let Some(time) = &pass.gpu_ms {
        text.push_str(&distribution(time));
    }
    let counts = pass.statistics.as_ref();
    let counters: Vec<String> = [
        ("vertices", counts.and_then(|c| c.vertices)),
        ("primitives", counts.and_then(|c| c.primitives)),
        ("fragments", counts.and_then(|c| c.fragments)),
        ("invocations", counts.and_then(|c| c.compute_invocations)),
        ("samples passed", counts.and_then(|c| c.samples_passed)),
    ]
    .into_iter()
    .filter_map(|(name, count)| Some(format!("{name} {}", count?)))
    .collect();
    let _ = writeln!(
        text,
        "counters: calls {}{}",
        pass.calls,
        counters.iter().map(|c| format!(", {c}")).collect::<String>()
    );
    if let Some(bytes) = &pass.bytes {
        let _ = write!(text, "bytes: read {}, written {}", bytes.read, bytes.written);
        if let Some(most) = bytes.at_most.filter(|most| (most.read, most.written) != (bytes.read, bytes.written)) {
            let _ = write!(text, "; with all that is bound at most {} and {}", most.read, most.written);
        }
        if !bytes.uncertain.is_empty() {
            let _ = write!(text, "; not certain: {}", one_line(&bytes.uncertain.join(", ")));
        }
        text.push('\n');
    }
    match (pass.floor_ms, &pass.bound) {
        (Some(floor), Some(bound)) => {
            let share =
                pass.share_of_limit().map_or_else(String::new, |share| format!(", {:.0} % of its time", 100.0 * share));
            let terms: Vec<String> = pass.floors.iter().map(|(name, ms)| format!("{name} {ms:.4}")).collect();
            let _ = writeln!(
                text,
                "floor: {floor:.4} ms{share}, bound by {bound} (ms at the limits: {})",
                terms.join(", ")
            );
        }
        _ => text.push_str("floor: not known; the limits or the counters were not measured\n"),
    }
}

/// Median, spread and a drawing of how often each time occurred.
fn distribution(time: &Summary) -> String {
    let mut text =
        format!("GPU time of {} frames, ms: min {:.4}, median {:.4}", time.samples.len(), time.min, time.median);
    for (name, value) in [("MAD", time.mad), ("p95", time.p95), ("p99", time.p99), ("max", Some(time.max))] {
        if let Some(value) = value {
            let _ = write!(text, ", {name} {value:.4}");
        }
    }
    text.push('\n');
    let width = (time.max - time.min) / BINS as f64;
    if width <= 0.0 {
        return text;
    }
    let mut counts = [0usize; BINS];
    for sample in &time.samples {
        counts[(((sample - time.min) / width) as usize).min(BINS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1);
    for (bin, count) in counts.iter().enumerate() {
        let bar = "#".repeat((count * BAR).div_ceil(most));
        let _ = writeln!(text, "  {:>10.4}  {count:>5}  {bar}", time.min + bin as f64 * width);
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

/// The device's own counters, each compiler's beside the other's.
fn counters(text: &mut String, profile: &Profile, style: Style) {
    let Some(names) = &profile.performance_counters else {
        text.push_str("performance counters (VK_KHR_performance_query): the device has none\n");
        return;
    };
    if let Some(reason) = &profile.counters_unread {
        let _ = writeln!(text, "performance counters that the device has, not read: {}", one_line(reason));
    }
    let Some(shown) = profile.compilers.iter().find_map(|compiled| compiled.counters.as_ref()) else {
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let _ = writeln!(text, "performance counters that the device has: {}", one_line(&names));
        return;
    };
    let _ = writeln!(
        text,
        "performance counters (VK_KHR_performance_query) of frame 0, replayed {} times; the pass is recorded {} times in it",
        shown.replays, shown.recordings
    );
    text.push_str(&counter_table(profile, shown).render(style));
    if !shown.left_out.is_empty() {
        let _ = writeln!(text, "left out, for they take too many replays: {}", one_line(&shown.left_out.join(", ")));
    }
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
        let Some(stages) = &compiled.stages else {
            text.push_str(
                "the driver's compiler (VK_KHR_pipeline_executable_properties): the device tells neither registers, spills, \
                 occupancy nor instructions\n",
            );
            return;
        };
        for stage in stages {
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
            "vertices 90000",
            "at most 4096 and 2048; not certain: density",
            "floor: 0.5000 ms, 25 % of its time, bound by vertices",
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

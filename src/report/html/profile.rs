//! A profiled pass on the page: all that the console prints of it.

use maud::{Markup, html};

use super::run::cell;
use crate::report::profile::{bins, left_out, properties, readings, spread, told_of_counters, told_of_stages};
use crate::report::record::{CounterReadings, Profile, Run, Summary};

/// Width of the drawing in its own units; the page scales it.
const WIDTH: f64 = 1000.0;
/// Height of its highest bar.
const HIGHEST: f64 = 80.0;
/// Room for a line of text above and below the bars.
const LINE: f64 = 18.0;

/// Empty for a run without a profiled pass.
pub(super) fn profile(run: &Run) -> Markup {
    let Some(profile) = &run.profile else { return html! {} };
    let count = |value: Option<u64>| html! { td.number data-value=[value] { @if let Some(value) = value { (value) } } };
    html! {
        h4 { "Pass " (profile.pass) " by both shader compilers" }
        @if let Some(pass) = run.passes.iter().find(|pass| pass.name == profile.pass) {
            @if let Some(time) = &pass.gpu_ms { (distribution(&pass.name, time)) }
            @for property in properties(pass) { p { (property) } }
        }
        div.wide tabindex="0" role="region" aria-label="binaries" { table.sortable {
            thead { tr {
                th { button type="button" { "compiler" } }
                th { button type="button" { "shader" } }
                @for name in ["instructions", "bytes", "GPU ms of the pass"] { th.number { button type="button" { (name) } } }
            } }
            tbody { @for compiled in &profile.compilers { @for binary in &compiled.binaries { tr {
                td { (compiled.compiler) }
                td { (binary.name) }
                (count(binary.instructions)) (count(binary.bytes))
                (cell(compiled.gpu_ms.as_ref().map(|time| time.median), 4))
            } } } }
        } }
        @for reason in profile.compilers.iter().filter_map(|compiled| compiled.fallback.as_ref()) { p { (reason) } }
        (stages(profile))
        @if let Some(line) = told_of_stages(profile) { p { (line) } }
        @for line in told_of_counters(profile) { p { (line) } }
        @if let Some(shown) = readings(profile) { (counters(profile, shown)) }
    }
}

/// Histogram of the times of the pass.
fn distribution(pass: &str, time: &Summary) -> Markup {
    let bins = bins(time);
    let most = bins.iter().map(|(_, count)| *count).max().unwrap_or(1).max(1) as f64;
    let width = WIDTH / bins.len().max(1) as f64;
    html! {
        @if !bins.is_empty() {
            figure.timeline {
                svg.distribution viewBox=(format!("0 0 {WIDTH} {}", HIGHEST + 2.0 * LINE)) role="img"
                    aria-label=(format!("how often each time of {pass} occurred")) {
                    @for (index, (start, count)) in bins.iter().enumerate() {
                        @let (x, height) = (width * index as f64, HIGHEST * *count as f64 / most);
                        rect.graphics x=(format!("{x:.2}")) y=(format!("{:.2}", LINE + HIGHEST - height))
                            width=(format!("{:.2}", width - 2.0)) height=(format!("{height:.2}")) {
                            title { "from " (format!("{start:.4} ms: {count}")) }
                        }
                        text x=(format!("{:.2}", x + 0.5 * width)) y=(format!("{:.2}", LINE + HIGHEST - height - 5.0))
                            text-anchor="middle" { (count) }
                        text.number x=(format!("{x:.2}")) y=(LINE + HIGHEST + 13.0) { (format!("{start:.4}")) }
                    }
                }
                figcaption { "How often each time occurred, each bar from the time below it on, ms" }
            }
        }
        p { (spread(time)) }
    }
}

/// The stages as the driver's compiler made them.
fn stages(profile: &Profile) -> Markup {
    let told = profile.compilers.iter().flat_map(|compiled| {
        compiled.stages.iter().flatten().map(|stage| (compiled.compiler.as_str(), stage)).collect::<Vec<_>>()
    });
    html! {
        @for (compiler, stage) in told { details {
            summary { (compiler) ", " (stage.name) ": subgroups of " (stage.subgroup_size)
                @for value in &stage.statistics { ", " (value.name) " " (value.value) }
            }
            p { (stage.description) }
            @for (name, listing) in &stage.texts { h5 { (name) } pre { (listing) } }
        } }
    }
}

/// The device's own counters, each compiler's beside the other's.
fn counters(profile: &Profile, shown: &CounterReadings) -> Markup {
    html! {
        div.wide tabindex="0" role="region" aria-label="device counters" { table.sortable {
            thead { tr {
                @for name in ["counter", "group", "scope", "unit"] { th { button type="button" { (name) } } }
                @for compiled in &profile.compilers { th.number { button type="button" { (compiled.compiler) } } }
            } }
            tbody { @for (index, counter) in shown.counters.iter().enumerate() { tr {
                td title=(counter.description) { (counter.name) }
                td { (counter.category) }
                td { (counter.scope) }
                td { (counter.unit) @if counter.is_mean { ", mean" } }
                @for compiled in &profile.compilers {
                    @let value = compiled.counters.as_ref().and_then(|readings| readings.counters.get(index)?.value.as_ref());
                    td.number data-value=[value] { @if let Some(value) = value { (value) } }
                }
            } } }
        } }
        @if let Some(line) = left_out(shown) { p { (line) } }
    }
}

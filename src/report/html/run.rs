//! One run on the page.

use maud::{Markup, html};

use super::bars::drawings;
use super::configurations::Shown;
use super::profile::profile;
use crate::report::record::{Limits, Pass, Run, Summary};

/// Heading, bars, the table of passes and all else that the record has of the run.
pub(super) fn run(Shown { run, id, title }: &Shown) -> Markup {
    html! {
        section.run id=(id) {
            h3 { (title) }
            @if let Some(frame) = &run.frame_ms {
                p.frame {
                    strong { (number(frame.median, 3)) " ms a frame" }
                    " (" (spread(frame)) "min " (number(frame.min, 3))
                    @for (name, value) in [("p95", frame.p95), ("p99", frame.p99)] {
                        @if let Some(value) = value { ", " (name) " " (number(value, 3)) }
                    }
                    ", max " (number(frame.max, 3)) ", "
                    (frame.samples.len()) " frames"
                    @if frame.median > 0.0 { "; " (number(1000.0 / frame.median, 1)) " frames/s" }
                    ")"
                    @for (name, value) in [
                        ("unaccounted", run.unaccounted_ms), ("overlap", run.overlap_ms), ("timestamp floor", run.stamp_floor_ms),
                        ("loading", run.load_ms), ("pipelines", run.pipeline_ms),
                    ] {
                        @if let Some(value) = value { "; " (name) " " (number(value, 3)) " ms" }
                    }
                }
            } @else {
                p.frame { "No frame was measured." }
            }
            (drawings(run))
            (passes(run))
            (profile(run))
            @if let Some(row) = &run.experiment {
                p { "Row of the experiment: " (row.row) ". "
                    @if let Some(ours) = row.ours { "Ours " (number(ours, 3)) "." }
                    @if let Some(paper) = row.paper { " The paper's " (number(paper, 3)) "." }
                    @if let Some(ratio) = row.ratio { " Ratio " (number(ratio, 3)) "." }
                }
            }
            (details(run))
        }
    }
}

fn spread(summary: &Summary) -> Markup {
    html! { @if let Some(mad) = summary.mad { "± " (number(mad, 3)) ", " } }
}

/// A number to read, with the record's own beside it for scripts and as a hint.
pub(super) fn number(value: f64, digits: usize) -> Markup {
    html! { span data-value=(value) title=(value) { (format!("{value:.digits$}")) } }
}

/// A cell that sorts by its number; empty without one, as is a share of nothing.
pub(super) fn cell(value: Option<f64>, digits: usize) -> Markup {
    let value = value.filter(|value| value.is_finite());
    html! {
        td.number data-value=[value] { @if let Some(value) = value { (format!("{value:.digits$}")) } }
    }
}

type Column = (&'static str, fn(&Pass, &Run) -> Option<f64>, usize);

const COLUMNS: [Column; 18] = [
    ("GPU ms", |pass, _| Some(pass.gpu_ms.as_ref()?.median), 4),
    ("± MAD", |pass, _| pass.gpu_ms.as_ref()?.mad, 4),
    ("% of frame", |pass, run| Some(100.0 * pass.busy_ms()? / run.median_frame_ms()?), 1),
    ("share of limit, %", |pass, _| Some(100.0 * pass.fraction_of_limit()?), 0),
    ("floor ms", |pass, _| pass.floor_ms, 4),
    ("host ms", |pass, _| Some(pass.host_ms.as_ref()?.median), 4),
    ("wait ms", |pass, _| Some(pass.wait_ms.as_ref()?.median), 4),
    ("calls", |pass, _| Some(f64::from(pass.calls)), 0),
    ("vertices", |pass, _| Some(pass.statistics.as_ref()?.vertices? as f64), 0),
    ("primitives", |pass, _| Some(pass.statistics.as_ref()?.primitives? as f64), 0),
    ("clipped primitives", |pass, _| Some(pass.statistics.as_ref()?.clipped_primitives? as f64), 0),
    ("fragments", |pass, _| Some(pass.statistics.as_ref()?.fragments? as f64), 0),
    ("invocations", |pass, _| Some(pass.statistics.as_ref()?.compute_invocations? as f64), 0),
    ("samples", |pass, _| Some(pass.statistics.as_ref()?.samples_passed? as f64), 0),
    ("bytes read", |pass, _| Some(pass.bytes.as_ref()?.read as f64), 0),
    ("bytes written", |pass, _| Some(pass.bytes.as_ref()?.written as f64), 0),
    ("read, at most", |pass, _| Some(pass.bytes.as_ref()?.at_most?.read as f64), 0),
    ("written, at most", |pass, _| Some(pass.bytes.as_ref()?.at_most?.written as f64), 0),
];

fn passes(run: &Run) -> Markup {
    if run.passes.is_empty() {
        return html! {};
    }
    let shown: Vec<&Column> =
        COLUMNS.iter().filter(|(_, value, _)| run.passes.iter().any(|pass| value(pass, run).is_some())).collect();
    html! {
        div.wide tabindex="0" role="region" aria-label="passes" {
            table.sortable {
                thead { tr {
                    th { button type="button" { "pass" } }
                    th { button type="button" { "section" } }
                    th { button type="button" { "kind" } }
                    @for (name, _, _) in &shown { th.number { button type="button" { (name) } } }
                    th { button type="button" { "bound by" } }
                    th { button type="button" { "compiler" } }
                } }
                tbody { @for pass in &run.passes { tr {
                    td { (pass.name) }
                    td { (pass.section.as_deref().unwrap_or_default()) }
                    td { (pass.kind.as_str()) }
                    @for (_, value, digits) in &shown { (cell(value(pass, run), *digits)) }
                    td { (pass.bound.as_deref().unwrap_or_default()) }
                    td { (pass.shader_compiler.as_deref().unwrap_or_default()) }
                } } }
            }
        }
    }
}

/// The device's limits with the spread of their samples.
fn rates(limits: &Limits) -> Markup {
    html! {
        div {
            h4 { "Limits of the device" }
            table.limits { tbody {
                @for limit in limits.listed() {
                    tr {
                        th scope="row" { (limit.what) @if !limit.unit.is_empty() { ", " (limit.unit) } }
                        td.number { (number(limit.value, 4)) }
                        td { @if let Some(mad) = limit.mad { "± " (number(mad, 4)) } }
                    }
                }
            } }
        }
    }
}

/// Parameters, results, memory and limits, folded away.
fn details(run: &Run) -> Markup {
    html! {
        details {
            summary { "Parameters, results, memory, limits" }
            div.columns {
                (pairs("Parameters", run.config.iter().map(|(name, value)| (name.as_str(), value.to_string()))))
                (pairs("The paper's own figures", run.results.iter().map(|(name, value)| (name.as_str(), value.to_string()))))
                (pairs("Input files, SHA-256", run.inputs.iter().map(|file| (file.path.as_str(), file.sha256.clone()))))
                @if !run.memory.by_resource.is_empty() {
                    div {
                        h4 { "Memory" }
                        table.sortable {
                            thead { tr {
                                th { button type="button" { "resource" } }
                                th.number { button type="button" { "bytes" } }
                            } }
                            tbody { @for resource in &run.memory.by_resource { tr {
                                td { (resource.name) }
                                td.number data-value=(resource.bytes) { (resource.bytes) }
                            } } }
                        }
                    }
                }
                @if let Some(limits) = &run.limits { (rates(limits)) }
            }
        }
    }
}

fn pairs<'a>(title: &str, rows: impl Iterator<Item = (&'a str, String)>) -> Markup {
    let rows: Vec<(&str, String)> = rows.collect();
    html! {
        @if !rows.is_empty() {
            div {
                h4 { (title) }
                table { tbody { @for (name, value) in rows { tr { th scope="row" { (name) } td { (value) } } } } }
            }
        }
    }
}

//! One run on the page.

use maud::{Markup, html};

use super::bars::bars;
use super::title;
use crate::report::record::{Pass, Run, Summary};

/// Heading, bars, the table of passes and all else that the record has of the run.
pub(super) fn run(run: &Run, id: &str) -> Markup {
    html! {
        section.run id=(id) {
            h3 { (title(run)) }
            @if let Some(frame) = &run.frame_ms {
                p.frame {
                    strong { (number(frame.median, 3)) " ms a frame" }
                    " (" (spread(frame)) "min " (number(frame.min, 3)) ", max " (number(frame.max, 3)) ", "
                    (frame.samples.len()) " frames; " (number(1000.0 / frame.median, 1)) " frames/s)"
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
            (bars(run))
            (passes(run))
            @if let Some(row) = &run.experiment {
                p { "Row of the experiment: " (row.row) ". "
                    @if let Some(ours) = row.ours { "Ours " (number(ours, 3)) "." }
                    @if let Some(paper) = row.paper { " The paper's " (number(paper, 3)) "." }
                    @if let Some(ratio) = row.ratio { " Ratio " (number(ratio, 3)) "." }
                }
            }
            @for warning in &run.warnings { p.warning { "Warning: " (warning) } }
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

/// A cell that sorts by its number; empty without one.
fn cell(value: Option<f64>, digits: usize) -> Markup {
    html! {
        td.number data-value=[value] { @if let Some(value) = value { (format!("{value:.digits$}")) } }
    }
}

type Column = (&'static str, fn(&Pass, &Run) -> Option<f64>, usize);

const COLUMNS: [Column; 11] = [
    ("GPU ms", |pass, _| Some(pass.gpu_ms.as_ref()?.median), 4),
    ("± MAD", |pass, _| pass.gpu_ms.as_ref()?.mad, 4),
    ("% of frame", |pass, run| Some(100.0 * super::bars::milliseconds(pass)? / run.median_frame_ms()?), 1),
    ("host ms", |pass, _| Some(pass.host_ms.as_ref()?.median), 4),
    ("wait ms", |pass, _| Some(pass.wait_ms.as_ref()?.median), 4),
    ("calls", |pass, _| Some(f64::from(pass.calls)), 0),
    ("vertices", |pass, _| Some(pass.statistics.as_ref()?.vertices? as f64), 0),
    ("primitives", |pass, _| Some(pass.statistics.as_ref()?.primitives? as f64), 0),
    ("fragments", |pass, _| Some(pass.statistics.as_ref()?.fragments? as f64), 0),
    ("invocations", |pass, _| Some(pass.statistics.as_ref()?.compute_invocations? as f64), 0),
    ("samples", |pass, _| Some(pass.statistics.as_ref()?.samples_passed? as f64), 0),
];

fn passes(run: &Run) -> Markup {
    if run.passes.is_empty() {
        return html! {};
    }
    let shown: Vec<&Column> =
        COLUMNS.iter().filter(|(_, value, _)| run.passes.iter().any(|pass| value(pass, run).is_some())).collect();
    html! {
        div.wide {
            table.sortable {
                thead { tr {
                    th { button type="button" { "pass" } }
                    th { button type="button" { "section" } }
                    th { button type="button" { "kind" } }
                    @for (name, _, _) in &shown { th.number { button type="button" { (name) } } }
                    th { button type="button" { "compiler" } }
                } }
                tbody { @for pass in &run.passes { tr {
                    td { (pass.name) }
                    td { (pass.section.as_deref().unwrap_or_default()) }
                    td { (pass.kind.name()) }
                    @for (_, value, digits) in &shown { (cell(value(pass, run), *digits)) }
                    td { (pass.shader_compiler.as_deref().unwrap_or_default()) }
                } } }
            }
        }
    }
}

/// Parameters, results, memory and limits, folded away.
fn details(run: &Run) -> Markup {
    let rates = run.limits.as_ref().map(|limits| {
        [
            ("copy, GB/s", limits.copy_gb_s),
            ("multiply-add, GFLOPS", limits.fma_gflops),
            ("fill, Gpixel/s", limits.fill_gpix_s),
            ("blend, Gpixel/s", limits.blend_gpix_s),
        ]
    });
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
                @if let Some(rates) = rates {
                    (pairs("Limits of the device", rates.into_iter().filter_map(|(name, rate)| {
                        rate.map(|rate| (name, format!("{rate:.3}")))
                    })))
                }
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

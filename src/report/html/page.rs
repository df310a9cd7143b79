//! The page around the runs.

use std::collections::{HashMap, HashSet};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

use super::configurations::{Configuration, configurations, shown};
use super::run::{number, run};
use super::tables::tables;
use super::{Contents, Pair, Picture, Section, Source};
use crate::report::console::counted_warnings;
use crate::report::record::{Environment, Record};
use crate::report::text::escaped;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// The whole page as HTML.
pub fn page(contents: &Contents) -> String {
    let script_sha256 = STANDARD.encode(Sha256::digest(SCRIPT));
    let policy =
        format!("default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{script_sha256}'");
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (contents.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { h1 { (contents.title) } (navigation(contents)) }
                main {
                    @if !contents.verdicts.is_empty() {
                        section id="verdicts" { h2 { "Verdicts" } @for verdict in &contents.verdicts { (section(verdict)) }
                            @if !contents.pairs.is_empty() { div.pictures { @for pair in &contents.pairs { (sides(pair)) } } }
                        }
                    }
                    @for (index, source) in contents.records.iter().enumerate() { (record(source, index)) }
                    @for (index, source) in contents.tables.iter().enumerate() { (tables(source, &format!("tables-{index}"))) }
                    @if !contents.plots.is_empty() {
                        section id="plots" {
                            h2 { "Plots of the experiments" }
                            @for plot in &contents.plots {
                                figure {
                                    img src=(data("image/svg+xml", &plot.svg)) alt=(format!("plot {}", plot.name));
                                    figcaption { (plot.name) }
                                    (command("", &plot.command))
                                }
                            }
                        }
                    }
                    @for warning in &contents.warnings { p.warning { "Warning: " (warning) } }
                }
                footer {
                    p { "Times are medians in milliseconds: GPU times of a pass between two full barriers, frames on the host's clock
                        without timestamps. Hold the pointer over a number for all its digits; a click on a heading sorts." }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    visible(&markup.into_string())
}

/// The text with its hidden characters as JSON writes them; tabs and ends of lines stay, by which listings are laid out.
fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for part in text.replace("\r\n", "\n").split_inclusive('\t') {
        let (part, tab) = part.strip_suffix('\t').map_or((part, ""), |part| (part, "\t"));
        shown.push_str(&escaped(part, false));
        shown.push_str(tab);
    }
    shown
}

fn data(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

fn navigation(contents: &Contents) -> Markup {
    html! {
        nav aria-label="Contents" {
            @if !contents.verdicts.is_empty() { a href="#verdicts" { "Verdicts" } }
            @for (index, source) in contents.records.iter().enumerate() {
                // One configuration may stand in several records.
                @if contents.records.len() > 1 { a href=(format!("#record-{index}")) { (source.name) ":" } }
                @for configuration in configurations(&source.record.runs, index) {
                    a href=(format!("#{}", configuration.first.id)) { (configuration.label) }
                }
            }
            @for (index, source) in contents.tables.iter().enumerate() {
                a href=(format!("#tables-{index}")) { (source.document.paper) " " (source.document.experiment) }
            }
            @if !contents.plots.is_empty() { a href="#plots" { "Plots" } }
        }
    }
}

fn section(section: &Section) -> Markup {
    html! {
        h3 { (section.title) }
        @for (label, arguments) in &section.commands { (command(label, arguments)) }
        @for line in &section.lines { p { (line) } }
        @if let Some(table) = &section.table {
            div.wide tabindex="0" role="region" aria-label=(section.title) { table.sortable {
                thead { tr { @for (name, is_number) in table.columns() {
                    th.number[is_number] { button type="button" { (name) } }
                } } }
                tbody { @for row in table.rows() { tr {
                    @for ((_, is_number), text) in table.columns().into_iter().zip(row) { td.number[is_number] { (text) } }
                } } }
            } }
        }
    }
}

fn record(source: &Source, index: usize) -> Markup {
    let record = &source.record;
    html! {
        section.record id=(format!("record-{index}")) {
            h2 { (source.name) }
            (command("", &record.command))
            (environment(&record.environment))
            (experiment(record))
            (pictures(source))
            @for configuration in configurations(&record.runs, index) { (runs(&configuration)) }
            @for warning in counted_warnings(record.runs.iter().map(|run| run.warnings.as_slice())) {
                p.warning { "Warning: " (warning) }
            }
        }
    }
}

/// The first process's run; those of others folded away, for they may be many.
fn runs(configuration: &Configuration) -> Markup {
    let Configuration { first, others, .. } = configuration;
    html! {
        (run(first))
        @if !others.is_empty() {
            details.processes {
                summary { (others.len()) @if others.len() == 1 { " run" } @else { " runs" } " of it by other processes" }
                @for other in others { (run(other)) }
            }
        }
    }
}

/// The command as a shell takes it; a word that none can hold stands as it is.
fn shell_command(command: &[String]) -> String {
    let quoted =
        |argument: &String| shlex::try_quote(argument).map_or_else(|_| argument.clone(), |quoted| quoted.into_owned());
    command.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// A command to copy, if there is one, after what it did.
pub(super) fn command(label: &str, arguments: &[String]) -> Markup {
    html! {
        @if !arguments.is_empty() {
            p.command { @if !label.is_empty() { span { (label) } } code { (shell_command(arguments)) } button.copy type="button" { "Copy" } }
        }
    }
}

pub(super) fn environment(environment: &Environment) -> Markup {
    let (device, host, build) = (&environment.device, &environment.host, &environment.build);
    let text = |value: &Option<String>| value.clone().unwrap_or_default();
    let rows = [
        ("device", format!("{} ({})", device.name, device.kind.as_str())),
        ("device's UUID", text(&device.uuid)),
        ("Vulkan", device.api_version.clone()),
        ("driver", format!("{} {}", text(&device.driver), text(&device.driver_version))),
        ("system", format!("{} {}", host.os, text(&host.kernel))),
        ("processor", text(&host.cpu)),
        ("cores", host.logical_cores.map_or_else(String::new, |cores| cores.to_string())),
        ("LP_NUM_THREADS", host.lp_num_threads.map_or_else(String::new, |threads| threads.to_string())),
        ("layers", environment.layers.join(", ")),
        ("program", format!("{} {} {}", build.version, text(&build.git_commit), text(&build.profile))),
        ("CPU governor", text(&host.cpu_governor)),
        ("loader", text(&environment.loader)),
        ("compiler of the program", text(&build.rustc)),
        ("SHA-256 of the program", text(&build.executable_sha256)),
        ("measured", environment.date.clone()),
    ];
    html! {
        details {
            summary { "Environment" }
            table { tbody {
                @for (name, value) in rows.iter().filter(|(_, value)| !value.trim().is_empty()) {
                    tr { th scope="row" { (name) } td { (value) } }
                }
                @for (name, value) in &host.variables { tr { th scope="row" { (name) } td { (value) } } }
            } }
        }
    }
}

/// The paper's rows beside ours.
fn experiment(record: &Record) -> Markup {
    let rows: Vec<_> = record.runs.iter().filter_map(|run| Some((run, run.experiment.as_ref()?))).collect();
    let cell = |value: Option<f64>| html! { td.number data-value=[value] { @if let Some(value) = value { (format!("{value:.3}")) } } };
    // Where ours is a ratio of methods, ours / paper is the ratio of ratios; both have the ends of their 95 % interval.
    let ends = |interval: Option<[f64; 2]>, paper: f64| {
        html! { @for end in [0, 1] { (cell(interval.map(|interval| interval[end] / paper))) } }
    };
    html! {
        @if !rows.is_empty() {
            h3 { "The paper's table beside ours" }
            p { "From and to are the ends of a 95 % interval, where two methods were measured in turn." }
            div.wide tabindex="0" role="region" aria-label="the paper's table" { table.sortable {
                thead { tr {
                    th { button type="button" { "row" } }
                    th { button type="button" { "variant" } }
                    @for name in ["paper", "ours", "from", "to", "ours / paper", "from", "to", "frame ms"] { th.number { button type="button" { (name) } } }
                } }
                tbody { @for (run, row) in rows { tr {
                    td { (row.row) }
                    td { (run.variant) }
                    (cell(row.paper)) (cell(row.ours)) (ends(row.interval, 1.0))
                    (cell(row.ratio)) (ends(row.interval.filter(|_| row.paper.is_some()), row.paper.unwrap_or(1.0)))
                    (cell(run.median_frame_ms()))
                } } }
            } }
        }
    }
}

/// Pictures of a run by both sides.
fn sides(pair: &Pair) -> Markup {
    let [a, b] = [("A", &pair.pngs[0]), ("B", &pair.pngs[1])].map(|(side, png)| {
        html! { img src=(data("image/png", png)) alt=(format!("picture of {} by side {side}", pair.title)); }
    });
    html! {
        figure {
            (divided(&a, &b))
            figcaption { (pair.title) ", left A, right B; " (luv_difference(pair.mean, pair.p99)) }
        }
    }
}

/// A picture with another over it, right of a divider that moves.
fn divided(base: &Markup, over: &Markup) -> Markup {
    html! {
        div.divided {
            (base)
            div.over { (over) }
            input type="range" min="0" max="100" value="50"
                aria-label="divider: left of it the one picture, right of it the other";
        }
    }
}

fn luv_difference(mean: f64, p99: f64) -> Markup {
    html! { "CIE Luv difference: mean " (number(mean, 3)) ", 99th percentile " (number(p99, 3)) }
}

/// Pictures; one that has a difference lies over what it is compared with, which is not shown alone, under a divider.
fn pictures(source: &Source) -> Markup {
    let names = shown(&source.record.runs, 0);
    let name = |at: usize| names.get(at).map_or_else(String::new, |shown| shown.title.clone());
    let image = |picture: &Picture| {
        html! { img src=(data("image/png", &picture.png)) alt=(format!("picture of {}", name(picture.run))); }
    };
    let differences = source.pictures.iter().filter_map(|picture| picture.difference.as_ref());
    let bases: HashSet<usize> = differences.map(|difference| difference.base).collect();
    let of_runs: HashMap<usize, &Picture> = source.pictures.iter().map(|picture| (picture.run, picture)).collect();
    html! {
        div.pictures {
            @for picture in source.pictures.iter().filter(|picture| !bases.contains(&picture.run)) {
                figure {
                    @if let Some(difference) = &picture.difference {
                        @if let Some(base) = of_runs.get(&difference.base) {
                            (divided(&image(base), &image(picture)))
                        }
                        figcaption {
                            "Left " (name(difference.base)) ", right " (name(picture.run)) "; "
                            (luv_difference(difference.mean, difference.p99))
                        }
                    } @else {
                        (image(picture))
                        figcaption { (name(picture.run)) }
                    }
                }
            }
        }
    }
}

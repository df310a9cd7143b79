//! The tables of an experiment that has no runs.

use maud::{Markup, html};
use serde_json::Value;

use super::TableSource;
use super::page::{command, environment};
use crate::report::tables::{Rows, shown};

/// Heading, command, environment and the tables, with the columns and cells that the console prints.
pub(super) fn tables(source: &TableSource, id: &str) -> Markup {
    let document = &source.document;
    html! {
        section.record.tables id=(id) {
            h2 { (source.name) }
            (command("", &document.command))
            (environment(&document.environment))
            @for table in document.all() { (rows(table)) }
            @for warning in &document.warnings { p.warning { "Warning: " (warning) } }
        }
    }
}

fn rows(table: &Rows) -> Markup {
    let is_number = |name: &str| table.rows.iter().all(|row| row.cell(name).is_number() || row.cell(name).is_null());
    let columns: Vec<(&str, bool)> = table.shown_columns().into_iter().map(|name| (name, is_number(name))).collect();
    html! {
        h3 { (table.title) }
        div.wide tabindex="0" role="region" aria-label=(table.title) { table.sortable {
            thead { tr { @for (name, is_number) in &columns { th.number[*is_number] { button type="button" { (name) } } } } }
            tbody { @for row in &table.rows { tr {
                @for (name, is_number) in &columns { (cell(row.cell(name), *is_number)) }
            } } }
        } }
    }
}

/// A number has the document's own digits beside the printed ones.
fn cell(value: &Value, is_number: bool) -> Markup {
    let digits = value.as_f64().map(|_| value.to_string());
    html! { td.number[is_number] data-value=[digits.as_ref()] title=[digits.as_ref()] { (shown(value)) } }
}

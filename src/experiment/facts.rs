//! Tables of experiments that time nothing.

use serde_json::{Map, Value, json};

use crate::report::csv::quote;
use crate::report::table::{Align, Style, Table};

/// A table of an experiment that times nothing: for the console and, row by row, for JSON and CSV.
pub struct Facts {
    pub title: &'static str,
    pub columns: &'static [&'static str],
    pub rows: Vec<Vec<Value>>,
}

impl Facts {
    /// For the console.
    pub fn render(&self, style: Style) -> String {
        format!("{}\n{}", self.title, self.table().render(style))
    }

    fn table(&self) -> Table {
        let columns: Vec<(&str, Align)> = self.columns.iter().map(|&c| (c, Align::Right)).collect();
        let mut table = Table::new(&columns);
        for row in &self.rows {
            table.push(row.iter().map(shown).collect());
        }
        table
    }

    /// One object a row.
    pub fn json(&self) -> Value {
        let object = |row: &Vec<Value>| -> Map<String, Value> {
            self.columns.iter().zip(row).map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
        };
        json!({"title": self.title, "rows": self.rows.iter().map(object).collect::<Vec<_>>()})
    }

    /// Comma-separated, with a header; quoted where a mesh's name needs it.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.iter().map(|cell| quote(cell)).collect::<Vec<_>>().join(",") + "\n";
        let header = line(self.columns.iter().map(|c| (*c).to_owned()).collect());
        self.rows.iter().fold(header, |text, row| text + &line(row.iter().map(shown).collect()))
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => format!("{:.4}", number.as_f64().unwrap_or(f64::NAN)),
        other => other.to_string(),
    }
}

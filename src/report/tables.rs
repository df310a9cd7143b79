//! Tables of an experiment, its whole outcome or beside its runs, schema [`SCHEMA`]: plain data, in the order in which it is
//! written. The JSON Schema is `schema/fumarole.table-1.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::bounded;
use super::record::Environment;

/// The value of [`Tables::schema`] that this program writes and reads.
pub const SCHEMA: &str = "fumarole.table/1";

/// One document: where it was measured, by which command, and the tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tables {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of the paper's command.
    pub paper: String,
    /// The experiment's name.
    pub experiment: String,
    /// Device, host and build.
    pub environment: Environment,
    /// The command line, program name first.
    pub command: Vec<String>,
    /// The experiment's own table.
    pub table: Rows,
    /// Tables after it, by their names.
    #[serde(default)]
    pub more: BTreeMap<String, Rows>,
    /// Doubts about what was measured, one line each, where no record has them; empty in what older programs wrote.
    #[serde(default)]
    pub warnings: Vec<String>,
}

impl Tables {
    /// Every table, the experiment's own first.
    pub fn all(&self) -> impl Iterator<Item = &Rows> {
        std::iter::once(&self.table).chain(self.more.values())
    }
}

/// A table row by row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rows {
    /// Line above the table.
    pub title: String,
    /// Headings in their order, with units.
    pub columns: Vec<String>,
    /// Cells by the headings of their columns; what was not measured is null or absent.
    pub rows: Vec<Row>,
}

impl Rows {
    /// Length of all texts in all columns, bytes.
    pub fn text_bytes(&self) -> usize {
        let cells = self.rows.iter().flat_map(|row| self.columns.iter().map(move |name| row.cell(name)));
        cells.map(|cell| cell.as_str().map_or(0, str::len)).fold(0, usize::saturating_add)
    }

    /// Columns in which a row has something: those that a reader is shown.
    pub fn shown_columns(&self) -> Vec<&str> {
        let is_shown = |name: &&str| self.rows.iter().any(|row| !shown(row.cell(name)).is_empty());
        self.columns.iter().map(String::as_str).filter(is_shown).collect()
    }
}

/// Cells of a row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Row(#[serde(deserialize_with = "bounded::object")] pub Map<String, Value>);

impl Row {
    /// The cell of a column.
    pub fn cell(&self, column: &str) -> &Value {
        self.0.get(column).unwrap_or(&Value::Null)
    }
}

/// A cell as people read it.
pub fn shown(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => format!("{:.4}", number.as_f64().unwrap_or(f64::NAN)),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;
    use serde_json::json;

    fn validator() -> jsonschema::Validator {
        let read = |text: &str| -> Value { serde_json::from_str(text).unwrap() };
        let bench = read(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.bench-1.json")));
        let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.table-1.json"));
        let mut schema = read(&text.replace("urn:fumarole:bench-1#", "#"));
        jsonschema::meta::validate(&schema).unwrap();
        for (name, definition) in bench["$defs"].as_object().unwrap() {
            schema["$defs"][name] = definition.clone();
        }
        jsonschema::validator_for(&schema).unwrap()
    }

    #[test]
    fn documents_meet_the_schema_and_wrong_ones_do_not() {
        let validator = validator();
        let full = serde_json::to_value(example::tables()).unwrap();
        let errors: Vec<String> = validator.iter_errors(&full).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:#?}");
        for (pointer, wrong) in [
            ("/schema", json!("fumarole.table/2")),
            ("/table/columns", json!([1])),
            ("/table/rows/0", json!([1])),
            ("/table/rows/0/mesh", json!({})),
            ("/environment/device/type", json!("gpu")),
            ("/more/smallest", json!(3)),
            ("/warnings", json!([1])),
        ] {
            let mut document = full.clone();
            *document.pointer_mut(pointer).unwrap() = wrong;
            assert!(!validator.is_valid(&document), "{pointer}");
        }
        for (pointer, fields) in [("", &full), ("/table", &full["table"])] {
            // Older programs wrote no warnings.
            for field in fields.as_object().unwrap().keys().filter(|field| *field != "warnings") {
                let mut document = full.clone();
                document.pointer_mut(pointer).unwrap().as_object_mut().unwrap().remove(field);
                assert!(!validator.is_valid(&document), "{pointer}/{field}");
            }
        }
    }

    #[test]
    fn columns_without_a_cell_are_not_shown() {
        let table = example::tables().table;
        assert_eq!(table.columns, ["mesh", "triangles", "thesis", "note"]);
        assert_eq!(table.shown_columns(), ["mesh", "triangles", "thesis"]);
        assert_eq!(shown(&json!(0.25)), "0.2500");
        assert_eq!(shown(&json!(6320)), "6320");
    }
}

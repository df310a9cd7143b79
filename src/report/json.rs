//! The record as JSON, and back.

use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::bounded;
use super::record::{Record, SCHEMA};
use super::stress::{self, StressRecord};
use super::text::one_line;
use crate::file;

/// Failures of reading a record; every message names the file.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("cannot read the record {}: {source}; name a file written by --json", .path.display())]
    Unreadable {
        /// File that was to be read.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    #[error(
        "cannot read the record {}: it ends too early, at line {line}; the file is truncated, write it again with --json",
        .path.display()
    )]
    Truncated {
        /// File that was read.
        path: PathBuf,
        /// Line at which it ends, from 1.
        line: usize,
    },
    #[error("cannot read the record {}: no JSON: {}; name a file written by --json", .path.display(), plain(.source))]
    NotJson {
        /// File that was read.
        path: PathBuf,
        /// The parser's error, with line and column.
        source: serde_json::Error,
    },
    #[error(
        "cannot read the record {}: {}; name a file written by --json of this version",
        .path.display(), other_schema(.found)
    )]
    WrongSchema {
        /// File that was read.
        path: PathBuf,
        /// Its schema in quotes, or `absent`, `no text` or `no object`.
        found: String,
    },
    #[error(
        "cannot read the record {}: field {}: {}; write it again with --json",
        .path.display(), one_line(.field), plain(.source)
    )]
    WrongField {
        /// File that was read.
        path: PathBuf,
        /// Path inside the document, e.g. `runs[0].passes[2].gpu_ms`.
        field: String,
        /// The parser's error on the field.
        source: serde_json::Error,
    },
}

/// Found in place of a schema where the document cannot have one.
const NO_OBJECT: &str = "no object";

/// A schema that is another one, for a message; what a file has in its place may be as long as the file.
fn other_schema(found: &str) -> String {
    const LONGEST: usize = 60;
    if found == NO_OBJECT {
        return "it is no such document".to_owned();
    }
    let (end, dots) = found.char_indices().nth(LONGEST).map_or((found.len(), ""), |(end, _)| (end, "..."));
    format!("its schema is {}{dots}, not \"{SCHEMA}\"", &found[..end])
}

/// The parser's message on one line, whatever it quotes, with its names in quotes: names in backticks are options of ours.
pub fn plain(error: &serde_json::Error) -> String {
    one_line(&error.to_string()).replace('`', "\"")
}

/// Any document of this crate as JSON: objects on indented lines, lists of plain values on one line, a final newline.
/// A number that is not finite becomes `null`.
///
/// # Errors
/// `value` cannot be represented in JSON, such as a map whose keys are no strings.
pub fn to_string(value: &impl Serialize) -> Result<String, serde_json::Error> {
    let mut text = String::new();
    push_value(&mut text, &serde_json::to_value(value)?, 0);
    text.push('\n');
    Ok(text)
}

/// Reads a record that [`to_string`] wrote; unknown fields are ignored.
///
/// # Errors
/// See [`ReadError`]: every message names the file, and the line or the field.
pub fn read(path: &Path) -> Result<Record, ReadError> {
    /// Far more than a hundred processes of a hundred thousand frames leave.
    const MAX_BYTES: u64 = 1 << 30;
    let text =
        file::read_text(path, MAX_BYTES).map_err(|source| ReadError::Unreadable { path: path.to_owned(), source })?;
    parse(&text, path)
}

/// Begin of every document of ours.
#[derive(Deserialize)]
struct Header {
    schema: Option<String>,
}

/// The schema that a document names, `None` of what is no document of ours.
pub fn schema(text: &str) -> Option<String> {
    serde_json::from_str::<Header>(text).ok()?.schema
}

/// Parses the text of a record; `path` is what errors call it.
///
/// # Errors
/// As [`read`], but for reading the file.
pub fn parse(text: &str, path: &Path) -> Result<Record, ReadError> {
    let owned = || path.to_owned();
    let header: Header = serde_json::from_str(text).map_err(|source| {
        if source.is_eof() {
            ReadError::Truncated { path: owned(), line: source.line() }
        } else if source.is_data() {
            let found = if text.trim_start().starts_with('{') { "no text" } else { NO_OBJECT };
            ReadError::WrongSchema { path: owned(), found: found.to_owned() }
        } else {
            ReadError::NotJson { path: owned(), source }
        }
    })?;
    match header.schema.as_deref() {
        Some(SCHEMA) => document(text, path),
        Some(stress::SCHEMA) => Ok(document::<StressRecord>(text, path)?.into_record()),
        _ => {
            let found = header.schema.map_or_else(|| "absent".to_owned(), |found| Value::from(found).to_string());
            Err(ReadError::WrongSchema { path: owned(), found })
        }
    }
}

/// Parses the text of a document with runs, whose schema is its type's.
///
/// # Errors
/// [`ReadError::WrongField`].
pub fn document<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, ReadError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let read = bounded::within(text.len(), || serde_path_to_error::deserialize(&mut deserializer));
    read.map_err(|error| ReadError::WrongField {
        path: path.to_owned(),
        field: error.path().to_string(),
        source: error.into_inner(),
    })
}

const INDENT: &str = "  ";

fn push_value(text: &mut String, value: &Value, depth: usize) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            let items = map.iter().map(|(key, value)| (Some(key.as_str()), value));
            push_lines(text, ['{', '}'], items, depth);
        }
        Value::Array(items) if items.iter().any(|item| item.is_object() || item.is_array()) => {
            push_lines(text, ['[', ']'], items.iter().map(|item| (None, item)), depth);
        }
        plain => text.push_str(&plain.to_string()),
    }
}

fn push_lines<'a>(
    text: &mut String,
    [open, close]: [char; 2],
    items: impl Iterator<Item = (Option<&'a str>, &'a Value)>,
    depth: usize,
) {
    text.push(open);
    for (index, (key, value)) in items.enumerate() {
        text.push_str(if index == 0 { "\n" } else { ",\n" });
        text.push_str(&INDENT.repeat(depth + 1));
        if let Some(key) = key {
            text.push_str(&Value::from(key).to_string());
            text.push_str(": ");
        }
        push_value(text, value, depth + 1);
    }
    text.push('\n');
    text.push_str(&INDENT.repeat(depth));
    text.push(close);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    fn error_of(text: &str) -> ReadError {
        parse(text, Path::new("some.json")).unwrap_err()
    }

    #[test]
    fn a_record_survives_the_round_trip() {
        for record in [example::full(), example::minimal()] {
            let text = to_string(&record).unwrap();
            assert_eq!(parse(&text, Path::new("some.json")).unwrap(), record);
            // Our layout is only a layout: serde's own reads as the same document.
            let compact: Value = serde_json::to_value(&record).unwrap();
            assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), compact);
        }
    }

    #[test]
    fn fields_stand_in_the_order_of_the_contract_and_absent_is_null() {
        let text = to_string(&example::minimal()).unwrap();
        let order = [
            "\"schema\": \"fumarole.bench/1\"",
            "\"environment\"",
            "\"timestamp_bits\": null",
            "\"command\"",
            "\"runs\"",
            "\"paper\"",
            "\"frame_ms\": null",
            "\"passes\"",
            "\"image\": null",
        ];
        let places: Vec<_> = order.iter().map(|name| text.find(name).unwrap()).collect();
        assert!(places.is_sorted(), "{places:?}");
    }

    #[test]
    fn samples_stay_on_one_line() {
        let text = to_string(&example::full()).unwrap();
        assert!(text.lines().any(|line| line.contains("\"samples\": [1.5,")));
    }

    #[test]
    fn unknown_fields_are_tolerated_and_missing_ones_absent() {
        let mut value = serde_json::to_value(example::minimal()).unwrap();
        value["runs"][0]["novelty"] = Value::from(1);
        value["runs"][0].as_object_mut().unwrap().remove("image");
        let record = parse(&value.to_string(), Path::new("some.json")).unwrap();
        assert_eq!(record, example::minimal());
    }

    #[test]
    fn errors_name_the_file_and_the_place() {
        let text = to_string(&example::full()).unwrap();
        let half = &text[..text.len() / 2];
        let error = error_of(half);
        assert!(matches!(error, ReadError::Truncated { line, .. } if line > 10));
        assert!(error.to_string().contains("some.json"), "{error}");

        assert!(matches!(error_of(""), ReadError::Truncated { .. }));
        let error = error_of("{\n\"a\": oops}");
        assert!(matches!(error, ReadError::NotJson { .. }));
        assert!(error.to_string().contains("line 2"), "{error}");
        for foreign in ["[1]", "{}", "{\"schema\": 3}", "{\"schema\": \"other/1\"}"] {
            let error = error_of(foreign);
            assert!(matches!(error, ReadError::WrongSchema { .. }), "{error}");
        }
        let error = error_of("[[[[]]]]").to_string();
        assert!(error.contains("it is no such document") && !error.contains("schema"), "{error}");
        assert!(error_of("{\"schema\": 3}").to_string().contains("its schema is no text"));
        let error = error_of(&format!("{{\"schema\": \"{}\"}}", "a ".repeat(1_000_000))).to_string();
        assert!(error.len() < 300 && error.contains("a a..."), "{error}");
        let error = error_of(&format!("{{\"schema\": \"{SCHEMA}\"}}")).to_string();
        assert!(error.contains("missing field \"") && !error.contains('`'), "{error}");

        assert!(matches!(error_of(&format!("{text}{text}")), ReadError::NotJson { .. }));

        let mut value = serde_json::to_value(example::full()).unwrap();
        value["runs"][0]["passes"][1]["gpu_ms"]["median"] = Value::from("fast");
        let error = error_of(&value.to_string());
        let expected = "runs[0].passes[1].gpu_ms.median";
        assert!(error.to_string().contains(expected), "{error}");
    }

    /// Of a file that quotes lines in a word of the schema, and in the name of a field.
    #[test]
    fn errors_are_one_line_whatever_they_quote() {
        let mut word = serde_json::to_value(example::full()).unwrap();
        word["environment"]["device"]["type"] = Value::from("x\nerror: y\u{1b}[2J");
        let mut name = serde_json::to_value(example::full()).unwrap();
        name["environment"]["host"]["variables"] = serde_json::json!({"x\nerror: y\u{1b}[2J": 1});
        for document in [word, name] {
            let error = error_of(&document.to_string()).to_string();
            assert!(!error.contains(char::is_control) && error.contains("x\\u000aerror: y\\u001b[2J"), "{error}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read(Path::new("/nowhere/some.json")).unwrap_err();
        assert!(error.to_string().contains("/nowhere/some.json"), "{error}");
    }
}

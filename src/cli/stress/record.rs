//! The record on the disk: written after every step, and gone on with by a second call.

use std::io::ErrorKind;
use std::path::PathBuf;

use serde_json::Value;

use super::super::failure::Failure;
use super::super::outcome;
use crate::file;
use crate::report::json;
use crate::report::stress::{SCHEMA, Series, StressRecord};

/// Longest record that is gone on with, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// The record's file.
pub struct File {
    path: PathBuf,
}

impl File {
    /// That of a path; it need not be there.
    pub fn new(path: PathBuf) -> Self {
        File { path }
    }

    /// The record that an earlier call left; none where there is no file, or all is to be measured anew.
    ///
    /// # Errors
    /// [`Failure::Input`] for a file that cannot be read or is no such record.
    pub fn left(&self, is_anew: bool) -> Result<Option<StressRecord>, Failure> {
        if is_anew {
            return Ok(None);
        }
        let path = self.path.display();
        let text = match file::read_text(&self.path, MAX_BYTES) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(Failure::Input(format!("going on with {path}: {e}; move it away, or use --anew"))),
        };
        if json::schema(&text).as_deref() != Some(SCHEMA) {
            let message =
                format!("going on with {path}: it is no record of stress; name another --json, or use --anew");
            return Err(Failure::Input(message));
        }
        Ok(Some(json::document(&text, &self.path)?))
    }

    /// The series of what was left, of the same steps as those of `template`.
    ///
    /// # Errors
    /// [`Failure::Input`] for a record of other steps.
    pub fn known(&self, left: Option<StressRecord>, template: &StressRecord) -> Result<Vec<Series>, Failure> {
        let path = self.path.display();
        let Some(record) = left else { return Ok(Vec::new()) };
        if record.identity != template.identity {
            let what = differences(&record, template);
            return Err(Failure::Input(format!(
                "going on with {path}: its steps differ in {what}; name another --json or --out, or use --anew"
            )));
        }
        if record.shard != template.shard {
            let message = format!("going on with {path}: it is of another --shard; name another --json or --out");
            return Err(Failure::Input(message));
        }
        Ok(record.series)
    }

    /// Writes the record in place of the one before.
    ///
    /// # Errors
    /// [`Failure::Running`] for a file that cannot be written.
    pub fn write(&self, record: &StressRecord) -> Result<(), Failure> {
        Ok(file::write(&self.path, outcome::text(record)?.as_bytes())?)
    }
}

/// Names of what fixes the steps and differs.
fn differences(a: &StressRecord, b: &StressRecord) -> String {
    let fields = |record: &StressRecord| {
        let mut fields = flat("", &serde_json::to_value(&record.settings).unwrap_or_default());
        fields.extend(flat("device", &serde_json::to_value(&record.environment.device).unwrap_or_default()));
        fields.extend(flat("host", &serde_json::to_value(&record.environment.host).unwrap_or_default()));
        fields.push(("the program".into(), record.environment.build.executable_sha256.clone().into()));
        fields.push(("the axes".into(), Value::from(format!("{:?}", (&record.axis, &record.across)))));
        fields
    };
    let (a, b) = (fields(a), fields(b));
    let of = |all: &[(String, Value)], name: &str| {
        all.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone())
    };
    let mut names: Vec<&String> = a.iter().chain(&b).map(|(name, _)| name).filter(|n| of(&a, n) != of(&b, n)).collect();
    names.dedup();
    names.sort();
    names.dedup();
    if names.is_empty() {
        "the machine".to_owned()
    } else {
        names.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// Fields of an object, those of objects in it under their own names.
fn flat(before: &str, value: &Value) -> Vec<(String, Value)> {
    let Value::Object(map) = value else { return Vec::new() };
    let named = |name: &String| if before.is_empty() { name.clone() } else { format!("{before} {name}") };
    map.iter()
        .flat_map(|(name, value)| match value {
            Value::Object(_) => flat(if name == "parameters" { "--" } else { name }, value)
                .into_iter()
                .map(|(name, value)| (name.replace("-- ", "--"), value))
                .collect(),
            other => vec![(named(name), other.clone())],
        })
        .collect()
}

//! Records of the shards of a measurement, put together: of `stress`, of `ab` and of experiments.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::super::failure::Failure;
use super::super::{outcome, stress};
use crate::file;
use crate::measure::compare::difference_of_machines;
use crate::measure::shard;
use crate::measure::stress::console::{Form, tables};
use crate::report::record::{Environment, Record};
use crate::report::stress::{SCHEMA, Series, StopKind, StressRecord};
use crate::report::{csv, environment, json};

/// Longest record, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Stands before a shard's number in the name of its record.
const MARK: &str = "-shard-";

/// The record of one shard.
enum Part {
    Stress(Box<StressRecord>),
    Bench(Box<Record>),
}

/// Records of the shards of one measurement.
pub struct Shards {
    /// Name of the whole's files.
    stem: String,
    /// Of the shards.
    count: u32,
    parts: BTreeMap<u32, (PathBuf, Part)>,
}

/// The measurements of folders, by their names.
///
/// # Errors
/// [`Failure::Input`] for what is no part, and for two records of one shard.
pub fn in_folders(folders: &[PathBuf]) -> Result<Vec<Shards>, Failure> {
    let mut found: BTreeMap<String, Shards> = BTreeMap::new();
    for folder in folders {
        for path in outcome::listed(folder)? {
            let Some(stem) = stem(&path) else { continue };
            let part = Part::read(&path)?;
            let Some([number, count]) = part.shard() else {
                let message = format!("assembling {}: it is the record of no shard; move it away", path.display());
                return Err(Failure::Input(message));
            };
            if number >= count || count > shard::MOST {
                return Err(Failure::Input(format!(
                    "assembling {}: it is of shard {number} of {count}, which is none; move it away",
                    path.display()
                )));
            }
            let shards = found.entry(stem.clone()).or_insert_with(|| Shards { stem, count, parts: BTreeMap::new() });
            let other = shards.parts.insert(number, (path.clone(), part));
            let (a, b) = (other.as_ref().map_or(folder, |(path, _)| path).display(), path.display());
            if other.is_some() {
                return Err(Failure::Input(format!("assembling {a} and {b}: both are shard {number}")));
            }
            if shards.count != count {
                let message = format!("assembling {a}: {b} is of {count} shards, and others of {}", shards.count);
                return Err(Failure::Input(message));
            }
        }
    }
    Ok(found.into_values().collect())
}

/// `ab-a-shard-2-of-5.json` is of `ab-a`.
fn stem(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.strip_suffix(".json")?;
    name.rsplit_once(MARK).map(|(stem, _)| stem.to_owned())
}

impl Part {
    fn read(path: &Path) -> Result<Self, Failure> {
        let unreadable = |e: std::io::Error| Failure::Input(format!("reading the part {}: {e}", path.display()));
        let text = file::read_text(path, MAX_BYTES).map_err(unreadable)?;
        Ok(match json::schema(&text).as_deref() {
            Some(SCHEMA) => Part::Stress(Box::new(json::document(&text, path)?)),
            _ => Part::Bench(Box::new(json::parse(&text, path)?)),
        })
    }

    fn shard(&self) -> Option<[u32; 2]> {
        match self {
            Part::Stress(record) => record.shard,
            Part::Bench(record) => record.share.as_ref()?.shard,
        }
    }

    fn environment(&self) -> &Environment {
        match self {
            Part::Stress(record) => &record.environment,
            Part::Bench(record) => &record.environment,
        }
    }

    /// False where a second call would go on.
    fn is_finished(&self) -> bool {
        let is_ended = |series: &Series| series.stop.as_ref().is_some_and(|stop| stop.kind != StopKind::Interruption);
        match self {
            Part::Stress(record) => record.series.iter().all(is_ended),
            Part::Bench(_) => true,
        }
    }

    /// The difference between the measurements that two parts are of; `None` where they are of the same one.
    fn difference(&self, other: &Part) -> Option<String> {
        if let Some([what, a, b]) = difference_of_machines(self.environment(), other.environment()) {
            return Some(format!("{what} is {a} and {b}"));
        }
        let is_same = match (self, other) {
            (Part::Stress(a), Part::Stress(b)) => {
                (&a.paper, &a.axis, &a.across, a.factor, &a.settings)
                    == (&b.paper, &b.axis, &b.across, b.factor, &b.settings)
            }
            (Part::Bench(a), Part::Bench(b)) => {
                a.share.as_ref().map(|share| &share.identity) == b.share.as_ref().map(|share| &share.identity)
            }
            _ => false,
        };
        (!is_same).then(|| "their settings differ".to_owned())
    }
}

impl Shards {
    /// Numbers of the shards whose record is not there, or was interrupted.
    ///
    /// # Errors
    /// [`Failure::Input`] for another number of shards.
    pub fn missing(&self, count: u32) -> Result<Vec<u32>, Failure> {
        if count != self.count {
            return Err(Failure::Input(format!(
                "--missing {count}: the records of {} are of {}",
                self.stem, self.count
            )));
        }
        let is_missing = |number: &u32| self.parts.get(number).is_none_or(|(_, part)| !part.is_finished());
        Ok((0..count).filter(is_missing).collect())
    }

    /// The files of the records.
    pub fn read(&self) -> impl Iterator<Item = PathBuf> {
        self.parts.values().map(|(path, _)| path.clone())
    }

    /// Joins the records, and writes the whole with its rows and plots.
    ///
    /// # Errors
    /// As [`joined`](Self::joined); a file that cannot be written.
    pub fn publish(self, out: &Path, is_quiet: bool) -> Result<(), Failure> {
        self.joined(out)?.publish(is_quiet)
    }

    /// Joins the records.
    ///
    /// # Errors
    /// [`Failure::Input`] for parts that are missing, or of other settings or machines.
    pub fn joined(self, out: &Path) -> Result<Joined, Failure> {
        let missing: Vec<String> = self.missing(self.count)?.iter().map(u32::to_string).collect();
        if !missing.is_empty() {
            let (stem, missing, count) = (&self.stem, missing.join(", "), self.count);
            return Err(Failure::Input(format!(
                "assembling {stem}: of {count} shards are missing {missing}; run them"
            )));
        }
        let mut parts = self.parts.values();
        if let Some((a, first)) = parts.next() {
            for (b, part) in parts {
                if let Some(difference) = first.difference(part) {
                    let (a, b) = (a.display(), b.display());
                    return Err(Failure::Input(format!(
                        "assembling {a} and {b}: {difference}; they are of two wholes"
                    )));
                }
            }
        }
        let [json, csv] = ["json", "csv"].map(|ending| out.join(format!("{}.{ending}", self.stem)));
        let (mut stress, mut bench) = (Vec::new(), Vec::new());
        for (path, part) in self.parts.into_values() {
            match part {
                Part::Stress(record) => stress.push((path, *record)),
                Part::Bench(record) => bench.push((path, *record)),
            }
        }
        let (mut files, mut printed) = (Vec::new(), String::new());
        if let Some(whole) = of_stress(stress)? {
            files.push((json, outcome::text(&whole)?));
            files.extend(stress::outcome_files(&whole, &self.stem, out, csv));
            printed = tables(&whole, Form::Console(outcome::style()));
        } else if let Some(whole) = of_bench(bench)? {
            files.push((json, outcome::text(&whole)?));
            files.push((csv, csv::to_string(&whole)));
        }
        Ok(Joined { files, printed })
    }
}

/// Records of all shards as one, still to be written.
pub struct Joined {
    files: Vec<(PathBuf, String)>,
    /// For standard output.
    printed: String,
}

impl Joined {
    /// The files that [`publish`](Self::publish) writes.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.files.iter().map(|(path, _)| path)
    }

    /// Writes the whole with its rows and plots.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn publish(&self, is_quiet: bool) -> Result<(), Failure> {
        if !is_quiet {
            outcome::print(&self.printed)?;
        }
        for (path, text) in &self.files {
            file::write(path, text.as_bytes())?;
            if !is_quiet {
                outcome::say(&format!("wrote {}", path.display()));
            }
        }
        Ok(())
    }
}

/// All series as one record: by variant in the order in which they were dealt out, then by second value.
fn of_stress(parts: Vec<(PathBuf, StressRecord)>) -> Result<Option<StressRecord>, Failure> {
    let Some(mut whole) = parts.first().map(|(_, record)| record.clone()) else { return Ok(None) };
    let least = parts.iter().flat_map(|(_, record)| &record.series).map(|series| series.across).min();
    let mut order: Vec<(usize, usize, String)> = Vec::new();
    for (number, (_, record)) in parts.iter().enumerate() {
        let of_row = record.series.iter().filter(|series| Some(series.across) == least);
        order.extend(of_row.enumerate().map(|(turn, series)| (turn, number, series.variant.clone())));
    }
    order.sort();
    let mut all: Vec<(PathBuf, Series)> = Vec::new();
    for (path, record) in parts {
        for series in record.series {
            let is_same =
                |(_, known): &&(PathBuf, Series)| (&known.variant, known.across) == (&series.variant, series.across);
            if let Some((other, _)) = all.iter().find(is_same) {
                let (a, b, variant) = (other.display(), path.display(), &series.variant);
                return Err(Failure::Input(format!("assembling {a} and {b}: both have the same series of {variant}")));
            }
            all.push((path.clone(), series));
        }
    }
    let place = |series: &Series| order.iter().position(|(.., variant)| *variant == series.variant);
    all.sort_by_key(|(_, series)| (place(series), series.across));
    whole.command = environment::command();
    whole.shard = None;
    whole.series = all.into_iter().map(|(_, series)| series).collect();
    Ok(Some(whole))
}

/// All runs as one record, in the order of what was shared out.
fn of_bench(parts: Vec<(PathBuf, Record)>) -> Result<Option<Record>, Failure> {
    let Some(mut whole) = parts.first().map(|(_, record)| record.clone()) else { return Ok(None) };
    let mut owners: BTreeMap<u32, PathBuf> = BTreeMap::new();
    let mut all = Vec::new();
    for (path, record) in parts {
        let items = record.share.map(|share| share.items).unwrap_or_default();
        if items.len() != record.runs.len() {
            let (items, runs) = (items.len(), record.runs.len());
            return Err(Failure::Input(format!(
                "assembling {}: it has {items} places for {runs} runs",
                path.display()
            )));
        }
        for (item, run) in items.into_iter().zip(record.runs) {
            let owner = owners.entry(item).or_insert_with(|| path.clone());
            if *owner != path {
                let (a, b) = (owner.display(), path.display());
                return Err(Failure::Input(format!("assembling {a} and {b}: both have measured number {item}")));
            }
            all.push((item, run));
        }
    }
    all.sort_by_key(|(item, _)| *item);
    whole.command = environment::command();
    if let Some(share) = &mut whole.share {
        share.shard = None;
        share.items = all.iter().map(|(item, _)| *item).collect();
    }
    whole.runs = all.into_iter().map(|(_, run)| run).collect();
    Ok(Some(whole))
}

//! Configurations of a record's runs: each is shown once, by its first process; runs of other processes are folded away
//! behind that.

use std::collections::{HashMap, HashSet};

use super::{method, name};
use crate::report::alternative::alternatives;
use crate::report::record::Run;

/// A run under the name that it has among the record's.
pub(super) struct Shown<'a> {
    /// The run in its record.
    pub run: &'a Run,
    /// Its anchor on the page.
    pub id: String,
    /// Its configuration's name, and which process it is.
    pub title: String,
}

/// The runs of one configuration.
pub(super) struct Configuration<'a> {
    /// Its name in the page's navigation.
    pub label: String,
    /// The run of the first process that measured it.
    pub first: Shown<'a>,
    /// The same by other processes.
    pub others: Vec<Shown<'a>>,
}

/// Each run of a record with its name, in their order.
pub(super) fn shown(runs: &[Run], record: usize) -> Vec<Shown<'_>> {
    let named = runs.iter().zip(alternatives(runs)).enumerate();
    let shown = named.map(|(at, (run, alternative))| {
        let process = if run.process > 0 { format!(", process {}", run.process) } else { String::new() };
        Shown { run, id: format!("run-{record}-{at}"), title: format!("{}{process}", name(run, &alternative)) }
    });
    shown.collect()
}

/// The configurations of a record in the order of their first runs. What one process measured twice is two.
pub(super) fn configurations(runs: &[Run], record: usize) -> Vec<Configuration<'_>> {
    let mut places: HashMap<_, usize> = HashMap::new();
    let mut found: Vec<Configuration> = vec![];
    for (shown, alternative) in shown(runs, record).into_iter().zip(alternatives(runs)) {
        let run = shown.run;
        let Run { paper, variant, preset, width, height, seed, frames, .. } = run;
        let config = serde_json::Value::from(run.config.clone()).to_string();
        let key = (paper, variant, preset, width, height, seed, frames, config);
        let place = *places.entry(key).or_insert(found.len());
        match found.get_mut(place) {
            Some(known) if known.first.run.process != run.process => known.others.push(shown),
            _ => found.push(Configuration { label: method(run, &alternative), first: shown, others: vec![] }),
        }
    }
    // What differs in its size alone is called by it.
    let (mut once, mut often) = (HashSet::new(), HashSet::new());
    for configuration in &found {
        if !once.insert(configuration.label.clone()) {
            often.insert(configuration.label.clone());
        }
    }
    for configuration in found.iter_mut().filter(|configuration| often.contains(&configuration.label)) {
        configuration.label = configuration.first.title.clone();
    }
    found
}

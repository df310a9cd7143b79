//! Matching of the runs of two sides, and the reasons why others may not be compared.
//!
//! Two runs are the same configuration when everything that fixes their work is equal: [`fields`]. The device's type
//! must be equal too. What else may shift a time (driver, CPU, build profile, ...) is a warning, as it may be what is
//! compared.

use std::collections::BTreeMap;

use serde_json::Value;

use super::Input;
use crate::report::record::{Record, Run};

/// Reasons why two sides cannot be compared.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    #[error("cannot compare: side {side} has no run; name at least one record with a finished run a side")]
    NoRun { side: &'static str },
    #[error(
        "cannot compare {a_name} with {b_name}: {field} is {a_value} in the first and {b_value} in the second; measure \
         both sides alike"
    )]
    Different { field: String, a_name: String, a_value: String, b_name: String, b_value: String },
}

/// The runs of one configuration on one side.
#[derive(Debug)]
pub(super) struct Configuration<'a> {
    fields: BTreeMap<String, String>,
    first: &'a Run,
    source: &'a str,
    /// Runs of one process, process after process.
    processes: Vec<Vec<&'a Run>>,
}

impl<'a> Configuration<'a> {
    /// The first run.
    pub fn first(&self) -> &'a Run {
        self.first
    }

    /// All runs, process after process.
    pub fn runs(&self) -> impl Iterator<Item = &'a Run> {
        self.processes.iter().flatten().copied()
    }

    /// One time's samples for every process that has any; runs of the same process follow each other.
    pub fn samples(&self, time: impl Fn(&Run) -> Option<Vec<f64>>) -> Vec<Vec<f64>> {
        let processes = self.processes.iter();
        let samples = processes.map(|runs| runs.iter().filter_map(|run| time(run)).flatten());
        samples.map(Iterator::collect::<Vec<f64>>).filter(|samples| !samples.is_empty()).collect()
    }

    fn name(&self) -> String {
        let preset = self.first.preset.as_ref();
        let preset = preset.map_or_else(String::new, |preset| format!(", {preset}"));
        format!(
            "{} {}{preset}, {} × {} ({})",
            self.first.paper, self.first.variant, self.first.width, self.first.height, self.source
        )
    }
}

#[derive(Debug)]
pub(super) struct Matched<'a> {
    /// Configurations of A and B with equal fields.
    pub pairs: Vec<(Configuration<'a>, Configuration<'a>)>,
    /// Names of variants that B lacks.
    pub only_in_a: Vec<String>,
    /// Names of variants that A lacks.
    pub only_in_b: Vec<String>,
    /// Doubts about the comparison, one line each.
    pub warnings: Vec<String>,
}

/// Pairs the configurations of both sides, in the order of A.
///
/// A variant that one side lacks altogether is listed; a variant that both sides have, but measured differently, is an
/// error, as is having nothing in common.
pub(super) fn match_runs<'a>(a: &'a [Input], b: &'a [Input]) -> Result<Matched<'a>, CompareError> {
    let mut warnings = check_environments(a, b)?;
    let a = configurations("A", a, &mut warnings)?;
    let mut b = configurations("B", b, &mut warnings)?;
    let (mut pairs, mut alone) = (vec![], vec![]);
    for configuration in a {
        match b.iter().position(|other| other.fields == configuration.fields) {
            Some(index) => pairs.push((configuration, b.remove(index))),
            None => alone.push(configuration),
        }
    }
    for configuration in &alone {
        let variant = |c: &Configuration| (c.first.paper.clone(), c.first.variant.clone());
        let nearest = b
            .iter()
            .filter(|other| pairs.is_empty() || variant(other) == variant(configuration))
            .min_by_key(|other| differences(configuration, other).len());
        if let Some(other) = nearest {
            return Err(different(configuration, other));
        }
    }
    Ok(Matched {
        pairs,
        only_in_a: alone.iter().map(Configuration::name).collect(),
        only_in_b: b.iter().map(Configuration::name).collect(),
        warnings,
    })
}

fn configurations<'a>(
    side: &'static str,
    inputs: &'a [Input],
    warnings: &mut Vec<String>,
) -> Result<Vec<Configuration<'a>>, CompareError> {
    let mut found: Vec<Configuration> = vec![];
    for input in inputs {
        let mut here: Vec<(BTreeMap<String, String>, u32, Vec<&Run>)> = vec![];
        for run in &input.record.runs {
            let fields = fields(run);
            let known = here.iter_mut().find(|(known, process, _)| *known == fields && *process == run.process);
            match known {
                Some((_, _, runs)) => runs.push(run),
                None => here.push((fields, run.process, vec![run])),
            }
        }
        for (fields, _, runs) in here {
            let index = found.iter().position(|known| known.fields == fields);
            let index = index.unwrap_or_else(|| {
                found.push(Configuration { fields, first: runs[0], source: &input.name, processes: vec![] });
                found.len() - 1
            });
            let processes = &mut found[index].processes;
            // The same measurement twice is not two processes: it would make an interval of nothing.
            if processes.iter().any(|known| same_measurement(known, &runs)) {
                let message =
                    format!("side {side}: {} repeats the samples of another process and is counted once", input.name);
                if !warnings.contains(&message) {
                    warnings.push(message);
                }
            } else {
                processes.push(runs);
            }
        }
    }
    if found.is_empty() {
        return Err(CompareError::NoRun { side });
    }
    Ok(found)
}

fn same_measurement(a: &[&Run], b: &[&Run]) -> bool {
    let samples = |runs: &[&Run]| -> Vec<f64> {
        let frames = runs.iter().filter_map(|run| run.frame_ms.as_ref());
        frames.flat_map(|frame| frame.samples.clone()).collect()
    };
    let samples_of_a = samples(a);
    !samples_of_a.is_empty() && samples_of_a == samples(b)
}

/// Everything that fixes the work of a run, by the field's path in the record.
fn fields(run: &Run) -> BTreeMap<String, String> {
    let text = |value: &str| Value::from(value).to_string();
    let preset = run.preset.as_deref();
    let fixed = [
        ("paper", text(&run.paper)),
        ("variant", text(&run.variant)),
        ("preset", preset.map_or_else(|| "absent".to_owned(), text)),
        ("width", run.width.to_string()),
        ("height", run.height.to_string()),
        ("seed", run.seed.to_string()),
        ("frames", run.frames.to_string()),
        ("validation", text(run.validation.name())),
    ];
    let config = run.config.iter();
    fixed
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .chain(config.map(|(name, value)| (format!("config.{name}"), value.to_string())))
        .collect()
}

/// Names of the fields that differ, the telling ones first.
fn differences(a: &Configuration, b: &Configuration) -> Vec<String> {
    let names = a.fields.keys().chain(b.fields.keys());
    let mut different: Vec<String> = names.filter(|name| a.fields.get(*name) != b.fields.get(*name)).cloned().collect();
    let rank = |name: &str| {
        let telling = ["paper", "variant", "preset"];
        telling.iter().position(|known| *known == name).unwrap_or(3)
    };
    different.sort_by(|x, y| rank(x).cmp(&rank(y)).then_with(|| x.cmp(y)));
    different.dedup();
    different
}

fn different(a: &Configuration, b: &Configuration) -> CompareError {
    let field = differences(a, b).into_iter().next().unwrap_or_default();
    let value = |c: &Configuration| c.fields.get(&field).cloned();
    let absent = || "absent".to_owned();
    CompareError::Different {
        a_name: a.source.to_owned(),
        a_value: value(a).unwrap_or_else(absent),
        b_name: b.source.to_owned(),
        b_value: value(b).unwrap_or_else(absent),
        field,
    }
}

/// Compares every record's environment with the first one's.
fn check_environments(a: &[Input], b: &[Input]) -> Result<Vec<String>, CompareError> {
    let mut inputs = a.iter().chain(b);
    let Some(first) = inputs.next() else {
        return Err(CompareError::NoRun { side: "A" });
    };
    let expected = conditions(&first.record);
    let mut warnings: Vec<(&str, String)> = vec![];
    for input in inputs {
        let device = |input: &Input| input.record.environment.device.kind.name().to_owned();
        if device(input) != device(first) {
            return Err(CompareError::Different {
                field: "environment.device.type".to_owned(),
                a_name: first.name.clone(),
                a_value: device(first),
                b_name: input.name.clone(),
                b_value: device(input),
            });
        }
        for ((name, expected), (_, found)) in expected.iter().zip(conditions(&input.record)) {
            let known = warnings.iter().any(|(known, _)| known == name);
            if *expected != found && !known {
                let message = format!("{name} is {expected} in {} and {found} in {}", first.name, input.name);
                warnings.push((name, message));
            }
        }
    }
    Ok(warnings.into_iter().map(|(_, message)| message).collect())
}

fn conditions(record: &Record) -> [(&'static str, Value); 8] {
    let environment = &record.environment;
    let (device, host) = (&environment.device, &environment.host);
    [
        ("device.name", Value::from(device.name.as_str())),
        ("device.driver_version", Value::from(device.driver_version.clone())),
        ("host.os", Value::from(host.os.as_str())),
        ("host.cpu", Value::from(host.cpu.clone())),
        ("host.logical_cores", Value::from(host.logical_cores)),
        ("host.lp_num_threads", Value::from(host.lp_num_threads)),
        ("layers", Value::from(environment.layers.clone())),
        ("build.profile", Value::from(environment.build.profile.clone())),
    ]
}

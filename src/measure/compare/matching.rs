//! Matching of the runs of two sides, and the reasons why others may not be compared.
//!
//! Two runs are the same configuration when everything that fixes their work is equal: [`fields`]. Input files count by
//! their content, whatever their path. What else may shift a time (device, driver, program, shaders, ...) may be what is
//! compared: [`super::conditions`] lists it.

use std::collections::{BTreeMap, HashMap, HashSet};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{Clock, Design, Input};
use crate::report::alternative::alternatives;
use crate::report::record::Run;

/// Reasons why two sides cannot be compared.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    #[error("cannot compare: side {side} has no run; name at least one record with a finished run a side")]
    NoRun {
        /// Name of the side, `A` or `B`.
        side: &'static str,
    },
    #[error("cannot compare: a sample of {time} in {name} is {sample} ms; no time is negative, measure it again")]
    Negative {
        /// Record that holds the sample.
        name: String,
        /// Description of the time: `the frame` or a pass, with paper and variant.
        time: String,
        /// The sample, milliseconds.
        sample: String,
    },
    #[error(
        "cannot compare {a_name} with {b_name}: {field} is {a_value} in the first and {b_value} in the second; measure \
         both sides alike"
    )]
    Different {
        /// Name of the field that differs; a parameter's own name.
        field: String,
        /// Record of side A.
        a_name: String,
        /// Value in A; `absent` where it has none.
        a_value: String,
        /// Record of side B.
        b_name: String,
        /// Value in B; `absent` where it has none.
        b_value: String,
    },
    #[error(
        "cannot compare blocks of {name}: the processes of the sides are not of the same blocks, two of each side in every \
         one; name ab-a.json and ab-b.json of one folder"
    )]
    Blocks {
        /// Name of the configuration.
        name: String,
    },
}

/// Milliseconds of the host's clock: times are taken in nanoseconds. No clock is taken to be finer.
const HOST_TICK_MS: f64 = 1e-6;

/// The runs of one configuration on one side.
#[derive(Debug)]
pub(super) struct Configuration<'a> {
    fields: BTreeMap<String, String>,
    first: &'a Run,
    source: &'a str,
    /// Parameters that tell it from others of its paper, variant and preset, as in [`alternatives`].
    pub alternative: String,
    /// Milliseconds of one step of a timestamp, on the device where it is longest; 0 where none tells.
    timestamp_ms: f64,
    /// Runs of one process, process after process.
    processes: Vec<Vec<&'a Run>>,
}

impl<'a> Configuration<'a> {
    /// Paper and variant.
    fn method(&self) -> (&'a str, &'a str) {
        (&self.first.paper, &self.first.variant)
    }

    /// The first run.
    pub fn first(&self) -> &'a Run {
        self.first
    }

    /// Start of each process's first run, RFC 3339; absent where a record does not say.
    pub fn started(&self) -> Option<Vec<&'a str>> {
        self.processes.iter().map(|runs| runs.first()?.started.as_deref()).collect()
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

    /// Milliseconds of one step of a clock, as far as records tell.
    pub fn tick_ms(&self, clock: Clock) -> f64 {
        match clock {
            Clock::Gpu => self.timestamp_ms.max(HOST_TICK_MS),
            Clock::Host | Clock::Wait => HOST_TICK_MS,
        }
    }

    /// Number of each process, in their order.
    pub fn process_numbers(&self) -> Vec<u32> {
        self.processes.iter().filter_map(|runs| Some(runs.first()?.process)).collect()
    }

    /// Paper, variant, preset, what tells it from others of these, size and file.
    pub fn name(&self) -> String {
        let Run { paper, variant, width, height, .. } = self.first;
        let preset = self.first.preset.as_ref();
        let preset = preset.map_or_else(String::new, |preset| format!(", {preset}"));
        format!("{paper} {variant}{preset}{}, {width} × {height} ({})", self.alternative, self.source)
    }
}

/// Refuses times below zero.
pub(super) fn check_samples(input: &Input) -> Result<(), CompareError> {
    for run in &input.record.runs {
        let of_passes = run.passes.iter().flat_map(|pass| {
            [&pass.gpu_ms, &pass.host_ms, &pass.wait_ms].map(|time| (pass.name.as_str(), time.as_ref()))
        });
        for (time, summary) in std::iter::once(("the frame", run.frame_ms.as_ref())).chain(of_passes) {
            let samples = summary.map_or(&[][..], |summary| &summary.samples);
            if let Some(sample) = samples.iter().find(|sample| **sample < 0.0) {
                let time = format!("{time} of {} {}", run.paper, run.variant);
                return Err(CompareError::Negative { name: input.name.clone(), time, sample: sample.to_string() });
            }
        }
    }
    Ok(())
}

#[derive(Debug)]
pub(super) struct Matched<'a> {
    /// Configurations of A and B with equal fields.
    pub pairs: Vec<(Configuration<'a>, Configuration<'a>)>,
    /// Names of variants that B lacks.
    pub only_in_a: Vec<String>,
    /// Names of variants that A lacks.
    pub only_in_b: Vec<String>,
    /// Parameters that differ within pairs.
    pub differences: Vec<Difference>,
    /// Doubts about the comparison, one line each.
    pub warnings: Vec<String>,
}

/// Pairs the configurations of both sides, in the order of A.
///
/// A variant that one side lacks altogether is listed; a variant that both sides have, but measured differently, is an
/// error, as is having nothing in common.
pub(super) fn match_runs<'a>(a: &'a [Input], b: &'a [Input]) -> Result<Matched<'a>, CompareError> {
    let mut warnings = Vec::new();
    let a = configurations("A", a, Design::Processes, &mut warnings)?;
    let b = configurations("B", b, Design::Processes, &mut warnings)?;
    let places = places(&b);
    let mut b: Vec<Option<Configuration>> = b.into_iter().map(Some).collect();
    let (mut pairs, mut alone) = (vec![], vec![]);
    for configuration in a {
        match places.get(&configuration.fields).and_then(|of| b[*of].take()) {
            Some(other) => pairs.push((configuration, other)),
            None => alone.push(configuration),
        }
    }
    let b: Vec<Configuration> = b.into_iter().flatten().collect();
    let methods: HashSet<_> = b.iter().map(Configuration::method).collect();
    let conflict = alone.iter().find(|one| pairs.is_empty() || methods.contains(&one.method()));
    if let Some(configuration) = conflict {
        let nearest = b
            .iter()
            .filter(|other| pairs.is_empty() || other.method() == configuration.method())
            .min_by_key(|other| differences(configuration, other).len());
        if let Some(other) = nearest {
            return Err(different(configuration, other));
        }
    }
    Ok(Matched {
        pairs,
        only_in_a: alone.iter().map(Configuration::name).collect(),
        only_in_b: b.iter().map(Configuration::name).collect(),
        differences: Vec::new(),
        warnings,
    })
}

/// Pairs configurations of A with those of B, the least different first and equal variants before others, and lists in which
/// parameters they differ. In the order of A.
pub(super) fn match_nearest<'a>(a: &'a [Input], b: &'a [Input]) -> Result<Matched<'a>, CompareError> {
    let mut warnings = Vec::new();
    let a = configurations("A", a, Design::Blocks, &mut warnings)?;
    let b = configurations("B", b, Design::Blocks, &mut warnings)?;
    let places = places(&b);
    let mut partners: Vec<Option<usize>> = a.iter().map(|one| places.get(&one.fields).copied()).collect();
    let mut taken = vec![false; b.len()];
    partners.iter().flatten().for_each(|of| taken[*of] = true);
    // Equal ones are nearest; only what is left is looked at by twos.
    let others: Vec<usize> = (0..b.len()).filter(|of| !taken[*of]).collect();
    let distance = |at: usize, of: usize| {
        let (one, other): (&Configuration, &Configuration) = (&a[at], &b[of]);
        (one.method() != other.method(), differences(one, other).len(), at, of)
    };
    let alone = (0..a.len()).filter(|at| partners[*at].is_none());
    let mut distances: Vec<_> = alone.flat_map(|at| others.iter().map(move |of| distance(at, *of))).collect();
    distances.sort_unstable();
    for (_, _, at, of) in distances {
        if partners[at].is_none() && !taken[of] {
            (partners[at], taken[of]) = (Some(of), true);
        }
    }
    let mut b: Vec<Option<Configuration>> = b.into_iter().map(Some).collect();
    let (mut pairs, mut only_in_a, mut listed) = (vec![], vec![], vec![]);
    for (configuration, partner) in a.into_iter().zip(partners) {
        let Some(other) = partner.and_then(|of| b[of].take()) else {
            only_in_a.push(configuration.name());
            continue;
        };
        let value = |side: &Configuration, field: &str| side.fields.get(field).cloned().into_iter().collect::<Vec<_>>();
        let differing = differences(&configuration, &other).into_iter().map(|field| Difference {
            a: value(&configuration, &field),
            b: value(&other, &field),
            what: field,
        });
        listed.extend(differing.filter(|difference| !listed.contains(difference)).collect::<Vec<_>>());
        pairs.push((configuration, other));
    }
    let only_in_b = b.iter().flatten().map(Configuration::name).collect();
    Ok(Matched { pairs, only_in_a, only_in_b, differences: listed, warnings })
}

fn configurations<'a>(
    side: &'static str,
    inputs: &'a [Input],
    design: Design,
    warnings: &mut Vec<String>,
) -> Result<Vec<Configuration<'a>>, CompareError> {
    let mut found: Vec<Configuration> = vec![];
    let mut places: HashMap<BTreeMap<String, String>, usize> = HashMap::new();
    let mut measured: HashSet<(usize, Vec<u64>)> = HashSet::new();
    for input in inputs {
        let mut here: Vec<(usize, Vec<&Run>)> = vec![];
        let mut known: HashMap<(usize, u32), usize> = HashMap::new();
        for run in &input.record.runs {
            let index = *places.entry(fields(run)).or_insert_with_key(|fields| {
                let (fields, source) = (fields.clone(), input.name.as_str());
                let (alternative, timestamp_ms, processes) = (String::new(), 0.0, vec![]);
                found.push(Configuration { fields, first: run, source, alternative, timestamp_ms, processes });
                found.len() - 1
            });
            let place = *known.entry((index, run.process)).or_insert(here.len());
            match here.get_mut(place) {
                Some((_, runs)) => runs.push(run),
                None => here.push((index, vec![run])),
            }
        }
        for (index, runs) in here {
            let Configuration { processes, timestamp_ms, .. } = &mut found[index];
            let period_ns = input.record.environment.device.timestamp_period.unwrap_or(0.0);
            *timestamp_ms = timestamp_ms.max(period_ns * 1e-6);
            // The same measurement twice is not two processes: it would make an interval of nothing. In blocks the
            // numbers of processes tell.
            let mut is_repeated = || {
                let samples = sample_bits(&runs);
                !samples.is_empty() && !measured.insert((index, samples))
            };
            if design == Design::Processes && is_repeated() {
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
    let names = alternatives(found.iter().map(|configuration| configuration.first));
    found.iter_mut().zip(names).for_each(|(configuration, name)| configuration.alternative = name);
    Ok(found)
}

/// The place of each configuration on its side; no two are equal.
fn places(side: &[Configuration]) -> HashMap<BTreeMap<String, String>, usize> {
    side.iter().enumerate().map(|(at, configuration)| (configuration.fields.clone(), at)).collect()
}

/// The frames' times, alike for those that are equal.
fn sample_bits(runs: &[&Run]) -> Vec<u64> {
    // Zero has two signs, of which the sum has none.
    runs.iter().flat_map(|run| run.frame_samples()).map(|sample| (sample + 0.0).to_bits()).collect()
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
        ("validation", text(run.validation.as_str())),
    ];
    let config = run.config.iter().map(|(name, value)| (format!("config.{name}"), by_content(value, run).to_string()));
    // Also of a file that the parameters tell by something else than its path.
    let mut contents: Vec<&str> = run.inputs.iter().map(|file| file.sha256.as_str()).collect();
    contents.sort_unstable();
    let inputs = ("inputs".to_owned(), Value::from(contents).to_string());
    fixed.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(config).chain([inputs]).collect()
}

/// A parameter's value with the content of files in place of their paths, of which a number of triangles (`:N`) or a place
/// (`@X,Y,Z`) may follow.
fn by_content(value: &Value, run: &Run) -> Value {
    match value {
        Value::String(text) => {
            let rest =
                |path: &str| text.strip_prefix(path).filter(|rest| rest.is_empty() || rest.starts_with([':', '@']));
            let found = run.inputs.iter().filter_map(|file| Some((file, rest(&file.path)?)));
            let longest = found.min_by_key(|(_, rest)| rest.len());
            longest.map_or_else(|| value.clone(), |(file, rest)| format!("sha256:{}{rest}", file.sha256).into())
        }
        Value::Array(items) => items.iter().map(|item| by_content(item, run)).collect(),
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), by_content(value, run))).collect::<Map<_, _>>().into()
        }
        other => other.clone(),
    }
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

/// Something that is not the same on both sides: what the comparison is about, or what disturbs it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Difference {
    /// Path in the record.
    pub what: String,
    /// Each value that the records of side A have, once.
    pub a: Vec<String>,
    /// Those of side B.
    pub b: Vec<String>,
}

/// The commands of a side's records, each once.
pub(super) fn commands(side: &[Input]) -> Vec<Vec<String>> {
    let mut commands: Vec<Vec<String>> = vec![];
    for command in side.iter().map(|input| &input.record.command).filter(|command| !command.is_empty()) {
        if !commands.contains(command) {
            commands.push(command.clone());
        }
    }
    commands
}

//! Verdicts on B against A, same, faster or slower, for the frame and for every pass.
//!
//! Runs are matched by what was measured (`matching.rs`); each record, and each process inside one, is one process of
//! its side and gives one number for every time: the logarithm of its median. What these say of the ratio B / A is
//! [evidence](Evidence), and the frame with all its passes is one family of quantities on which it is [decided](decide):
//!
//! - `SAME`: the ratio lies within the margin of 1, or both sides hold the very same samples;
//! - `SLOWER`, `FASTER`: it lies above or below 1, and not certainly within the margin;
//! - `UNCLEAR`: anything else, and always when a side has one process only: how much processes differ is then unknown.

mod console;
mod decision;
mod doubts;
mod evidence;
mod matching;
#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trials;
mod within;

pub use console::{markdown, render, sections};
pub use decision::{CONFIDENCE, Gate, Rules, SAME_MARGIN, Verdict, decide, gate, needed};
pub use evidence::Evidence;
pub use matching::{CompareError, Difference, difference_of_machines};
pub use within::{Ratio, ratio_within_process};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::statistics::median;
use crate::report::environment;
use crate::report::record::{Record, Run};
use matching::{Configuration, commands};

/// The value of [`Comparison::schema`].
pub const SCHEMA: &str = "fumarole.compare/2";

/// Numbers of blocks after which sides that are measured in turn are compared, each time with an equal part of the error:
/// looking after every block would find differences where there are none.
pub const LOOKS: [usize; 4] = [5, 10, 20, 40];

/// Processes a side, or blocks, beyond which none are recommended.
const MOST_PROCESSES: usize = 1000;

/// A record and the file it came from, which messages name.
#[derive(Clone, Debug)]
pub struct Input {
    /// Path of the file.
    pub name: String,
    /// Its contents.
    pub record: Record,
}

/// Order in which the sides were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Design {
    /// In any order: processes are compared by Welch's t-test.
    Processes,
    /// In blocks A B B A: the differences of blocks are compared by signed ranks.
    Blocks,
}

/// Rules of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Margin and error of the verdicts.
    pub rules: Rules,
    /// Fraction by which B may be slower: 0.05 is 5 %.
    pub fail_above: Option<f64>,
    /// Fraction of the frame's time from which on a pass is held against `fail_above`, on the side where it is greater.
    pub min_share: f64,
    /// Order of the measurement.
    pub design: Design,
}

impl Default for Options {
    fn default() -> Self {
        Options { rules: Rules::default(), fail_above: None, min_share: MIN_SHARE, design: Design::Processes }
    }
}

impl Options {
    /// These for sides that were measured in blocks. `ab` measures until it has decided, so that each of its [`LOOKS`] has a
    /// part of the error; parts of many machines have a number of blocks that was fixed beforehand, and are looked at once.
    pub fn for_blocks(mut self, a: &[Input], b: &[Input]) -> Self {
        self.design = Design::Blocks;
        if !a.iter().chain(b).all(|input| input.record.share.is_some()) {
            self.rules.error /= LOOKS.len() as f64;
        }
        self
    }
}

/// [`Options::min_share`] of those that name none.
pub const MIN_SHARE: f64 = 0.02;

/// The outcome, as written by `--json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// [`SCHEMA`].
    pub schema: String,
    /// Files of each side.
    pub a: Vec<String>,
    /// Files of side B.
    pub b: Vec<String>,
    /// The command line that compared, program name first; empty in what older programs wrote.
    #[serde(default)]
    pub command: Vec<String>,
    /// The command lines that measured A, each once.
    #[serde(default)]
    pub a_commands: Vec<Vec<String>>,
    /// The command lines that measured B, each once.
    #[serde(default)]
    pub b_commands: Vec<Vec<String>>,
    /// Order of the measurement, which decides the test.
    pub design: Design,
    /// Probability with which an interval holds the true ratio, 0 to 1.
    pub confidence: f64,
    /// The margin in use, as a fraction.
    pub margin: f64,
    /// Fraction by which B may be slower than A; absent without `--fail-above`.
    pub fail_above: Option<f64>,
    /// Fraction of the frame from which on a pass is held against it.
    pub min_share: f64,
    /// Differences between the sides beside their times.
    pub differences: Vec<Difference>,
    /// In the order of A.
    pub runs: Vec<RunComparison>,
    /// Runs that the other side does not have.
    pub only_in_a: Vec<String>,
    /// Runs that A does not have.
    pub only_in_b: Vec<String>,
    /// Doubts about the comparison, one line each.
    pub warnings: Vec<String>,
}

impl Comparison {
    /// Everything that was compared: of each run the frame, then the passes.
    pub fn quantities(&self) -> impl Iterator<Item = &Quantity> {
        self.runs.iter().flat_map(RunComparison::quantities)
    }

    /// True when a frame or a pass lies beyond `fail_above`.
    pub fn has_regression(&self) -> bool {
        self.quantities().any(|quantity| quantity.gate == Some(Gate::Failed))
    }

    /// True when a frame, or a pass whose share counts, is not decided: against `fail_above`, or without it at all.
    pub fn is_unclear(&self) -> bool {
        self.quantities().filter(|quantity| quantity.counts).any(|quantity| match self.fail_above {
            Some(_) => quantity.gate.is_none_or(|gate| gate == Gate::Undecided),
            None => quantity.verdict == Verdict::Unclear,
        })
    }

    /// True when B lacks a run or a pass of A.
    pub fn is_missing_any(&self) -> bool {
        !self.only_in_a.is_empty() || self.runs.iter().any(|run| !run.missing_passes.is_empty())
    }
}

/// One configuration, measured on both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunComparison {
    /// Name of the paper's command.
    pub paper: String,
    /// Name of the variant.
    pub variant: String,
    /// Name of the preset; absent without one.
    pub preset: Option<String>,
    /// Every parameter under its option's name, as A has it.
    pub config: Map<String, Value>,
    /// Pixels of the picture.
    pub width: u32,
    /// Pixels of the picture.
    pub height: u32,
    /// Distinct processes of A that timed the frame.
    pub a_processes: usize,
    /// Distinct processes of B that timed the frame.
    pub b_processes: usize,
    /// Time of the whole frame on the host's clock.
    pub frame: Quantity,
    /// In the order of A, then what only B has.
    pub passes: Vec<PassComparison>,
    /// Passes of A that B lacks.
    pub missing_passes: Vec<String>,
}

impl RunComparison {
    fn quantities(&self) -> impl Iterator<Item = &Quantity> {
        std::iter::once(&self.frame).chain(self.passes.iter().map(|pass| &pass.time))
    }
}

/// One time of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassComparison {
    /// Name of the pass.
    pub name: String,
    /// Clock that timed it.
    pub clock: Clock,
    /// Its verdict.
    #[serde(flatten)]
    pub time: Quantity,
}

/// Clock of a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Clock {
    /// Time stamps of the device.
    Gpu,
    /// Work of the host, without waiting.
    Host,
    /// Waiting of the host for the device.
    Wait,
}

/// A time on both sides, their ratio and the verdict on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Geometric mean of the processes' medians; absent where A has no such time.
    pub a_median_ms: Option<f64>,
    /// Absent where B has no such time.
    pub b_median_ms: Option<f64>,
    /// B / A, below 1 where B is faster; by signed ranks the median ratio of the blocks.
    pub ratio: Option<f64>,
    /// Lower and upper end; absent where too little was measured for one.
    pub interval: Option<[f64; 2]>,
    /// Fraction of the frame's time, on the side where it is greater.
    pub share: Option<f64>,
    /// The frame, or a pass of at least `min_share`.
    pub counts: bool,
    /// The verdict.
    pub verdict: Verdict,
    /// Reason of a verdict that is not clear.
    pub reason: Option<String>,
    /// Standing against `fail_above`; absent without it, and for what does not count or has no verdict.
    pub gate: Option<Gate>,
}

/// Compares side B with side A.
///
/// # Errors
/// A side has no record or no run, or the sides were not measured alike; the message names the field that differs.
pub fn compare(a: &[Input], b: &[Input], options: &Options) -> Result<Comparison, CompareError> {
    a.iter().chain(b).try_for_each(check_samples)?;
    let mut options = *options;
    // Sides in turn may do different work on purpose; that is then what is compared.
    let mut matched = match options.design {
        Design::Processes => matching::match_runs(a, b)?,
        Design::Blocks => matching::match_nearest(a, b)?,
    };
    // What fails is not called the same.
    if let Some(limit) = options.fail_above {
        options.rules.margin = options.rules.margin.min(limit);
    }
    let names = |side: &[Input]| side.iter().map(|input| input.name.clone()).collect();
    if options.design == Design::Processes {
        matched.warnings.extend(matched.pairs.iter().filter_map(|(a, b)| order_warning(a, b)).next());
    }
    Ok(Comparison {
        schema: SCHEMA.to_owned(),
        a: names(a),
        b: names(b),
        command: environment::command(),
        a_commands: commands(a),
        b_commands: commands(b),
        design: options.design,
        confidence: 1.0 - options.rules.error,
        margin: options.rules.margin,
        fail_above: options.fail_above,
        min_share: options.min_share,
        differences: [matched.differences, matching::differences_between(a, b)].concat(),
        runs: matched.pairs.iter().map(|(a, b)| compare_run(a, b, &options)).collect(),
        only_in_a: matched.only_in_a,
        only_in_b: matched.only_in_b,
        warnings: [matched.warnings, doubts::of_runs(a, b)].concat(),
    })
}

/// Refuses times below zero.
fn check_samples(input: &Input) -> Result<(), CompareError> {
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

/// A doubt about sides of which one was measured wholly before the other: drift then looks like a difference.
fn order_warning(a: &Configuration, b: &Configuration) -> Option<String> {
    let (Some(a), Some(b)) = (a.started(), b.started()) else {
        return Some("the records do not say when each process ran: drift may look like a difference".to_owned());
    };
    let ends = |side: &[&str]| Some((side.iter().min()?.to_string(), side.iter().max()?.to_string()));
    let (a, b) = (ends(&a)?, ends(&b)?);
    let is_apart = a.0 != b.0 && (a.1 < b.0 || b.1 < a.0);
    is_apart.then(|| {
        "one side was measured wholly before the other, so that drift looks like a difference: measure them in turn with \
         ab"
        .to_owned()
    })
}

/// The times of one quantity, process after process of each side.
struct Times {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
}

impl Times {
    /// Both sides hold the same processes' samples, in any order of the processes: they are one measurement.
    fn are_identical(&self) -> bool {
        !self.a.is_empty() && self.a.len() == self.b.len() && self.a.iter().all(|samples| self.b.contains(samples))
    }

    fn evidence(&self, design: Design) -> Option<Evidence> {
        let (a, b) = (log_medians(&self.a)?, log_medians(&self.b)?);
        match design {
            Design::Processes => Evidence::welch(&a, &b),
            Design::Blocks => {
                let means =
                    |side: &[f64]| side.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
                let blocks = means(&b).iter().zip(means(&a)).map(|(b, a)| b - a).collect::<Vec<_>>();
                (a.len() == b.len()).then(|| Evidence::signed_ranks(&blocks)).flatten()
            }
        }
    }

    /// Processes of the side with fewer, or blocks.
    fn count(&self, design: Design) -> usize {
        let processes = self.a.len().min(self.b.len());
        if design == Design::Blocks { processes / 2 } else { processes }
    }
}

/// Logarithm of each process's median; absent where one is not positive.
fn log_medians(side: &[Vec<f64>]) -> Option<Vec<f64>> {
    side.iter().map(|samples| median(samples).filter(|median| *median > 0.0).map(f64::ln)).collect()
}

/// Of times near the ends of what a number holds a ratio may be none.
fn finite(ratio: f64) -> Option<f64> {
    Some(ratio).filter(|ratio| ratio.is_finite())
}

fn geometric_mean(side: &[Vec<f64>]) -> Option<f64> {
    let logs = log_medians(side).filter(|logs| !logs.is_empty())?;
    Some((logs.iter().sum::<f64>() / logs.len() as f64).exp())
}

fn compare_run(a: &Configuration, b: &Configuration, options: &Options) -> RunComparison {
    let times = |time: &dyn Fn(&Run) -> Option<Vec<f64>>| Times { a: a.samples(time), b: b.samples(time) };
    let frame = times(&|run| run.frame_ms.as_ref().map(|time| time.samples.clone()));
    let passes = pass_times(a, b);
    let of_frame = |pass: &Times| {
        let share = |pass, frame| finite(geometric_mean(pass)? / geometric_mean(frame)?);
        let shares = [share(&pass.a, &frame.a), share(&pass.b, &frame.b)];
        shares.into_iter().flatten().max_by(f64::total_cmp)
    };
    let shares: Vec<Option<f64>> =
        std::iter::once(Some(1.0)).chain(passes.iter().map(|(_, _, times)| of_frame(times))).collect();
    let family: Vec<&Times> = std::iter::once(&frame).chain(passes.iter().map(|(_, _, times)| times)).collect();
    let mut quantities = judge(&family, &shares, options).into_iter();
    let has = |side: &Configuration, name: &str| side.runs().any(|run| run.passes.iter().any(|pass| pass.name == name));
    let names = pass_names(a, b);
    let run = a.first();
    RunComparison {
        paper: run.paper.clone(),
        variant: run.variant.clone(),
        preset: run.preset.clone(),
        config: run.config.clone(),
        width: run.width,
        height: run.height,
        a_processes: frame.a.len(),
        b_processes: frame.b.len(),
        frame: quantities.next().unwrap_or_else(|| unmeasured(&frame, None)),
        passes: passes
            .iter()
            .zip(quantities)
            .map(|((name, clock, _), time)| PassComparison { name: name.clone(), clock: *clock, time })
            .collect(),
        missing_passes: names.into_iter().filter(|name| has(a, name) && !has(b, name)).collect(),
    }
}

fn pass_names(a: &Configuration, b: &Configuration) -> Vec<String> {
    let mut names: Vec<String> = vec![];
    for pass in a.runs().chain(b.runs()).flat_map(|run| &run.passes) {
        if !names.contains(&pass.name) {
            names.push(pass.name.clone());
        }
    }
    names
}

/// Every pass's times on every clock that either side has.
fn pass_times(a: &Configuration, b: &Configuration) -> Vec<(String, Clock, Times)> {
    let mut found = vec![];
    for name in pass_names(a, b) {
        for clock in [Clock::Gpu, Clock::Host, Clock::Wait] {
            let samples = |run: &Run| {
                let pass = run.passes.iter().find(|pass| pass.name == name)?;
                let time = match clock {
                    Clock::Gpu => &pass.gpu_ms,
                    Clock::Host => &pass.host_ms,
                    Clock::Wait => &pass.wait_ms,
                };
                time.as_ref().map(|time| time.samples.clone())
            };
            let times = Times { a: a.samples(samples), b: b.samples(samples) };
            if !(times.a.is_empty() && times.b.is_empty()) {
                found.push((name.clone(), clock, times));
            }
        }
    }
    found
}

/// Verdicts on a run's family: the frame first.
fn judge(family: &[&Times], shares: &[Option<f64>], options: &Options) -> Vec<Quantity> {
    let mut quantities: Vec<Quantity> =
        family.iter().zip(shares).map(|(times, share)| unmeasured(times, *share)).collect();
    let found: Vec<Option<Evidence>> =
        family.iter().map(|times| times.evidence(options.design).filter(|_| !times.are_identical())).collect();
    let known: Vec<(usize, &Evidence)> =
        found.iter().enumerate().filter_map(|(index, evidence)| Some((index, evidence.as_ref()?))).collect();
    let evidence: Vec<&Evidence> = known.iter().map(|(_, evidence)| *evidence).collect();
    for ((index, evidence), verdict) in known.iter().zip(decide(&evidence, options.rules)) {
        let [low, high] = evidence.interval(options.rules.error).map(f64::exp);
        let quantity = &mut quantities[*index];
        quantity.ratio = finite(evidence.estimate().exp());
        quantity.interval = (low > 0.0 && high.is_finite()).then_some([low, high]);
        quantity.verdict = verdict;
        quantity.reason = (verdict == Verdict::Unclear).then(|| {
            let count = family[*index].count(options.design);
            let unit = if options.design == Design::Blocks { "blocks" } else { "processes a side" };
            match needed(evidence, options.rules, count, known.len(), MOST_PROCESSES) {
                Some(count) => format!("about {count} {unit} would decide"),
                None => format!("more than {MOST_PROCESSES} {unit} would be needed"),
            }
        });
    }
    for (index, (quantity, times)) in quantities.iter_mut().zip(family).enumerate() {
        quantity.counts = index == 0 || quantity.share.is_some_and(|share| share >= options.min_share);
        if times.are_identical() {
            // Nothing is estimated: the two are one measurement.
            (quantity.ratio, quantity.interval) = (Some(1.0), Some([1.0, 1.0]));
            (quantity.verdict, quantity.reason) = (Verdict::Same, None);
            quantity.gate = options.fail_above.filter(|_| quantity.counts).map(|_| Gate::Passed);
        }
    }
    if let Some(limit) = options.fail_above {
        let counting: Vec<(usize, &Evidence)> =
            known.iter().filter(|(index, _)| quantities[*index].counts).copied().collect();
        let evidence: Vec<&Evidence> = counting.iter().map(|(_, evidence)| *evidence).collect();
        for ((index, _), gate) in counting.iter().zip(gate(&evidence, limit, options.rules.error)) {
            quantities[*index].gate = Some(gate);
        }
    }
    quantities
}

/// A time without evidence on it.
fn unmeasured(times: &Times, share: Option<f64>) -> Quantity {
    let (a_median_ms, b_median_ms) = (geometric_mean(&times.a), geometric_mean(&times.b));
    let reason = if times.a.is_empty() {
        "A has no such time"
    } else if times.b.is_empty() {
        "B has no such time"
    } else if a_median_ms.is_none() || b_median_ms.is_none() {
        "a median is not positive"
    } else {
        "one process on a side: how much processes differ is unknown; measure with --processes 5 or with ab"
    };
    Quantity {
        a_median_ms,
        b_median_ms,
        ratio: a_median_ms.zip(b_median_ms).and_then(|(a, b)| finite(b / a)),
        interval: None,
        share,
        counts: false,
        verdict: Verdict::Unclear,
        reason: Some(reason.to_owned()),
        gate: None,
    }
}

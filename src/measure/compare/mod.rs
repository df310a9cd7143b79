//! Verdicts on B against A, same, faster or slower, for the frame and for every pass.
//!
//! Runs are matched by what was measured (`matching.rs`); each record, and each process inside one, is one process of
//! its side and gives one number for every time: the logarithm of its median. What these say of the ratio B / A is
//! [evidence](Evidence), and the frame with all its passes is one family of quantities on which it is [decided](decide):
//!
//! - `SAME`: the ratio lies within the margin of 1, or both sides hold the very same samples;
//! - `SLOWER`, `FASTER`: it lies above or below 1, and not certainly within the margin;
//! - `UNCLEAR`: anything else, and always when a side has one process only: how much processes differ is then unknown.

mod conditions;
mod console;
mod decision;
mod doubts;
mod evidence;
mod judge;
mod matching;
mod order;
#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trials;
mod within;

pub use conditions::difference_of_machines;
pub use console::{markdown, render, sections};
pub use decision::{CONFIDENCE, Gate, Rules, SAME_MARGIN, Verdict, decide, gate, needed, needed_for_gate};
pub use evidence::Evidence;
pub use matching::{CompareError, Difference};
pub use within::{Ratio, ratio_within_process};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::report::record::Record;
use crate::report::{bounded, environment};
use matching::commands;

/// The value of [`Comparison::schema`].
pub const SCHEMA: &str = "fumarole.compare/2";

/// Numbers of blocks after which sides that are measured in turn are compared, each time with an equal part of the error:
/// looking after every block would find differences where there are none.
pub const LOOKS: [usize; 4] = [5, 10, 20, 40];

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
    #[serde(default, deserialize_with = "bounded::lists_of_texts")]
    pub a_commands: Vec<Vec<String>>,
    /// The command lines that measured B, each once.
    #[serde(default, deserialize_with = "bounded::lists_of_texts")]
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
    #[serde(deserialize_with = "bounded::list")]
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

    /// True when more measurements would decide nothing: the frame and every pass that counts, as far as both sides have
    /// them, have a verdict, and stand on one side of `fail_above` if there is one.
    pub fn is_decided(&self) -> bool {
        let on_both = |quantity: &&Quantity| quantity.a_median_ms.is_some() && quantity.b_median_ms.is_some();
        let stands = |gate: Option<Gate>| gate.is_some_and(|gate| gate != Gate::Undecided);
        self.quantities().filter(|quantity| quantity.counts).filter(on_both).all(|quantity| {
            quantity.verdict != Verdict::Unclear && (self.fail_above.is_none() || stands(quantity.gate))
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
    /// Parameters that tell it from others of these, with a comma before each; empty for one without such others, and in
    /// records of older programs.
    #[serde(default)]
    pub alternative: String,
    /// Every parameter under its option's name, as A has it.
    #[serde(deserialize_with = "bounded::object")]
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
    #[serde(deserialize_with = "bounded::list")]
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
    /// Timestamps of the device.
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
    /// Measurement that would decide on an uncertain standing; absent in records of older programs.
    #[serde(default)]
    pub gate_reason: Option<String>,
}

const OF_BLOCKS: &str = "the sides were measured in blocks A B B A, as by ab: compare --blocks takes the differences of \
                         blocks, in which drift cancels";

/// True when every configuration of both sides was measured in blocks A B B A, as `ab` leaves them.
pub fn are_in_blocks(a: &[Input], b: &[Input]) -> bool {
    matching::match_nearest(a, b)
        .is_ok_and(|matched| !matched.pairs.is_empty() && matched.pairs.iter().all(|(a, b)| order::is_in_blocks(a, b)))
}

/// Compares side B with side A.
///
/// # Errors
/// A side has no record or no run, or the sides were not measured alike; the message names the field that differs. In
/// blocks, also sides whose processes are not two a block.
pub fn compare(a: &[Input], b: &[Input], options: &Options) -> Result<Comparison, CompareError> {
    a.iter().chain(b).try_for_each(matching::check_samples)?;
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
    match options.design {
        Design::Processes => {
            matched.warnings.extend(matched.pairs.iter().find_map(|(a, b)| order::doubt(a, b)));
            if matched.pairs.iter().any(|(a, b)| order::is_in_blocks(a, b)) {
                matched.warnings.push(OF_BLOCKS.to_owned());
            }
        }
        Design::Blocks => matched.pairs.iter().try_for_each(|(a, b)| order::check_blocks(a, b))?,
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
        differences: [matched.differences, conditions::differences_between(a, b, &matched.pairs)].concat(),
        runs: matched.pairs.iter().map(|(a, b)| judge::run(a, b, &options)).collect(),
        only_in_a: matched.only_in_a,
        only_in_b: matched.only_in_b,
        warnings: [matched.warnings, doubts::of_runs(a, b)].concat(),
    })
}

//! Verdict on B against A, faster or slower, from several records a side.
//!
//! Runs are matched by what was measured (`matching.rs`); each record, and each process inside one, is one process of
//! its side. The frame decides: the ratio of its medians B / A has an interval of 95 % (`bootstrap.rs`), and
//!
//! - `SAME`: the whole interval lies within [`SAME_MARGIN`] of 1, or both sides hold the very same samples;
//! - `SLOWER`, `FASTER`: the interval lies above or below 1;
//! - `UNCLEAR`: anything else, and always when a side has one process only: how much processes differ is then unknown.
//!
//! The margin is 2 %: what moving code or memory about changes by itself (Mytkowicz et al., 2009, "Producing wrong data
//! without doing anything obviously wrong"), and no more than five quiet processes a side resolve. A difference that is
//! certain but smaller is called the same. A threshold below the margin replaces it. Passes are reported with their
//! intervals and get no verdict: among many passes some interval always misses 1 by chance.

mod bootstrap;
mod console;
mod matching;
#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests;

pub use bootstrap::{CONFIDENCE, RESAMPLES};
pub use console::render;
pub use matching::CompareError;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::report::record::{Record, Run};
use matching::Configuration;

/// Distance from 1 within which the whole interval of a ratio must lie to be called the same.
pub const SAME_MARGIN: f64 = 0.02;

/// The value of [`Comparison::schema`].
pub const SCHEMA: &str = "fumarole.compare/1";

/// A record and the file it came from, which messages name.
#[derive(Clone, Debug)]
pub struct Input {
    /// Path of the file.
    pub name: String,
    /// Its contents.
    pub record: Record,
}

/// The outcome, as written by `--json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// [`SCHEMA`].
    pub schema: String,
    /// Files of each side.
    pub a: Vec<String>,
    /// Files of side B.
    pub b: Vec<String>,
    /// Confidence of the intervals, 0 to 1.
    pub confidence: f64,
    /// Bootstrap resamples behind each interval.
    pub resamples: usize,
    /// The margin in use, as a fraction.
    pub same_margin: f64,
    /// Fraction by which B may be slower than A; absent without `--fail-above`.
    pub fail_above: Option<f64>,
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
    /// True when any run's interval lies beyond `fail_above`.
    pub fn has_regression(&self) -> bool {
        self.runs.iter().any(|run| run.regression)
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
    /// Every parameter under its option's name.
    pub config: Map<String, Value>,
    /// Pixels of the picture.
    pub width: u32,
    /// Pixels of the picture.
    pub height: u32,
    /// Distinct processes on each side that timed the frame.
    pub a_processes: usize,
    /// Distinct processes of B that timed the frame.
    pub b_processes: usize,
    /// Verdict on the frame's time.
    pub verdict: Verdict,
    /// Why the verdict is not clear; absent when it is.
    pub reason: Option<String>,
    /// The interval lies beyond `fail_above`.
    pub regression: bool,
    /// Absent when a side did not time the frame.
    pub frame: Option<Ratio>,
    /// In the order of A, then what only B has.
    pub passes: Vec<PassComparison>,
}

/// B against A.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    Same,
    Faster,
    Slower,
    Unclear,
}

/// Two medians and B / A with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// Geometric mean of the processes' medians.
    pub a_median_ms: f64,
    /// Geometric mean of the medians of B's processes.
    pub b_median_ms: f64,
    /// `b_median_ms / a_median_ms`: below 1 where B is faster.
    pub ratio: f64,
    /// Lower and upper end.
    pub interval: [f64; 2],
    /// Frames in a resampled block.
    pub block_length: usize,
}

/// The ratio B / A of two methods measured in one process, alternating frame by frame: drift hits both alike, so the
/// noise of frames is all that its interval has to cover. Absent without samples.
pub fn ratio_within_process(a: &[f64], b: &[f64]) -> Option<Ratio> {
    bootstrap::estimate(&[a.to_vec()], &[b.to_vec()])
}

/// One time of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassComparison {
    /// Name of the pass.
    pub name: String,
    /// Clock that timed it.
    pub clock: Clock,
    /// Absent when a side lacks the pass or this time of it.
    pub ratio: Option<Ratio>,
}

/// Clock of a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Clock {
    Gpu,
    Host,
}

/// Compares side B with side A. `fail_above` is the fraction (0.05 is 5 %) by which B may be slower.
///
/// # Errors
/// A side has no record or no run, or the sides were not measured alike; the message names the field that differs.
pub fn compare(a: &[Input], b: &[Input], fail_above: Option<f64>) -> Result<Comparison, CompareError> {
    let matched = matching::match_runs(a, b)?;
    let same_margin = fail_above.map_or(SAME_MARGIN, |limit| limit.clamp(0.0, SAME_MARGIN));
    let names = |side: &[Input]| side.iter().map(|input| input.name.clone()).collect();
    let runs = matched.pairs.iter().map(|(a, b)| {
        let mut run = compare_run(a, b, same_margin);
        // One process a side is no ground to fail on.
        run.regression = fail_above.is_some_and(|limit| {
            let beyond = run.frame.is_some_and(|frame| frame.interval[0] > 1.0 + limit);
            beyond && run.verdict == Verdict::Slower
        });
        run
    });
    Ok(Comparison {
        schema: SCHEMA.to_owned(),
        a: names(a),
        b: names(b),
        confidence: CONFIDENCE,
        resamples: RESAMPLES,
        same_margin,
        fail_above,
        runs: runs.collect(),
        only_in_a: matched.only_in_a,
        only_in_b: matched.only_in_b,
        warnings: matched.warnings,
    })
}

fn compare_run(a: &Configuration, b: &Configuration, same_margin: f64) -> RunComparison {
    let frame_times = |run: &Run| run.frame_ms.as_ref().map(|time| time.samples.clone());
    let (a_times, b_times) = (a.samples(frame_times), b.samples(frame_times));
    let identical = !a_times.is_empty() && same_samples(&a_times, &b_times);
    let frame = ratio(&a_times, &b_times, identical);
    let (verdict, reason) =
        if identical { (Verdict::Same, None) } else { decide(frame, a_times.len().min(b_times.len()), same_margin) };
    let run = a.first();
    RunComparison {
        paper: run.paper.clone(),
        variant: run.variant.clone(),
        preset: run.preset.clone(),
        config: run.config.clone(),
        width: run.width,
        height: run.height,
        a_processes: a_times.len(),
        b_processes: b_times.len(),
        verdict,
        reason,
        regression: false,
        frame,
        passes: compare_passes(a, b),
    }
}

fn decide(frame: Option<Ratio>, processes: usize, same_margin: f64) -> (Verdict, Option<String>) {
    let unclear = |reason: &str| (Verdict::Unclear, Some(reason.to_owned()));
    let Some(Ratio { interval: [low, high], .. }) = frame else {
        return unclear("a side did not time the frame");
    };
    if processes < 2 {
        return unclear("one process on a side: how much processes differ is unknown; measure with --processes 5");
    }
    let margin = 1.0 + same_margin;
    if low >= 1.0 / margin && high <= margin {
        (Verdict::Same, None)
    } else if low > 1.0 {
        (Verdict::Slower, None)
    } else if high < 1.0 {
        (Verdict::Faster, None)
    } else {
        unclear("the interval holds 1 and is wider than the margin; measure more processes or frames")
    }
}

fn compare_passes(a: &Configuration, b: &Configuration) -> Vec<PassComparison> {
    let mut names: Vec<&str> = vec![];
    for run in a.runs().chain(b.runs()) {
        for pass in &run.passes {
            if !names.contains(&pass.name.as_str()) {
                names.push(&pass.name);
            }
        }
    }
    let mut compared = vec![];
    for name in names {
        for clock in [Clock::Gpu, Clock::Host] {
            let times = |run: &Run| {
                let pass = run.passes.iter().find(|pass| pass.name == name)?;
                let time = match clock {
                    Clock::Gpu => &pass.gpu_ms,
                    Clock::Host => &pass.host_ms,
                };
                time.as_ref().map(|time| time.samples.clone())
            };
            let (a_times, b_times) = (a.samples(times), b.samples(times));
            if a_times.is_empty() && b_times.is_empty() {
                continue;
            }
            let identical = same_samples(&a_times, &b_times);
            compared.push(PassComparison { name: name.to_owned(), clock, ratio: ratio(&a_times, &b_times, identical) });
        }
    }
    compared
}

fn ratio(a: &[Vec<f64>], b: &[Vec<f64>], identical: bool) -> Option<Ratio> {
    let mut ratio = bootstrap::estimate(a, b)?;
    if identical {
        // Nothing is estimated: the two are one measurement.
        ratio.ratio = 1.0;
        ratio.interval = [1.0, 1.0];
    }
    Some(ratio)
}

/// True when both sides hold the same processes' samples, in any order of the processes.
fn same_samples(a: &[Vec<f64>], b: &[Vec<f64>]) -> bool {
    a.len() == b.len() && a.iter().all(|samples| b.contains(samples))
}

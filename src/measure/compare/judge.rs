//! Verdicts on one configuration: its times on both sides, and what they say of the frame and of every pass.

use super::decision::{Gate, Verdict, decide, gate, needed, needed_for_gate};
use super::evidence::Evidence;
use super::matching::Configuration;
use super::{Clock, Design, Options, PassComparison, Quantity, RunComparison};
use crate::measure::statistics::median;
use crate::report::record::Run;

/// Processes a side, or blocks, beyond which none are recommended.
const MOST_PROCESSES: usize = 1000;

/// Compares a configuration on both sides.
pub(super) fn run(a: &Configuration, b: &Configuration, options: &Options) -> RunComparison {
    let frame = Times::of(a, b, Clock::Host, |run| run.frame_ms.as_ref().map(|time| time.samples.clone()));
    let passes = pass_times(a, b);
    let of_frame = |pass: &Times| {
        let share = |pass, frame| positive(geometric_mean(pass)? / geometric_mean(frame)?);
        let shares = [share(&pass.a, &frame.a), share(&pass.b, &frame.b)];
        shares.into_iter().flatten().max_by(f64::total_cmp)
    };
    let shares: Vec<Option<f64>> =
        std::iter::once(Some(1.0)).chain(passes.iter().map(|(_, _, times)| of_frame(times))).collect();
    let family: Vec<&Times> = std::iter::once(&frame).chain(passes.iter().map(|(_, _, times)| times)).collect();
    let mut quantities = judge(&family, &shares, options).into_iter();
    let has = |side: &Configuration, name: &str| side.runs().any(|run| run.passes.iter().any(|pass| pass.name == name));
    let names = pass_names(a, b);
    let first = a.first();
    RunComparison {
        paper: first.paper.clone(),
        variant: first.variant.clone(),
        preset: first.preset.clone(),
        alternative: a.alternative.clone(),
        config: first.config.clone(),
        width: first.width,
        height: first.height,
        a_processes: frame.a.len(),
        b_processes: frame.b.len(),
        frame: quantities.next().unwrap_or_else(|| unmeasured(&frame, None, options.design)),
        passes: passes
            .iter()
            .zip(quantities)
            .map(|((name, clock, _), time)| PassComparison { name: name.clone(), clock: *clock, time })
            .collect(),
        missing_passes: names.into_iter().filter(|name| has(a, name) && !has(b, name)).collect(),
    }
}

/// The times of one quantity, process after process of each side.
struct Times {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    /// Milliseconds of a step of each side's clock.
    steps_ms: [f64; 2],
    /// Processes of the side with more of them, also of those without this time.
    processes: usize,
}

impl Times {
    fn of(a: &Configuration, b: &Configuration, clock: Clock, time: impl Fn(&Run) -> Option<Vec<f64>>) -> Self {
        let processes = a.process_numbers().len().max(b.process_numbers().len());
        let [of_a, of_b] = [a, b].map(|side| side.samples(&time));
        let steps_ms = [(a, &of_a), (b, &of_b)].map(|(side, samples)| side.tick_ms(clock).max(shown_step_ms(samples)));
        Times { a: of_a, b: of_b, steps_ms, processes }
    }

    /// Every process has this time: the second of two stands in the block that it was measured in.
    fn are_whole(&self) -> bool {
        [&self.a, &self.b].iter().all(|side| side.len() == self.processes)
    }

    /// Both sides hold the same processes' samples, in any order of the processes: they are one measurement.
    fn are_identical(&self) -> bool {
        !self.a.is_empty() && self.a.len() == self.b.len() && self.a.iter().all(|samples| self.b.contains(samples))
    }

    fn evidence(&self, design: Design) -> Option<Evidence> {
        let (a, b) = (log_medians(&self.a)?, log_medians(&self.b)?);
        let middle = |logs: &[f64]| (logs.iter().sum::<f64>() / logs.len() as f64).exp();
        let [of_a, of_b] = self.steps_ms;
        let steps = [of_a / middle(&a), of_b / middle(&b)];
        match design {
            Design::Processes => Evidence::welch_of_steps(&a, &b, steps),
            Design::Blocks => {
                let means =
                    |side: &[f64]| side.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
                let blocks = means(&b).iter().zip(means(&a)).map(|(b, a)| b - a).collect::<Vec<_>>();
                self.are_whole().then(|| Evidence::signed_ranks_of_steps(&blocks, steps)).flatten()
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

/// Milliseconds of the step that samples show: the least difference between two of one process, where most of its samples
/// repeat others. Devices step their timestamps by more than the period that they tell. Elsewhere steps are too short to
/// matter, and this is 0.
fn shown_step_ms(side: &[Vec<f64>]) -> f64 {
    let of_process = |samples: &Vec<f64>| {
        let mut ascending = samples.clone();
        ascending.sort_by(f64::total_cmp);
        let neighbours = ascending.windows(2).map(|pair| (pair[1] - pair[0], pair[1]));
        // The same ticks in another order have a sum that differs in its last digits.
        let steps: Vec<f64> = neighbours.filter(|(step, sample)| *step > 1e-9 * sample).map(|(step, _)| step).collect();
        let values = steps.len() + 1;
        steps.into_iter().min_by(f64::total_cmp).filter(|_| 2 * values <= samples.len())
    };
    side.iter().filter_map(of_process).min_by(f64::total_cmp).unwrap_or(0.0)
}

/// Of times near the ends of what a number holds a ratio, or a mean, may be 0 or infinite, which is none.
fn positive(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite() && *number > 0.0)
}

fn geometric_mean(side: &[Vec<f64>]) -> Option<f64> {
    let logs = log_medians(side).filter(|logs| !logs.is_empty())?;
    positive((logs.iter().sum::<f64>() / logs.len() as f64).exp())
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
            let times = Times::of(a, b, clock, samples);
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
        family.iter().zip(shares).map(|(times, share)| unmeasured(times, *share, options.design)).collect();
    let found: Vec<Option<Evidence>> =
        family.iter().map(|times| times.evidence(options.design).filter(|_| !times.are_identical())).collect();
    let known: Vec<(usize, &Evidence)> =
        found.iter().enumerate().filter_map(|(index, evidence)| Some((index, evidence.as_ref()?))).collect();
    let evidence: Vec<&Evidence> = known.iter().map(|(_, evidence)| *evidence).collect();
    for ((index, evidence), verdict) in known.iter().zip(decide(&evidence, options.rules)) {
        let [low, high] = evidence.interval(options.rules.error).map(f64::exp);
        let quantity = &mut quantities[*index];
        quantity.ratio = positive(evidence.estimate().exp());
        quantity.interval = (low > 0.0 && high.is_finite()).then_some([low, high]);
        quantity.verdict = verdict;
        quantity.reason = (verdict == Verdict::Unclear).then(|| {
            let count = family[*index].count(options.design);
            wanting(needed(evidence, options.rules, count, known.len(), MOST_PROCESSES), options.design)
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
        for ((index, evidence), gate) in counting.iter().zip(gate(&evidence, limit, options.rules.error)) {
            let quantity = &mut quantities[*index];
            quantity.gate = Some(gate);
            quantity.gate_reason = (gate == Gate::Undecided).then(|| {
                let count = family[*index].count(options.design);
                let rules = (limit, options.rules.error);
                wanting(needed_for_gate(evidence, rules, count, counting.len(), MOST_PROCESSES), options.design)
            });
        }
    }
    quantities
}

/// Words for how many would decide.
fn wanting(count: Option<usize>, design: Design) -> String {
    let unit = if design == Design::Blocks { "blocks" } else { "processes a side" };
    match count {
        Some(count) => format!("about {count} {unit} would decide"),
        None => format!("more than {MOST_PROCESSES} {unit} would be needed"),
    }
}

/// A time without evidence on it.
fn unmeasured(times: &Times, share: Option<f64>, design: Design) -> Quantity {
    let (a_median_ms, b_median_ms) = (geometric_mean(&times.a), geometric_mean(&times.b));
    let reason = if times.a.is_empty() {
        "A has no such time"
    } else if times.b.is_empty() {
        "B has no such time"
    } else if a_median_ms.is_none() || b_median_ms.is_none() {
        "a median is not positive"
    } else if design == Design::Blocks && !times.are_whole() {
        "not every block has this time"
    } else if design == Design::Blocks {
        "of one block, how much blocks differ is unknown"
    } else {
        "one process on a side: how much processes differ is unknown; measure with --processes 5 or with ab"
    };
    Quantity {
        a_median_ms,
        b_median_ms,
        ratio: a_median_ms.zip(b_median_ms).and_then(|(a, b)| positive(b / a)),
        interval: None,
        share,
        counts: false,
        verdict: Verdict::Unclear,
        reason: Some(reason.to_owned()),
        gate: None,
        gate_reason: None,
    }
}

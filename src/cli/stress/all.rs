//! `fumarole stress`: every paper's first axis.

use std::ffi::OsString;
use std::time::Instant;

use clap::Args;

use super::{Ascent, LimitArgs, StressOutput, default_axis, schedule};
use crate::cli::failure::Failure;
use crate::cli::options::MachineArgs;
use crate::cli::pool;
use crate::cli::watch::interrupted;
use crate::measure::measure::Schedule;
use crate::measure::shard::Shard;
use crate::measure::study::{Study, Visitor};
use crate::papers;

#[derive(Debug, Clone, Args)]
pub struct StressAllArgs {
    /// Of the papers, the part I of N
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    output: StressOutput,
}

/// Seconds without `--budget`.
const BUDGET_S: f64 = 600.0;

struct Papers<'a> {
    arguments: &'a StressAllArgs,
    started: Instant,
    /// Papers before this one.
    number: usize,
    /// Papers that are still to come.
    left: u32,
}

struct Count {
    shard: Shard,
    number: usize,
    papers: u32,
}

impl Visitor for Count {
    type Error = Failure;

    fn visit<S: Study>(&mut self) -> Result<(), Failure> {
        self.papers += u32::from(!S::axes().is_empty() && self.shard.has(self.number));
        self.number += 1;
        Ok(())
    }
}

/// Grows every paper's first axis, each for its part of the budget that is left.
pub fn run(arguments: &StressAllArgs) -> Result<(), Failure> {
    pool::start()?;
    let mut count = Count { shard: arguments.shard.unwrap_or(Shard::ALONE), number: 0, papers: 0 };
    papers::each(&mut count)?;
    papers::each(&mut Papers { arguments, started: Instant::now(), number: 0, left: count.papers })
}

impl Visitor for Papers<'_> {
    type Error = Failure;

    fn visit<S: Study>(&mut self) -> Result<(), Failure> {
        let is_own = self.arguments.shard.is_none_or(|shard| shard.has(self.number));
        self.number += 1;
        if !is_own || S::axes().is_empty() || interrupted().load(std::sync::atomic::Ordering::Relaxed) {
            return Ok(());
        }
        let StressAllArgs { limits, machine, output, .. } = self.arguments;
        let usual = Schedule { warmup: 1, frames: 1, repeat: 3, min_time_s: 0.0 };
        let mut child_arguments: Vec<OsString> = vec![S::PAPER.into(), "stress".into()];
        child_arguments.extend(machine.arguments());
        if let Some(until) = limits.until {
            child_arguments.extend(["--until".into(), until.as_str().into()]);
        }
        let ascent = Ascent::<S> {
            setup: S::default(),
            variants: vec![S::RENDERED],
            axis: default_axis()?,
            across: None,
            from: None,
            shard: None,
            schedule: schedule(limits.until, usual),
            limits,
            output,
            machine,
            json: None,
            csv: None,
            child_arguments,
            suffix: String::new(),
        };
        let left_s = limits.budget.unwrap_or(BUDGET_S) - self.started.elapsed().as_secs_f64();
        let budget_s = left_s.max(0.0) / f64::from(self.left.max(1));
        self.left = self.left.saturating_sub(1);
        ascent.publish(budget_s)
    }
}

//! The process of one step: it measures, writes its report and ends.

use std::io::{self, Read};
use std::path::PathBuf;
use std::thread;

use clap::Args;

use super::super::failure::Failure;
use super::super::options::MachineArgs;
use super::super::outcome;
use super::super::spelling;
use super::super::watch::watched;
use crate::file;
use crate::measure::machine::Machine;
use crate::measure::measure::Schedule;
use crate::measure::stress::step::{Report, measure, stop_kind};
use crate::measure::stress::{Axis, host_memory};
use crate::measure::study::Study;
use crate::measure::{Error, Variant};

/// The step that a process is started for; set by its parent.
#[derive(Debug, Clone, Args)]
pub struct StepArgs {
    /// File of the report
    #[arg(long, hide = true)]
    step_report: Option<PathBuf>,
    /// Value of the axis; without one the report is of the machine
    #[arg(long, hide = true, requires = "step_report")]
    step_value: Option<u64>,
    /// Value of the second axis
    #[arg(long, hide = true, requires = "step_value")]
    step_across: Option<u64>,
    #[arg(long, hide = true, requires = "step_value")]
    step_variant: Option<String>,
}

impl StepArgs {
    pub fn is_step(&self) -> bool {
        self.step_report.is_some()
    }
}

/// Measures the step and writes its report.
pub fn run<S: Study>(
    step: &StepArgs,
    machine: &MachineArgs,
    axes: (&Axis<S>, Option<&Axis<S>>),
    setup: S,
    variants: &[S::Variant],
    schedule: Schedule,
) -> Result<(), Failure> {
    let Some(path) = &step.step_report else { return Ok(()) };
    end_with_parent().map_err(|e| Failure::Running(format!("starting a thread: {e}")))?;
    host_memory::be_killed_first();
    let options = machine.resolve(0);
    let report = match step.step_value {
        None => Report::Machine(Box::new(Machine::open(&options, S::NEEDS)?.environment())),
        Some(value) => {
            let is_named = |variant: &&S::Variant| step.step_variant.as_deref() == Some(variant.as_str());
            let Some(&variant) = variants.iter().find(is_named) else { return Ok(()) };
            let mut setup = setup;
            let set = || -> Result<S, Error> {
                if let (Some(across), Some(value)) = (axes.1, step.step_across) {
                    across.set(&mut setup, value)?;
                }
                axes.0.set(&mut setup, value)?;
                Ok(setup)
            };
            let measured = set().and_then(|setup| {
                watched(true, S::PAPER, |watch| measure(&setup, (axes.0, value), variant, &options, schedule, watch))
            });
            match measured {
                Ok(measured) => Report::Measured(Box::new(measured)),
                Err(error) => match stop_kind(&error) {
                    Some(kind) => Report::Stopped { kind, reason: spelling::options(&error.to_string()) },
                    None => Report::Refused(Failure::from(error).to_string()),
                },
            }
        }
    };
    Ok(file::write(path, outcome::text(&report)?.as_bytes())?)
}

/// Ends this process when its parent does, whatever ends that: the parent holds the other end of standard input.
fn end_with_parent() -> io::Result<()> {
    let wait = || {
        let mut rest = Vec::new();
        // An error is an end, too.
        let _ = io::stdin().lock().read_to_end(&mut rest);
        std::process::exit(1);
    };
    thread::Builder::new().spawn(wait).map(drop)
}

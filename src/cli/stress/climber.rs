//! Steps as fresh processes: started, watched, ended in time, and what becomes of them.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::super::failure::Failure;
use super::super::outcome;
use super::super::processes::{Ended, failure, finish_within};
use super::super::watch::interrupted;
use super::record::File;
use crate::file;
use crate::measure::stress::step::{Measured, Report};
use crate::measure::stress::{Cell, Climber, Outcome, costs, host_memory};
use crate::report::json;
use crate::report::record::Environment;
use crate::report::stress::{Series, Step, StopKind, StressRecord};

/// Longest report of a step, bytes.
const MAX_REPORT_BYTES: u64 = 1 << 30;

/// Starts processes of this program.
pub struct Children<'a> {
    program: PathBuf,
    arguments: &'a [OsString],
    is_quiet: bool,
}

/// End of a step's process, and its report.
struct Returned {
    ended: Ended,
    report: Option<Report>,
    wall_s: f64,
}

impl<'a> Children<'a> {
    pub fn new(arguments: &'a [OsString], is_quiet: bool) -> Result<Self, Failure> {
        let program = std::env::current_exe().map_err(|e| failed(&e))?;
        Ok(Children { program, arguments, is_quiet })
    }

    /// The machine that steps will be measured on.
    pub fn environment(&self) -> Result<Environment, Failure> {
        let returned = self.run(&[], None)?;
        match returned.report {
            Some(Report::Machine(environment)) => Ok(*environment),
            _ => Err(failure("the process that looks for the device", &returned.ended)),
        }
    }

    fn run(&self, step: &[OsString], end: Option<Instant>) -> Result<Returned, Failure> {
        let report = file::temporary().map_err(|e| failed(&e))?;
        let started = Instant::now();
        let mut command = Command::new(&self.program);
        // Its standard input ends when this process does, and it with it.
        command.args(self.arguments).arg("--step-report").arg(report.path()).args(step).stdin(Stdio::piped());
        command.stdout(Stdio::null());
        let ended = finish_within(&mut command, interrupted(), end).map_err(|e| failed(&e))?;
        let wall_s = started.elapsed().as_secs_f64();
        let text = file::read_text(report.path(), MAX_REPORT_BYTES).ok().filter(|_| ended.status.success());
        let report = text.and_then(|text| json::document(&text, report.path()).ok());
        Ok(Returned { ended, report, wall_s })
    }
}

fn failed(error: &io::Error) -> Failure {
    Failure::Running(format!("starting the process of a step: {error}"))
}

/// Takes steps on this machine.
pub struct MachineClimber<'a> {
    /// Starts the process of each step.
    pub children: Children<'a>,
    /// The record without its series.
    pub template: StressRecord,
    /// The record's file, written anew after every step.
    pub file: File,
    /// Time at which the call began; the budget counts from here.
    pub started: Instant,
    /// Unit of the axis, plural, for the lines about steps.
    pub unit: &'static str,
    /// Set when the user wants no more steps.
    pub interrupted: &'a AtomicBool,
    /// A step has been finished.
    pub has_steps: bool,
}

impl MachineClimber<'_> {
    /// The record with its series and their costs.
    pub fn record(&self, series: &[Series]) -> StressRecord {
        let series = series.iter().map(|series| Series { costs: costs(series), ..series.clone() }).collect();
        StressRecord { series, ..self.template.clone() }
    }

    fn say(&self, cell: &Cell, end: &str) {
        if !self.children.is_quiet {
            let across = cell.across.zip(self.template.across.as_ref());
            let across = across.map_or_else(String::new, |(value, axis)| format!(", {value} {}", axis.unit));
            let paper = &self.template.paper;
            outcome::say(&format!("{paper} {}{across}: {} {}: {end}", cell.variant, cell.value, self.unit));
        }
    }
}

impl Climber for MachineClimber<'_> {
    type Error = Failure;

    fn elapsed_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn available_bytes(&self) -> Option<u64> {
        host_memory::available_bytes()
    }

    fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    fn take(&mut self, cell: &Cell, left_s: f64) -> Result<Outcome, Failure> {
        let mut arguments: Vec<OsString> = vec![
            "--step-value".into(),
            cell.value.to_string().into(),
            "--step-variant".into(),
            cell.variant.clone().into(),
        ];
        if let Some(across) = cell.across {
            arguments.extend(["--step-across".into(), across.to_string().into()]);
        }
        let end = Instant::now() + Duration::from_secs_f64(left_s);
        let killed_before = host_memory::killed_for_memory();
        let Returned { ended, report, wall_s } = self.children.run(&arguments, Some(end))?;
        let outcome = match report {
            _ if self.is_interrupted() => Outcome::Stopped(StopKind::Interruption, "interrupted".to_owned()),
            Some(Report::Measured(measured)) => Outcome::Finished(Box::new(step(cell.value, *measured, wall_s))),
            Some(Report::Stopped { kind, reason }) => Outcome::Stopped(kind, reason),
            Some(Report::Refused(reason)) if !self.has_steps => return Err(Failure::Input(reason)),
            Some(Report::Refused(reason)) => Outcome::Stopped(StopKind::End, reason),
            Some(Report::Machine(_)) | None if ended.is_late => {
                Outcome::Stopped(StopKind::Time, format!("ended after {wall_s:.1} s, when the budget was over"))
            }
            Some(Report::Machine(_)) | None => {
                crashed(&ended, killed_before.is_some() && killed_before == host_memory::killed_for_memory())
            }
        };
        match &outcome {
            Outcome::Finished(step) => {
                self.has_steps = true;
                let frame_ms = step.run.median_frame_ms().unwrap_or_default();
                self.say(cell, &format!("frame {frame_ms:.2} ms; {wall_s:.1} s in all"));
            }
            Outcome::Stopped(kind, reason) => self.say(cell, &format!("stopped by {}: {reason}", kind.as_str())),
        }
        Ok(outcome)
    }

    fn keep(&mut self, series: &[Series]) -> Result<(), Failure> {
        self.file.write(&self.record(series))
    }
}

fn step(value: u64, measured: Measured, wall_s: f64) -> Step {
    let Measured { run, amount, not_finite, peak_bytes } = measured;
    let frame_ms = run.median_frame_ms().filter(|ms| *ms > 0.0);
    Step { value, amount, throughput_per_s: frame_ms.map(|ms| amount / ms * 1e3), wall_s, peak_bytes, not_finite, run }
}

/// Cause of the end of a process that left no report. Where the system tells that it has killed nothing for memory, a kill
/// came from elsewhere, and another call tries the step again.
fn crashed(ended: &Ended, has_memory: bool) -> Outcome {
    if !is_killed(ended.status) {
        return Outcome::Stopped(StopKind::Crash, format!("its process failed: {}", ended.message()));
    }
    let (kind, by_whom) = if has_memory {
        (StopKind::Crash, "and not by the system for memory")
    } else {
        (StopKind::Memory, "as the system does when memory runs out")
    };
    Outcome::Stopped(kind, format!("its process was killed, {by_whom}"))
}

/// SIGKILL ended the process, with which Linux ends one when memory runs out.
#[cfg(unix)]
fn is_killed(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    const KILL: i32 = 9;
    status.signal() == Some(KILL)
}

/// No system but Unix tells of signals.
#[cfg(not(unix))]
fn is_killed(_: ExitStatus) -> bool {
    false
}

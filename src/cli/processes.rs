//! `--processes K`: the same command in fresh processes, their records joined.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::failure::Failure;
use super::watch::{interrupted, progress_bar};
use crate::measure::Error;
use crate::report::{Record, environment, json};

/// Options that the fresh processes do not get, and whether a value follows.
const OURS: [(&str, bool); 4] = [("--processes", true), ("--process", true), ("--csv", true), ("--quiet", false)];
/// Options that only the first process gets: it writes what all of them would write alike.
pub const OF_THE_FIRST: [(&str, bool); 4] =
    [("--trace", true), ("--image", true), ("--profile", true), ("--capture", true)];

/// Time that a process has to end by itself.
const PATIENCE: Duration = Duration::from_secs(5);

/// Runs this command `count` times and joins the records, each with its process's number. Ctrl-C reaches the process
/// that runs as well, and keeps what is finished. So does a process that fails, whose failure comes with the record of those
/// before it.
///
/// # Errors
/// The failure of the first process.
pub fn run(count: u32, quiet: bool) -> Result<(Record, Option<Failure>), Failure> {
    let program = std::env::current_exe().map_err(failed)?;
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let interrupted = interrupted();
    let bar = progress_bar(quiet, "processes");
    bar.set_length(u64::from(count));
    let (mut joined, mut failure): (Option<Record>, _) = (None, None);
    for process in 0..count {
        if joined.is_some() && interrupted.load(Ordering::Relaxed) {
            break;
        }
        match measure(&program, &given, process, interrupted) {
            Ok((record, failed)) => {
                match &mut joined {
                    Some(all) => all.runs.extend(record.runs),
                    None => joined = Some(Record { command: environment::command(), ..record }),
                }
                failure = failed;
                if failure.is_some() {
                    break;
                }
            }
            Err(_) if interrupted.load(Ordering::Relaxed) && joined.is_some() => break,
            Err(_) if interrupted.load(Ordering::Relaxed) => return Err(Error::Interrupted.into()),
            Err(failed) => {
                failure = Some(failed);
                break;
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    match (joined, failure) {
        (Some(joined), failure) => Ok((joined, failure)),
        (None, failure) => Err(failure.unwrap_or_else(|| failed("none was asked for"))),
    }
}

/// Measures in one fresh process, with the arguments that this one was given. One that fails after it has measured leaves its
/// record all the same.
fn measure(
    program: &Path,
    given: &[OsString],
    process: u32,
    interrupted: &AtomicBool,
) -> Result<(Record, Option<Failure>), Failure> {
    let removed = if process == 0 { OURS.to_vec() } else { [&OURS[..], &OF_THE_FIRST[..]].concat() };
    let file = crate::file::temporary().map_err(failed)?;
    let mut command = Command::new(program);
    command
        .args(without(&removed, given.iter().cloned()))
        .args(["--process", &process.to_string(), "--quiet", "--json"])
        .arg(file.path())
        .stdin(Stdio::null());
    let ended = finish(&mut command, interrupted).map_err(failed)?;
    if !ended.status.success() {
        let failure = failure(&format!("process {process}"), &ended);
        return match json::read(file.path()) {
            Ok(record) => Ok((record, Some(failure))),
            Err(_) => Err(failure),
        };
    }
    Ok((json::read(file.path())?, None))
}

fn failed(reason: impl Display) -> Failure {
    Failure::Running(format!("measuring in a fresh process: {reason}"))
}

/// Exit status of a process, and its output.
pub struct Ended {
    /// As the system tells it.
    pub status: ExitStatus,
    /// It was ended because its time was over.
    pub is_late: bool,
    /// Its standard output, where that is piped.
    pub output: Vec<u8>,
    errors: String,
}

impl Ended {
    /// Its own message, or else how it ended.
    pub fn message(&self) -> String {
        self.own_message().map_or_else(|| format!("ended with {}", self.status), str::to_owned)
    }

    /// The rest of its last line that began with `prefix`.
    pub fn last_after(&self, prefix: &str) -> Option<&str> {
        self.errors.lines().rev().find_map(|line| line.strip_prefix(prefix))
    }

    fn own_message(&self) -> Option<&str> {
        self.errors.lines().find_map(|line| line.strip_prefix("error: "))
    }

    /// A message with its exit code as ours.
    pub fn failure(&self, message: String) -> Failure {
        match self.status.code() {
            Some(2) => Failure::Input(message),
            Some(3) => Failure::NoDevice(message),
            _ => Failure::Running(message),
        }
    }
}

/// Runs a process to its end. After an interruption it has [`PATIENCE`] to end by itself, as it does when the terminal has
/// told it too; then it is told, and a while later ended, so that none outlives us. What it prints is for nobody.
pub fn finish(command: &mut Command, interrupted: &AtomicBool) -> io::Result<Ended> {
    finish_within(command.stdout(Stdio::null()), interrupted, None)
}

/// The same, and ends the process when the time is over. Its standard output is what `command` says.
pub fn finish_within(command: &mut Command, interrupted: &AtomicBool, end: Option<Instant>) -> io::Result<Ended> {
    let mut child = command.stderr(Stdio::piped()).spawn()?;
    // What cannot be read is not said.
    let read = |pipe: Option<Box<dyn Read + Send>>| {
        thread::Builder::new().spawn(move || {
            let mut bytes = Vec::new();
            let _ = pipe.map(|mut pipe| pipe.read_to_end(&mut bytes));
            bytes
        })
    };
    let errors = read(child.stderr.take().map(|pipe| Box::new(pipe) as _));
    let output = read(child.stdout.take().map(|pipe| Box::new(pipe) as _));
    let (errors, output) = match (errors, output) {
        (Ok(errors), Ok(output)) => (errors, output),
        (Err(error), _) | (_, Err(error)) => return child.kill().and_then(|()| child.wait()).and(Err(error)),
    };
    let (mut deadline, mut is_told, mut is_late) = (None, false, false);
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if interrupted.load(Ordering::Relaxed)
            && Instant::now() > *deadline.get_or_insert_with(|| Instant::now() + PATIENCE)
        {
            if is_told || !tell(&child) {
                child.kill()?;
            }
            is_told = true;
            deadline = Some(Instant::now() + PATIENCE);
        }
        if end.is_some_and(|end| Instant::now() > end) {
            is_late = true;
            child.kill()?;
        }
        thread::sleep(Duration::from_millis(20));
    };
    let errors = String::from_utf8_lossy(&errors.join().unwrap_or_default()).into_owned();
    Ok(Ended { status, is_late, output: output.join().unwrap_or_default(), errors })
}

/// Asks a process to end and to keep what is finished. False where that cannot be asked.
#[cfg(unix)]
fn tell(child: &Child) -> bool {
    use nix::sys::signal::{Signal, kill};
    i32::try_from(child.id()).is_ok_and(|id| kill(nix::unistd::Pid::from_raw(id), Signal::SIGTERM).is_ok())
}

#[cfg(not(unix))]
fn tell(_: &Child) -> bool {
    false
}

/// A process's own message and exit code as ours.
pub fn failure(which: &str, ended: &Ended) -> Failure {
    let message = ended.own_message().map_or_else(|| format!("{which} ended with {}", ended.status), str::to_owned);
    ended.failure(message)
}

/// The arguments without the options `removed`, and without `--json` and its optional value.
pub fn without(removed: &[(&str, bool)], arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut kept = Vec::new();
    let mut arguments = arguments.peekable();
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy().into_owned();
        let name = text.split('=').next().unwrap_or_default();
        if let Some((_, has_value)) = removed.iter().find(|(removed, _)| *removed == name) {
            if *has_value && !text.contains('=') {
                arguments.next();
            }
        } else if name == "--json" {
            if !text.contains('=') && arguments.peek().is_some_and(|a| !a.to_string_lossy().starts_with("--")) {
                arguments.next();
            }
        } else if text != "-q" {
            kept.push(argument);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(removed: &[(&str, bool)], arguments: &str) -> String {
        let kept = without(removed, arguments.split(' ').map(OsString::from));
        kept.iter().map(|a| a.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn fresh_processes_get_everything_but_our_own_options() {
        assert_eq!(kept(&OURS, "bench --processes 5 --planes 9 --json a.json --csv=b -q"), "bench --planes 9");
        assert_eq!(kept(&OURS, "bench --json --variant all --processes=2"), "bench --variant all");
        assert_eq!(kept(&OURS, "bench --image p.png --quiet"), "bench --image p.png");
        assert_eq!(kept(&OF_THE_FIRST, "bench --image p.png --trace=t --size 8x8"), "bench --size 8x8");
    }
}

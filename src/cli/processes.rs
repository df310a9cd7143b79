//! `--processes K`: the same command in fresh processes, their records joined.

use std::ffi::OsString;
use std::process::{Command, Stdio};

use super::failure::Failure;
use crate::report::{Record, json};

/// Options that the fresh processes do not get, and whether a value follows.
const OURS: [(&str, bool); 6] = [
    ("--processes", true),
    ("--process", true),
    ("--csv", true),
    ("--trace", true),
    ("--image", true),
    ("--quiet", false),
];

/// Runs this command `count` times and joins the records, each with its process's number.
///
/// # Errors
/// The first process that fails, with its own message already on standard error.
pub fn run(count: u32) -> Result<Record, Failure> {
    let failed = |reason: String| Failure::Running(format!("measuring in a fresh process: {reason}"));
    let program = std::env::current_exe().map_err(|e| failed(e.to_string()))?;
    let arguments = inherited(std::env::args_os().skip(1));
    let mut joined: Option<Record> = None;
    for process in 0..count {
        let file = tempfile::NamedTempFile::new().map_err(|e| failed(e.to_string()))?;
        let status = Command::new(&program)
            .args(&arguments)
            .args(["--process", &process.to_string(), "--quiet", "--json"])
            .arg(file.path())
            .stdin(Stdio::null())
            .status()
            .map_err(|e| failed(e.to_string()))?;
        match status.code() {
            Some(0) => {}
            Some(2) => return Err(Failure::Input(format!("fresh process {process} refused its input"))),
            Some(3) => return Err(Failure::NoDevice(format!("fresh process {process} found no device"))),
            _ => return Err(failed(format!("process {process} ended with {status}"))),
        }
        let record = json::read(file.path())?;
        match &mut joined {
            Some(all) => all.runs.extend(record.runs),
            None => joined = Some(Record { command: std::env::args().collect(), ..record }),
        }
    }
    joined.ok_or_else(|| failed("none was asked for".into()))
}

/// The arguments without our own options, and without `--json` and its optional value.
fn inherited(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut kept = Vec::new();
    let mut arguments = arguments.peekable();
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy().into_owned();
        let name = text.split('=').next().unwrap_or_default();
        if let Some((_, has_value)) = OURS.iter().find(|(ours, _)| *ours == name) {
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

    fn kept(arguments: &str) -> String {
        let kept = inherited(arguments.split(' ').map(OsString::from));
        kept.iter().map(|a| a.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn fresh_processes_get_everything_but_our_own_options() {
        assert_eq!(kept("bench --processes 5 --planes 9 --json a.json --csv=b -q"), "bench --planes 9");
        assert_eq!(kept("bench --json --variant all --processes=2"), "bench --variant all");
        assert_eq!(kept("bench --image p.png --size 8x8 --quiet"), "bench --size 8x8");
    }
}

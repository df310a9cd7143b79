//! The sides of `ab`: what each one runs.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::json;

use super::AbArgs;
use crate::cli::failure::Failure;
use crate::cli::processes::{OF_THE_FIRST, finish, without};
use crate::cli::watch::interrupted;
use crate::cli::{listed, paper_names};
use crate::content;
use crate::measure::compare::{Comparison, Difference};
use crate::report::{Record, json as reader};

/// One of the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    A,
    B,
}

/// Options as a shell would split them.
#[derive(Debug, Clone)]
pub struct SideOptions(pub Vec<String>);

pub fn parse_side_options(text: &str) -> Result<SideOptions, String> {
    shlex::split(text).map(SideOptions).ok_or_else(|| "a quotation mark is not closed".to_owned())
}

fn parse_side(text: &str) -> Result<(Side, &str), String> {
    match text.split_once(':') {
        Some(("A" | "a", rest)) => Ok((Side::A, rest)),
        Some(("B" | "b", rest)) => Ok((Side::B, rest)),
        _ => Err("begin with the side, A: or B:".to_owned()),
    }
}

/// A side's variable of the environment.
pub fn parse_variable(text: &str) -> Result<(Side, (String, String)), String> {
    let (side, assignment) = parse_side(text)?;
    match assignment.split_once('=') {
        Some((name, value)) if !name.is_empty() && !text.contains('\0') => {
            Ok((side, (name.to_owned(), value.to_owned())))
        }
        _ => Err("give NAME=VALUE after the side".to_owned()),
    }
}

/// A side's program.
pub fn parse_binary(text: &str) -> Result<(Side, PathBuf), String> {
    let (side, path) = parse_side(text)?;
    if path.is_empty() { Err("give a file after the side".to_owned()) } else { Ok((side, path.into())) }
}

impl AbArgs {
    /// SHA-256 of what fixes the blocks of a side.
    pub fn identity(&self, side: Side) -> Result<String, Failure> {
        let text = |arguments: &[OsString]| {
            arguments.iter().map(|argument| argument.to_string_lossy().into_owned()).collect::<Vec<_>>()
        };
        let mut programs = Vec::new();
        for (of, path) in &self.binary {
            let failed = |e| Failure::Input(format!("side {of:?}: reading {}: {e}", path.display()));
            programs.push((format!("{of:?}"), content::file_sha256(path).map_err(failed)?));
        }
        let variables: Vec<_> = self.env.iter().map(|(of, variable)| (format!("{of:?}"), variable)).collect();
        let fixed =
            json!([format!("{side:?}"), self.a.0, self.b.0, variables, programs, self.blocks, text(&self.common)]);
        Ok(content::sha256(fixed.to_string().as_bytes()))
    }

    /// The program that was named for a side.
    fn binary(&self, side: Side) -> Option<&PathBuf> {
        self.binary.iter().rev().find(|(of, _)| *of == side).map(|(_, path)| path)
    }

    fn variables(&self, side: Side) -> impl Iterator<Item = &(String, String)> {
        self.env.iter().filter(move |(of, _)| *of == side).map(|(_, variable)| variable)
    }

    /// Lists the sides' own variables among the differences, as far as no record tells of them.
    pub fn list_variables(&self, comparison: &mut Comparison) {
        for (_, (name, _)) in &self.env {
            let [a, b] = [Side::A, Side::B].map(|side| {
                let given = self.variables(side).filter(|(known, _)| known == name).map(|(_, value)| value.clone());
                given.last().or_else(|| std::env::var(name).ok()).into_iter().collect::<Vec<_>>()
            });
            let what = format!("host.variables.{name}");
            let is_told = name == "LP_NUM_THREADS" || comparison.differences.iter().any(|known| known.what == what);
            if a != b && !is_told {
                comparison.differences.push(Difference { what, a, b });
            }
        }
    }

    /// Arguments of a side's program, without those that say where its record goes.
    pub fn arguments(&self, side: Side) -> Result<Vec<OsString>, Failure> {
        let own = if side == Side::A { &self.a.0 } else { &self.b.0 };
        let (paper, options) = match &self.common[..] {
            [paper, verb, rest @ ..] if verb == "bench" => (paper, rest),
            [paper, rest @ ..] => (paper, rest),
            [] => return Err(Failure::Input("ab: name a paper, as in: ab --b \"--seed 2\" gas".to_owned())),
        };
        let arguments = [paper.clone(), "bench".into()].into_iter().chain(options.iter().cloned());
        Ok(arguments.chain(own.iter().map(OsString::from)).collect())
    }

    /// Refuses what a side's bench would refuse before it measures, and lists the files that it writes. Of another build no more is
    /// known than that it is there.
    pub fn check(&self, side: Side) -> Result<Vec<PathBuf>, Failure> {
        let arguments = self.arguments(side)?;
        if let Some(program) = self.binary(side) {
            let folders = std::env::var_os("PATH").unwrap_or_default();
            let is_there = match program.components().count() {
                1 => std::env::split_paths(&folders).any(|folder| folder.join(program).is_file()),
                _ => program.is_file(),
            };
            // Elsewhere its ending may be left out.
            if cfg!(unix) && !is_there {
                let message = format!("{}: there is no such program; name a build of fumarole", program.display());
                return Err(Failure::Input(message));
            }
            return Ok(Vec::new());
        }
        let papers = listed();
        let name = arguments.first().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(paper) = papers.iter().find(|paper| paper.name == name) else {
            let message = format!("{name}: there is no such paper; name one of {}", paper_names(&papers));
            return Err(Failure::Input(message));
        };
        let matches = (paper.command)().try_get_matches_from(&arguments).map_err(|error| {
            let text = error.to_string();
            // Behind the first lines come usage and hints on it.
            let first = text.split("\n\n").next().unwrap_or_default();
            Failure::Input(first.strip_prefix("error: ").unwrap_or(first).to_owned())
        })?;
        matches.subcommand_matches("bench").map_or(Ok(Vec::new()), paper.check)
    }

    /// The files that a side reads, as far as this program knows its options: those of another build may be others.
    pub fn read(&self, side: Side) -> Vec<PathBuf> {
        let arguments = self.arguments(side).unwrap_or_default();
        let papers = listed();
        let paper = arguments.first().and_then(|name| papers.iter().find(|paper| name == paper.name));
        let read = paper.and_then(|paper| {
            let matches = (paper.command)().try_get_matches_from(&arguments).ok()?;
            Some((paper.read)(matches.subcommand_matches("bench")?))
        });
        read.unwrap_or_default().into_iter().chain(self.binary(side).cloned()).collect()
    }

    /// The command that measures a side once, as a shell takes it.
    pub fn command(&self, side: Side) -> Result<Vec<String>, Failure> {
        let own = std::env::args_os().next().unwrap_or_else(|| "fumarole".into());
        let program = self.binary(side).map_or(own, |path| path.clone().into_os_string());
        let mut variables: Vec<String> = self.variables(side).map(|(name, value)| format!("{name}={value}")).collect();
        if !variables.is_empty() {
            variables.insert(0, "env".to_owned());
        }
        let arguments = std::iter::once(program).chain(self.arguments(side)?);
        Ok(variables.into_iter().chain(arguments.map(|argument| argument.to_string_lossy().into_owned())).collect())
    }

    /// Measures one side in a fresh process, its process of that number. The first of a side alone measures the device's
    /// limits, if they are asked for at all, and writes what every one would write alike.
    pub fn measure(&self, side: Side, process: u32, is_first: bool) -> Result<Record, Failure> {
        let failed = |e: std::io::Error| Failure::Running(format!("measuring side {side:?} in a fresh process: {e}"));
        let program = self.binary(side).map_or_else(std::env::current_exe, |path| Ok(path.clone())).map_err(failed)?;
        let file = crate::file::temporary().map_err(failed)?;
        let mut arguments = self.arguments(side)?;
        let without_limits = "--no-limits";
        if !is_first {
            arguments = without(&OF_THE_FIRST, arguments.into_iter());
            if !arguments.iter().any(|argument| argument == without_limits) {
                arguments.push(without_limits.into());
            }
        }
        let mut command = Command::new(&program);
        command
            .args(arguments)
            .args(["--process", &process.to_string(), "--quiet", "--out"])
            .arg(self.record_file(side).with_extension(""))
            .arg("--json")
            .arg(file.path())
            .envs(self.variables(side).cloned())
            .stdin(Stdio::null());
        let ended = finish(&mut command, interrupted()).map_err(|e| {
            Failure::Input(format!("side {side:?}: starting {}: {e}; name a build of fumarole", program.display()))
        })?;
        if !ended.status.success() {
            return Err(ended.failure(format!("side {side:?}: {}", ended.message())));
        }
        reader::read(file.path()).map_err(|_| {
            let program = program.display();
            let message =
                format!("{program} has ended without a record that this program reads; name a build of fumarole");
            Failure::Input(message).of(&format!("side {side:?}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_named_before_what_is_theirs() {
        let (side, variable) = parse_variable("B:VK_DRIVER_FILES=/a=b.json").unwrap();
        assert_eq!((side, variable), (Side::B, ("VK_DRIVER_FILES".to_owned(), "/a=b.json".to_owned())));
        for wrong in ["VK=1", "C:VK=1", "A:VK", "A:=1"] {
            parse_variable(wrong).unwrap_err();
        }
        assert_eq!(parse_binary("a:./old").unwrap(), (Side::A, PathBuf::from("./old")));
        parse_binary("A:").unwrap_err();
        assert_eq!(parse_side_options("--variant none --shader-dir 'a b'").unwrap().0.len(), 4);
        parse_side_options("'").unwrap_err();
    }
}

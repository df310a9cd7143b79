//! `ab`: two sides measured in turn, in fresh processes, until the verdicts are certain.

use std::ffi::OsString;
use std::ops::Range;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::json;

use super::compare::VerdictArgs;
use super::failure::Failure;
use super::outcome;
use super::processes::{failure, finish};
use super::watch::{interrupted, progress_bar};
use crate::content;
use crate::file;
use crate::measure::compare::{Comparison, Design, Input, LOOKS, Verdict, compare};
use crate::measure::shard::Shard;
use crate::report::record::Share;
use crate::report::{Record, environment, json as reader};

#[derive(Debug, Clone, Args)]
pub struct AbArgs {
    /// Options of side A alone, as one text: "--variant none --shader-dir changed"
    #[arg(long, value_name = "OPTIONS", value_parser = parse_words, allow_hyphen_values = true, default_value = "")]
    a: Words,
    /// Options of side B alone
    #[arg(long, value_name = "OPTIONS", value_parser = parse_words, allow_hyphen_values = true, default_value = "")]
    b: Words,
    /// Environment variable of one side; may be repeated
    #[arg(long, value_name = "A|B:NAME=VALUE", value_parser = parse_variable)]
    env: Vec<(Side, (String, String))>,
    /// Program of one side, in place of this one: another build of fumarole
    #[arg(long, value_name = "A|B:FILE", value_parser = parse_binary)]
    binary: Vec<(Side, PathBuf)>,
    /// Start no further block after this many seconds, 1 to 86400
    #[arg(long, value_name = "S", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=86_400))]
    budget: u64,
    /// Blocks A B B A at most, 2 to 40
    #[arg(long, value_name = "N", default_value_t = LAST_LOOK, value_parser = clap::value_parser!(u32).range(2..=i64::from(LAST_LOOK)))]
    blocks: u32,
    /// Of the blocks, measure the part I of N and compare nothing; assemble joins the records for compare --blocks
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Folder for the records of both sides, ab-a.json and ab-b.json
    #[arg(long, value_name = "DIR", default_value = "fumarole-out")]
    out: PathBuf,
    /// Print nothing but the comparison
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    verdict: VerdictArgs,
    /// Paper and options of both sides, as after bench: gas --preset fig-8
    #[arg(value_name = "PAPER [OPTIONS]", trailing_var_arg = true, allow_hyphen_values = true, required = true)]
    common: Vec<OsString>,
}

/// The verdicts, beside the records.
pub const VERDICTS_FILE: &str = "ab.json";

const LAST_LOOK: u32 = LOOKS[LOOKS.len() - 1] as u32;

/// A block's order: drift that is linear over its four processes cancels.
const BLOCK: [Side; 4] = [Side::A, Side::B, Side::B, Side::A];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    A,
    B,
}

/// Options as a shell would split them.
#[derive(Debug, Clone)]
struct Words(Vec<String>);

fn parse_words(text: &str) -> Result<Words, String> {
    shlex::split(text).map(Words).ok_or_else(|| "a quotation mark is not closed".to_owned())
}

fn parse_side(text: &str) -> Result<(Side, &str), String> {
    match text.split_once(':') {
        Some(("A" | "a", rest)) => Ok((Side::A, rest)),
        Some(("B" | "b", rest)) => Ok((Side::B, rest)),
        _ => Err("begin with the side, A: or B:".to_owned()),
    }
}

fn parse_variable(text: &str) -> Result<(Side, (String, String)), String> {
    let (side, assignment) = parse_side(text)?;
    match assignment.split_once('=') {
        Some((name, value)) if !name.is_empty() && !text.contains('\0') => {
            Ok((side, (name.to_owned(), value.to_owned())))
        }
        _ => Err("give NAME=VALUE after the side".to_owned()),
    }
}

fn parse_binary(text: &str) -> Result<(Side, PathBuf), String> {
    let (side, path) = parse_side(text)?;
    if path.is_empty() { Err("give a file after the side".to_owned()) } else { Ok((side, path.into())) }
}

pub fn run(arguments: &AbArgs) -> Result<(), Failure> {
    let files = [Side::A, Side::B].map(|side| arguments.record_file(side));
    let verdicts = arguments.out.join(VERDICTS_FILE);
    files.iter().chain([&verdicts]).try_for_each(|path| file::check_writable(path))?;
    let interrupted = interrupted();
    let own = arguments.own_blocks()?;
    let bar = progress_bar(arguments.quiet, "blocks A B B A");
    bar.set_length(own.len() as u64);
    let deadline = Instant::now() + Duration::from_secs(arguments.budget);
    let mut records: [Vec<Record>; 2] = [vec![], vec![]];
    let mut comparison = None;
    for block in own.start as usize + 1..=own.end as usize {
        let mut measured = vec![];
        for (place, side) in BLOCK.into_iter().enumerate() {
            let process = 2 * (block - 1) + usize::from(place > 1);
            match arguments.measure(side, process) {
                Ok(record) => measured.push((side, record)),
                Err(_) if interrupted.load(Ordering::Relaxed) => break,
                Err(failure) => return Err(failure),
            }
        }
        // An unfinished block cancels no drift.
        if measured.len() == BLOCK.len() {
            for (side, record) in measured {
                records[side as usize].push(record);
            }
            bar.inc(1);
        }
        let is_last = block == own.end as usize || Instant::now() >= deadline || interrupted.load(Ordering::Relaxed);
        if arguments.shard.is_some() {
            // How many blocks there will be is decided beforehand: no look.
            if is_last {
                break;
            }
        } else if is_last || LOOKS.contains(&block) {
            comparison = arguments.look(&records)?;
            if is_last || comparison.as_ref().is_some_and(is_decided) {
                break;
            }
        }
    }
    bar.finish_and_clear();
    if let Some(shard) = arguments.shard {
        return arguments.leave(shard, own.start, &records);
    }
    let Some(mut comparison) = comparison else {
        let end = if interrupted.load(Ordering::Relaxed) { "interrupted" } else { "the --budget was over" };
        return Err(Failure::Running(format!("{end} before two blocks were measured; nothing can be said")));
    };
    for ((file, side), name) in files.iter().zip(&records).zip([&mut comparison.a, &mut comparison.b]) {
        if let Some(joined) = joined(side) {
            file::write(file, outcome::text(&joined)?.as_bytes())?;
            *name = vec![file.display().to_string()];
            if !arguments.quiet {
                outcome::say(&format!("wrote {}", file.display()));
            }
        }
    }
    comparison.a_commands = vec![arguments.command(Side::A)?];
    comparison.b_commands = vec![arguments.command(Side::B)?];
    // What the page of a report shows: compared again, without the options of this call, it might be decided otherwise.
    file::write(&verdicts, outcome::text(&comparison)?.as_bytes())?;
    if !arguments.quiet {
        outcome::say(&format!("wrote {}", verdicts.display()));
    }
    arguments.verdict.publish(&comparison)
}

/// True when the frame and every pass that counts have a verdict, and stand on one side of the limit if there is one.
fn is_decided(comparison: &Comparison) -> bool {
    let counting = || comparison.quantities().filter(|quantity| quantity.counts);
    !comparison.is_unclear() && counting().all(|quantity| quantity.verdict != Verdict::Unclear)
}

/// All records of one side as one.
fn joined(records: &[Record]) -> Option<Record> {
    let mut joined = records.first()?.clone();
    joined.command = environment::command();
    joined.runs = records.iter().flat_map(|record| record.runs.clone()).collect();
    Some(joined)
}

impl AbArgs {
    fn record_file(&self, side: Side) -> PathBuf {
        let shard = self.shard.map_or_else(String::new, |shard| format!("-{shard}"));
        self.out.join(format!("ab-{}{shard}.json", if side == Side::A { "a" } else { "b" }))
    }

    /// Blocks that this process measures.
    fn own_blocks(&self) -> Result<Range<u32>, Failure> {
        match self.shard {
            Some(shard) if shard.count > self.blocks => {
                let message = format!("--shard: there are {} --blocks for {} shards", self.blocks, shard.count);
                Err(Failure::Input(message))
            }
            shard => Ok(shard.unwrap_or(Shard::ALONE).of(0..self.blocks)),
        }
    }

    /// Writes the records of a shard, whose first block has a number.
    fn leave(&self, shard: Shard, first: u32, records: &[Vec<Record>; 2]) -> Result<(), Failure> {
        for side in [Side::A, Side::B] {
            let measured = &records[side as usize];
            let Some(mut record) = joined(measured) else {
                return Err(Failure::Running("interrupted before a block was measured; nothing is left".to_owned()));
            };
            let blocks = (0..).zip(measured).map(|(process, record)| (first + process / 2, record.runs.len()));
            let items = blocks.flat_map(|(block, runs)| std::iter::repeat_n(block, runs)).collect();
            record.share =
                Some(Share { identity: self.identity(side)?, shard: Some([shard.number, shard.count]), items });
            let file = self.record_file(side);
            file::write(&file, outcome::text(&record)?.as_bytes())?;
            if !self.quiet {
                outcome::say(&format!("wrote {}", file.display()));
            }
        }
        Ok(())
    }

    /// SHA-256 of what fixes the blocks of a side.
    fn identity(&self, side: Side) -> Result<String, Failure> {
        let text =
            |words: &[OsString]| words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>();
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

    /// Compares the blocks so far; absent with fewer than two.
    fn look(&self, records: &[Vec<Record>; 2]) -> Result<Option<Comparison>, Failure> {
        if records[0].len() < 4 {
            return Ok(None);
        }
        let inputs = |side: Side| -> Vec<Input> {
            let name = self.record_file(side).display().to_string();
            records[side as usize].iter().map(|record| Input { name: name.clone(), record: record.clone() }).collect()
        };
        let (a, b) = (inputs(Side::A), inputs(Side::B));
        Ok(Some(compare(&a, &b, &self.verdict.options(Design::Blocks).for_blocks(&a, &b))?))
    }

    /// The program that was named for a side.
    fn binary(&self, side: Side) -> Option<&PathBuf> {
        self.binary.iter().rev().find(|(of, _)| *of == side).map(|(_, path)| path)
    }

    fn variables(&self, side: Side) -> impl Iterator<Item = &(String, String)> {
        self.env.iter().filter(move |(of, _)| *of == side).map(|(_, variable)| variable)
    }

    /// What a side's program is given, but for where its record goes.
    fn words(&self, side: Side) -> Result<Vec<OsString>, Failure> {
        let own = if side == Side::A { &self.a.0 } else { &self.b.0 };
        let (paper, options) = match &self.common[..] {
            [paper, verb, rest @ ..] if verb == "bench" => (paper, rest),
            [paper, rest @ ..] => (paper, rest),
            [] => return Err(Failure::Input("ab: name a paper, as in: ab --b \"--seed 2\" gas".to_owned())),
        };
        let words = [paper.clone(), "bench".into()].into_iter().chain(options.iter().cloned());
        Ok(words.chain(own.iter().map(OsString::from)).collect())
    }

    /// The command that measures a side once, as a shell takes it.
    fn command(&self, side: Side) -> Result<Vec<String>, Failure> {
        let own = std::env::args_os().next().unwrap_or_else(|| "fumarole".into());
        let program = self.binary(side).map_or(own, |path| path.clone().into_os_string());
        let mut variables: Vec<String> = self.variables(side).map(|(name, value)| format!("{name}={value}")).collect();
        if !variables.is_empty() {
            variables.insert(0, "env".to_owned());
        }
        let words = std::iter::once(program).chain(self.words(side)?);
        Ok(variables.into_iter().chain(words.map(|word| word.to_string_lossy().into_owned())).collect())
    }

    /// Measures one side in a fresh process.
    fn measure(&self, side: Side, process: usize) -> Result<Record, Failure> {
        let failed = |e: std::io::Error| Failure::Running(format!("measuring side {side:?} in a fresh process: {e}"));
        let program = self.binary(side).map_or_else(std::env::current_exe, |path| Ok(path.clone())).map_err(failed)?;
        let file = crate::file::temporary().map_err(failed)?;
        let mut command = Command::new(&program);
        command
            .args(self.words(side)?)
            .args(["--process", &process.to_string(), "--quiet", "--json"])
            .arg(file.path())
            .envs(self.variables(side).cloned())
            .stdin(Stdio::null());
        let ended = finish(&mut command, interrupted()).map_err(|e| {
            Failure::Input(format!("side {side:?}: starting {}: {e}; name a build of fumarole", program.display()))
        })?;
        if !ended.status.success() {
            return Err(failure(&format!("side {side:?}"), &ended));
        }
        Ok(reader::read(file.path())?)
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
        assert_eq!(parse_words("--variant none --shader-dir 'a b'").unwrap().0.len(), 4);
        parse_words("'").unwrap_err();
    }
}

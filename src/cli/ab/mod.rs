//! `ab`: two sides measured in turn, in fresh processes, until the verdicts are certain.

mod arguments;
mod side;

pub(super) use arguments::reordered;

use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::compare::VerdictArgs;
use super::failure::Failure;
use super::outcome;
use super::pool;
use super::watch::{interrupted, patiently, progress_bar};
use crate::file;
use crate::measure::compare::{Comparison, Design, Input, LOOKS, compare};
use crate::measure::shard::Shard;
use crate::report::record::Share;
use crate::report::{Record, environment};
use side::{Side, SideOptions, parse_binary, parse_side_options, parse_variable};

#[derive(Debug, Clone, Args)]
pub struct AbArgs {
    /// Options of side A alone, as one text: "--variant none --shader-dir changed"
    #[arg(long, value_name = "OPTIONS", value_parser = parse_side_options, allow_hyphen_values = true, default_value = "")]
    a: SideOptions,
    /// Options of side B alone
    #[arg(long, value_name = "OPTIONS", value_parser = parse_side_options, allow_hyphen_values = true, default_value = "")]
    b: SideOptions,
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
    /// Paper and options of both sides, as after bench: gas --preset fig-8; ab's own may stand among them
    #[arg(value_name = "PAPER [OPTIONS]", trailing_var_arg = true, allow_hyphen_values = true, required = true)]
    common: Vec<OsString>,
}

/// The verdicts, beside the records.
pub const VERDICTS_FILE: &str = "ab.json";

const LAST_LOOK: u32 = LOOKS[LOOKS.len() - 1] as u32;

/// A block's order: drift that is linear over its four processes cancels.
const BLOCK: [Side; 4] = [Side::A, Side::B, Side::B, Side::A];

pub fn run(arguments: &AbArgs) -> Result<(), Failure> {
    arguments.check_arguments()?;
    let files = [Side::A, Side::B].map(|side| arguments.record_file(side));
    let verdicts = arguments.out.join(VERDICTS_FILE);
    let named = arguments.verdict.json.iter().filter(|path| path.as_os_str() != "-");
    files.iter().chain([&verdicts]).chain(named.clone()).try_for_each(|path| file::check_writable(path))?;
    // Verdicts that are named as the folder's own are the same.
    let read = [Side::A, Side::B].map(|side| arguments.read(side)).concat();
    outcome::check_apart(files.iter().chain(named.clone()), &read)?;
    outcome::check_apart([&verdicts], &read)?;
    let own = arguments.own_blocks()?;
    let of_sides = arguments.check_sides()?;
    outcome::check_apart(files.iter().chain(named).chain(&of_sides), &read)?;
    outcome::check_apart([&verdicts].into_iter().chain(&of_sides), &read)?;
    let interrupted = interrupted();
    let bar = progress_bar(arguments.quiet, "blocks A B B A");
    bar.set_length(own.len() as u64);
    let deadline = Instant::now() + Duration::from_secs(arguments.budget);
    let mut records: [Vec<Record>; 2] = [vec![], vec![]];
    // A failure ends the measurement, and throws no block away.
    let (mut comparison, mut failed) = (None, None);
    for block in own.clone() {
        let measured = arguments.measure_block(block, block == own.start);
        let is_interrupted = interrupted.load(Ordering::Relaxed);
        match measured {
            Ok(measured) if !is_interrupted => {
                for (side, record) in measured {
                    records[side as usize].push(record);
                }
                bar.inc(1);
            }
            // An unfinished block cancels no drift, and an interrupted process may have left a part.
            Ok(_) => {}
            Err(failure) => failed = (!is_interrupted).then_some(failure),
        }
        let is_last = block + 1 == own.end || Instant::now() >= deadline || is_interrupted || failed.is_some();
        if arguments.shard.is_some() {
            // How many blocks there will be is decided beforehand: no look.
            if is_last {
                break;
            }
        } else if is_last || LOOKS.contains(&(block as usize + 1)) {
            match arguments.look(&records) {
                Ok(found) => comparison = found,
                Err(failure) => failed = failed.or(Some(failure)),
            }
            if is_last || failed.is_some() || comparison.as_ref().is_some_and(Comparison::is_decided) {
                break;
            }
        }
    }
    bar.finish_and_clear();
    if let Some(shard) = arguments.shard {
        let left = arguments.leave(shard, own, &records);
        return failed.map_or(left, Err);
    }
    if has_two_blocks(&records) {
        for (file, side) in files.iter().zip(&records) {
            if let Some(joined) = joined(side) {
                arguments.write(file, &joined)?;
            }
        }
    }
    let Some(mut comparison) = comparison else {
        if has_two_blocks(&records) {
            // Verdicts of an earlier call are none of these records.
            let _gone = std::fs::remove_file(&verdicts);
        }
        return Err(failed.unwrap_or_else(|| {
            let end = if interrupted.load(Ordering::Relaxed) { "interrupted" } else { "the --budget was over" };
            Failure::Running(format!("{end} before two blocks were measured; nothing can be said"))
        }));
    };
    [comparison.a, comparison.b] = files.map(|file| vec![file.display().to_string()]);
    arguments.list_variables(&mut comparison);
    comparison.a_commands = vec![arguments.command(Side::A)?];
    comparison.b_commands = vec![arguments.command(Side::B)?];
    // What the page of a report shows: compared again, without the options of this call, it might be decided otherwise.
    arguments.write(&verdicts, &comparison)?;
    let published = arguments.verdict.publish(&comparison);
    failed.map_or(published, Err)
}

/// True when there is enough for a comparison.
fn has_two_blocks(records: &[Vec<Record>; 2]) -> bool {
    records.iter().all(|side| side.len() >= 4)
}

/// All records of one side as one.
fn joined(records: &[Record]) -> Option<Record> {
    let mut joined = records.first()?.clone();
    joined.command = environment::command();
    joined.runs = records.iter().flat_map(|record| record.runs.clone()).collect();
    Some(joined)
}

impl AbArgs {
    /// Checks both sides before one of them is measured, and lists the files that they write themselves.
    fn check_sides(&self) -> Result<Vec<PathBuf>, Failure> {
        pool::start()?;
        let check = || [Side::A, Side::B].map(|side| self.check(side));
        match patiently(self.quiet, "checking both sides", check) {
            [Err(a), Err(b)] if a.to_string() == b.to_string() => Err(a.of("both sides")),
            [Err(a), _] => Err(a.of("side A")),
            [Ok(a), b] => Ok([a, b.map_err(|failure| failure.of("side B"))?].concat()),
        }
    }

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

    /// Writes the records of a shard, of as many of its blocks as were measured.
    fn leave(&self, shard: Shard, own: Range<u32>, records: &[Vec<Record>; 2]) -> Result<(), Failure> {
        let (first, all, done) = (own.start, own.len(), records[0].len() / 2);
        for side in [Side::A, Side::B] {
            let measured = &records[side as usize];
            let Some(mut record) = joined(measured) else {
                return Err(Failure::Running("interrupted before a block was measured; nothing is left".to_owned()));
            };
            let blocks = (0..).zip(measured).map(|(process, record)| (first + process / 2, record.runs.len()));
            let items = blocks.flat_map(|(block, runs)| std::iter::repeat_n(block, runs)).collect();
            record.share =
                Some(Share { identity: self.identity(side)?, shard: Some([shard.number, shard.count]), items });
            if let Some(last) = record.runs.last_mut().filter(|_| done < all) {
                last.warnings.push(format!("{shard} was ended after {done} of its {all} blocks"));
            }
            self.write(&self.record_file(side), &record)?;
        }
        if done < all && !self.quiet {
            outcome::say(&format!("warning: {shard} was ended after {done} of its {all} blocks"));
        }
        Ok(())
    }

    /// Writes a document and says so.
    fn write(&self, file: &Path, document: &impl Serialize) -> Result<(), Failure> {
        file::write(file, outcome::text(document)?.as_bytes())?;
        if !self.quiet {
            outcome::say(&format!("wrote {}", file.display()));
        }
        Ok(())
    }

    /// Measures a block; the limits of the device take seconds, and are the same in all.
    fn measure_block(&self, block: u32, is_first: bool) -> Result<Vec<(Side, Record)>, Failure> {
        let (mut seen, mut measured) = ([0; 2], Vec::new());
        for side in BLOCK {
            let place = &mut seen[side as usize];
            measured.push((side, self.measure(side, 2 * block + *place, is_first && *place == 0)?));
            *place += 1;
        }
        Ok(measured)
    }

    /// Compares the blocks so far; absent with fewer than two.
    fn look(&self, records: &[Vec<Record>; 2]) -> Result<Option<Comparison>, Failure> {
        if !has_two_blocks(records) {
            return Ok(None);
        }
        let inputs = |side: Side| -> Vec<Input> {
            let name = self.record_file(side).display().to_string();
            records[side as usize].iter().map(|record| Input { name: name.clone(), record: record.clone() }).collect()
        };
        let (a, b) = (inputs(Side::A), inputs(Side::B));
        Ok(Some(compare(&a, &b, &self.verdict.options(Design::Blocks).for_blocks(&a, &b))?))
    }
}

//! Every call of every variant fails in turn, round after round in one process: the machine is opened, the paper made, measured
//! and drawn, its record and its picture take the place of old files, and all of it is given up. A round takes a small part of
//! what a program takes.

use std::collections::HashSet;
use std::env;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use fumarole::cli::Failure;
use fumarole::gpu::{self, Instance, PhysicalDevice};
use fumarole::image::{read_png, write_png};
use fumarole::measure::bench::{Bench, Loaded, load};
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::measure::{Schedule, Watch};
use fumarole::measure::parameter::Given;
use fumarole::measure::picture::render;
use fumarole::measure::study::{Study, Visitor};
use fumarole::measure::{Error, Paper as _, Variant};
use fumarole::report::{Record, environment, json};
use fumarole::{file, papers};
use tempfile::TempDir;

use super::calls::{FAILURES, HARMLESS, MEMORY, code};
use super::{Layer, PAPERS, Paper, Report};
use crate::cli::program::{entries, folder};
use crate::common::wanted_device;

/// Paper whose rounds a process is to run, the file that keeps what was found, and that which tells the layer of rounds.
const PAPER: &str = "FUMAROLE_TEST_FAULTY_PAPER";
const FOUND: &str = "FUMAROLE_TEST_FAULTS_FOUND";
const ROUND: &str = "FUMAROLE_LAYER_ROUNDS";
/// Rounds of a process; the driver may keep some memory of each.
const MOST_ROUNDS: usize = 1000;

/// Runs the rounds of a paper that `found` has nothing of yet.
pub fn assert_all_faults_are_told(paper: &Paper, found: &Path) {
    let found = std::path::absolute(found).unwrap();
    let summary = loop {
        let layer = Layer::new();
        let round = layer.folder.path().join("round");
        fs::write(&round, "").unwrap();
        let test = ["--exact", "faults::rounds::rounds_of_a_process", "--nocapture"];
        let mut command = Command::new(env::current_exe().unwrap());
        // Of many papers, two go on at a time.
        command.args(test).envs(layer.environment(false)).env("LP_NUM_THREADS", "1");
        let output = command.env(PAPER, paper.name).env(FOUND, &found).env(ROUND, &round).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            // What it was at was the end of it.
            let text = format!("{text}{}", String::from_utf8_lossy(&output.stderr));
            let at = fs::read_to_string(&round).unwrap();
            let (variant, failing) = at.split_once(' ').filter(|(_, failing)| !failing.is_empty()).expect(&text);
            let call = format!("{} {} {failing}", paper.name, variant.split('/').next_back().unwrap());
            note(&mut open(&found), &call, Err(format!("the process ended with {}", output.status)));
        } else if let Some(summary) = text.lines().find_map(|line| line.strip_prefix("rounds: ")) {
            break summary.to_owned();
        }
    };
    let log = fs::read_to_string(&found).unwrap();
    let of_paper = format!("NOT TOLD: {} ", paper.name);
    let failures: Vec<&str> = log.lines().filter(|line| line.starts_with(&of_paper)).collect();
    println!("{}: {summary}, {} not told", paper.name, failures.len());
    assert!(failures.is_empty(), "{failures:#?}");
}

fn open(found: &Path) -> File {
    OpenOptions::new().append(true).create(true).open(found).unwrap()
}

/// Keeps what was found of a call.
fn note(found: &mut File, call: &str, outcome: Result<(), String>) {
    let line = match outcome {
        Ok(()) => format!("told: {call}\n"),
        Err(problem) => format!("NOT TOLD: {call}: {}\n", problem.split_whitespace().collect::<Vec<_>>().join(" ")),
    };
    found.write_all(line.as_bytes()).unwrap();
}

/// Calls to fail, by name and number, and how: in turn, and the ends of each name in each way. Names of objects, which cost
/// nothing but the name, fail all in one round (number 0).
fn every(calls: &[(String, usize)]) -> Vec<(&str, usize, &'static str)> {
    let mut all = Vec::new();
    for (name, count) in calls {
        let ends = [1, *count];
        let is_asked = |number: &usize| name != HARMLESS || ends.contains(number);
        for number in (1..=*count).filter(is_asked) {
            let in_each_way = ends.contains(&number);
            let ways = (0..FAILURES.len()).filter(|way| in_each_way || *way == number % FAILURES.len());
            all.extend(ways.map(|way| (name.as_str(), number, FAILURES[way])));
        }
        if name == HARMLESS {
            all.extend(["host", "device"].map(|failure| (name.as_str(), 0, failure)));
        }
    }
    all
}

/// In a process of the tests: what is left of a paper's rounds. By itself: no call is left out.
#[test]
fn rounds_of_a_process() {
    let known: &'static [Paper] = &PAPERS;
    let Some(paper) = env::var(PAPER).ok().and_then(|name| known.iter().find(|paper| paper.name == name)) else {
        let calls = [("vkCreateFence".to_owned(), 4), (HARMLESS.to_owned(), 9)];
        let all = every(&calls);
        for number in 1..=4 {
            assert!(all.iter().any(|(name, at, _)| *name == "vkCreateFence" && *at == number), "{all:?}");
        }
        assert_eq!(all.iter().filter(|(name, ..)| *name == "vkCreateFence").count(), 3 + 1 + 1 + 3, "{all:?}");
        assert_eq!(all.iter().filter(|(name, ..)| *name == HARMLESS).count(), 3 + 3 + 2, "{all:?}");
        return;
    };
    let path = |variable: &str| PathBuf::from(env::var_os(variable).unwrap());
    let log = fs::read_to_string(path(FOUND)).unwrap_or_default();
    let call =
        |line: &str| line.split_once(": ").map(|(_, rest)| rest.split(": ").next().unwrap_or_default().to_owned());
    let mut rounds = Rounds {
        paper,
        round: path(ROUND),
        report: path("FUMAROLE_LAYER_REPORT"),
        done: log.lines().filter_map(call).collect(),
        found: open(&path(FOUND)),
        number: 0,
        calls: 0,
        variants: 0,
        has_more: false,
        out: folder(),
    };
    papers::each(&mut rounds).unwrap();
    if !rounds.has_more {
        println!("\nrounds: {} failing calls of {} variants", rounds.calls, rounds.variants);
    }
}

struct Rounds {
    paper: &'static Paper,
    round: PathBuf,
    report: PathBuf,
    /// Calls that were made to fail before, with paper, variant and way.
    done: HashSet<String>,
    found: File,
    /// Rounds so far.
    number: usize,
    /// Calls to fail so far, and the variants that make them.
    calls: usize,
    variants: usize,
    /// It ended before all was done.
    has_more: bool,
    /// Folder of the files of each round.
    out: TempDir,
}

impl Visitor for Rounds {
    type Error = Error;

    fn visit<S: Study>(&mut self) -> Result<(), Error> {
        if S::PAPER != self.paper.name {
            return Ok(());
        }
        let study: S = study(self.paper.scene)?;
        let loaded = load(&study)?;
        // Keeps the driver loaded from round to round.
        let anchor = Instance::new(false)?;
        for &variant in S::Variant::ALL {
            self.variants += 1;
            let out = self.out.path().to_owned();
            let work = || bench(&study, &loaded, variant, &out);
            let (whole, report) = self.run(&anchor, variant.as_str(), "", work);
            whole.unwrap();
            assert_eq!(written(&out), Ok([true; FILES.len()]), "{}", variant.as_str());
            for (name, number, failure) in every(&report.calls) {
                let failing = format!("{name}@{number}:{failure}");
                let call = format!("{} {} {failing}", S::PAPER, variant.as_str());
                self.calls += 1;
                if self.done.contains(&call) {
                    continue;
                }
                if self.number >= MOST_ROUNDS {
                    self.has_more = true;
                    return Ok(());
                }
                let work = || panic::catch_unwind(AssertUnwindSafe(|| bench(&study, &loaded, variant, &out)));
                let (outcome, report) = self.run(&anchor, variant.as_str(), &failing, work);
                let judged = judged((name, number, failure), outcome, &report, written(&out));
                note(&mut self.found, &call, judged);
            }
        }
        Ok(())
    }
}

impl Rounds {
    /// A round in which a call fails, and what the layer saw in it.
    fn run<T>(
        &mut self,
        anchor: &Arc<Instance>,
        variant: &str,
        failing: &str,
        work: impl FnOnce() -> T,
    ) -> (T, Report) {
        self.number += 1;
        for name in FILES {
            fs::write(self.out.path().join(name), OLD).unwrap();
        }
        fs::write(&self.round, format!("{}/{variant} {failing}", self.number)).unwrap();
        let outcome = work();
        fs::write(&self.round, format!("{}/after ", self.number)).unwrap();
        // The layer ends a round with the first call of the next.
        PhysicalDevice::enumerate(anchor).unwrap();
        (outcome, Report::of(&fs::read_to_string(&self.report).unwrap()))
    }
}

/// The set-up of options as they are typed.
fn study<S: Study>(options: &str) -> Result<S, Error> {
    let mut study = S::default();
    let words: Vec<&str> = options.split_whitespace().collect();
    let pairs = || words.chunks(2).map(|pair| (pair[0].trim_start_matches('-'), pair[1]));
    for (name, value) in pairs() {
        let declared = S::parameters().into_iter().find(|p| p.name == name).expect("the paper has the parameter");
        declared.set(&mut study, &[OsStr::new(value)]).map_err(Error::Input)?;
    }
    study.resolve(&pairs().map(|(name, _)| name.to_owned()).collect::<Given>())?;
    Ok(study.alternatives().swap_remove(0))
}

/// A round's record and picture.
const FILES: [&str; 2] = ["a.json", "a.png"];
/// Their contents before it.
const OLD: &str = "old";

/// As the program's `bench` with a picture, from a device that is not open to one that is closed.
fn bench<S: Study>(study: &S, loaded: &Loaded<S>, variant: S::Variant, out: &Path) -> Result<(), Failure> {
    static NEVER: AtomicBool = AtomicBool::new(false);
    let options = MachineOptions { device: Some(wanted_device()), ..MachineOptions::default() };
    let mut machine = Machine::open(&options, S::NEEDS)?;
    let schedule = Schedule { warmup: 1, frames: 2, repeat: 1, min_time_s: 0.0 };
    let mut watch = Watch { interrupted: &NEVER, progress: &mut |_, _| {} };
    let bench = Bench { study, loaded, variants: &[variant], schedule, limits: None };
    let [record, picture] = FILES.map(|name| out.join(name));
    // A picture that fails throws no measurement away.
    let mut drawn = Ok(());
    let measured = bench.measure_and(&mut machine, &mut watch, |machine, paper| {
        let rendered = paper.restart().map_err(Error::from).and_then(|()| render(machine, paper, 0));
        drawn = rendered.map_err(Failure::from).and_then(|pixels| Ok(write_png(&picture, &pixels)?));
        Ok(())
    })?;
    let runs = measured.into_iter().map(|measured| measured.run).collect();
    let text = json::to_string(&Record::new(machine.environment(), environment::command(), runs)).unwrap();
    file::write_unsynced(&record, |file| file.write_all(text.as_bytes()))?;
    drawn
}

/// True of each file that is a whole new one, false of an old one.
fn written(out: &Path) -> Result<[bool; FILES.len()], String> {
    let there = entries(out);
    if there != FILES {
        return Err(format!("{there:?} are there"));
    }
    let is_old = |name: &str| fs::read(out.join(name)).is_ok_and(|bytes| bytes == OLD.as_bytes());
    let [record, picture] = FILES.map(|name| out.join(name));
    let is_whole = [json::read(&record).is_ok(), read_png(&picture).is_ok()];
    match FILES.iter().zip(is_whole).find(|(name, is_whole)| !is_whole && !is_old(name)) {
        Some((name, _)) => Err(format!("half of {name} is there")),
        None => Ok(is_whole),
    }
}

/// Nothing is left alive, and the failure is told in one line and by the exit code.
fn judged(
    (name, number, failure): (&str, usize, &str),
    outcome: thread::Result<Result<(), Failure>>,
    report: &Report,
    written: Result<[bool; FILES.len()], String>,
) -> Result<(), String> {
    let written = written?;
    let outcome = outcome.map_err(|_| "it panicked".to_owned())?;
    if report.alive != ["Instance 1"] {
        return Err(format!("{:?} are alive", report.alive));
    }
    match (outcome, &report.failed) {
        // A wait is asked again where the machine is slow, and the round that was counted had more of them.
        (Ok(()), None) if report.count(name) < number => Ok(()),
        (Ok(()), Some(_)) if MEMORY.contains(&name) || name == HARMLESS && failure != "lost" => Ok(()),
        (Err(_), Some(_)) if written == [true; FILES.len()] => {
            Err("it failed with all that it was to write".to_owned())
        }
        (Err(error), Some(_)) => {
            let (line, expected, found) = (error.to_string(), code(name, failure), i32::from(error.code()));
            if line.lines().count() != 1 || line.contains("allocating 0 bytes") {
                return Err(format!("it says {line:?}"));
            }
            if found == expected { Ok(()) } else { Err(format!("exit code {found} in place of {expected}: {line}")) }
        }
        (outcome, failed) => Err(format!("{outcome:?} where {failed:?} failed")),
    }
}

/// Of calls before there is a device and after that, failing in one line and otherwise.
#[test]
fn rounds_are_judged_by_exit_codes() {
    let report = Report::of("frames 0\nalive Instance 1\nfailed vkCreateFence\n");
    let judge =
        |name: &str, error: gpu::Error| judged((name, 1, "host"), Ok(Err(error.into())), &report, Ok([false; 2]));
    let lost = || gpu::Error::OutOfMemory { object: "fence".to_owned(), bytes: 0 };
    let absent = |reason: &str| gpu::Error::NoDevice { reason: reason.to_owned() };
    judge("vkCreateFence", lost()).unwrap();
    judge("vkCreateDevice", absent("none")).unwrap();
    let limit = gpu::Error::Limit { object: "fence".to_owned(), what: "count", wanted: 2, limit: 1 };
    for (wrong, part) in [
        (judge("vkCreateFence", absent("none")), "exit code 3 in place of 1"),
        (judge("vkCreateFence", limit), "exit code 2 in place of 1"),
        (judge("vkCreateDevice", lost()), "exit code 1 in place of 3"),
        (judge("vkCreateDevice", absent("two\nlines")), "it says"),
    ] {
        assert!(wrong.as_ref().is_err_and(|problem| problem.contains(part)), "{part}: {wrong:?}");
    }
}

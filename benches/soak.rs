//! Long runs: `cargo bench --bench soak -- [PAPER|all] [FRAMES] [DEVICE]`, which `dist/soak.sh` calls. A paper runs frame
//! after frame in one process, and must end as it began: no memory but what the first frames took, the same live
//! objects, the picture of a fresh run, and after a restart the times of the same frames in a fresh process, which runs
//! them in turn with it: whatever else the machine does slows both.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdout, Command, ExitCode, Stdio};
use std::time::Instant;

use fumarole::gpu::Mode;
use fumarole::measure::bench::{build, load};
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::picture::render;
use fumarole::measure::study::{Study, Visitor};
use fumarole::measure::{Error, Paper, Variant};
use fumarole::papers;

/// Frames after which pipelines, pools and the allocator have what they keep.
const WARMUP: u32 = 200;
/// Frames that are timed after the last, and in a fresh process.
const TIMED: u32 = 500;
/// Frames of one side after the other.
const BLOCK: u32 = 10;
/// Word after the others that makes a process the fresh one.
const FRESH: &str = "fresh";
/// Frames from one look at the live objects to the next.
const PERIOD: u32 = 500;
/// Most that a run may leave behind.
const MOST_GROWN_KB: i64 = 5 << 10;
/// Most by which the later of equal frames may be slower, in the middle of all.
const MOST_SLOWER: f64 = 1.1;

/// The smallest scenes in which every pass has something to do, and which go on from frame to frame.
fn small(paper: &str) -> &'static str {
    match paper {
        "burning" => {
            "size=16x12 mesh=sphere triangles=200 blocks=2x2x2 fire=20 smoke=10 speed=0.01 flammability=1000 first-frame=0"
        }
        "caustics" => "size=16x12 mesh=box map-size=16 planes=3 water-triangles=50",
        "gas" => "size=16x12 steps=4 table=4 frame-step=1",
        "lava" => "size=16x12 particles=50 radius=0.3 density=8x4x4 splats=10x5 splat-radius=0.2",
        "terrain" => "size=16x12 resolution=17",
        _ => "size=16x12",
    }
}

struct Soak {
    paper: String,
    frames: u32,
    machine: MachineOptions,
    is_fresh: bool,
    failures: Vec<String>,
}

impl Visitor for Soak {
    type Error = Error;

    fn visit<S: Study>(&mut self) -> Result<(), Error> {
        if self.paper != "all" && self.paper != S::PAPER {
            return Ok(());
        }
        let mut study = S::default();
        for (name, value) in small(S::PAPER).split(' ').filter_map(|word| word.split_once('=')) {
            if let Some(parameter) = S::parameters().iter().find(|parameter| parameter.name == name) {
                parameter.set(&mut study, &[OsStr::new(value)]).map_err(Error::Input)?;
            }
        }
        let started = Instant::now();
        let mut machine = Machine::open(&self.machine, S::NEEDS)?;
        let scene = load(&study)?.scene;
        let mut built = build(&machine, &study, &scene, S::RENDERED)?;
        let last = self.frames - 1;

        settled(&mut machine, &mut built.paper)?;
        built.paper.restart()?;
        if self.is_fresh {
            return answer(&mut machine, &mut built.paper);
        }
        let (mut objects, mut resident_kb) = (machine.device.live().alive(), 0);
        let mut is_constant = true;
        for number in 0..last {
            let paper = &mut built.paper;
            machine.recorder.run(Mode::Plain, |frame| paper.record(frame, number))?;
            if number == WARMUP {
                (objects, resident_kb) = (machine.device.live().alive(), resident());
            }
            if number > WARMUP && number % PERIOD == 0 {
                is_constant &= machine.device.live().alive() == objects;
            }
        }
        let picture = render(&mut machine, &mut built.paper, last)?;
        let grown_kb = resident() - resident_kb;
        is_constant &= machine.device.live().alive() == objects;

        built.paper.restart()?;
        let mut fresh = Fresh::start(S::PAPER, &self.machine)?;
        let mut ratios = vec![];
        for block in 0..TIMED.min(last) / BLOCK {
            let fresh_ms = fresh.block()?;
            ratios.push(block_ms(&mut machine, &mut built.paper, block)? / fresh_ms);
        }
        let slower = middle(ratios);
        drop(built);

        let is_equal = fresh.picture(last)? == picture.sha256();
        fresh.end();
        println!(
            "| {} {} | {} | {} | {grown_kb} kB | {} | {} | {slower:.2} | {:.0} s |",
            S::PAPER,
            S::RENDERED.as_str(),
            machine.device.physical().name,
            self.frames,
            if is_constant { "constant" } else { "changing" },
            if is_equal { "equal" } else { "different" },
            started.elapsed().as_secs_f64(),
        );
        for (is_good, what) in [
            (grown_kb < MOST_GROWN_KB, "memory grows"),
            (is_constant, "live objects change"),
            (is_equal, "the last picture is not that of a fresh run"),
            (slower < MOST_SLOWER, "frames become slower"),
        ] {
            if !is_good {
                self.failures.push(format!("{}: {what}", S::PAPER));
            }
        }
        Ok(())
    }
}

/// Median of a block's frames, milliseconds.
fn block_ms(machine: &mut Machine, paper: &mut impl Paper, block: u32) -> Result<f64, Error> {
    let mut times_ms = vec![];
    for number in block * BLOCK..(block + 1) * BLOCK {
        times_ms.push(machine.recorder.run(Mode::Plain, |frame| paper.record(frame, number))?.frame_ms);
    }
    Ok(middle(times_ms))
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// As the fresh process: times the next block of frames for each empty line that is read, and draws the frame that another
/// line names.
fn answer(machine: &mut Machine, paper: &mut impl Paper) -> Result<(), Error> {
    let mut block = 0;
    for line in io::stdin().lines() {
        let line = line.map_err(|error| Error::Input(format!("reading what to do: {error}")))?;
        if let Ok(number) = line.parse() {
            paper.restart()?;
            println!("{}", render(machine, paper, number)?.sha256());
        } else {
            println!("{}", block_ms(machine, paper, block)?);
            block += 1;
        }
    }
    Ok(())
}

/// A fresh process that times blocks of frames and draws, whenever it is asked to.
struct Fresh {
    child: Child,
    answers: BufReader<ChildStdout>,
}

impl Fresh {
    fn start(paper: &str, machine: &MachineOptions) -> Result<Self, Error> {
        let failed = |error: io::Error| Error::Input(format!("starting a fresh process: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command.args([paper, "0"]).args(&machine.device).arg(FRESH);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let answers = BufReader::new(child.stdout.take().expect("the output is piped"));
        Ok(Fresh { child, answers })
    }

    /// Median of the next block's frames, milliseconds.
    fn block(&mut self) -> Result<f64, Error> {
        let answer = self.ask("")?;
        answer.parse().map_err(|_| Error::Input(format!("a fresh process that times frames answered {answer:?}")))
    }

    /// SHA-256 of a frame's picture.
    fn picture(&mut self, number: u32) -> Result<String, Error> {
        self.ask(&number.to_string())
    }

    fn ask(&mut self, question: &str) -> Result<String, Error> {
        let input = self.child.stdin.as_mut().expect("the input is piped");
        let mut line = String::new();
        let asked = writeln!(input, "{question}").and_then(|()| input.flush());
        asked
            .and_then(|()| self.answers.read_line(&mut line))
            .map_err(|error| Error::Input(format!("asking a fresh process: {error}")))?;
        Ok(line.trim().to_owned())
    }

    /// Its input ends, and so does it.
    fn end(mut self) {
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// Runs the frames of the warm-up until no buffer grows any more.
fn settled(machine: &mut Machine, paper: &mut impl Paper) -> Result<(), Error> {
    loop {
        paper.restart()?;
        for number in 0..WARMUP {
            machine.recorder.run(Mode::Plain, |frame| paper.record(frame, number))?;
        }
        if paper.settle(&machine.shaders)? {
            return Ok(());
        }
    }
}

/// Resident memory of this process in kB but that of files, whose pages the system drops and reads again as it likes; 0 where
/// no system tells.
fn resident() -> i64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let of = |line: &str| line.strip_prefix("RssAnon:").or_else(|| line.strip_prefix("RssShmem:")).map(str::to_owned);
    status.lines().filter_map(of).filter_map(|text| text.trim().trim_end_matches(" kB").parse::<i64>().ok()).sum()
}

fn main() -> ExitCode {
    fumarole::gpu::pin_software_threads();
    // cargo adds an option of its own.
    let mut words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let is_fresh = words.last().is_some_and(|word| word == FRESH);
    words.truncate(words.len() - usize::from(is_fresh));
    let word = |at: usize| words.get(at).cloned();
    let frames = word(1).and_then(|text| text.parse().ok()).unwrap_or(20_000);
    let mut soak = Soak {
        paper: word(0).unwrap_or_else(|| "all".to_owned()),
        frames: if frames > 2 * WARMUP { frames } else { 2 * WARMUP },
        machine: MachineOptions { device: word(2), ..MachineOptions::default() },
        is_fresh,
        failures: vec![],
    };
    if let Err(error) = papers::each(&mut soak) {
        soak.failures.push(error.to_string());
    }
    soak.failures.iter().for_each(|failure| eprintln!("soak: {failure}"));
    if soak.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

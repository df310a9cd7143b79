//! Ctrl-C keeps what is finished, and so do the signals TERM and HUP.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use super::program::{Ended, Program, Running, assert_schema, burning, caustics, entries, folder, lava, read_json};

/// Far above what a frame of the tiny scene takes.
const SOON: Duration = Duration::from_secs(30);

/// True once a process handles SIGINT; before that, the signal just ends it.
fn handles_interrupts(process: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).map(str::trim);
    caught.and_then(|mask| u64::from_str_radix(mask, 16).ok()).is_some_and(|mask| mask & 0b10 != 0)
}

fn children(process: u32) -> Vec<u32> {
    let listed = fs::read_to_string(format!("/proc/{process}/task/{process}/children")).unwrap_or_default();
    listed.split_whitespace().map(|id| id.parse().unwrap()).collect()
}

/// Time in seconds that a process has computed so far.
fn computed_s(process: u32) -> u64 {
    /// By the kernel's interface for programs, whatever it uses itself.
    const TICKS_PER_S: u64 = 100;
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // Behind the name, which may hold anything: user time and system time are the fields 14 and 15.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    fields.filter_map(|ticks| ticks.parse::<u64>().ok()).sum::<u64>() / TICKS_PER_S
}

/// Waits until `ready` or the end of the program.
fn wait_until(running: &mut Running, ready: impl Fn(u32) -> bool) {
    let deadline = Instant::now() + SOON;
    while !ready(running.id()) && !running.has_ended() {
        assert!(Instant::now() < deadline, "it never got ready");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Signals that end a program: Ctrl-C, a batch system, a terminal that is closed.
const SIGNALS: [&str; 3] = ["-INT", "-TERM", "-HUP"];

/// Starts a program, presses Ctrl-C when it is `ready` and a while later, and returns how it ended. The while grows as
/// long as nothing was finished in it, which a busy machine may need.
fn interrupt(program: impl Fn() -> Program, ready: impl Fn(u32) -> bool) -> Ended {
    interrupt_by("-INT", program, ready)
}

fn interrupt_by(signal: &str, program: impl Fn() -> Program, ready: impl Fn(u32) -> bool) -> Ended {
    let mut pause = Duration::from_millis(300);
    loop {
        // The tests may run under `nohup` themselves.
        let mut running = program().under("env --default-signal=HUP").start();
        wait_until(&mut running, &ready);
        thread::sleep(pause);
        let group = format!("-{}", running.id());
        let killed = Command::new("kill").args([signal, "--", &group]).status().unwrap();
        assert!(killed.success(), "{:?}", running.end().stderr);
        let pressed = Instant::now();
        let ended = running.end();
        assert!(pressed.elapsed() < SOON, "it took {:?} to end", pressed.elapsed());
        if !(ended.stderr.contains("interrupted before") && pause < SOON) {
            return ended;
        }
        pause *= 3;
    }
}

fn assert_interrupted(record: &Path) {
    let record = read_json(record);
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    assert!(!runs.is_empty());
    for run in runs {
        assert!(!run["frame_ms"]["samples"].as_array().unwrap().is_empty());
        let warnings = run["warnings"].to_string();
        assert!(warnings.contains("interrupted"), "{warnings}");
    }
}

const LONG: &str = "bench --frames 100000 --repeat 100 --no-limits --variant level-map,volumetric --json a.json";

#[test]
fn a_bench_keeps_its_finished_frames() {
    for signal in SIGNALS {
        let out = folder();
        let program = || caustics(LONG).args("--csv a.csv --image a.png").inside(out.path()).tiny();
        let ended = interrupt_by(signal, program, handles_interrupts).succeeded();
        assert!(ended.stdout.contains("interrupted after"), "{signal}: {}", ended.stdout);
        assert_eq!(entries(out.path()), ["a.csv", "a.json", "a.png"], "{signal}");
        assert_interrupted(&out.path().join("a.json"));
    }
}

/// The last frame is hours of fire away.
#[test]
fn an_interrupted_bench_draws_a_frame_that_it_has_measured() {
    let out = folder();
    let scene = "--size 24x16 --mesh sphere --triangles 200 --blocks 2x2x2 --fire 20 --smoke 10 --speed 0.001";
    let program = || {
        let bench = burning("bench --variant shell --frames 100000 --repeat 1 --no-limits --json a.json --image a.png");
        bench.args(scene).inside(out.path()).on_test_device()
    };
    interrupt(program, handles_interrupts).succeeded();
    assert_interrupted(&out.path().join("a.json"));
    fumarole::image::read_png(&out.path().join("a.png")).unwrap();
}

#[test]
fn fresh_processes_keep_theirs() {
    let out = folder();
    let program = || caustics(LONG).args("--processes 3").inside(out.path()).tiny();
    let ready = |id: u32| handles_interrupts(id) && children(id).iter().any(|&child| handles_interrupts(child));
    interrupt(program, ready).succeeded();
    assert_eq!(entries(out.path()), ["a.json"]);
    assert_interrupted(&out.path().join("a.json"));
    assert!(read_json(&out.path().join("a.json"))["runs"].as_array().unwrap().iter().all(|run| run["process"] == 0));
}

#[test]
fn a_film_says_that_it_is_cut_short() {
    let out = folder();
    let program = || caustics("render --frame 0..1000000 --film a.y4m").inside(out.path()).tiny();
    let ended = interrupt(program, handles_interrupts).succeeded();
    assert!(ended.stderr.contains("of 1000000 frames"), "{}", ended.stderr);
    assert_eq!(entries(out.path()), ["a.y4m"]);
}

#[test]
fn less_time_than_was_asked_for_is_told() {
    let out = folder();
    let options = "bench --frames 1 --repeat 1 --min-time 3600 --no-limits --variant level-map --json a.json";
    interrupt(|| caustics(options).inside(out.path()).tiny(), handles_interrupts).succeeded();
    let record = read_json(&out.path().join("a.json"));
    let warnings = record["runs"][0]["warnings"].to_string();
    assert!(warnings.contains("of the 3600 s that --min-time asks for"), "{warnings}");
}

/// `nohup` has a program ignore that its terminal is closed: it goes on, and so do its fresh processes. Ctrl-C ends it still.
#[test]
fn what_is_to_outlive_its_terminal_does() {
    let out = folder();
    let program = caustics(LONG).args("--processes 2").inside(out.path()).tiny().under("nohup");
    let mut running = program.start();
    wait_until(&mut running, |id| children(id).iter().any(|&child| handles_interrupts(child)));
    let (id, child) = (running.id(), children(running.id())[0]);
    let kill = |signal: &str| {
        let group = format!("-{id}");
        assert!(Command::new("kill").args([signal, "--", &group]).status().unwrap().success());
    };
    kill("-HUP");
    // Some frames are finished in this time.
    thread::sleep(Duration::from_secs(3));
    assert!(!running.has_ended() && children(id) == [child], "a process has ended");
    kill("-INT");
    running.end().succeeded();
    assert_interrupted(&out.path().join("a.json"));
}

#[test]
fn a_range_of_pictures_keeps_those_that_it_names() {
    for signal in SIGNALS {
        let out = folder();
        let program = || caustics("render --frame 0..1000000 --out .").inside(out.path()).tiny();
        let ready = |id: u32| handles_interrupts(id) && !entries(out.path()).is_empty();
        let ended = interrupt_by(signal, program, ready).succeeded();
        let named = ended.stderr.lines().filter_map(|line| line.strip_prefix("wrote ./"));
        let named: Vec<&str> = named.collect();
        let (count, last) = (named.len(), "of 1000000 frames");
        assert!(ended.stderr.contains(&format!("interrupted after {count} {last}")), "{signal}: {}", ended.stderr);
        assert_eq!(named, entries(out.path()), "{signal}");
        fumarole::image::read_png(&out.path().join(named[named.len() - 1])).unwrap();
    }
}

#[test]
fn a_sweep_keeps_its_finished_rows() {
    let out = folder();
    let options = "--step 1 --frames 3 --repeat 1 --mesh sphere --no-limits --out . --size 96x64 --map-size 64";
    let program = || caustics("experiment 5-1").args(options).inside(out.path()).on_test_device();
    interrupt(program, handles_interrupts).succeeded();
    let record = read_json(&out.path().join("caustics-5-1.json"));
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    assert!(!runs.is_empty() && runs.len() < 2 * 99, "{} runs", runs.len());
    let warnings = runs[runs.len() - 1]["warnings"].to_string();
    assert!(warnings.contains("the sweep was interrupted after") && warnings.contains("of 99 points"), "{warnings}");
}

/// A table without times too: its rows so far, the plot and the document.
#[test]
fn a_table_keeps_its_finished_rows() {
    let out = folder();
    let options = "--step 1 --mesh sphere --out . --size 96x64 --map-size 64";
    let program = || caustics("experiment 5-5").args(options).inside(out.path()).on_test_device();
    let ready = |id: u32| handles_interrupts(id) && !entries(out.path()).is_empty();
    interrupt(program, ready).succeeded();
    assert_eq!(entries(out.path()), [".csv", ".json", ".svg"].map(|ending| format!("caustics-5-5{ending}")));
    let record = read_json(&out.path().join("caustics-5-5.json"));
    let rows = record["table"]["rows"].as_array().unwrap();
    assert!(!rows.is_empty() && rows.len() < 99, "{} rows", rows.len());
}

/// True where a process of a group is left, also one that has ended and that nothing has waited for.
fn has_member(group: u32) -> bool {
    let of_group = |name: std::ffi::OsString| {
        let stat = fs::read_to_string(Path::new("/proc").join(name).join("stat")).unwrap_or_default();
        // Behind the name, which may hold anything: state, parent, group.
        let field = stat.rsplit(')').next().unwrap_or_default().split_whitespace().nth(2).map(str::to_owned);
        field.is_some_and(|field| field == group.to_string())
    };
    fs::read_dir("/proc").unwrap().flatten().any(|entry| of_group(entry.file_name()))
}

/// A signal to the first process alone, as a service manager, a batch system or a shell that ends sends it.
fn assert_first_process_ends_all(signal: &str) {
    let out = folder();
    let temporary = folder();
    let program = caustics(LONG).args("--processes 3").inside(out.path()).tiny().env("TMPDIR", temporary.path());
    // The tests may run under `nohup` themselves.
    let mut running = program.under("env --default-signal=HUP").start();
    wait_until(&mut running, |id| children(id).iter().any(|&child| handles_interrupts(child)));
    // Some frames are finished in this time.
    thread::sleep(Duration::from_secs(3));
    let (id, child) = (running.id(), children(running.id())[0]);
    assert!(has_member(id), "the group {id} is empty");
    assert!(Command::new("kill").args([signal, &id.to_string()]).status().unwrap().success());
    let pressed = Instant::now();
    let ended = running.end();
    assert!(pressed.elapsed() < SOON, "it took {:?} to end", pressed.elapsed());
    ended.succeeded();
    assert!(!Path::new(&format!("/proc/{child}")).exists(), "the process {child} outlives its parent");
    assert!(!has_member(id), "a process outlives the first one");
    assert_eq!(entries(temporary.path()), [""; 0]);
    assert_eq!(entries(out.path()), ["a.json"]);
    assert_interrupted(&out.path().join("a.json"));
}

#[test]
fn term_ends_a_run_of_fresh_processes_and_keeps_what_is_finished() {
    assert_first_process_ends_all("-TERM");
}

#[test]
fn a_closed_terminal_ends_a_run_of_fresh_processes_and_keeps_what_is_finished() {
    assert_first_process_ends_all("-HUP");
}

/// A frame of 4e12 weights, and the hundred steps to one of a fluid of 200,000 particles, which is minutes and more: they are
/// given up half-way. The first says meanwhile that it goes on.
#[test]
fn term_ends_a_picture_within_its_frame() {
    let of_weights = ("--variant gpu-driven --density 4096x4x1024 --radius 0.5", 13, "drawing frame 0 goes on");
    let of_steps = ("--simulation sph --particles 200000 --substeps 100 --frame 9", 0, "");
    for (options, wait_s, told) in [of_weights, of_steps] {
        let out = folder();
        let program = lava("render --size 64x48 --image a.png").args(options);
        let mut running = program.on_test_device().inside(out.path()).start();
        // By then it has begun.
        wait_until(&mut running, |id| computed_s(id) >= 4);
        thread::sleep(Duration::from_secs(wait_s));
        assert!(Command::new("kill").args(["-TERM", &running.id().to_string()]).status().unwrap().success());
        let pressed = Instant::now();
        let ended = running.end();
        assert!(pressed.elapsed() < SOON, "{options}: it took {:?} to end", pressed.elapsed());
        assert!(ended.stderr.contains(told), "{options}: {}", ended.stderr);
        assert_eq!(ended.status.code(), Some(1), "{options}: {}", ended.stderr);
        assert!(ended.stderr.contains("interrupted before a picture was written"), "{options}: {}", ended.stderr);
        assert_eq!(entries(out.path()), [""; 0], "{options}");
    }
}

#[test]
fn term_ends_a_list_of_passes_within_its_frame() {
    let list = lava("passes --variant gpu-driven --size 64x48 --density 4096x4x1024 --radius 0.5");
    let mut running = list.on_test_device().start();
    wait_until(&mut running, |id| computed_s(id) >= 4);
    assert!(Command::new("kill").args(["-TERM", &running.id().to_string()]).status().unwrap().success());
    let pressed = Instant::now();
    let ended = running.end();
    assert!(pressed.elapsed() < SOON, "it took {:?} to end", pressed.elapsed());
    assert_eq!((ended.status.code(), ended.stdout.as_str()), (Some(1), ""), "{}", ended.stderr);
    assert!(ended.stderr.contains("interrupted before all passes were listed"), "{}", ended.stderr);
}

//! Killed programs, full disks, folders that take no file, and two processes in one folder. Signals come at moments that are
//! drawn; `FUMAROLE_TEST_SEED` draws others.

use std::collections::HashSet;
use std::env;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use fumarole::image::read_png;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::{PAPERS, Paper};
use crate::cli::program::{ONCE, Program, Running, assert_schema, entries, folder, read_json};
use crate::common::beside_others;

const DOCUMENTS: &str = "--quiet --json a.json --csv a.csv --trace a.trace";
const ENDLESS: &str = "--frames 100000 --repeat 10000 --warmup 1 --no-limits";
/// Far above what an interrupted program takes on a busy machine.
const SOON: Duration = Duration::from_secs(20);

/// A bench that writes every document.
fn bench(paper: &Paper, out: &Path) -> Program {
    let program = paper.run("bench").args(DOCUMENTS).inside(out);
    // Of many variants, whose files are written as those of one are.
    match paper.name {
        "gas" => program.args("--variant table"),
        "terrain" => program.args("--variant gpu-compute"),
        _ => program,
    }
}

fn with_picture(paper: &Paper, out: &Path) -> Program {
    bench(paper, out).args("--image a.png")
}

/// Asserts that each file in a folder is whole, but for temporary ones.
fn assert_whole(out: &Path) {
    for name in entries(out) {
        let path = out.join(&name);
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("json") => assert_schema(&read_json(&path)),
            Some("trace") => drop(read_json(&path)),
            Some("csv") => assert!(fs::read_to_string(&path).unwrap().ends_with('\n'), "{name}"),
            Some("png") => drop(read_png(&path).unwrap()),
            Some("tmp") => {}
            _ => panic!("{name} was not asked for"),
        }
    }
}

/// A part of a time, drawn evenly.
fn part(random: &mut Pcg32, of: Duration) -> Duration {
    of.mul_f64(f64::from(random.next_u32()) / f64::from(u32::MAX))
}

fn send(signal: Signal, running: &Running) {
    // It may have ended by itself.
    let _ = kill(Pid::from_raw(running.id().try_into().unwrap()), signal);
}

/// Waits until a program has begun so many files, or has ended.
fn await_files(count: usize, running: &mut Running, out: &Path) {
    let mut begun = HashSet::new();
    let older: HashSet<String> = entries(out).into_iter().collect();
    while begun.len() < count && !running.has_ended() {
        begun.extend(entries(out).into_iter().filter(|name| name.ends_with(".tmp") && !older.contains(name)));
        thread::sleep(Duration::from_micros(50));
    }
}

fn assert_killed(running: Running, out: &Path) {
    send(Signal::SIGKILL, &running);
    let status = running.end().status;
    assert!(status.success() || status.signal() == Some(Signal::SIGKILL as i32), "{status}");
    assert_whole(out);
}

#[test]
fn a_killed_run_leaves_whole_files_and_its_rest_is_swept() {
    let seed = env::var("FUMAROLE_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let mut random = Pcg32::new(seed, 0);
    for paper in &PAPERS {
        beside_others(|| assert_killed_runs_leave_whole_files(paper, &mut random));
    }
}

fn assert_killed_runs_leave_whole_files(paper: &Paper, random: &mut Pcg32) {
    let out = folder();
    let out = out.path();
    // Of another machine, whose processes are not known: nobody sweeps it.
    fs::write(out.join(".fumarole-4294967295-00000000-x.tmp"), "half").unwrap();
    with_picture(paper, out).args(ONCE).run().succeeded();
    let written = entries(out);
    let files = written.len() - 1;
    let begun = Instant::now();
    with_picture(paper, out).args(ONCE).run().succeeded();
    let whole_run = begun.elapsed();
    for _ in 0..3 {
        let running = with_picture(paper, out).args(ONCE).start();
        thread::sleep(part(random, whole_run));
        assert_killed(running, out);
    }
    // Writing takes a small part of a run.
    for _ in 0..3 {
        let mut running = with_picture(paper, out).args(ONCE).start();
        // The files that show beforehand that some can be made are gone by then.
        thread::sleep(whole_run / 4);
        await_files(1 + random.next_u32() as usize % files, &mut running, out);
        assert_killed(running, out);
    }
    with_picture(paper, out).args(ONCE).run().succeeded();
    assert_eq!(entries(out), written, "{}", paper.name);
    for signal in [Signal::SIGTERM, Signal::SIGINT, Signal::SIGHUP] {
        // The tests may run under `nohup` themselves.
        let running = with_picture(paper, out).args(ENDLESS).under("env --default-signal=HUP").start();
        thread::sleep(part(random, whole_run));
        send(signal, &running);
        let sent = Instant::now();
        let ended = running.end();
        let what = format!("{} by {signal}: {} after {:?}: {}", paper.name, ended.status, sent.elapsed(), ended.stderr);
        assert!(sent.elapsed() < SOON, "{what}");
        // It has measured something, or nothing, or was not yet listening.
        match ended.status.code() {
            Some(0) => assert_eq!(ended.stderr, "", "{what}"),
            Some(_) => ended.refused(1, &["interrupted"]),
            None => assert_eq!(ended.status.signal(), Some(signal as i32), "{what}"),
        }
        assert_eq!(entries(out), written, "{what}");
        assert_whole(out);
    }
}

/// Programs that write to full devices and sealed folders end with one line; older files stay.
#[test]
fn a_full_device_is_told() {
    for (paper, option) in PAPERS.iter().zip(["--json", "--csv", "--trace"].iter().cycle()) {
        let out = folder();
        let ended = paper.run("bench --quiet").args(ONCE).arg(format!("{option}=/dev/full")).inside(out.path()).run();
        ended.refused(2, &["/dev/full", "No space left"]);
        assert_eq!(entries(out.path()), [""; 0]);
    }
}

/// A file system of a test's own.
struct Disk {
    folder: tempfile::TempDir,
}

impl Disk {
    /// The message of `mount`, where it made none.
    fn mount(options: &str) -> Result<Self, String> {
        let folder = folder();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(folder.path());
        match mount.output() {
            Ok(output) if output.status.success() => Ok(Disk { folder }),
            Ok(output) => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
            Err(error) => Err(error.to_string()),
        }
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.folder.path()).status();
    }
}

/// Runs the body of `test` on a file system of its own. Whoever may not mount one is the root of name spaces of a process of
/// the test's; where there are none either, the test fails.
fn on_disk(options: &str, test: &str, body: impl FnOnce(&Path)) {
    const INSIDE: &str = "FUMAROLE_TEST_NAME_SPACE";
    let refusal = match Disk::mount(options) {
        Ok(disk) => return body(disk.folder.path()),
        Err(refusal) => refusal,
    };
    assert!(env::var_os(INSIDE).is_none(), "mounting a file system for the test: {refusal}; run it as root");
    let mut again = Command::new("unshare");
    again.args(["--map-root-user", "--mount"]).arg(env::current_exe().unwrap());
    let output = again.args(["--exact", test, "--nocapture"]).env(INSIDE, "1").output().unwrap();
    let said = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(said[0].contains("1 passed"), "{test} mounts no file system ({refusal}), and in name spaces: {said:?}");
}

#[test]
fn a_full_disk_keeps_older_files() {
    // Four pages, of which the older documents take three.
    on_disk("size=16384", "faults::files::a_full_disk_keeps_older_files", |out| {
        let older = ["a.csv", "a.json", "a.trace"];
        for name in older {
            fs::write(out.join(name), "older").unwrap();
        }
        for paper in &PAPERS {
            bench(paper, out).args(ONCE).run().refused(2, &["a.json", "No space left"]);
            assert_eq!(entries(out), older, "{}", paper.name);
            for name in older {
                assert_eq!(fs::read_to_string(out.join(name)).unwrap(), "older", "{}: {name}", paper.name);
            }
        }
    });
}

#[test]
fn a_disk_that_a_picture_fills_throws_no_measurement_away() {
    // Two pages, of which the older picture takes one; a new one takes two by itself.
    on_disk("size=8192", "faults::files::a_disk_that_a_picture_fills_throws_no_measurement_away", |disk| {
        let picture = disk.join("a.png");
        fs::write(&picture, "older").unwrap();
        for paper in &PAPERS {
            let out = folder();
            let large = bench(paper, out.path()).args("--size 256x192").arg("--image").arg(&picture);
            large.args(ONCE).run().refused(2, &["a.png", "No space left"]);
            assert_eq!(entries(disk), ["a.png"], "{}", paper.name);
            assert_eq!(fs::read_to_string(&picture).unwrap(), "older", "{}", paper.name);
            assert_eq!(entries(out.path()), ["a.csv", "a.json", "a.trace"], "{}", paper.name);
            assert_whole(out.path());
            let run = &read_json(&out.path().join("a.json"))["runs"][0];
            let warnings = run["warnings"].to_string();
            assert!(warnings.contains("without a picture") && warnings.contains("No space left"), "{warnings}");
            assert!(run["image"].is_null() && !run["frame_ms"]["samples"].as_array().unwrap().is_empty(), "{run}");
        }
    });
}

#[test]
fn a_read_only_folder_is_told_before_the_work() {
    on_disk("ro", "faults::files::a_read_only_folder_is_told_before_the_work", |out| {
        for paper in &PAPERS {
            let long = paper.run("bench --frames 100000 --repeat 10000 --quiet --json a.json").inside(out);
            long.run().refused(2, &["a.json"]);
        }
    });
}

#[test]
fn two_processes_in_one_folder_leave_whole_files() {
    let out = folder();
    let out = out.path();
    for paper in &PAPERS {
        with_picture(paper, out).args(ONCE).run().succeeded();
    }
    let written = entries(out);
    for (index, paper) in PAPERS.iter().enumerate() {
        let both = [paper, &PAPERS[(index + 1) % PAPERS.len()]];
        beside_others(|| {
            let running = both.map(|paper| with_picture(paper, out).args(ONCE).start());
            for running in running {
                running.end().succeeded();
            }
        });
        assert_eq!(entries(out), written, "{}", paper.name);
        assert_whole(out);
        let of = read_json(&out.join("a.json"))["runs"][0]["paper"].clone();
        assert!(both.iter().any(|paper| of == paper.name), "{}: {of}", paper.name);
    }
}

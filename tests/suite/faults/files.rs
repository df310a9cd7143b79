//! Killed programs, full disks, folders that take no file, and two processes in one folder.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

use fumarole::image::read_png;

use super::{PAPERS, Paper};
use crate::cli::program::{ONCE, assert_schema, entries, folder, read_json};

const FILES: &str = "--quiet --json a.json --csv a.csv --trace a.trace --image a.png";

/// Files of a bench of caustics, a picture of each variant among them.
const WRITTEN: [&str; 8] =
    ["a-culled.png", "a-hit.png", "a-level-map-smart.png", "a-volumetric.png", "a.csv", "a.json", "a.png", "a.trace"];

fn bench(paper: &Paper, out: &Path) -> crate::cli::program::Program {
    paper.run("bench").args(FILES).args(ONCE).inside(out)
}

/// Asserts that each of the bench's files is there and whole.
fn assert_whole(out: &Path) {
    assert_schema(&read_json(&out.join("a.json")));
    for name in WRITTEN.iter().filter(|name| name.ends_with(".png")) {
        read_png(&out.join(name)).unwrap();
    }
    serde_json::from_slice::<serde_json::Value>(&fs::read(out.join("a.trace")).unwrap()).unwrap();
    assert!(fs::read_to_string(out.join("a.csv")).unwrap().ends_with('\n'));
}

#[test]
fn a_killed_run_leaves_whole_files_and_its_rest_is_swept() {
    let out = folder();
    let paper = &PAPERS[2];
    bench(paper, out.path()).run().succeeded();
    let begun = std::time::Instant::now();
    bench(paper, out.path()).run().succeeded();
    let whole_run = begun.elapsed();
    for part in 0..10 {
        let running = bench(paper, out.path()).start();
        thread::sleep(whole_run * part / 8);
        let id = running.id().to_string();
        // It may have ended by itself.
        let _ = Command::new("kill").args(["-KILL", &id]).status().unwrap();
        running.end();
        assert_whole(out.path());
    }
    // As if it had been killed while it wrote: Linux gives no process this number.
    let name = |home: &str| format!(".fumarole-4294967295-{home}-x.tmp");
    fs::write(out.path().join(name("00000000")), "half").unwrap();
    bench(paper, out.path()).run().succeeded();
    let of_another_machine = name("00000000");
    assert_eq!(entries(out.path()), [&[of_another_machine.as_str()][..], &WRITTEN[..]].concat());
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
    // Two pages, of which the older record takes one.
    on_disk("size=8192", "faults::files::a_full_disk_keeps_older_files", |out| {
        fs::write(out.join("a.json"), "older").unwrap();
        for paper in &PAPERS[1..3] {
            let ended = paper.run("bench --quiet --json a.json").args(ONCE).inside(out).run();
            ended.refused(2, &["a.json", "No space left"]);
            assert_eq!(fs::read_to_string(out.join("a.json")).unwrap(), "older");
            assert_eq!(entries(out), ["a.json"]);
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
    for _ in 0..3 {
        let both = [&PAPERS[2], &PAPERS[3]].map(|paper| bench(paper, out.path()).start());
        thread::sleep(Duration::from_millis(1));
        for running in both {
            running.end().succeeded();
        }
        assert_whole(out.path());
        assert_eq!(entries(out.path()), WRITTEN);
    }
}

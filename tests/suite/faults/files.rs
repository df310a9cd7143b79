//! Killed programs, full disks, folders that take no file, and two processes in one folder.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

use fumarole::image::read_png;

use super::{PAPERS, Paper};
use crate::cli::program::{ONCE, assert_schema, entries, folder, read_json};

const FILES: &str = "--quiet --json a.json --csv a.csv --trace a.trace --image a.png";

/// What a bench of caustics leaves, a picture of each variant among it.
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
    for part in 0..20 {
        let running = bench(paper, out.path()).start();
        thread::sleep(whole_run * part / 18);
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
    for paper in &PAPERS {
        for option in ["--json=/dev/full", "--csv=/dev/full", "--trace=/dev/full"] {
            let out = folder();
            let ended = paper.run("bench --quiet").args(ONCE).arg(option).inside(out.path()).run();
            ended.refused(2, &["/dev/full", "No space left"]);
            assert_eq!(entries(out.path()), [""; 0]);
        }
    }
}

/// A file system of few bytes of this test's own, if this process may make one.
struct SmallDisk {
    folder: tempfile::TempDir,
}

impl SmallDisk {
    fn mount(options: &str) -> Option<Self> {
        let folder = folder();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(folder.path());
        let mounted = mount.output().is_ok_and(|output| output.status.success());
        mounted.then_some(SmallDisk { folder })
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.folder.path()).status();
    }
}

#[test]
fn a_full_disk_keeps_older_files() {
    // Two pages, of which the older record takes one.
    let Some(disk) = SmallDisk::mount("size=8192") else {
        eprintln!("no file system can be mounted here: a full disk was not tried");
        return;
    };
    let out = disk.folder.path();
    fs::write(out.join("a.json"), "older").unwrap();
    for paper in &PAPERS {
        let ended = paper.run("bench --quiet --json a.json").args(ONCE).inside(out).run();
        ended.refused(2, &["a.json", "No space left"]);
        assert_eq!(fs::read_to_string(out.join("a.json")).unwrap(), "older");
        assert_eq!(entries(out), ["a.json"]);
    }
}

#[test]
fn a_read_only_folder_is_told_before_the_work() {
    let Some(disk) = SmallDisk::mount("ro") else {
        eprintln!("no file system can be mounted here: a read-only folder was not tried");
        return;
    };
    for paper in &PAPERS {
        let long = paper.run("bench --frames 100000 --repeat 10000 --quiet --json a.json").inside(disk.folder.path());
        long.run().refused(2, &["a.json"]);
    }
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

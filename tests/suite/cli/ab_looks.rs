//! When `fumarole ab` looks and with what code it ends: another build plays records that were measured beforehand, with other
//! times.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::program::{Ended, caustics, entries, folder, fumarole, read_json};

/// Gives out the record of its side and process.
const SCRIPT: &str = r#"#!/bin/sh
while [ $# -gt 0 ]; do
    case $1 in
        --process) process=$2 ;;
        --json) file=$2 ;;
    esac
    shift
done
exec cp "$PLAYED/$SIDE-$process.json" "$file"
"#;

/// Times of a block, in milliseconds: the frame's and the pass's on each side.
type Block = [[f64; 2]; 2];

/// The pass is half of the frame; B is 4 % off A, below it in one block of three, and takes 30 % longer from block `since` on.
fn slower_since(since: usize) -> impl Fn(usize) -> Block {
    move |block| {
        let noise = if block % 3 == 2 { 1.0 / 1.04 } else { 1.04 };
        let factor = if block < since { noise } else { 1.3 };
        [[10.0, 5.0], [10.0 * factor, 5.0 * factor]]
    }
}

fn time(milliseconds: f64) -> Value {
    json!({
        "samples": [milliseconds, milliseconds], "min": milliseconds, "median": milliseconds, "mean": milliseconds,
        "p95": null, "p99": null, "max": milliseconds, "mad": 0.0,
    })
}

/// Two programs that give out records of such blocks.
struct Played {
    folder: TempDir,
}

impl Played {
    fn new(blocks: impl Fn(usize) -> Block) -> Self {
        let folder = folder();
        let script = folder.path().join("script");
        fs::write(&script, SCRIPT).unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
        let mut record =
            caustics("bench --variant level-map --frames 2 --repeat 1 --warmup 1 --no-limits --json --quiet")
                .tiny()
                .run()
                .succeeded()
                .json();
        let passes = record["runs"][0]["passes"].as_array_mut().unwrap();
        passes.retain(|pass| pass["name"] == "cast");
        assert_eq!(passes.len(), 1);
        for process in 0..80 {
            for (side, [frame, pass]) in ["A", "B"].iter().zip(blocks(process / 2)) {
                let run = &mut record["runs"][0];
                run["process"] = process.into();
                run["frame_ms"] = time(frame);
                run["passes"][0]["gpu_ms"] = time(pass);
                fs::write(folder.path().join(format!("{side}-{process}.json")), record.to_string()).unwrap();
            }
        }
        Played { folder }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Compares them, with `options` of `ab`.
    fn compared(&self, options: &str) -> Ended {
        let [script, played] = ["script", ""].map(|name| self.folder.path().join(name));
        let mut program = fumarole("ab --quiet").args(options).arg("--out").arg(self.out());
        for side in ["A", "B"] {
            program = program.arg("--binary").arg(format!("{side}:{}", script.display()));
            program = program.arg("--env").arg(format!("{side}:SIDE={side}"));
            program = program.arg("--env").arg(format!("{side}:PLAYED={}", played.display()));
        }
        program.args("caustics").run()
    }

    /// Blocks that were measured, and the verdicts on frame and pass.
    fn verdicts(&self) -> (u64, [String; 2]) {
        let found = read_json(&self.out().join("ab.json"));
        let run = &found["runs"][0];
        let verdict = |of: &Value| of["verdict"].as_str().unwrap().to_owned();
        let cast = run["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "cast").unwrap();
        for name in ["ab-a.json", "ab-b.json"] {
            assert_eq!(runs(&self.out().join(name)) as u64, run["a_processes"].as_u64().unwrap());
        }
        (run["a_processes"].as_u64().unwrap() / 2, [verdict(&run["frame"]), verdict(cast)])
    }
}

fn runs(record: &Path) -> usize {
    read_json(record)["runs"].as_array().unwrap().len()
}

fn both(verdict: &str) -> [String; 2] {
    [verdict, verdict].map(str::to_owned)
}

/// After 5, 10, 20 and 40 blocks, and at none between; 5 can decide nothing at a quarter of the error.
#[test]
fn it_looks_after_5_10_20_and_40_blocks() {
    for (since, looked) in [(0, 10), (10, 20), (20, 40)] {
        let played = Played::new(slower_since(since));
        played.compared("").succeeded();
        assert_eq!(played.verdicts(), (looked, both("SLOWER")), "slower since block {since}");
    }
    // Nor can they for sides that hardly differ.
    let equal = Played::new(|_| [[10.0, 5.0], [10.001, 5.001]]);
    equal.compared("--fail-above 5% --fail-unclear").succeeded();
    assert_eq!(equal.verdicts(), (10, both("SAME")));
    // No more than there may be, and a look at the last.
    let short = Played::new(slower_since(0));
    short.compared("--blocks 12").succeeded();
    assert_eq!(short.verdicts().0, 10);
    short.compared("--blocks 7").succeeded();
    assert_eq!(short.verdicts(), (7, both("UNCLEAR")));
}

/// By frame or by a pass alone, and by what stays unclear to the end.
#[test]
fn its_gates_end_with_their_code() {
    let code = |ended: &Ended| ended.status.code();
    let slower = Played::new(slower_since(0));
    let ended = slower.compared("--fail-above 5%");
    assert_eq!(code(&ended), Some(4), "{}{}", ended.stdout, ended.stderr);
    slower.compared("--fail-above 50%").succeeded();

    let pass_alone = Played::new(|_| [[10.0, 1.0], [10.001, 3.0]]);
    let ended = pass_alone.compared("--fail-above 5%");
    assert_eq!(code(&ended), Some(4), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains("regression beyond 5 %: cast"), "{}", ended.stdout);
    assert_eq!(pass_alone.verdicts(), (10, ["SAME", "SLOWER"].map(str::to_owned)));
    assert_eq!(entries(&pass_alone.out()), ["ab-a.json", "ab-b.json", "ab.json"]);
    // Of so small a part of the frame none counts.
    pass_alone.compared("--fail-above 5% --min-share 40%").succeeded();

    let unclear = Played::new(slower_since(40));
    unclear.compared("").succeeded();
    assert_eq!(unclear.verdicts(), (40, both("UNCLEAR")));
    let ended = unclear.compared("--fail-unclear");
    assert_eq!(code(&ended), Some(4), "{}{}", ended.stdout, ended.stderr);
}

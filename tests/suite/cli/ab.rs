//! `fumarole ab`: two sides in turn.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::program::{ONCE, Program, SCENE, device, entries, folder, fumarole, read_json};
use super::shaders::{end_cast_with, own_shaders};

/// Two blocks of the tiny scene, with `options` before the paper.
fn ab(options: &str) -> Program {
    fumarole("ab --blocks 2 --quiet").args(options)
}

fn common(program: Program) -> Program {
    program.args("caustics bench --variant level-map").args(SCENE).args(ONCE).arg("--device").arg(device())
}

#[test]
fn sides_are_measured_in_turn_and_both_records_kept() {
    let out = folder();
    let report = out.path().join("ab.json");
    let program =
        ab("--env A:LP_NUM_THREADS=2 --env B:LP_NUM_THREADS=1 --env B:FUMAROLE_AB=x --env B:NIR_DEBUG= --json")
            .arg(&report)
            .arg("--out")
            .arg(out.path());
    let ended = common(program.arg("--b").arg("--waves 2 --seed 7")).run().succeeded();
    assert!(ended.stdout.starts_with("what is compared\n"), "{}", ended.stdout);
    for part in [
        "seed: A 1, B 7",
        "host.lp_num_threads: A 2, B 1",
        "host.variables.FUMAROLE_AB: A unset, B x",
        "blocks A B B A",
    ] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    let report = read_json(&report);
    assert_eq!(report["schema"], "fumarole.compare/2");
    assert_eq!(report["design"], "blocks");
    // Each side's own command, as a shell takes it.
    let command = |side: &str| -> Vec<String> {
        let words = report[format!("{side}_commands")][0].as_array().unwrap().iter();
        words.map(|word| word.as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(command("a")[..2], ["env", "LP_NUM_THREADS=2"]);
    let of_b = command("b");
    assert_eq!(of_b[..4], ["env", "LP_NUM_THREADS=1", "FUMAROLE_AB=x", "NIR_DEBUG="]);
    assert!(of_b[4].ends_with("fumarole") && of_b[5..7] == ["caustics", "bench"], "{of_b:?}");
    let lists = |what: &str| report["differences"].as_array().unwrap().iter().filter(|one| one["what"] == what).count();
    assert_eq!((lists("host.variables.NIR_DEBUG"), lists("host.variables.LP_NUM_THREADS")), (1, 0));
    assert!(of_b.ends_with(&["--waves", "2", "--seed", "7"].map(str::to_owned)), "{of_b:?}");
    assert!(report["command"].as_array().unwrap().contains(&"--env".into()), "{}", report["command"]);
    let run = &report["runs"][0];
    assert_eq!((&run["a_processes"], &run["b_processes"]), (&4.into(), &4.into()));
    // Two blocks are too few for any verdict at this error.
    assert_eq!(run["frame"]["verdict"], "UNCLEAR");
    assert!(run["passes"].as_array().unwrap().len() > 3);
    let records = ["ab-a.json", "ab-b.json"].map(|name| read_json(&out.path().join(name)));
    let started = records.each_ref().map(|record| {
        let runs = record["runs"].as_array().unwrap().iter();
        runs.map(|run| run["started"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    });
    let [a, b] = started;
    assert!(a[0] < b[0] && b[0] < b[1] && b[1] < a[1] && a[1] < a[2], "A B B A: {a:?} {b:?}");
}

#[test]
fn a_side_may_be_another_program_and_failures_name_the_side() {
    let out = folder();
    let nowhere = out.path().join("nowhere");
    let binary = |path: &str| common(ab("--binary").arg(format!("B:{path}")).arg("--out").arg(out.path()));
    binary(nowhere.to_str().unwrap()).run().refused(2, &["side B", "nowhere"]);
    common(ab("--out").arg(out.path()).arg("--a").arg("--planes 0")).run().refused(2, &["error: side A: ", "planes"]);
    assert!(!out.path().join("ab-a.json").exists(), "nothing was measured");
}

/// Side A, which comes first, would fail as soon as it is measured.
#[test]
fn both_sides_are_checked_before_one_is_measured() {
    let out = folder();
    let with = |option: &str| common(fumarole("ab --quiet").arg("--a=--device none").arg(option).inside(out.path()));
    for (options, part) in [
        ("--planes 0", "--planes 0"),
        ("--plains 3", "unexpected argument '--plains' found"),
        ("--variant no", "[possible values: "),
        ("--mesh no-such.obj", "no-such.obj"),
        ("--shader-dir no-such", "no-such"),
        ("--image no.exr", "no.exr"),
        ("--trace /proc/no/a", "/proc/no"),
    ] {
        with(&format!("--b={options}")).run().refused(2, &["error: side B: ", part]);
    }
    for binary in ["B:no-such-program", "B:./nowhere"] {
        with(&format!("--binary={binary}")).run().refused(2, &["error: side B: ", &binary[2..], "build of fumarole"]);
    }
    with("--b=--help").run().refused(2, &["--help in --b"]);
    let picture = common(fumarole("ab --quiet").arg("--a=--image a.png").arg("--b=--trace ./a.png").inside(out.path()));
    picture.run().refused(2, &["./a.png: two outputs"]);
    let both = |arguments: &str| fumarole("ab --quiet").args(arguments).inside(out.path()).run();
    both("gass").refused(2, &["error: both sides: gass: there is no such paper; name one of lava, gas"]);
    both("caustics --plains 3").refused(2, &["error: both sides: unexpected argument '--plains'"]);
    assert!(entries(out.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn a_program_that_leaves_no_record_is_named_with_its_side() {
    let out = folder();
    let program = fumarole("ab --quiet --binary A:/bin/true --out").arg(out.path());
    common(program).run().refused(2, &["error: side A: /bin/true ", "without a record", "build of fumarole"]);
}

/// Hardly anything is as far from 1 as this margin: a look decides, the one after 10 blocks where the machine is quiet, and no
/// block follows it. Of 5 blocks none can at its part of the error.
#[test]
fn it_ends_with_the_look_that_decides() {
    let out = folder();
    let program = fumarole("ab --quiet --blocks 20 --margin 100% --min-share 60% --json --out").arg(out.path());
    let report = common(program).run().succeeded().json();
    let run = &report["runs"][0];
    let processes = run["a_processes"].as_u64().unwrap();
    assert!(processes == 20 && run["frame"]["verdict"] == "SAME" || processes == 40, "{report}");
    assert_eq!(report["confidence"], 0.9875, "a quarter of the error");
    let kept = read_json(&out.path().join("ab-b.json"));
    assert_eq!(kept["runs"].as_array().unwrap().len() as u64, processes);

    // The page shows these verdicts and none of its own.
    let verdicts = out.path().join("ab.json");
    let mut left = read_json(&verdicts);
    assert_eq!(left, report);
    left["runs"][0]["frame"]["verdict"] = "FASTER".into();
    fs::write(&verdicts, left.to_string()).unwrap();
    let page = out.path().join("page.html");
    fumarole("report --quiet -o").arg(&page).arg(out.path()).run().succeeded();
    assert!(fs::read_to_string(page).unwrap().contains("FASTER"));
}

#[test]
fn a_side_may_have_another_program_and_changed_shaders() {
    let out = folder();
    let shaders = own_shaders(out.path());
    end_cast_with(&shaders, "color.r += 0.25;");
    // The same program but for its digest.
    let another = out.path().join("another");
    let mut bytes = fs::read(env!("CARGO_BIN_EXE_fumarole")).unwrap();
    bytes.push(0);
    fs::write(&another, bytes).unwrap();
    fs::set_permissions(&another, fs::metadata(env!("CARGO_BIN_EXE_fumarole")).unwrap().permissions()).unwrap();
    let program = ab("--json --out").arg(out.path()).arg("--binary").arg(format!("B:{}", another.display()));
    let report = common(program.arg("--b").arg(format!("--shader-dir {}", shaders.display()))).run().succeeded().json();
    let differences = report["differences"].as_array().unwrap().iter();
    let whats: Vec<&str> = differences.map(|difference| difference["what"].as_str().unwrap()).collect();
    assert!(whats.iter().any(|what| what.starts_with("SPIR-V of caustics level-map cast")), "{whats:?}");
    assert!(whats.contains(&"build.executable_sha256"), "{whats:?}");
}

/// An option of one side takes the place of the common one.
#[test]
fn a_side_s_own_value_comes_after_the_common_one() {
    let out = folder();
    let program = ab("--json --out").arg(out.path()).arg("--a").arg("--variant level-map --seed 3");
    let program = program.arg("--b").arg("--variant level-map --seed 4").args("caustics --variant volumetric --seed 2");
    let report = program.args(SCENE).args(ONCE).arg("--device").arg(device()).run().succeeded().json();
    assert_eq!(report["runs"].as_array().unwrap().len(), 1, "{report}");
    assert_eq!(report["runs"][0]["variant"], "level-map");
    let differences = report["differences"].as_array().unwrap();
    let seed = differences.iter().find(|difference| difference["what"] == "seed").expect("the seeds differ");
    assert_eq!((&seed["a"][0], &seed["b"][0]), (&"3".into(), &"4".into()));
    // Of a list that one word names as well.
    let program =
        ab("--json --out").arg(out.path()).arg("--b").arg("--march delta").args("gas --variant none --march steps");
    let program = program.args("--size 24x16").args(ONCE).arg("--device").arg(device());
    let report = program.run().succeeded().json();
    assert_eq!((&report["only_in_a"], &report["only_in_b"]), (&json!([]), &json!([])), "{report}");
    assert_eq!(report["runs"].as_array().unwrap().len(), 1, "{report}");
}

/// Its own options behind the paper, where they are read as those of both sides otherwise.
#[test]
fn its_own_options_may_stand_behind_the_paper() {
    let out = folder();
    let program = common(fumarole("ab")).args("--blocks 2 --b").arg("--seed 2").args("--quiet --margin 3% --markdown");
    let ended = program.args("--env B:LP_NUM_THREADS=1 --out").arg(out.path()).run().succeeded();
    assert!(ended.stdout.starts_with("**What is compared**\n"), "{}", ended.stdout);
    for part in ["- seed: A 1, B 2", "### caustics level-map: 96 × 64", "| --- |", "within ± 3 %", "blocks A B B A"] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    assert_eq!(ended.stderr, "");
    assert_eq!(entries(out.path()), ["ab-a.json", "ab-b.json", "ab.json"]);
}

/// Several processes in one place of a block would count as blocks, and files of both sides be those of one.
#[test]
fn what_would_make_no_blocks_or_one_file_of_all_is_refused() {
    let out = folder();
    let ab = || ab("--out").arg(out.path());
    for words in
        ["--processes 2", "--process 2", "--image x.png", "--trace x.json", "--csv x.csv", "--capture renderdoc"]
    {
        let (option, value) = words.split_once(' ').unwrap();
        common(ab()).arg(option).arg(value).run().refused(2, &["ab: ", option]);
        common(ab()).arg(format!("{option}={value}")).run().refused(2, &["ab: ", option]);
    }
    for side in ["--a", "--b"] {
        for words in ["--processes 2", "--csv x.csv", "--json x.json", "--json", "--out=x", "--quiet", "-q"] {
            let option = words.split(['=', ' ']).next().unwrap();
            common(ab().arg(side).arg(words)).run().refused(2, &["error: ab: ", option]);
        }
    }
    for words in ["--fail-above 5%", "--fail-unclear", "--fail-missing", "--markdown", "--json"] {
        let option = words.split(' ').next().unwrap();
        common(ab().args("--shard 1/2").args(words)).run().refused(2, &[option, "--shard"]);
    }
    assert_eq!(entries(out.path()), [""; 0]);
}

/// Limits take seconds, and are the device's; a picture is the side's.
#[test]
fn the_first_process_of_a_side_alone_measures_the_limits_and_writes_files() {
    let out = folder();
    let once = ONCE.replace("--no-limits", "");
    let program = ab("--out").arg(out.path()).arg("--a").arg(format!("--image {}/a.png", out.path().display()));
    let program = program.args("caustics --variant level-map").args(SCENE).args(&once);
    program.arg("--device").arg(device()).run().succeeded();
    assert_eq!(entries(out.path()), ["a.png", "ab-a.json", "ab-b.json", "ab.json"]);
    for name in ["ab-a.json", "ab-b.json"] {
        let record = read_json(&out.path().join(name));
        let runs = record["runs"].as_array().unwrap();
        let have_limits: Vec<bool> = runs.iter().map(|run| !run["limits"].is_null()).collect();
        assert_eq!(have_limits, [true, false, false, false], "{name}");
        let have_pictures: Vec<bool> = runs.iter().map(|run| !run["image"].is_null()).collect();
        assert_eq!(have_pictures, [name == "ab-a.json", false, false, false], "{name}");
    }
}

/// The program, but for calls of some numbers, which do something else.
#[cfg(unix)]
fn counting_script(folder: &Path, numbers: &str, other: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let (calls, script) = (folder.join("calls"), folder.join("script"));
    let text = format!(
        "#!/bin/sh\necho >> '{0}'\nif [ $(wc -l < '{0}') {numbers} ]; then {other}; fi\nexec '{1}' \"$@\"\n",
        calls.display(),
        env!("CARGO_BIN_EXE_fumarole")
    );
    fs::write(&script, text).unwrap();
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    script
}

/// A program that fails in the third block: two are compared, and all that was measured is kept.
#[cfg(unix)]
#[test]
fn a_failure_throws_no_block_away() {
    let out = folder();
    let script = counting_script(out.path(), "-ge 9", "echo 'error: the ninth call' >&2; exit 1");
    let kept = out.path().join("kept");
    let [a, b] = ["A", "B"].map(|side| format!("{side}:{}", script.display()));
    let program = fumarole("ab --blocks 5 --quiet --out").arg(&kept).arg("--binary").arg(&a).arg("--binary").arg(&b);
    let ended = common(program).run();
    assert_eq!(ended.status.code(), Some(1), "{}{}", ended.stdout, ended.stderr);
    assert_eq!(ended.stderr, "error: side A: the ninth call\n");
    assert!(ended.stdout.contains("blocks A B B A") && ended.stdout.contains("4 processes"), "{}", ended.stdout);
    for name in ["ab-a.json", "ab-b.json"] {
        let processes = read_json(&kept.join(name))["runs"].as_array().unwrap().len();
        assert_eq!(processes, 4, "{name}");
    }
    assert_eq!(read_json(&kept.join("ab.json"))["runs"][0]["a_processes"], 4);

    // Before two blocks there is nothing to say.
    let none = out.path().join("none");
    let program = fumarole("ab --blocks 5 --quiet --out").arg(&none).arg("--binary").arg(&a);
    common(program).run().refused(1, &["side A: the ninth call"]);
    assert!(!none.join("ab-a.json").exists());
}

/// Told to end in its third block, by a process that does not end by itself: two are compared.
#[cfg(unix)]
#[test]
fn an_interruption_keeps_whole_blocks() {
    let out = folder();
    let script = counting_script(out.path(), "-eq 10", "kill -INT $PPID; exec sleep 1000");
    let kept = out.path().join("kept");
    let [a, b] = ["A", "B"].map(|side| format!("{side}:{}", script.display()));
    let program = fumarole("ab --blocks 5 --quiet --out").arg(&kept).arg("--binary").arg(&a).arg("--binary").arg(&b);
    let ended = common(program).run().succeeded();
    assert!(ended.stdout.contains("4 processes"), "{}", ended.stdout);
    assert_eq!(entries(&kept), ["ab-a.json", "ab-b.json", "ab.json"]);
    for name in ["ab-a.json", "ab-b.json"] {
        assert_eq!(read_json(&kept.join(name))["runs"].as_array().unwrap().len(), 4, "{name}");
    }
    assert_eq!(read_json(&kept.join("ab.json"))["runs"][0]["a_processes"], 4);
    assert_eq!(fs::read_to_string(out.path().join("calls")).unwrap().lines().count(), 10);
}

#[test]
fn no_block_begins_after_the_budget() {
    let out = folder();
    let started = std::time::Instant::now();
    let ended = common(fumarole("ab --quiet --budget 1 --out").arg(out.path())).run();
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
    // On a slow machine the first block takes all of it.
    match ended.status.code() {
        Some(0) => assert!(ended.stdout.contains("UNCLEAR: frame"), "{}", ended.stdout),
        _ => ended.refused(1, &["--budget", "two blocks"]),
    }
}

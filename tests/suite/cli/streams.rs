//! Standard output and standard error: pipes, terminals, and readers that have left.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use super::program::{ONCE, Program, caustics, entries, folder};

fn bench(folder: &Path) -> Program {
    caustics("bench").inside(folder).tiny().args(ONCE)
}

/// Output of `command` on a terminal, and its exit code.
fn on_terminal(command: &str, folder: &Path, variables: &[(&str, &str)]) -> (String, Option<i32>) {
    let mut script = Command::new("script");
    script.args(["--quiet", "--return", "--command", command, "/dev/null"]).current_dir(folder);
    script.env_remove("NO_COLOR").env("TERM", "xterm-256color").envs(variables.iter().copied());
    let output = script.stdin(Stdio::null()).output().expect("util-linux's script makes a terminal");
    (String::from_utf8_lossy(&output.stdout).into_owned(), output.status.code())
}

fn has_escapes(text: &str) -> bool {
    text.contains('\x1b')
}

#[test]
fn a_pipe_gets_neither_bar_nor_colours() {
    let out = folder();
    let ended = bench(out.path()).args("--json a.json").run().succeeded();
    assert!(ended.stdout.contains("caustics level-map"), "{}", ended.stdout);
    assert!(!has_escapes(&ended.stdout) && !has_escapes(&ended.stderr));
    assert!(!ended.stdout.contains('\r') && !ended.stderr.contains('\r'));
    assert_eq!(ended.stderr, "wrote a.json\n");
}

#[test]
fn a_terminal_gets_colours_unless_they_are_unwanted() {
    let out = folder();
    let command = format!("{} 2>messages", bench(out.path()).for_shell());
    let (coloured, code) = on_terminal(&command, out.path(), &[]);
    assert_eq!(code, Some(0), "{coloured}");
    assert!(coloured.contains("caustics level-map") && has_escapes(&coloured), "{coloured}");
    let (plain, code) = on_terminal(&command, out.path(), &[("NO_COLOR", "1")]);
    assert_eq!(code, Some(0), "{plain}");
    assert!(plain.contains("caustics level-map") && !has_escapes(&plain), "{plain}");
    assert_eq!(fs::read_to_string(out.path().join("messages")).unwrap(), "");
}

#[test]
fn a_terminal_gets_a_progress_bar_unless_it_is_unwanted() {
    let out = folder();
    // Long enough to be drawn: a bar refreshes twenty times a second.
    let long = || bench(out.path()).args("--min-time 0.3 --variant level-map");
    let (shown, code) = on_terminal(&format!("{} >table", long().for_shell()), out.path(), &[]);
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains("caustics") && shown.contains('/'), "no bar: {shown:?}");
    let (shown, code) = on_terminal(&format!("{} >table", long().arg("--quiet").for_shell()), out.path(), &[]);
    assert_eq!((shown.as_str(), code), ("", Some(0)));
}

#[test]
fn quiet_leaves_what_was_asked_for() {
    let out = folder();
    let ended = bench(out.path()).args("--quiet --csv a.csv").run().succeeded();
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
    assert_eq!(entries(out.path()), ["a.csv"]);
    let ended = bench(out.path()).args("-q --json").run().succeeded();
    assert_eq!(ended.json()["schema"], "fumarole.bench/1");
    assert_eq!(ended.stderr, "");
    bench(out.path()).args("--quiet --planes-").run().misused(&["--planes-"]);
}

/// A substituted process is a pipe that is read.
#[test]
fn pipes_that_are_read_get_what_is_written() {
    let out = folder();
    let program = bench(out.path()).args("--quiet --csv").for_shell();
    let mut bash = Command::new("bash");
    bash.arg("-c").arg(format!("{program} >(cat >a.csv; touch ended) && until [ -e ended ]; do sleep 0.01; done"));
    assert!(bash.current_dir(out.path()).stdin(Stdio::null()).status().unwrap().success());
    assert!(fs::read_to_string(out.path().join("a.csv")).unwrap().starts_with("device,"));
    let (stdout, stderr, code) = in_shell(&format!("{program} /dev/stdout | cat"), out.path());
    assert!(stdout.starts_with("device,") && code == Some(0), "{stderr}");
}

fn in_shell(command: &str, folder: &Path) -> (String, String, Option<i32>) {
    let output = Command::new("sh").arg("-c").arg(command).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let out = folder();
    for program in [bench(out.path()).args("--csv a.csv"), caustics("passes").tiny(), caustics("experiment --list")] {
        // The reader is gone before the program prints.
        let command = format!("{{ {} 2>messages; echo $? >code; }} | true", program.for_shell());
        let _ = fs::remove_file(out.path().join("a.csv"));
        let (_, _, code) = in_shell(&command, out.path());
        assert_eq!(code, Some(0));
        let messages = fs::read_to_string(out.path().join("messages")).unwrap();
        assert_eq!(fs::read_to_string(out.path().join("code")).unwrap(), "0\n", "{messages}");
        assert!(!messages.contains("panicked"), "{messages}");
    }
    // The file is written even so, and nobody need listen to messages either.
    let deaf =
        format!("{{ {} 2>&1 >/dev/null; echo $? >code; }} | true", bench(out.path()).args("--csv a.csv").for_shell());
    in_shell(&deaf, out.path());
    assert_eq!(fs::read_to_string(out.path().join("code")).unwrap(), "0\n");
    assert!(out.path().join("a.csv").exists());
}

#[test]
fn a_full_disk_behind_standard_output_is_one_line() {
    let out = folder();
    for program in [bench(out.path()).args("--json --quiet --csv a.csv"), caustics("passes").tiny(), caustics("--help")]
    {
        let (_, stderr, code) = in_shell(&format!("{} >/dev/full", program.for_shell()), out.path());
        assert_eq!(code, Some(2), "{stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stderr.starts_with("error: writing to standard output: "), "{stderr}");
    }
    assert!(out.path().join("a.csv").exists(), "what can be written is");
}

//! Standard output and standard error: pipes, terminals, and readers that have left.

use std::fs::{self, File};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use nix::fcntl::{FcntlArg, fcntl};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

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

/// A pipe that is full, of which nobody reads any more: the system would wait for that, deaf to signals.
#[test]
fn a_reader_that_takes_nothing_is_given_up_after_an_interruption() {
    let out = folder();
    let pipe = out.path().join("pipe.y4m");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let end = |writes: bool| {
        File::options().read(!writes).write(writes).custom_flags(nix::libc::O_NONBLOCK).open(&pipe).unwrap()
    };
    let is_full = || {
        let writer = end(true);
        poll(&mut [PollFd::new(writer.as_fd(), PollFlags::POLLOUT)], PollTimeout::ZERO).unwrap() == 0
    };
    let film = caustics("render --frame 0..1000000 --film pipe.y4m").tiny().for_shell();
    let printed = format!("{} >pipe.y4m", caustics("passes --json --variant all").tiny().for_shell());
    for (command, code, told) in
        [(film, 2, "pipe.y4m: it is a pipe that no one reads"), (printed, 1, "standard output")]
    {
        let reader = end(false);
        fcntl(&reader, FcntlArg::F_SETPIPE_SZ(4096)).unwrap();
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("exec {command}")).current_dir(out.path()).stderr(Stdio::piped());
        let mut program = shell.spawn().unwrap();
        while !is_full() {
            assert_eq!(program.try_wait().unwrap(), None, "{command}: it has ended before the pipe was full");
            thread::sleep(Duration::from_millis(20));
        }
        kill(Pid::from_raw(program.id() as i32), Signal::SIGTERM).unwrap();
        let told_at = Instant::now();
        let ended = program.wait_with_output().unwrap();
        assert!(told_at.elapsed() < Duration::from_secs(30), "{command}: {:?}", told_at.elapsed());
        let stderr = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(code), "{stderr}");
        assert!(stderr.contains(told), "{stderr}");
    }
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

//! The client against programs that are no worker: what it tells of them, and that none stays.

use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

use fumarole::window::client::Client;
use fumarole::window::protocol::{Event, Request};

fn shell(script: &str) -> Client {
    let arguments = ["-c", script, "worker"].map(OsString::from);
    Client::spawn(Path::new("/bin/sh"), &arguments, || {}).unwrap()
}

/// Every event up to the last.
fn events(client: &mut Client) -> Vec<Event> {
    let started = Instant::now();
    let mut events = Vec::new();
    while !matches!(events.last(), Some(Event::Ended(_))) {
        assert!(started.elapsed() < Duration::from_secs(20), "{events:?}");
        match client.try_receive() {
            Some(event) => events.push(event),
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    events
}

#[test]
fn a_death_is_an_event_with_its_code_and_last_words() {
    let mut client = shell(r#"echo '{"warning":"x"}'; echo; echo no JSON; echo out of paper >&2; exit 7"#);
    let events = events(&mut client);
    assert_eq!(events[0], Event::Warning("x".into()));
    let [_, Event::Ended(last)] = &events[..] else { panic!("{events:?}") };
    assert_eq!((last.code, last.signal), (Some(7), None));
    assert!(last.stderr.contains(&"out of paper".to_owned()) && last.stderr.contains(&"no JSON".to_owned()));
    assert!(!client.is_alive());
    // Nobody hears; nothing fails.
    client.send(Request::Play);
}

#[test]
fn only_the_last_words_are_kept_and_a_signal_is_named() {
    let mut client = shell("i=0; while [ $i -lt 500 ]; do echo line $i >&2; i=$((i+1)); done; kill -9 $$");
    let events = events(&mut client);
    let [Event::Ended(last)] = &events[..] else { panic!("{events:?}") };
    assert_eq!((last.code, last.signal), (None, Some(9)));
    assert_eq!((last.stderr.len(), last.stderr.last().unwrap().as_str()), (20, "line 499"));
}

#[test]
fn pictures_that_are_not_there_are_a_problem_and_their_frame_is_taken_all_the_same() {
    let picture = r#"{"width":1,"height":1,"block":{"offset":4,"len":99999999999999}}"#;
    let side = format!(r#"{{"picture":{picture},"frame_ms":1,"written":[]}}"#);
    let frame = format!(
        r#"{{"frame":{{"serial":1,"heeds":0,"number":0,"is_playing":false,"speed":1,"after":null,"sides":[{side}],"difference":null,"target":null,"thumbnails":[]}}}}"#
    );
    let mut client = shell(&format!(r#"echo '{frame}'; read -r heard; echo "$heard" >&2"#));
    let events = events(&mut client);
    let [Event::Failed { problem, .. }, Event::Ended(last)] = &events[..] else { panic!("{events:?}") };
    assert!(problem.contains("pictures"), "{problem}");
    assert_eq!(last.stderr, [r#"{"id":1,"request":{"taken":1}}"#]);
}

#[test]
fn a_worker_that_does_not_listen_is_killed_and_leaves_no_file() {
    let client = shell("trap '' TERM; echo $5; while true; do sleep 1; done");
    let id = client.process_id();
    // More than a pipe holds.
    let mut client = client;
    for _ in 0..5_000 {
        client.send(Request::GoTo(7));
    }
    let started = Instant::now();
    drop(client);
    assert!(started.elapsed() < Duration::from_secs(5));
    assert!(!Path::new("/proc").join(id.to_string()).exists());
    let mine = format!(".fumarole-{}-", std::process::id());
    let left = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    let left: Vec<_> = left.filter(|entry| entry.file_name().to_string_lossy().starts_with(&mine)).collect();
    assert!(left.is_empty(), "{left:?}");
}

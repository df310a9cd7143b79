//! Impossible requests, and the end of a worker: it says so in a line, and never stays behind.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use fumarole::window::protocol::{Assignment, Event, Keep, Request, SideChoice, TargetChoice};

use super::scene::{Worker, picture, program, rendered, set, small, variant, words};
use crate::common::{beside_others, wanted_device};

#[test]
fn what_cannot_be_is_one_line_and_the_last_picture_stays() {
    beside_others(|| {
        let mut worker = Worker::small("caustics");
        let first = picture(&worker.frame_after(0), 0);
        let value = |name: &str, values: &[&str]| {
            Request::Set(vec![Assignment { name: name.into(), values: values.iter().map(|&v| v.into()).collect() }])
        };
        let broken = tempfile::NamedTempFile::with_suffix(".obj").unwrap();
        std::fs::write(broken.path(), "v 0 0 0\nf 1 2 3\n").unwrap();
        let broken = broken.path().display().to_string();
        let named = [broken.as_str()];
        let film = Keep::Film { side: 0, first: 5, end: 5, file: "film.y4m".into() };
        let cases: Vec<(Request, &[&str])> = vec![
            (value("no-such", &["1"]), &["no-such"]),
            (value("planes", &["many"]), &["planes", "many"]),
            (value("planes", &["0"]), &["planes", "0"]),
            (value("planes", &["7", "8"]), &["planes"]),
            (value("camera", &["0,0,0,0,0,0"]), &["camera"]),
            (value("mesh", &["/no/such.obj"]), &["/no/such.obj"]),
            (value("mesh", &named), &named),
            (value("map-size", &["4000000"]), &["map-size"]),
            (Request::Preset(Some("fig-0".into())), &["fig-0"]),
            (Request::Sides(vec![]), &["side"]),
            (Request::Sides(vec![variant("no-such")]), &["no-such"]),
            (Request::Sides(vec![SideChoice { compiler: Some("cc".into()), ..variant("stencil") }]), &["cc"]),
            (Request::Speed(0.0), &["speed"]),
            (Request::Speed(f64::from(f32::MAX)), &["speed"]),
            (Request::Keep(Keep::Picture { side: 0, file: "x.jpg".into() }), &["x.jpg", ".png"]),
            (Request::Keep(Keep::Picture { side: 3, file: "x.png".into() }), &["side"]),
            (Request::Keep(Keep::Target { side: 0, name: "fog".into(), file: "x.npy".into() }), &["fog", "water"]),
            (Request::Keep(film), &["5..5"]),
            (Request::Keep(Keep::Picture { side: 0, file: "/proc/x.png".into() }), &["/proc/x.png"]),
        ];
        for (request, expected) in cases {
            let shown = format!("{request:?}");
            let problem = worker.refusal_of(request);
            assert!(expected.iter().all(|part| problem.contains(part)), "{shown}: {problem}");
        }
        for (name, layer) in [("fog", 0), ("picture", 3)] {
            let choice = TargetChoice { side: 0, name: name.into(), layer, first_row: 0 };
            worker.client.send(Request::Target(Some(choice)));
            loop {
                if let Event::Failed { problem, .. } = worker.next() {
                    assert!(problem.contains(name), "{problem}");
                    break;
                }
            }
        }
        worker.client.send(Request::Target(None));
        let frame = worker.frame_of(set("camera", "0.5,4,3,0,-2,0"));
        assert!(picture(&frame, 0) != first);
        assert!(picture(&frame, 0) == rendered("caustics", &format!("{} --camera=0.5,4,3,0,-2,0", small("caustics"))));
        worker.quit();
    });
}

#[test]
fn a_set_up_that_cannot_be_loaded_can_be_mended() {
    beside_others(|| {
        let options = format!("{} --mesh /no/such.obj", small("caustics").replace("--mesh teapot", ""));
        let mut worker = Worker::start("caustics", &options);
        loop {
            if let Event::Failed { problem, .. } = worker.next() {
                assert!(problem.contains("/no/such.obj"), "{problem}");
                break;
            }
        }
        assert!(picture(&worker.frame_of(set("mesh", "teapot")), 0) == rendered("caustics", small("caustics")));
        worker.quit();
    });
}

#[test]
fn a_killed_worker_is_an_event_and_a_device_that_is_not_there_an_exit_code() {
    beside_others(|| {
        let mut worker = Worker::small("gas");
        worker.frame_after(0);
        let id = worker.client.process_id().to_string();
        assert!(Command::new("kill").args(["-9", &id]).status().unwrap().success());
        let ended = loop {
            if let Event::Ended(ended) = worker.next() {
                break ended;
            }
        };
        assert_eq!((ended.code, ended.signal), (None, Some(9)));
        assert!(!worker.client.is_alive());

        let mut worker = Worker::start("gas", "--device no-such");
        let ended = loop {
            if let Event::Ended(ended) = worker.next() {
                break ended;
            }
        };
        assert_eq!(ended.code, Some(2));
        assert!(ended.stderr.iter().any(|line| line.contains("no-such")), "{ended:?}");
    });
}

/// A worker whose other end is this test itself.
fn bare(options: &str) -> (Child, tempfile::NamedTempFile) {
    let exchange = tempfile::NamedTempFile::new().unwrap();
    (bare_with(options, exchange.path()), exchange)
}

/// As [`bare`], with this file for its pictures.
fn bare_with(options: &str, exchange: &Path) -> Child {
    let mut command = Command::new(program());
    command.args(words(options)).arg("--device").arg(wanted_device()).arg("--exchange").arg(exchange);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    command.spawn().unwrap()
}

/// Seconds until it has ended.
fn ended(child: &mut Child) -> f64 {
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it stays");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    started.elapsed().as_secs_f64()
}

#[test]
fn a_worker_ends_with_its_window_even_while_it_draws() {
    beside_others(|| {
        // Minutes of a frame.
        let options = "gas worker --size 1600x1200 --steps 400 --table 8";
        let (mut child, exchange) = bare(options);
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        assert!(lines.next().unwrap().unwrap().starts_with("{\"ready\""));
        assert!(!exchange.path().exists(), "the file has no name any more");
        std::thread::sleep(Duration::from_secs(2));
        drop(child.stdin.take());
        let seconds = ended(&mut child);
        assert!(seconds < 20.0, "it stayed for {seconds} s");
    });
}

#[test]
fn lines_that_are_no_requests_are_told_of_and_do_no_harm() {
    beside_others(|| {
        let (mut child, _exchange) = bare(&format!("gas worker {}", small("gas")));
        let mut input = child.stdin.take().unwrap();
        input.write_all(b"nonsense\n{\"id\":1}\n{\"id\":2,\"request\":{\"go_to\":-3}}\n\n").unwrap();
        input.write_all(b"{\"id\":3,\"request\":\"quit\"}\n").unwrap();
        assert!(ended(&mut child) < 60.0);
        let mut told = String::new();
        child.stdout.take().unwrap().read_to_string(&mut told).unwrap();
        assert_eq!(told.matches("reading a request").count(), 4, "{told}");
    });
}

#[test]
fn frames_that_find_no_room_are_told_of_one_by_one_and_the_next_is_tried() {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        // The worker takes the name away, which is the link's alone.
        let full = folder.path().join("full");
        std::os::unix::fs::symlink("/dev/full", &full).unwrap();
        let mut child = bare_with(&format!("gas worker {}", small("gas")), &full);
        let mut input = child.stdin.take().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        let is_failure = |line: &String| line.starts_with(r#"{"failed":"#) && line.contains("to the window");
        assert!(lines.any(|line| is_failure(&line)), "the first");
        writeln!(input, r#"{{"id":1,"request":{{"step":1}}}}"#).unwrap();
        assert!(lines.any(|line| is_failure(&line)), "the second");
        // What is asked for last is told after the frame that is asked for before it.
        writeln!(input, r#"{{"id":2,"request":{{"step":1}}}}"#).unwrap();
        writeln!(input, r#"{{"id":3,"request":"memory"}}"#).unwrap();
        let told: Vec<String> = lines.by_ref().take_while(|line| !line.starts_with(r#"{"memory":"#)).collect();
        assert_eq!(told.iter().filter(|line| is_failure(line)).count(), 1, "{told:?}");
        drop(input);
        assert!(ended(&mut child) < 60.0);
    });
}

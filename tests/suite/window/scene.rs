//! A worker of the tests, and the small scenes that it draws.

use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use fumarole::image::{Rgba8, read_png};
use fumarole::window::client::Client;
use fumarole::window::protocol::{Assignment, Event, Frame, Picture, Request, Setup, SideChoice};

use crate::common::wanted_device;

/// Each paper with options of a scene that is drawn in no time.
pub const PAPERS: [(&str, &str); 5] = [
    ("lava", "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --splat-radius 0.2"),
    ("gas", "--size 45x31 --steps 8 --table 8"),
    ("caustics", "--size 64x48 --map-size 64 --water-triangles 500 --mesh teapot"),
    (
        "burning",
        "--size 48x32 --blocks 3x3x3 --fire 60 --smoke 30 --speed 1 --flammability 10 --mesh sphere --triangles 300",
    ),
    ("terrain", "--size 48x32 --resolution 65"),
];

/// The options of a paper's small scene.
pub fn small(paper: &str) -> &'static str {
    PAPERS.iter().find(|(name, _)| *name == paper).unwrap().1
}

pub fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_fumarole"))
}

/// The words of a text.
pub fn words(text: &str) -> Vec<OsString> {
    text.split_whitespace().map(OsString::from).collect()
}

/// A worker under validation. Every event is expected: what no test asks for fails it.
pub struct Worker {
    pub client: Client,
    woken: mpsc::Receiver<()>,
    /// Everything that it has told.
    pub events: Vec<Event>,
}

impl Worker {
    pub fn start(paper: &str, options: &str) -> Self {
        Self::spawn(program(), Vec::new(), paper, options)
    }

    /// Of the paper's small scene, with these variables in its environment.
    pub fn in_environment(variables: &[(&str, OsString)], paper: &str) -> Self {
        let set = variables.iter().map(|(name, value)| {
            let mut word = OsString::from(name);
            word.push("=");
            word.push(value);
            word
        });
        let words: Vec<OsString> = set.chain([OsString::from(program())]).collect();
        Self::spawn(Path::new("env"), words, paper, small(paper))
    }

    /// With what stands for RenderDoc in its process, which writes its files to `folder`.
    pub fn under_renderdoc(paper: &str, folder: &Path) -> Self {
        let variable = |name: &str| [OsStr::new(name), folder.as_os_str()].into_iter().collect::<OsString>();
        let set = [variable("LD_LIBRARY_PATH="), variable("TMPDIR="), "LD_PRELOAD=librenderdoc.so".into()];
        Self::spawn(Path::new("env"), [&set[..], &[program().into()]].concat(), paper, small(paper))
    }

    fn spawn(program: &Path, before: Vec<OsString>, paper: &str, options: &str) -> Self {
        let mut verb = words(&format!("{paper} worker --validate"));
        if !options.contains("--device") {
            verb.extend(["--device".into(), wanted_device().into()]);
        }
        let arguments = [before, verb, words(options)].concat();
        let (wake, woken) = mpsc::channel();
        let client = Client::spawn(program, &arguments, move || {
            let _gone = wake.send(());
        });
        Worker { client: client.unwrap(), woken, events: Vec::new() }
    }

    pub fn small(paper: &str) -> Self {
        Self::start(paper, small(paper))
    }

    /// The next event.
    pub fn next(&mut self) -> Event {
        let started = Instant::now();
        loop {
            if let Some(event) = self.client.try_receive() {
                assert!(!matches!(event, Event::Validation(_)), "{event:?}");
                self.events.push(event.clone());
                return event;
            }
            assert!(started.elapsed() < Duration::from_secs(120), "nothing comes after {:?}", self.names());
            let _none = self.woken.recv_timeout(Duration::from_millis(50));
        }
    }

    fn names(&self) -> Vec<String> {
        self.events.iter().map(|event| format!("{event:?}").chars().take(60).collect()).collect()
    }

    /// The next event that `wanted` takes; a failure or an end that it does not take fails the test.
    pub fn wait_for<T>(&mut self, wanted: impl Fn(&Event) -> Option<T>) -> T {
        loop {
            let event = self.next();
            if let Some(found) = wanted(&event) {
                return found;
            }
            assert!(!matches!(event, Event::Failed { .. } | Event::Ended(_)), "{event:?}");
        }
    }

    /// Sends a request, and gives the first frame that heeds it.
    pub fn frame_of(&mut self, request: Request) -> Frame {
        let id = self.client.send(request);
        self.frame_after(id)
    }

    pub fn frame_after(&mut self, id: u64) -> Frame {
        self.wait_for(|event| match event {
            Event::Frame(frame) if frame.heeds >= id => Some((**frame).clone()),
            _ => None,
        })
    }

    /// Sends a request that cannot be done, and gives the problem.
    pub fn refusal_of(&mut self, request: Request) -> String {
        let sent = self.client.send(request);
        loop {
            if let Event::Failed { id, problem } = self.next() {
                assert_eq!(id, sent, "{problem}");
                assert!(!problem.contains('\n'), "{problem}");
                return problem;
            }
        }
    }

    pub fn setup(&self) -> &Setup {
        let last = self.events.iter().rev().find_map(|event| match event {
            Event::Setup(setup) => Some(setup),
            _ => None,
        });
        last.unwrap()
    }

    /// The end that was asked for: in order, with every Vulkan object gone.
    pub fn quit(mut self) {
        self.client.send(Request::Quit);
        let ended = self.wait_for(|event| match event {
            Event::Ended(ended) => Some(ended.clone()),
            _ => None,
        });
        assert_eq!((ended.code, ended.signal), (Some(0), None), "{ended:?}");
    }
}

pub fn set(name: &str, value: &str) -> Request {
    Request::Set(vec![Assignment { name: name.into(), values: vec![value.into()] }])
}

pub fn unset(name: &str) -> Request {
    Request::Set(vec![Assignment { name: name.into(), values: Vec::new() }])
}

pub fn variant(name: &str) -> SideChoice {
    SideChoice { variant: Some(name.into()), ..SideChoice::default() }
}

pub fn pixels(picture: &Picture) -> Rgba8 {
    Rgba8::new(picture.width, picture.height, picture.block.bytes.clone()).unwrap()
}

/// The picture of a side.
pub fn picture(frame: &Frame, side: usize) -> Rgba8 {
    pixels(frame.sides[side].picture.as_ref().expect("a picture"))
}

/// The options, of which the last of a name counts.
fn last_of_each(options: &str) -> Vec<OsString> {
    let mut kept: Vec<(&str, Vec<OsString>)> = Vec::new();
    for word in options.split_whitespace() {
        if word.starts_with("--") {
            let name = word.split('=').next().unwrap();
            kept.retain(|(other, _)| *other != name);
            kept.push((name, vec![word.into()]));
        } else {
            kept.last_mut().unwrap().1.push(word.into());
        }
    }
    kept.into_iter().flat_map(|(_, words)| words).collect()
}

/// Picture of `render` with these options.
pub fn rendered(paper: &str, options: &str) -> Rgba8 {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("picture.png");
    let mut command = Command::new(program());
    command.args([paper, "render", "--quiet", "--device"]).arg(wanted_device()).args(last_of_each(options));
    let ended = command.arg("--image").arg(&file).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    read_png(&file).unwrap()
}

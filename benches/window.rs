//! The window as its user feels it, on an Xvfb of its own: `cargo bench --bench window -- [interface] [latency] [idle]
//! [soak SECONDS] [pictures FOLDER]`; without a word the first three. No validation layer. The worker draws the whole time
//! but for `idle`. Each is held against its bar, and one that is missed ends the run with exit code 1. `pictures` makes those
//! of the window that the pages show.

#[path = "../tests/suite/common.rs"]
#[expect(dead_code, reason = "the harness is that of the tests")]
mod common;
#[path = "../tests/suite/cli/program.rs"]
pub mod program;
mod cli {
    pub use super::program;
}
#[path = "../tests/suite/window/display.rs"]
#[expect(dead_code, reason = "the harness is that of the tests")]
mod display;

use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

use display::{Display, Window};
use fumarole::image::{Rgba8, write_png};
use fumarole::measure::statistics::median;
use program::{Running, fumarole};
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

/// X key symbols.
const SPACE: u32 = 0x20;
const F1: u32 = 0xffbe;

/// A frame of more than five seconds on lavapipe with two cores, which a window must not wait for.
const HEAVY: &str = "gas --variant traced --size 800x500 --steps 240";
/// Shortest frame of the worker that `latency` is measured beside, milliseconds.
const LEAST_FRAME_MS: f64 = 5000.0;
/// From a key to the screen, at most, milliseconds.
const MOST_LATENCY_MS: f64 = 100.0;
/// A frame of the interface in the middle of all, at most, milliseconds.
const MOST_OWN_MS: f64 = 8.0;
/// Processor time at rest in 10 s, at most, hundredths of a second: 1 % of a core.
const MOST_TICKS: u64 = 10;
/// When `soak` first looks at the memory, and then again and again.
const FIRST_LOOK: Duration = Duration::from_secs(60);
/// Memory that a process may hold more at the end of `soak` than after its first minute, kB.
const MOST_GROWN_KB: i64 = 2 << 10;
/// A frame that is there soon, so that the interface has something new to show all the time, texel by pixel.
const LIGHT: &str = "caustics --size 600x375";
/// As [`LIGHT`], of a picture that is made to fit.
const LARGE: &str = "caustics --size 800x500";
/// Pictures of the pages, one of each paper, texel by pixel, and how many passes on lies the one that is looked at.
const PICTURES: [(&str, &str, usize); 5] = [
    ("lava", "--size 600x400 --particles 2000", 4),
    ("gas", "--size 600x400", 4),
    ("caustics", "--size 600x400 --floor --shadows --intensity vertex --fresnel --coverage 2", 5),
    ("burning", "--size 600x400 --frame 60", 2),
    ("terrain", "--size 600x400 --variant gpu-fragment", 2),
];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let asked = |name: &str| words.is_empty() || words.iter().any(|word| word == name);
    let mut missed = vec![];
    if asked("interface") {
        missed.extend(interface("a picture texel by pixel", LIGHT));
        missed.extend(interface("a picture that is made to fit", LARGE));
    }
    if asked("latency") {
        missed.extend(latency());
    }
    if asked("idle") {
        missed.extend(idle());
    }
    if let Some(at) = words.iter().position(|word| word == "soak") {
        let seconds = words.get(at + 1).and_then(|text| text.parse().ok()).expect("soak SECONDS");
        missed.extend(soak(Duration::from_secs(seconds)));
    }
    if let Some(at) = words.iter().position(|word| word == "pictures") {
        pictures(Path::new(words.get(at + 1).expect("pictures FOLDER")));
    }
    missed.iter().for_each(|bar| eprintln!("window: {bar}"));
    if missed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Message about a bar that is missed.
fn held(is_held: bool, bar: String) -> Option<String> {
    (!is_held).then_some(bar)
}

fn open<'a>(display: &'a Display, scene: &str) -> Window<'a> {
    let mut window = Window::start(display, fumarole(&format!("view {scene}")));
    window.resize(1280, 800);
    window.wait_for_frame(0);
    window
}

fn process_id(window: &Window<'_>) -> u32 {
    window.program.as_ref().map(Running::id).expect("it is open")
}

/// Bytes of a part of the screen: left, top, width, height.
fn pixels(display: &Display, [left, top, width, height]: [i16; 4]) -> Vec<u8> {
    let size = (width as u16, height as u16);
    let part = display.connection.get_image(ImageFormat::Z_PIXMAP, display.root, left, top, size.0, size.1, u32::MAX);
    part.unwrap().reply().unwrap().data
}

/// Left, top, width and height of a text, on a display where nobody moves the window.
fn place(window: &Window<'_>, text: &str) -> Option<[i16; 4]> {
    let controls = window.controls();
    let side = |control: &serde_json::Value, index: usize| control["rectangle_px"][index].as_f64();
    controls.iter().find(|control| control["value"] == text).and_then(|control| {
        let [left, top, right, bottom] = [0, 1, 2, 3].map(|index| side(control, index).unwrap_or_default() as i16);
        Some([left, top, right - left, bottom - top]).filter(|[.., width, height]| *width > 0 && *height > 0)
    })
}

/// Time of the window's own drawing by its own text, milliseconds: of the last frame whose panels were laid out, and of the last
/// that showed a new picture alone.
fn own_ms(window: &Window<'_>) -> [Option<f64>; 2] {
    let words = words(window);
    let text = words.iter().find_map(|text| text.strip_prefix("window ")?.strip_suffix(" ms"));
    let mut parts = text.into_iter().flat_map(|text| text.split(" / ")).map(|part| part.parse().ok());
    [parts.next().flatten(), parts.next().flatten()]
}

/// The window's text on the last frame, as "frame 3 in 21.4 ms".
fn frame(window: &Window<'_>) -> String {
    words(window).into_iter().find(|text| text.starts_with("frame ") && text.ends_with(" ms")).unwrap_or_default()
}

/// All that it says.
fn words(window: &Window<'_>) -> Vec<String> {
    let texts = |control: serde_json::Value| {
        ["label", "value"].map(|key| control[key].as_str().map(str::to_owned)).into_iter().flatten()
    };
    window.controls().into_iter().flat_map(texts).collect()
}

fn interface(what: &str, scene: &str) -> Option<String> {
    let display = Display::start();
    let window = open(&display, scene);
    display.key(SPACE);
    let started = Instant::now();
    let (mut laid_out, mut of_pictures) = (vec![], vec![]);
    let mut last = String::new();
    while started.elapsed() < Duration::from_secs(20) {
        let now = frame(&window);
        if now != last {
            let [panels, picture] = own_ms(&window);
            laid_out.extend(panels);
            of_pictures.extend(picture);
            last = now;
        }
        sleep(Duration::from_millis(20));
    }
    let own = format!("ms of the window's own drawing at 1280x800 while {what} plays");
    let mut middle = tell("interface", &format!("{own}, its panels laid out"), laid_out).0;
    if !of_pictures.is_empty() {
        middle = middle.max(tell("interface", &format!("{own}, a new picture alone"), of_pictures).0);
    }
    window.close().succeeded();
    held(middle <= MOST_OWN_MS, format!("the interface takes more than {MOST_OWN_MS} ms a frame with {what}"))
}

fn latency() -> Option<String> {
    let display = Display::start();
    let mut window = open(&display, HEAVY);
    display.key(F1);
    let area = window.wait("the list of keys", |window| place(window, "this list"));
    display.key(SPACE);
    sleep(Duration::from_secs(1));
    let mut samples = vec![];
    for number in 0..40_u64 {
        let before = pixels(&display, area);
        let pressed = Instant::now();
        display.key(F1);
        while pixels(&display, area) == before {
            sleep(Duration::from_millis(1));
        }
        samples.push(pressed.elapsed().as_secs_f64() * 1e3);
        sleep(Duration::from_millis(400 + 37 * number));
    }
    let beside = frame(&window);
    let most = tell("latency", &format!("ms from a key to the screen while the worker draws, {beside}"), samples).1;
    window.close().succeeded();
    let frame_ms = beside.strip_suffix(" ms").and_then(|text| text.rsplit(' ').next()?.parse::<f64>().ok());
    if frame_ms.is_none_or(|ms| ms < LEAST_FRAME_MS) {
        return Some(format!("the worker's frames are shorter than {LEAST_FRAME_MS} ms here: {beside}"));
    }
    held(most <= MOST_LATENCY_MS, format!("more than {MOST_LATENCY_MS} ms from a key to the screen"))
}

fn idle() -> Option<String> {
    let display = Display::start();
    let window = open(&display, LIGHT);
    sleep(Duration::from_secs(3));
    let (window_ticks, worker_ticks) = (ticks(process_id(&window)), ticks(worker(process_id(&window))));
    sleep(Duration::from_secs(10));
    let of_window = ticks(process_id(&window)) - window_ticks;
    let of_worker = ticks(worker(process_id(&window))) - worker_ticks;
    println!("idle: {of_window} ticks of the window and {of_worker} of its worker in 10 s, of 1000 a core");
    window.close().succeeded();
    held(of_window + of_worker <= MOST_TICKS, "more than 1 % of a core at rest".to_owned())
}

fn soak(time: Duration) -> Option<String> {
    let display = Display::start();
    let mut window = open(&display, LIGHT);
    display.key(SPACE);
    let started = Instant::now();
    let mut next = FIRST_LOOK;
    let mut step = 0;
    let mut looks: Vec<[u64; 2]> = vec![];
    while started.elapsed() < time {
        let middle = window.middle("picture");
        step += 1;
        window.drag(1, middle, (middle.0 + if step % 2 == 0 { 70 } else { -70 }, middle.1 + step % 7 - 3));
        if started.elapsed() >= next {
            let both = [process_id(&window), worker(process_id(&window))].map(resident_kb);
            let [own, of_worker] = both;
            println!("soak: {:4} s, {own} kB the window, {of_worker} kB its worker, {step} drags", next.as_secs());
            looks.push(both);
            next += FIRST_LOOK;
        }
    }
    window.close().succeeded();
    let (Some(first), Some(last)) = (looks.first(), looks.last()) else { panic!("soak for minutes") };
    let grown = [0, 1].map(|process| last[process] as i64 - first[process] as i64);
    println!("soak: grown by {} kB the window and {} kB its worker since the first minute", grown[0], grown[1]);
    held(grown.into_iter().all(|kb| kb <= MOST_GROWN_KB), format!("memory grows by more than {MOST_GROWN_KB} kB"))
}

fn pictures(folder: &Path) {
    for (paper, scene, passes) in PICTURES {
        let display = Display::start();
        let mut window = Window::start(&display, fumarole(&format!("view {paper} {scene}")));
        window.resize(1280, 800);
        window.display.key('m' as u32);
        window.wait("times", |window| window.says("median of 9 frames").then_some(()));
        for _ in 0..passes {
            display.key(']' as u32);
        }
        window.wait("the pass's target", |window| (!window.shows("picture")).then_some(()));
        display.key('t' as u32);
        window.wait("the picture", |window| window.shows("picture").then_some(()));
        // Small pictures and plots come after.
        sleep(Duration::from_secs(2));
        let screen = display.screenshot();
        let of_window = screen.pixels().chunks_exact(4 * screen.width() as usize).take(800);
        let rows = of_window.flat_map(|row| &row[..4 * 1280]).copied().collect();
        let file = folder.join(format!("view-{paper}.png"));
        write_png(&file, &Rgba8::new(1280, 800, rows).expect("a picture")).expect("the folder can be written");
        println!("pictures: {}", file.display());
        window.close().succeeded();
    }
}

/// Prints the samples, and gives their median and the largest.
fn tell(name: &str, what: &str, mut samples: Vec<f64>) -> (f64, f64) {
    samples.sort_by(f64::total_cmp);
    let (Some(&least), Some(&most)) = (samples.first(), samples.last()) else { panic!("{name}: nothing was measured") };
    let median = median(&samples).unwrap_or_default();
    println!("{name}: median {median:.1}, least {least:.1}, most {most:.1} of {} {what}", samples.len());
    (median, most)
}

/// The process that draws the paper for a window.
fn worker(window: u32) -> u32 {
    let children = fs::read_dir(format!("/proc/{window}/task"))
        .unwrap()
        .map(|task| fs::read_to_string(task.unwrap().path().join("children")).unwrap_or_default());
    let children: String = children.collect();
    children.split_whitespace().next().and_then(|id| id.parse().ok()).expect("the window has a worker")
}

/// Processor time in hundredths of a second.
fn ticks(process: u32) -> u64 {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    // Behind the name, which may hold anything: state is the third field, the two times are the 14th and 15th.
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    fields[11..13].iter().map(|field| field.parse::<u64>().unwrap()).sum()
}

fn resident_kb(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

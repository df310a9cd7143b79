//! The real window on a display: every paper opens, real events do what they say, the picture on the screen is `render`'s.
//! All runs are under validation with synchronization validation in both processes; a window that leaves a Vulkan object
//! alive, or hears a message, does not end with 0.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use fumarole::image::{Rgba8, read_png};

use super::display::{Display, Window, wait};
use super::scene::{PAPERS, small};
use crate::cli::program::{Program, device, fumarole};
use crate::common::beside_others;

/// X key symbols.
const SPACE: u32 = 0x20;
const RETURN: u32 = 0xff0d;
const CONTROL: u32 = 0xffe3;
const F4: u32 = 0xffc1;
/// The button that the wheel is.
const WHEEL_UP: u8 = 4;

pub fn pixel(picture: &Rgba8, x: u32, y: u32) -> [u8; 3] {
    let at = (y as usize * picture.width() as usize + x as usize) * 4;
    *picture.pixels()[at..].first_chunk().unwrap()
}

/// Largest distance of two bytes of the picture at an offset of the screen.
fn distance(screen: &Rgba8, picture: &Rgba8, (left, top): (u32, u32)) -> u8 {
    let mut largest = 0;
    for y in 0..picture.height() {
        for x in 0..picture.width() {
            let (a, b) = (pixel(screen, left + x, top + y), pixel(picture, x, y));
            let apart = (0..3).map(|channel| a[channel].abs_diff(b[channel])).max().unwrap();
            largest = largest.max(apart);
            if largest > 1 {
                return largest;
            }
        }
    }
    largest
}

/// True when the picture lies somewhere in the rectangle of the screen, to 1 of 255.
pub fn shows(screen: &Rgba8, picture: &Rgba8, [left, top, right, bottom]: [i16; 4]) -> bool {
    let clamp = |side: i16| u32::try_from(side).unwrap_or(0);
    let lefts = clamp(left)..=(clamp(right).min(screen.width()) - picture.width());
    let tops = || clamp(top)..=(clamp(bottom).min(screen.height()) - picture.height());
    lefts.into_iter().any(|x| tops().any(|y| distance(screen, picture, (x, y)) <= 1))
}

/// True when anything is drawn in the rectangle.
pub fn is_drawn(screen: &Rgba8, [left, top, right, bottom]: [i16; 4]) -> bool {
    let corner = pixel(screen, left as u32, top as u32);
    (top..bottom).any(|y| (left..right).any(|x| pixel(screen, x as u32, y as u32) != corner))
}

/// A driver by its manifest, or the device of the tests.
type Driver<'a> = Option<&'a Path>;

/// On the driver.
fn on(driver: Driver<'_>, program: Program) -> Program {
    match driver {
        Some(manifest) => program.env("VK_DRIVER_FILES", manifest),
        None => program.on_test_device(),
    }
}

/// Window and worker on a second driver beside the one that the tests run on.
fn on_second_driver(test: impl Fn(Driver<'_>)) {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        test(Some(&crate::drivers::driver_manifest(&folder)));
    });
}

#[test]
fn every_paper_opens_and_its_picture_is_that_of_render() {
    beside_others(|| every_paper_opens(None));
}

#[test]
fn every_paper_opens_on_a_second_driver() {
    on_second_driver(every_paper_opens);
}

fn every_paper_opens(driver: Driver<'_>) {
    let display = Display::start();
    for (paper, scene) in PAPERS {
        let mut window = Window::open_with(&display, &format!("{paper} {scene}"), |program| on(driver, program));
        window.wait_for_frame(0);
        let passes = on(driver, fumarole(&format!("{paper} passes --json {scene}"))).run().succeeded().json();
        let names = passes[0]["passes"].as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap());
        let screen = display.screenshot();
        for name in names {
            assert!(is_drawn(&screen, window.rectangle(name)), "{paper}: {name} is not on the screen");
        }
        let file = window.folder.path().join("rendered.png");
        let render = on(driver, fumarole(&format!("{paper} render {scene}")));
        render.arg("--image").arg(&file).run().succeeded();
        let rendered = read_png(&file).unwrap();
        let area = window.rectangle("picture");
        wait(&format!("{paper}: the picture on the screen"), || {
            shows(&display.screenshot(), &rendered, area).then_some(())
        });
        window.close().succeeded();
    }
}

#[test]
fn events_of_a_user_do_what_they_say() {
    beside_others(|| events_do_what_they_say(None));
}

#[test]
fn events_do_what_they_say_on_a_second_driver() {
    on_second_driver(events_do_what_they_say);
}

fn events_do_what_they_say(driver: Driver<'_>) {
    let display = Display::start();
    let scene = format!("caustics {}", small("caustics"));
    let mut window = Window::open_with(&display, &scene, |program| on(driver, program));
    window.wait_for_frame(0);
    // A button, a key, a field.
    window.click(">");
    window.wait_for_frame(1);
    display.key('.' as u32);
    window.wait_for_frame(2);
    window.enter("frame");
    display.keys(&[CONTROL, 'a' as u32]);
    display.write("5");
    display.key(RETURN);
    window.wait_for_frame(5);
    // A pass and its target, with room for them.
    display.key(F4);
    window.wait("no drawer", |window| (!window.has("Hold")).then_some(()));
    window.click("caustics-map");
    window.click("thumbnail caustics-map");
    window.wait("the target", |window| window.shows("caustics-map").then_some(()));
    // Its colours: a ramp with hues, and one without.
    let hues = |window: &Window<'_>| {
        let [left, top, right, bottom] = window.try_image("caustics-map")?;
        let screen = display.screenshot();
        let rows = (top.max(0)..bottom.min(screen.height() as i16)).flat_map(|y| (left..right).map(move |x| (x, y)));
        Some(rows.filter(|&(x, y)| pixel(&screen, x as u32, y as u32).windows(2).any(|two| two[0] != two[1])).count())
    };
    window.wait("a target with hues", |window| hues(window).filter(|&count| count > 500));
    window.click("ramp");
    window.click("grey");
    window.wait("a target in grey", |window| hues(window).filter(|&count| count < 50));
    display.key('t' as u32);
    window.wait("the picture", |window| window.shows("picture").then_some(()));
    // The camera.
    let before = window.wait("the camera", |window| camera(window));
    let middle = window.middle("picture");
    window.drag(1, middle, (middle.0 + 60, middle.1 + 10));
    let orbited = window.wait("another camera", |window| camera(window).filter(|camera| *camera != before));
    display.button(WHEEL_UP);
    window.wait("a nearer camera", |window| camera(window).filter(|camera| *camera != orbited));
    window.enter("camera");
    display.keys(&[CONTROL, 'a' as u32]);
    display.write("0,3,6,0,0,0");
    display.key(RETURN);
    window.wait("the camera that was typed", |window| camera(window).filter(|camera| camera == "0,3,6,0,0,0"));
    // Across the view, and along it.
    window.drag(3, middle, (middle.0 + 40, middle.1 - 30));
    let panned = window.wait("a camera to one side", |window| {
        let now = eye_and_offset(window).filter(|(eye, _)| eye[0] != 0.0)?;
        // Not while it still moves.
        thread::sleep(Duration::from_millis(300));
        (eye_and_offset(window) == Some(now)).then_some(now)
    });
    let is_near = |a: f64, b: f64| (a - b).abs() < 1e-3;
    let (eye, offset) = panned;
    assert!(is_near(offset[0], 0.0) && is_near(offset[1], offset[2] / 2.0), "{panned:?} looks another way");
    // Where it looks has gone across the view.
    let target: [f64; 3] = std::array::from_fn(|axis| eye[axis] - offset[axis]);
    assert!(is_near(target[1] + 2.0 * target[2], 0.0), "{panned:?} is not across the view");
    display.hold('w' as u32, Duration::from_millis(300));
    let flown = window.wait("a camera ahead", |window| eye_and_offset(window).filter(|now| *now != panned));
    let moved: [f64; 3] = std::array::from_fn(|axis| flown.0[axis] - panned.0[axis]);
    assert!(moved[2] < 0.0 && is_near(moved[0], 0.0) && is_near(moved[1], moved[2] / 2.0), "{moved:?}");
    window.close().succeeded();
}

#[test]
fn the_divider_is_dragged_and_parts_the_two_pictures() {
    beside_others(|| {
        let display = Display::start();
        let scene = small("caustics").replace("64x48", "320x240");
        let variants = ["level-map", "volumetric"];
        let mut window = Window::open(&display, &format!("caustics {scene} --variant {}", variants.join(",")));
        window.wait_for_frame(0);
        let pictures = variants.map(|variant| {
            let file = window.folder.path().join(format!("{variant}.png"));
            let render = fumarole(&format!("caustics render {scene} --variant {variant}"));
            render.on_test_device().arg("--image").arg(&file).run().succeeded();
            read_png(&file).unwrap()
        });
        assert!(pictures[0] != pictures[1], "nothing to be told apart");
        let before = window.wait("the camera", |window| camera(window));
        window.click("Divider");
        let mut at = window.middle("divider");
        for by in [-100_i16, 170] {
            window.drag(1, at, (at.0 + by, at.1 + 30));
            let wanted = at.0 + by;
            at = window.wait("the divider where it was dragged to", |window| {
                let [left, top, right, bottom] = window.try_rectangle("divider")?;
                let middle = ((left + right) / 2, (top + bottom) / 2);
                (middle.0.abs_diff(wanted) <= 2).then_some(middle)
            });
            let [_, top, _, bottom] = window.rectangle("divider");
            let area = window.rectangle("pictures");
            let left = ((area[0] + area[2]) / 2 - 160) as u32;
            let top = ((top + bottom) / 2 - 120) as u32;
            let cut = at.0 as u32 - left;
            wait("A left of the divider and B right of it", || {
                let screen = display.screenshot();
                // The line itself, and a pixel of rounding, lie between.
                let parts = [(&pictures[0], 0..cut - 4), (&pictures[1], cut + 4..320)];
                let is_there = |x: u32, y: u32| {
                    parts.iter().all(|(picture, columns)| {
                        let mut rows = (0..240).flat_map(|row| columns.clone().map(move |column| (column, row)));
                        let near = |(column, row)| {
                            let (a, b) = (pixel(&screen, x + column, y + row), pixel(picture, column, row));
                            (0..3).all(|channel| a[channel].abs_diff(b[channel]) <= 1)
                        };
                        rows.all(near)
                    })
                };
                (left - 1..=left + 1).any(|x| (top - 2..=top + 2).any(|y| is_there(x, y))).then_some(())
            });
        }
        assert_eq!(camera(&window), Some(before), "the camera moved with the divider");
        window.close().succeeded();
    });
}

fn camera(window: &Window<'_>) -> Option<String> {
    let controls = window.controls();
    let field = controls.iter().find(|control| control["label"] == "camera")?;
    field["value"].as_str().map(str::to_owned)
}

/// The camera's eye, and where it lies from its target.
fn eye_and_offset(window: &Window<'_>) -> Option<([f64; 3], [f64; 3])> {
    let numbers: Vec<f64> =
        camera(window)?.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    let [eye, target] = [numbers.first_chunk::<3>()?, numbers.last_chunk::<3>()?];
    Some((*eye, std::array::from_fn(|axis| eye[axis] - target[axis])))
}

#[test]
fn a_window_is_resized_to_one_pixel_and_back() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("terrain {}", small("terrain")));
        window.wait_for_frame(0);
        for step in 0..100_u32 {
            let side = |phase: u32, most: u32| 1 + (step * 37 + phase) % most;
            match step % 10 {
                0 => window.resize(1, 1),
                _ => window.resize(side(0, 900), side(11, 700)),
            }
            // The window draws some of them, and is overtaken by others.
            thread::sleep(Duration::from_millis(5));
        }
        window.resize(1280, 800);
        display.key('.' as u32);
        window.wait_for_frame(1);
        window.close().succeeded();
    });
}

#[test]
fn a_window_is_minimised_and_comes_back() {
    beside_others(|| {
        let display = Display::managed();
        let mut window = Window::open(&display, &format!("gas {}", small("gas")));
        window.wait_for_frame(0);
        let file = window.folder.path().join("rendered.png");
        let render = fumarole(&format!("gas render {}", small("gas"))).on_test_device();
        render.arg("--image").arg(&file).run().succeeded();
        let rendered = read_png(&file).unwrap();
        let is_shown = |window: &mut Window<'_>, what: &str| {
            let area = window.rectangle("picture");
            wait(what, || shows(&display.screenshot(), &rendered, area).then_some(()));
        };
        is_shown(&mut window, "the picture");
        window.minimise();
        window.restore();
        is_shown(&mut window, "the picture, with nothing that has changed");
        window.focus();
        display.key('.' as u32);
        window.wait_for_frame(1);
        window.close().succeeded();
    });
}

#[test]
fn quitting_does_not_wait_for_a_long_frame() {
    beside_others(|| {
        let display = Display::start();
        let scene = "caustics --size 1024x768 --water-triangles 400000 --map-size 1024 --planes 101";
        let mut window = Window::open(&display, scene);
        display.key(SPACE);
        window.wait("the paper", |window| window.has("paper").then_some(()));
        let asked = Instant::now();
        window.close().succeeded();
        assert!(asked.elapsed().as_secs() < 20, "it took {:?}", asked.elapsed());
    });
}

#[test]
fn a_window_ends_after_the_frames_that_were_asked_for() {
    beside_others(|| {
        let display = Display::start();
        let program = fumarole(&format!("view lava {} --validate --exit-after 3", small("lava")));
        let program = program.env("DISPLAY", display.name()).without("WAYLAND_DISPLAY");
        program.arg("--device").arg(device()).run().succeeded();
    });
}

#[test]
fn a_window_of_so_many_frames_ends_with_what_stops_it() {
    beside_others(|| {
        let display = Display::start();
        let program = fumarole("view caustics --mesh /no/such.obj --exit-after 1").on_test_device();
        let program = program.env("DISPLAY", display.name()).without("WAYLAND_DISPLAY").without("WAYLAND_SOCKET");
        program.run().refused(1, &["/no/such.obj"]);
    });
}

#[test]
fn every_way_of_presenting_shows_frames() {
    beside_others(|| {
        let display = Display::start();
        for mode in ["fifo", "fifo-relaxed", "mailbox", "immediate"] {
            let scene = small("terrain");
            let program = fumarole(&format!("view terrain {scene} --validate --exit-after 2 --present-mode {mode}"));
            let program = program.env("DISPLAY", display.name()).without("WAYLAND_DISPLAY");
            program.arg("--device").arg(device()).run().succeeded();
        }
    });
}

#[test]
fn text_is_as_large_as_the_display_says_and_the_picture_stays_texel_by_pixel() {
    beside_others(|| {
        let display = Display::start();
        let scene = format!("terrain {}", small("terrain"));
        let mut heights = Vec::new();
        for scale in ["1", "2"] {
            let mut window = Window::open_with(&display, &scene, |program| {
                program.arg("--device").arg(device()).env("WINIT_X11_SCALE_FACTOR", scale)
            });
            window.resize(1500, 900);
            window.wait_for_frame(0);
            let [_, top, _, bottom] = window.rectangle("Copy as command");
            heights.push(f64::from(bottom - top));
            let file = window.folder.path().join("rendered.png");
            let render = fumarole(&format!("terrain render {}", small("terrain"))).on_test_device();
            render.arg("--image").arg(&file).run().succeeded();
            let rendered = read_png(&file).unwrap();
            let area = window.rectangle("picture");
            wait("the picture on the screen", || shows(&display.screenshot(), &rendered, area).then_some(()));
            window.close().succeeded();
        }
        assert!((heights[1] / heights[0] - 2.0).abs() < 0.15, "{heights:?}");
    });
}

/// Configurations and passes of a record's runs, without times and dates.
fn configuration(record: &serde_json::Value) -> Vec<serde_json::Value> {
    let parts = ["paper", "variant", "preset", "config", "width", "height", "seed", "warmup", "frames", "repeat"];
    let runs = record["runs"].as_array().unwrap();
    let passes = |run: &serde_json::Value| {
        let passes = run["passes"].as_array().unwrap().iter();
        passes.map(|pass| serde_json::json!([pass["name"], pass["calls"], pass["shader_compiler"]])).collect::<Vec<_>>()
    };
    runs.iter().map(|run| serde_json::json!([parts.map(|part| run[part].clone()), passes(run)])).collect()
}

#[test]
fn a_benchmark_from_the_window_is_the_one_of_the_shell() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("terrain {}", small("terrain")));
        window.wait_for_frame(0);
        window.click("Bench");
        window.click("Run bench");
        let record = window.wait("the record", |window| {
            let folder = std::fs::read_dir(window.folder.path().join("fumarole-out")).ok()?;
            let file = folder.filter_map(Result::ok).find(|file| file.path().extension().is_some_and(|e| e == "json"));
            serde_json::from_slice::<serde_json::Value>(&std::fs::read(file?.path()).ok()?).ok()
        });
        let words = record["command"].as_array().unwrap().iter().map(|word| word.as_str().unwrap());
        let words: Vec<&str> = words.skip(1).collect();
        let ending = words.iter().position(|word| *word == "--quiet").unwrap();
        let file = window.folder.path().join("shell.json");
        let shell = words[..ending].iter().fold(fumarole(""), |program, word| program.arg(word));
        shell.arg("--quiet").arg("--json").arg(&file).run().succeeded();
        let of_shell: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        assert_eq!(configuration(&record), configuration(&of_shell));
        assert_eq!(record["environment"]["host"], of_shell["environment"]["host"], "as many threads");
        window.close().succeeded();
    });
}

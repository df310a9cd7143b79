//! Contents of a window: the frame that it begins with, another paper, and a target: numbers at the pointer, range,
//! exposure and histogram, each as it stands on the screen.

use std::path::PathBuf;

use fumarole::image::Rgba8;
use x11rb::protocol::xproto::ConnectionExt;

use super::desktop::{is_drawn, pixel, shows};
use super::display::{Display, Window, wait};
use super::scene::{rendered, small};
use crate::cli::dumps::read_npy;
use crate::cli::program::fumarole;
use crate::common::beside_others;

/// X key symbols.
const RETURN: u32 = 0xff0d;
const CONTROL: u32 = 0xffe3;
const F2: u32 = 0xffbf;
const F3: u32 = 0xffc0;
const F4: u32 = 0xffc1;
/// A place beside the window, where the pointer brings up no words.
const ASIDE: (i16, i16) = (1500, 900);

/// Waits until the picture lies on the screen.
fn wait_for_picture(window: &mut Window<'_>, picture: &Rgba8) {
    let display = window.display;
    window.wait("the picture on the screen", |window| {
        let area = window.try_image("picture")?;
        let has_room = area[2] - area[0] >= picture.width() as i16 && area[3] - area[1] >= picture.height() as i16;
        (has_room && shows(&display.screenshot(), picture, area)).then_some(())
    });
}

#[test]
fn a_window_begins_with_the_frame_that_was_asked_for() {
    beside_others(|| {
        let display = Display::start();
        // The state of the second goes on from frame to frame.
        for paper in ["caustics", "lava"] {
            let options = format!("{} --frame 3", small(paper));
            let mut window = Window::open(&display, &format!("{paper} {options}"));
            window.wait_for_frame(3);
            wait_for_picture(&mut window, &rendered(paper, &options));
            let field = window.controls().into_iter().find(|control| control["label"] == "frame");
            assert_eq!(field.expect("the field")["value"], "3", "{paper}");
            window.close().succeeded();
        }
    });
}

#[test]
fn another_paper_takes_the_place_of_the_one_that_is_shown() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("lava {} --frame 2", small("lava")));
        window.wait_for_frame(2);
        assert!(window.has("extract"), "lava's passes are not shown");
        window.click("paper");
        window.click("terrain");
        window.wait_for_frame(0);
        window.wait("the passes of terrain", |window| window.has("geometric-transformation").then_some(()));
        assert!(!window.has("extract"), "a pass of lava is still there");
        let listed = fumarole("terrain passes --json").on_test_device().run().succeeded().json();
        let screen = display.screenshot();
        for pass in listed[0]["passes"].as_array().unwrap() {
            let name = pass["name"].as_str().unwrap();
            assert!(is_drawn(&screen, window.rectangle(name)), "{name} is not on the screen");
        }
        // Texel by pixel, with the whole window for it.
        [F2, F3, F4].into_iter().for_each(|key| display.key(key));
        wait_for_picture(&mut window, &rendered("terrain", ""));
        window.close().succeeded();
    });
}

/// Texels across the target.
const SIDE: usize = 64;

/// First layer of a target of one channel as `--dump` writes it.
struct Dumped(Vec<f64>);

impl Dumped {
    /// The caustics map of the small scene.
    fn caustics_map(folder: PathBuf) -> Self {
        let file = folder.join("map.npy");
        let dump = format!("caustics-map={}", file.display());
        let render = fumarole(&format!("caustics render {}", small("caustics"))).on_test_device();
        render.arg("--image").arg(folder.join("picture.png")).arg("--dump").arg(dump).run().succeeded();
        let (shape, values) = read_npy(&file);
        assert!(values.len() >= SIDE * SIDE && shape.contains(&(SIDE as u64)), "{shape:?}");
        Dumped(values[..SIDE * SIDE].to_vec())
    }

    fn ends(&self) -> (f64, f64) {
        self.0.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
    }

    /// The map in greys, black at `low` and white at `high`, after so many stops.
    fn in_greys(&self, (low, high): (f64, f64), stops: f64) -> Rgba8 {
        let grey = |&value: &f64| (((value - low) / (high - low) * stops.exp2()).clamp(0.0, 1.0) * 255.0).round() as u8;
        let pixels = self.0.iter().map(grey).flat_map(|grey| [grey, grey, grey, 255]).collect();
        Rgba8::new(SIDE as u32, SIDE as u32, pixels).unwrap()
    }

    /// Values in each of 128 parts of equal width.
    fn histogram(&self) -> [u64; 128] {
        let (low, high) = self.ends();
        let mut counts = [0; 128];
        for value in &self.0 {
            counts[(((value - low) / (high - low) * 128.0) as usize).min(127)] += 1;
        }
        counts
    }
}

/// Value of the control that begins so, and its middle on the screen.
fn beginning_with(window: &Window<'_>, text: &str) -> Option<(String, (i16, i16))> {
    let begins = |control: &serde_json::Value| control["value"].as_str().is_some_and(|value| value.starts_with(text));
    let control = window.controls().into_iter().find(begins)?;
    let side = |index: usize| control["rectangle_px"][index].as_f64().unwrap();
    let middle = ((side(0) + side(2)) / 2.0, (side(1) + side(3)) / 2.0);
    let origin = window.display.connection.translate_coordinates(window.id, window.display.root, 0, 0);
    let origin = origin.unwrap().reply().unwrap();
    let middle = (middle.0 as i16 + origin.dst_x, middle.1 as i16 + origin.dst_y);
    Some((control["value"].as_str().unwrap().to_owned(), middle))
}

/// Types a number into the field that begins so.
fn type_into(window: &mut Window<'_>, field: &str, number: &str) {
    let (display, (_, middle)) = (window.display, window.wait(field, |window| beginning_with(window, field)));
    display.point(middle);
    display.button(1);
    // While it is typed into, it has no words before its number.
    window.wait("the number alone", |window| beginning_with(window, field).is_none().then_some(()));
    display.keys(&[CONTROL, 'a' as u32]);
    display.write(number);
    display.key(RETURN);
    window.wait(field, |window| beginning_with(window, field));
}

/// Place of a texel that the line at the bottom tells of, and what it says of it, while the pointer is within a texel of
/// `texel` of a target whose corner lies there on the screen: the middle of the window may lie between two pixels.
fn said_at(window: &mut Window<'_>, target: &str, corner: (i16, i16), texel: (i16, i16)) -> ([usize; 2], String) {
    window.display.point((corner.0 + texel.0, corner.1 + texel.1));
    window.wait("the line at the pointer", |window| {
        let (line, _) = beginning_with(window, &format!("{target} "))?;
        let (place, said) = line[target.len() + 1..].split_once(": ")?;
        let (x, y) = place.split_once(", ")?;
        let place: [usize; 2] = [x.parse().ok()?, y.parse().ok()?];
        let is_near = place[0].abs_diff(texel.0 as usize) <= 1 && place[1].abs_diff(texel.1 as usize) <= 1;
        is_near.then(|| (place, said.to_owned()))
    })
}

#[test]
fn a_target_is_drawn_as_its_controls_say() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("caustics {}", small("caustics")));
        window.wait_for_frame(0);
        let map = Dumped::caustics_map(window.folder.path().to_owned());
        display.key(F4);
        window.click("caustics-map");
        window.wait("the target", |window| window.try_image("caustics-map"));
        window.click("ramp");
        window.click("grey");
        window.wait("the list is gone", |window| (!window.has("diverging")).then_some(()));

        // From the smallest to the largest, then brighter, then of a range that was typed.
        let on_screen = |window: &mut Window<'_>, what: &str, range: (f64, f64), stops: f64| {
            let expected = map.in_greys(range, stops);
            window.wait(what, |window| {
                let area = window.try_image("caustics-map")?;
                shows(&display.screenshot(), &expected, area).then_some(())
            });
        };
        let (low, high) = map.ends();
        window.click("all");
        on_screen(&mut window, "greys from end to end", (low, high), 0.0);
        type_into(&mut window, "exposure ", "1.5");
        on_screen(&mut window, "greys after 1.5 stops", (low, high), 1.5);
        type_into(&mut window, "exposure ", "0");
        let half = (high * 5e5).round() / 1e6;
        type_into(&mut window, "to ", &half.to_string());
        on_screen(&mut window, "greys up to half of the largest", (low, half), 0.0);

        // Place, value and unit of texels under the pointer; the target lies in the middle, texel by pixel.
        let [left, top, right, bottom] = window.wait("the target", |window| window.try_image("caustics-map"));
        let corner = ((left + right) / 2 - 32, (top + bottom) / 2 - 32);
        for texel in [(8, 50), (33, 20), (60, 61)] {
            let ([x, y], said) = said_at(&mut window, "caustics-map", corner, texel);
            let value = map.0[y * SIDE + x];
            assert_eq!(
                said,
                format!("{value:.6} (I_c of eq. 4-18 for light of unit intensity; R32_SFLOAT)"),
                "{x}, {y}"
            );
        }
        window.close().succeeded();
    });
}

/// Tallness of the bars between left and right, over that of the whole, from a screen.
fn bars(screen: &Rgba8, [left, top, right, bottom]: [i16; 4]) -> Vec<f64> {
    let at = |x: i16, y: i16| pixel(screen, x as u32, y as u32);
    let highest: Vec<[u8; 3]> = (left..right).map(|x| at(x, top + 2)).collect();
    // Few bars are so tall.
    let behind = highest.iter().max_by_key(|one| highest.iter().filter(|other| other == one).count()).unwrap();
    let is_bar = |x: i16, y: i16| (0..3).any(|channel| at(x, y)[channel].abs_diff(behind[channel]) > 24);
    let tall = |x: i16| (top..bottom).filter(|&y| is_bar(x, y)).count() as f64;
    (left..right).map(|x| tall(x) / f64::from(bottom - top)).collect()
}

#[test]
fn a_histogram_has_the_counts_of_the_values() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("caustics {}", small("caustics")));
        window.wait_for_frame(0);
        let map = Dumped::caustics_map(window.folder.path().to_owned());
        display.key(F4);
        window.click("caustics-map");
        window.wait("the target", |window| window.try_image("caustics-map"));
        // The lines of the range's ends would be bars, and words at the pointer lie over them.
        window.click("all");
        let (_, high) = map.ends();
        window.wait("the range", |window| {
            let (end, _) = beginning_with(window, "to ")?;
            let end: f64 = end["to ".len()..].parse().ok()?;
            ((end - high).abs() < 1e-3 * high).then_some(())
        });
        let counts = map.histogram();
        for is_logarithmic in [false, true] {
            if is_logarithmic {
                window.click("log");
                window.wait("logarithms", |window| {
                    let is_on = |control: &serde_json::Value| control["label"] == "log" && control["is_on"] == true;
                    window.controls().iter().any(is_on).then_some(())
                });
            }
            display.point(ASIDE);
            let height = |count: u64| if is_logarithmic { (count as f64 + 1.0).ln() } else { count as f64 };
            let most = counts.iter().map(|&count| height(count)).fold(0.0, f64::max);
            let area = window.wait("the histogram", |window| window.try_image("histogram"));
            let width = f64::from(area[2] - area[0]) / 128.0;
            assert!(width > 2.0, "bars of {width} pixels");
            wait("the bars", || {
                let found = bars(&display.screenshot(), area);
                let of_bin = |bin: usize| found[((bin as f64 + 0.5) * width) as usize];
                // Half a pixel of 42 at each end, and the two lines at the ends of the range.
                let is_right = |bin: usize| (of_bin(bin) - height(counts[bin]) / most).abs() < 0.04;
                (2..126).all(is_right).then_some(())
            });
        }
        window.close().succeeded();
    });
}

//! Size of text by option and display, and what a window remembers of the last one.

use std::fs;
use std::thread;
use std::time::Duration;

use fumarole::image::read_png;

use super::desktop::shows;
use super::display::{Display, Window, wait};
use super::scene::small;
use crate::cli::program::fumarole;
use crate::common::beside_others;

/// X key symbol.
const F4: u32 = 0xffc1;

/// Height of a control, pixels.
fn height(window: &Window<'_>) -> Option<f64> {
    let [_, top, _, bottom] = window.try_rectangle("Hold")?;
    Some(f64::from(bottom - top))
}

fn is_near(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 0.08
}

#[test]
fn text_has_the_size_of_the_option_and_of_the_display() {
    beside_others(|| {
        let display = Display::start();
        let scene = format!("caustics {}", small("caustics"));
        let mut window = Window::open(&display, &scene);
        let usual = window.wait("a control", height);
        window.close().succeeded();
        display.set_dots_per_inch(120);
        for (option, scale) in [("", 1.25), (" --scale 0.8", 1.0), (" --scale 1.2", 1.5)] {
            let mut window = Window::open(&display, &format!("{scene}{option}"));
            let found = window.wait("a control", height);
            assert!(is_near(found, scale * usual), "{found} for {usual} at {scale}");
            window.close().succeeded();
        }
    });
}

#[test]
fn text_and_window_follow_a_display_whose_scale_changes_while_it_is_open() {
    beside_others(|| {
        let display = Display::managed();
        let settings = display.offer_settings(96);
        let scene = small("caustics");
        let mut window = Window::open(&display, &format!("caustics {scene}"));
        window.resize(800, 640);
        window.wait_for_frame(0);
        let usual = window.wait("a control", height);
        let file = window.folder.path().join("rendered.png");
        let render = fumarole(&format!("caustics render {scene}")).on_test_device();
        render.arg("--image").arg(&file).run().succeeded();
        let rendered = read_png(&file).unwrap();
        for dpi in [120, 96] {
            display.change_settings(settings, dpi);
            let scale = f64::from(dpi) / 96.0;
            window.wait(&format!("text at {dpi} dots per inch"), |window| {
                height(window).filter(|found| is_near(*found, scale * usual))
            });
            let wanted = [800.0 * scale, 640.0 * scale];
            window.wait(&format!("a window of {wanted:?} pixels"), |window| {
                // Not while it still grows.
                thread::sleep(Duration::from_millis(300));
                let size = display.size(window.id);
                (0..2).all(|axis| (size[axis] - wanted[axis]).abs() < 3.0).then_some(())
            });
            // The picture stays texel by pixel.
            let area = window.rectangle("picture");
            wait("the picture on the screen", || shows(&display.screenshot(), &rendered, area).then_some(()));
        }
        window.close().succeeded();
    });
}

#[test]
fn the_layout_is_that_of_the_last_window_and_survives_damage() {
    beside_others(|| {
        let display = Display::start();
        let state = tempfile::tempdir().unwrap();
        let scene = format!("caustics {}", small("caustics"));
        let open = || Window::open_again(&display, &scene, state.path());
        let mut window = open();
        window.wait("the drawer", height);
        display.key(F4);
        window.wait("no drawer", |window| height(window).is_none().then_some(()));
        window.close().succeeded();
        let mut window = open();
        window.wait_for_frame(0);
        assert!(height(&window).is_none(), "the drawer was closed");
        window.close().succeeded();
        let left: Vec<_> = walk(state.path());
        assert!(!left.is_empty());
        left.iter().for_each(|file| fs::write(file, b"\xff{damaged").unwrap());
        let mut window = open();
        window.wait("the drawer, as at first", height);
        window.close().succeeded();
    });
}

fn walk(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { walk(&path) } else { vec![path] }).collect()
}

//! A display that changes under the window: acquisitions and presents end as real displays now and then let them end, by the
//! tests' layer, under validation.

use fumarole::image::read_png;

use super::desktop::shows;
use super::display::{Display, Window, wait};
use super::scene::small;
use crate::cli::program::{Program, device, fumarole};
use crate::common::beside_others;
use crate::faults::Layer;

const ENDINGS: [(&str, &str); 7] = [
    ("acquire@2", "surface-lost"),
    ("acquire@5", "out-of-date"),
    ("acquire@7", "suboptimal"),
    ("acquire@9", "timeout"),
    ("present@8", "surface-lost"),
    ("present@10", "out-of-date"),
    ("present@12", "suboptimal"),
];

#[test]
fn the_window_goes_on_whatever_its_display_does() {
    beside_others(|| {
        let said = goes_on(|layer, program| layer.before(program, true));
        assert!(!said.contains("fences of presents"), "{said}");
    });
}

/// As on the drivers that have `VK_EXT_swapchain_maintenance1`, which a layer plays.
#[test]
fn the_window_goes_on_with_fences_of_its_presents() {
    beside_others(|| {
        let said = goes_on(|layer, program| {
            let program = layer.with_extensions(program, &["VK_EXT_surface_maintenance1"]);
            program.arg("--validate").env("FUMAROLE_LAYER_LENDS", "present-fences")
        });
        assert!(said.contains("layer: fences of presents are signalled: SUCCESS"), "{said}");
    });
}

/// Plays a window whose presents end in every way, and gives what it has said.
fn goes_on(with_layer: impl FnOnce(&Layer, Program) -> Program) -> String {
    let display = Display::start();
    let layer = Layer::new();
    let scene = small("caustics");
    let endings = ENDINGS.map(|(call, ending)| format!("{call}={ending}")).join(",");
    let program = with_layer(&layer, fumarole(&format!("view caustics {scene}")).on_test_device());
    let mut window = Window::start(&display, program.env("FUMAROLE_LAYER_PRESENTS", endings));
    window.wait_for_frame(0);
    const LAST: u32 = 16;
    for frame in 1..=LAST {
        display.key('.' as u32);
        window.wait_for_frame(frame);
    }
    let file = window.folder.path().join("rendered.png");
    let render = fumarole(&format!("caustics render {scene} --frame {LAST}")).arg("--device").arg(device());
    render.arg("--image").arg(&file).run().succeeded();
    let (rendered, area) = (read_png(&file).unwrap(), window.rectangle("picture"));
    wait("the picture on the screen", || shows(&display.screenshot(), &rendered, area).then_some(()));
    let ended = window.close().succeeded();
    for (call, _) in ENDINGS {
        assert!(ended.stderr.contains(&format!("layer: {call}=")), "{call}: {}", ended.stderr);
    }
    ended.stderr
}

#[test]
fn a_display_that_is_never_content_gets_no_swapchain_for_each_picture() {
    beside_others(|| {
        let display = Display::start();
        let layer = Layer::new();
        let program = fumarole(&format!("view caustics {}", small("caustics"))).on_test_device();
        let endings: Vec<String> = (1..=500).map(|present| format!("present@{present}=suboptimal")).collect();
        let program = layer.before(program, false).env("FUMAROLE_LAYER_PRESENTS", endings.join(","));
        let mut window = Window::start(&display, program);
        window.wait_for_frame(0);
        for frame in 1..=16 {
            display.key('.' as u32);
            window.wait_for_frame(frame);
        }
        let ended = window.close().succeeded();
        let presented = ended.stderr.matches("layer: present@").count();
        // A second one of the first size, and one more where the window gets another.
        let made = layer.report(&ended).count("vkCreateSwapchainKHR");
        assert!(made >= 2 && 2 * made < presented, "{made} swapchains for {presented} pictures: {}", ended.stderr);
    });
}

#[test]
fn a_device_that_is_lost_while_presenting_ends_the_window_in_a_line() {
    beside_others(|| {
        let display = Display::start();
        let layer = Layer::new();
        let folder = tempfile::tempdir().unwrap();
        let program = fumarole(&format!("view terrain {}", small("terrain"))).on_test_device();
        let program = layer.before(program, false).env("FUMAROLE_LAYER_PRESENTS", "present@2=device-lost");
        let program = program.env("DISPLAY", display.name()).without("WAYLAND_DISPLAY").without("WAYLAND_SOCKET");
        let ended = program.env("XDG_STATE_HOME", folder.path()).inside(folder.path()).run();
        let said: Vec<&str> = ended.stderr.lines().filter(|line| !line.starts_with("layer: ")).collect();
        assert_eq!((ended.status.code(), said.len()), (Some(1), 1), "{}", ended.stderr);
        assert!(said[0].starts_with("error: ") && said[0].contains("device"), "{}", ended.stderr);
    });
}

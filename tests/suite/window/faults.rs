//! Every call that a window makes of its surface and its swapchain fails in turn: the window ends with one line and leaves
//! nothing behind.

use super::display::Display;
use super::scene::small;
use crate::cli::program::{Ended, fumarole};
use crate::common::beside_others;
use crate::faults::{FAILURES, Layer, Report};

/// Calls of surfaces and swapchains, and the exit code of a window without them.
const CALLS: [(&str, i32); 9] = [
    ("vkCreateXcbSurfaceKHR", 1),
    ("vkGetPhysicalDeviceSurfaceSupportKHR", 3),
    ("vkGetPhysicalDeviceSurfaceCapabilitiesKHR", 1),
    ("vkGetPhysicalDeviceSurfaceFormatsKHR", 1),
    ("vkGetPhysicalDeviceSurfacePresentModesKHR", 1),
    ("vkCreateSwapchainKHR", 1),
    ("vkGetSwapchainImagesKHR", 1),
    ("vkAcquireNextImageKHR", 1),
    ("vkQueuePresentKHR", 1),
];

/// A window that ends by itself after a frame, with a call of its failing.
fn run(display: &Display, layer: &Layer, failing: &str) -> (Ended, Report) {
    let state = tempfile::tempdir().unwrap();
    let program = fumarole(&format!("view terrain {} --exit-after 1", small("terrain"))).on_test_device();
    let program = layer.before(program, false).env("FUMAROLE_LAYER_FAIL", failing);
    let program = program.env("DISPLAY", display.name()).without("WAYLAND_DISPLAY").without("WAYLAND_SOCKET");
    let ended = program.env("XDG_STATE_HOME", state.path()).inside(state.path()).run();
    // The worker, which ends first, has written one as well.
    let report = layer.report(&ended);
    (ended, report)
}

#[test]
fn a_window_whose_calls_fail_ends_in_a_line() {
    beside_others(|| {
        let display = Display::start();
        let layer = Layer::new();
        let (ended, whole) = run(&display, &layer, "");
        ended.succeeded();
        assert_eq!(whole.alive, [""; 0]);
        for (name, code) in CALLS {
            assert!(whole.count(name) > 0, "{name} is not among {:?}", whole.calls);
            for failure in FAILURES {
                let (ended, report) = run(&display, &layer, &format!("{name}@1:{failure}"));
                assert_eq!(report.failed.as_deref(), Some(name), "{failure}: {}", ended.stderr);
                assert_eq!(report.alive, [""; 0], "{name} {failure}: {}", ended.stderr);
                ended.refused(code, &[]);
            }
        }
    });
}

//! The worker's device: one that is lost, and one that says that it is a GPU.

use fumarole::window::protocol::Request;

use super::display::{Display, Window};
use super::scene::{Worker, picture, small};
use crate::cli::program::fumarole;
use crate::common::beside_others;
use crate::faults::Layer;

/// X key symbol.
const SPACE: u32 = 0x20;
/// Submissions of a worker that has shown some frames and draws more.
const LOST_AT: usize = 150;

#[test]
fn a_lost_device_of_the_worker_leaves_the_window_which_starts_another() {
    beside_others(|| {
        let display = Display::start();
        let layer = Layer::new();
        let program = layer.before(fumarole(&format!("view gas {}", small("gas"))).on_test_device(), false);
        let program = program
            .env("FUMAROLE_LAYER_FAIL", format!("vkQueueSubmit2@{LOST_AT}:lost"))
            .env("FUMAROLE_LAYER_ONLY", "worker");
        let mut window = Window::start(&display, program);
        window.wait_for_frame(0);
        display.key(SPACE);
        window.wait("the end of the worker", |window| window.says("ended with exit code 1").then_some(()));
        assert!(window.says("lost"), "no word of what has happened");
        assert!(window.shows("picture"), "the last picture is gone");
        window.click("Start it again");
        window.wait("another worker", |window| (!window.says("ended with exit code 1")).then_some(()));
        window.wait_for_frame(0);
        window.close().succeeded();
    });
}

#[test]
fn a_gpu_is_shared_with_the_window_pass_by_pass() {
    beside_others(|| {
        let drawn = |is_discrete: bool| {
            let layer = Layer::new();
            let mut variables = layer.environment(true);
            variables.extend(is_discrete.then(|| ("FUMAROLE_LAYER_DISCRETE", "1".into())));
            let mut worker = Worker::in_environment(&variables, "caustics");
            let mut pictures = vec![picture(&worker.frame_after(0), 0)];
            pictures.extend((1..5).map(|number| picture(&worker.frame_of(Request::GoTo(number)), 0)));
            worker.quit();
            (pictures, layer.submissions())
        };
        let (of_cpu, of_gpu) = (drawn(false), drawn(true));
        assert!(of_cpu.0 == of_gpu.0, "other pictures");
        // Each of five frames has seven passes.
        assert!(of_gpu.1 >= of_cpu.1 + 5 * 6, "{} submissions for {}", of_gpu.1, of_cpu.1);
    });
}

//! Without a display, and without a window.

use std::process::Command;

use fumarole::gpu::{Device, Instance, PhysicalDevice};

use crate::cli::program::fumarole;
use crate::common::gpu_test_alone;

fn is_of_windows(extension: &str) -> bool {
    extension.contains("surface") || extension.contains("swapchain")
}

#[test]
fn no_extension_of_windows_is_asked_for_without_one() {
    gpu_test_alone(|_| {
        for validate in [false, true] {
            let instance = Instance::new(validate).unwrap();
            assert!(!instance.extensions().iter().any(|name| is_of_windows(name)), "{:?}", instance.extensions());
            for physical in PhysicalDevice::enumerate(&instance).unwrap() {
                if physical.lacks(&[]).is_empty() {
                    let device = Device::open(&instance, physical).unwrap();
                    assert!(!device.extensions().iter().any(|name| is_of_windows(name)), "{:?}", device.extensions());
                }
            }
        }
    });
}

#[test]
fn a_device_presents_by_an_instance_that_was_made_for_a_display() {
    gpu_test_alone(|_| {
        let instance = Instance::new(true).unwrap();
        for physical in PhysicalDevice::enumerate(&instance).unwrap() {
            if physical.lacks(&[]).is_empty() {
                let refused = Device::open_presenting(&instance, physical).map(|_| ()).unwrap_err().to_string();
                assert!(refused.ends_with("presenting: its instance was not made for a display"), "{refused}");
            }
        }
        let messages = instance.take_messages();
        assert!(messages.is_empty(), "{messages:?}");
    });
}

#[test]
fn without_a_display_there_is_one_line_and_exit_code_3() {
    let view = fumarole("view caustics").without("DISPLAY").without("WAYLAND_DISPLAY").without("WAYLAND_SOCKET");
    view.run().refused(3, &["opening a window", "render"]);
}

#[test]
fn what_no_paper_takes_is_refused_before_a_window_opens() {
    for (arguments, word) in [
        ("view caustics --planes 0", "planes"),
        ("view --scale 9", "scale"),
        ("view gas --variant all", "variant"),
        ("caustics view --present-mode sometimes", "present-mode"),
        ("view lava --exit-after 0", "exit-after"),
    ] {
        fumarole(arguments).without("DISPLAY").without("WAYLAND_DISPLAY").run().misused(&[word]);
    }
}

#[test]
fn without_the_feature_no_crate_of_windows_is_compiled() {
    let tree = |more: &[&str]| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["tree", "--offline", "--locked", "--edges", "normal,build", "--prefix", "none"]).args(more);
        let ended = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        String::from_utf8(ended.stdout).unwrap()
    };
    const OF_WINDOWS: [&str; 6] = ["winit ", "egui ", "egui-winit ", "ash-window ", "raw-window-handle ", "accesskit "];
    let (with, without) = (tree(&[]), tree(&["--no-default-features"]));
    for name in OF_WINDOWS {
        let is_in = |tree: &str| tree.lines().any(|line| line.starts_with(name));
        assert!(is_in(&with) && !is_in(&without), "{name}");
    }
}

//! A window on a Wayland compositor that has no screen.

use std::process::{Child, Command, Stdio};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use super::display::{controls, wait};
use super::scene::small;
use crate::cli::program::{device, fumarole};
use crate::common::beside_others;

/// The compositor, ended when dropped.
struct Compositor(Child);

impl Drop for Compositor {
    fn drop(&mut self) {
        let _ended = self.0.kill().and_then(|()| self.0.wait());
    }
}

#[test]
fn a_wayland_window_opens_is_resized_plays_and_ends() {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new("weston");
        command.args(["--backend=headless-backend.so", "--socket=display", "--width=900", "--height=640"]);
        command.args(["--idle-time=0", "--no-config"]);
        command.env("XDG_RUNTIME_DIR", folder.path()).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let _compositor = Compositor(command.spawn().expect("weston is missing: run ./setup.sh --tests"));
        wait("the compositor", || folder.path().join("display").exists().then_some(()));
        let path = folder.path().join("controls.json");
        // The window asks for 1280 x 800; the display makes it as large as itself.
        let program = fumarole(&format!("view gas {} --validate --fullscreen", small("gas")));
        let program = program.env("XDG_RUNTIME_DIR", folder.path()).env("WAYLAND_DISPLAY", "display");
        let program = program.env("XDG_STATE_HOME", folder.path()).without("DISPLAY");
        let mut program = program.arg("--controls").arg(&path).arg("--device").arg(device()).start();
        wait("the first frame in a window of the display's size", || {
            assert!(!program.has_ended(), "the window has ended");
            let controls = controls(&path);
            let is_there = |text: &str| controls.iter().any(|one| one["value"].as_str().unwrap_or("").contains(text));
            let search = controls.iter().find(|one| one["label"] == "search parameters")?;
            let right = search["rectangle_px"][2].as_f64()?;
            (is_there("frame 0 in ") && (880.0..=900.0).contains(&right)).then_some(())
        });
        kill(Pid::from_raw(program.id() as i32), Signal::SIGTERM).unwrap();
        program.end().succeeded();
    });
}

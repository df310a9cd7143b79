//! Two displays of different scale, under a Wayland compositor that draws them into two windows of an X server: a window is
//! carried from one to the other.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use x11rb::protocol::xproto::{ConfigureWindowAux, ConnectionExt, Window as WindowId};

use super::display::{Display, LOOK, controls, wait};
use super::scene::small;
use crate::cli::program::{device, fumarole};
use crate::common::beside_others;

/// X key symbol of the key that has the compositor move windows.
const SUPER: u32 = 0xffeb;
/// The displays, left and right, and what the second draws on a pixel of the first.
const LEFT: &str = "name=X1\nmode=800x600\nscale=1";
const RIGHT: &str = "name=X2\nmode=400x300\nscale=2";
/// A place that the window covers wherever the compositor has put it on the left display, and one on the right.
const ON_LEFT: (i16, i16) = (400, 300);
const ON_RIGHT: (i16, i16) = (1050, 300);
/// Below both displays.
const OUTSIDE: (i16, i16) = (800, 900);

/// The compositor, ended when dropped.
struct Compositor(Child);

impl Compositor {
    fn start(display: &Display, folder: &Path) -> Self {
        let config = folder.join("weston.ini");
        fs::write(&config, format!("[output]\n{LEFT}\n[output]\n{RIGHT}\n[shell]\nanimation=none\n")).unwrap();
        let mut command = Command::new("weston");
        command.args(["--backend=x11-backend.so", "--output-count=2", "--socket=display", "--idle-time=0"]);
        command.arg(format!("--config={}", config.display()));
        command.env("XDG_RUNTIME_DIR", folder).env("DISPLAY", display.name()).env_remove("WAYLAND_DISPLAY");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        Compositor(command.spawn().expect("weston is missing: run ./setup.sh --tests"))
    }
}

impl Drop for Compositor {
    fn drop(&mut self) {
        let _ended = self.0.kill().and_then(|()| self.0.wait());
    }
}

/// The X windows that the displays are drawn in, in the order of their making.
fn outputs(display: &Display) -> Option<[WindowId; 2]> {
    let children = display.connection.query_tree(display.root).ok()?.reply().ok()?.children;
    let is_large = |window: &WindowId| {
        let geometry = display.connection.get_geometry(*window).ok().and_then(|asked| asked.reply().ok());
        geometry.is_some_and(|geometry| geometry.width >= 400)
    };
    let mut large: Vec<WindowId> = children.into_iter().filter(is_large).collect();
    large.sort_unstable();
    large.try_into().ok()
}

#[test]
fn a_window_is_carried_to_a_display_of_another_scale() {
    beside_others(|| {
        let display = Display::start();
        let folder = tempfile::tempdir().unwrap();
        let _compositor = Compositor::start(&display, folder.path());
        wait("the compositor", || folder.path().join("display").exists().then_some(()));
        let windows = wait("its displays", || outputs(&display));
        for (window, left) in windows.into_iter().zip([0, 800]) {
            let place = ConfigureWindowAux::new().x(left).y(0);
            display.connection.configure_window(window, &place).unwrap().check().unwrap();
        }
        // Windows come to the display of the pointer.
        display.point((399, 299));
        display.point(ON_LEFT);
        fs::create_dir(folder.path().join("fumarole")).unwrap();
        fs::write(folder.path().join("fumarole/window.json"), r#"{"window_size": [500.0, 350.0]}"#).unwrap();
        let path = folder.path().join("controls.json");
        let program = fumarole(&format!("view caustics {} --validate", small("caustics")));
        let program = program.env("XDG_RUNTIME_DIR", folder.path()).env("WAYLAND_DISPLAY", "display");
        let program = program.env("XDG_STATE_HOME", folder.path()).without("DISPLAY");
        let mut program = program.arg("--controls").arg(&path).arg("--device").arg(device()).start();
        let height = || {
            let button = controls(&path).into_iter().find(|one| one["label"] == "Copy as command")?;
            Some(button["rectangle_px"][3].as_f64()? - button["rectangle_px"][1].as_f64()?)
        };
        let usual = wait("the first frame", || {
            assert!(!program.has_ended(), "the window has ended");
            let is_there =
                |text: &str| controls(&path).iter().any(|one| one["value"].as_str().unwrap_or("").contains(text));
            height().filter(|_| is_there("frame 0 in "))
        });
        // The compositor goes by the pointer's steps from where it last came in, which it may have missed while it started.
        display.point(OUTSIDE);
        thread::sleep(LOOK);
        display.carry(SUPER, ON_LEFT, ON_RIGHT);
        wait("text twice as large", || {
            assert!(!program.has_ended(), "the window has ended");
            height().filter(|found| (found / (2.0 * usual) - 1.0).abs() < 0.08)
        });
        kill(Pid::from_raw(program.id() as i32), Signal::SIGTERM).unwrap();
        program.end().succeeded();
    });
}

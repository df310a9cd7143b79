//! The window's controls as assistive tools read them: over D-Bus, on buses of the test's own.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use super::display::{Display, Window, wait};
use super::scene::small;
use crate::cli::program::device;
use crate::common::beside_others;

/// A session of its own, which ends with its standard input.
struct Session {
    run: Child,
    address: String,
}

impl Session {
    fn start(display: &Display) -> Self {
        let mut command = Command::new("dbus-run-session");
        command.args(["--", "sh", "-c", "echo \"$DBUS_SESSION_BUS_ADDRESS\"; exec cat"]);
        // What the bus starts, as the registry of accessible programs, hears of the display.
        command.env("DISPLAY", display.name()).env_remove("WAYLAND_DISPLAY").env_remove("AT_SPI_BUS_ADDRESS");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut run = command.spawn().expect("dbus-run-session is missing: run ./setup.sh --tests");
        let mut address = String::new();
        BufReader::new(run.stdout.take().unwrap()).read_line(&mut address).unwrap();
        Session { run, address: address.trim().to_owned() }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        drop(self.run.stdin.take());
        let _ended = self.run.wait();
    }
}

/// Answer of an object on a bus; `None` for an error.
fn call(bus: &str, destination: &str, path: &str, method: &str, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("dbus-send");
    command.arg(format!("--bus={bus}")).args(["--print-reply", &format!("--dest={destination}"), path, method]);
    let ended = command.args(arguments).output().expect("dbus-send is missing: run ./setup.sh --tests");
    ended.status.success().then(|| String::from_utf8_lossy(&ended.stdout).into_owned())
}

/// The texts in quotes of an answer.
fn texts(answer: &str) -> Vec<String> {
    answer.lines().filter_map(|line| Some(line.split_once('"')?.1.rsplit_once('"')?.0.to_owned())).collect()
}

/// An accessible object: the name of its program on the bus, and its path.
type Object = (String, String);

fn children(bus: &str, (program, path): &Object) -> Vec<Object> {
    let answer = call(bus, program, path, "org.a11y.atspi.Accessible.GetChildren", &[]);
    let texts = answer.map(|answer| texts(&answer)).unwrap_or_default();
    texts.chunks_exact(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect()
}

fn name(bus: &str, (program, path): &Object) -> String {
    let property = ["string:org.a11y.atspi.Accessible", "string:Name"];
    let answer = call(bus, program, path, "org.freedesktop.DBus.Properties.Get", &property);
    answer.and_then(|answer| texts(&answer).pop()).unwrap_or_default()
}

/// The names of an object and all below it, until all of `wanted` are among them.
fn names_below(bus: &str, root: Object, wanted: &[&str]) -> Vec<String> {
    let (mut names, mut next) = (Vec::new(), vec![root]);
    while let Some(object) = next.pop() {
        names.push(name(bus, &object));
        if wanted.iter().all(|wanted| names.iter().any(|name| name == wanted)) {
            break;
        }
        next.extend(children(bus, &object));
    }
    names
}

#[test]
fn assistive_tools_read_the_controls_over_d_bus() {
    beside_others(|| {
        let display = Display::start();
        let session = Session::start(&display);
        let status = ["string:org.a11y.Status", "string:IsEnabled", "variant:boolean:true"];
        let set = "org.freedesktop.DBus.Properties.Set";
        wait("the accessibility bus", || call(&session.address, "org.a11y.Bus", "/org/a11y/bus", set, &status));
        let bus = call(&session.address, "org.a11y.Bus", "/org/a11y/bus", "org.a11y.Bus.GetAddress", &[]);
        let bus = texts(&bus.expect("an address")).pop().unwrap();
        let scene = format!("caustics {}", small("caustics"));
        let mut window = Window::open_with(&display, &scene, |program| {
            program.arg("--device").arg(device()).env("DBUS_SESSION_BUS_ADDRESS", &session.address)
        });
        window.wait_for_frame(0);
        let registry = ("org.a11y.atspi.Registry".to_owned(), "/org/a11y/atspi/accessible/root".to_owned());
        let wanted = ["paper", "caustics-map", "after pass", "planes", "picture", "Copy as command"];
        let program = wait("the program among those that are accessible", || children(&bus, &registry).pop());
        wait("the controls over D-Bus", || {
            let names = names_below(&bus, program.clone(), &wanted);
            wanted.iter().all(|wanted| names.iter().any(|name| name == wanted)).then_some(())
        });
        window.close().succeeded();
    });
}

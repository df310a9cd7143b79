//! A display of the tests' own, Xvfb, and real events on it; the window says itself where its controls are.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use fumarole::image::Rgba8;
use serde_json::Value;
use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt, CreateWindowAux, EventMask, ImageFormat,
    InputFocus, PropMode, Window as WindowId, WindowClass,
};
use x11rb::protocol::xtest::ConnectionExt as XtestExt;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as WrapperExt;

use crate::cli::program::{Ended, Running, device, fumarole};

/// Far above what anything here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Between two looks, and between two events of one hand.
pub const LOOK: Duration = Duration::from_millis(20);
/// Without a frame the window is at rest.
const QUIET: Duration = Duration::from_millis(100);
/// In which a window draws what comes of the mouse, on a busy machine.
const ANSWER: Duration = Duration::from_secs(2);

/// X events of the test extension.
const KEY_PRESS: u8 = 2;
const BUTTON_PRESS: u8 = 4;
const MOTION: u8 = 6;
/// States of a window to its manager.
const NORMAL: u8 = 1;
const ICONIC: u8 = 3;

/// Waits until `look` finds something.
///
/// # Panics
/// When it takes too long.
pub fn wait<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < deadline, "{what}: not after {PATIENCE:?}");
        thread::sleep(LOOK);
    }
}

/// The controls that a window has written into a file.
pub fn controls(path: &Path) -> Vec<Value> {
    let text = fs::read(path).unwrap_or_default();
    serde_json::from_slice(&text).unwrap_or_default()
}

/// An X server without a screen of the host's.
pub struct Display {
    name: String,
    server: Child,
    manager: Option<Child>,
    pub connection: RustConnection,
    pub root: WindowId,
}

impl Display {
    /// # Panics
    /// Xvfb is not installed: a test never passes for want of it.
    pub fn start() -> Self {
        let mut command = Command::new("Xvfb");
        // It ends with its last client, so with this process, however that ends.
        command.args(["-displayfd", "1", "-terminate", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"]);
        let server = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = server.expect("Xvfb is missing: run ./setup.sh --tests");
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let (connection, screen) = RustConnection::connect(Some(&name)).unwrap();
        let root = connection.setup().roots[screen].root;
        Display { name, server, manager: None, connection, root }
    }

    /// With a window manager.
    pub fn managed() -> Self {
        let mut display = Self::start();
        let mut command = Command::new("openbox");
        command.env("DISPLAY", &display.name).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        display.manager = Some(command.spawn().expect("openbox is missing: run ./setup.sh --tests"));
        let supported = display.atom("_NET_SUPPORTING_WM_CHECK");
        wait("the window manager", || {
            let value = display.property(display.root, supported);
            (!value.is_empty()).then_some(())
        });
        display
    }

    /// As DISPLAY has it.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn atom(&self, name: &str) -> u32 {
        self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom
    }

    fn property(&self, window: WindowId, name: u32) -> Vec<u8> {
        let reply = self.connection.get_property(false, window, name, AtomEnum::ANY, 0, 64).unwrap().reply();
        reply.map(|reply| reply.value).unwrap_or_default()
    }

    /// The window that has this title, wherever the window manager has put it.
    fn find(&self, parent: WindowId, title: &str) -> Option<WindowId> {
        let children = self.connection.query_tree(parent).ok()?.reply().ok()?.children;
        children.into_iter().find_map(|child| {
            let name = self.property(child, AtomEnum::WM_NAME.into());
            if name == title.as_bytes() { Some(child) } else { self.find(child, title) }
        })
    }

    /// Sets the display's dots per inch, as a desktop's settings do; 96 are a scale of 1.
    pub fn set_dots_per_inch(&self, dpi: u32) {
        let text = format!("Xft.dpi:\t{dpi}\n");
        let (manager, string) = (AtomEnum::RESOURCE_MANAGER, AtomEnum::STRING);
        let changed = self.connection.change_property8(PropMode::REPLACE, self.root, manager, string, text.as_bytes());
        changed.unwrap().check().unwrap();
    }

    /// Offers settings as a desktop's daemon does (XSETTINGS), of which there are the dots per inch, to windows that open from
    /// now on. Gives the window that [`Display::change_settings`] changes them with.
    pub fn offer_settings(&self, dpi: u32) -> WindowId {
        let owner = self.connection.generate_id().unwrap();
        let (class, aux) = (WindowClass::INPUT_OUTPUT, CreateWindowAux::new());
        let made = self.connection.create_window(0, owner, self.root, 0, 0, 1, 1, 0, class, 0, &aux);
        made.unwrap().check().unwrap();
        self.change_settings(owner, dpi);
        let selection = self.atom("_XSETTINGS_S0");
        self.connection.set_selection_owner(owner, selection, x11rb::CURRENT_TIME).unwrap().check().unwrap();
        owner
    }

    /// Changes what [`Display::offer_settings`] offers.
    pub fn change_settings(&self, owner: WindowId, dpi: u32) {
        const NAME: &[u8] = b"Xft/DPI\0";
        let atom = self.atom("_XSETTINGS_SETTINGS");
        // Lowest byte first; a serial number; one setting: an integer, its name, when it changed, and its value.
        let mut bytes = vec![0, 0, 0, 0];
        bytes.extend([dpi, 1].iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0, 0, 7, 0]);
        bytes.extend(NAME);
        bytes.extend([dpi, dpi * 1024].iter().flat_map(|number| number.to_le_bytes()));
        let changed = self.connection.change_property8(PropMode::REPLACE, owner, atom, atom, &bytes);
        changed.unwrap().check().unwrap();
    }

    /// Width and height of a window, pixels.
    pub fn size(&self, window: WindowId) -> [f64; 2] {
        let geometry = self.connection.get_geometry(window).unwrap().reply().unwrap();
        [geometry.width, geometry.height].map(f64::from)
    }

    /// Picture of the screen.
    pub fn screenshot(&self) -> Rgba8 {
        let geometry = self.connection.get_geometry(self.root).unwrap().reply().unwrap();
        let (width, height) = (geometry.width, geometry.height);
        let reply = self.connection.get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, u32::MAX);
        let bytes = reply.unwrap().reply().unwrap().data;
        let pixels = bytes.chunks_exact(4).flat_map(|bgra| [bgra[2], bgra[1], bgra[0], 255]).collect();
        Rgba8::new(u32::from(width), u32::from(height), pixels).unwrap()
    }

    fn input(&self, kind: u8, detail: u8, (x, y): (i16, i16)) {
        self.connection.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).unwrap().check().unwrap();
    }

    /// Moves the pointer.
    pub fn point(&self, (x, y): (i16, i16)) {
        self.input(MOTION, 0, (x, y));
    }

    /// Presses and lets go a button: 1 left, 3 right, 4 and 5 the wheel.
    pub fn button(&self, button: u8) {
        self.input(BUTTON_PRESS, button, (0, 0));
        self.input(BUTTON_PRESS + 1, button, (0, 0));
    }

    /// Presses and lets go a key, by its symbol.
    pub fn key(&self, symbol: u32) {
        self.keys(&[symbol]);
    }

    /// Presses keys one after the other, and lets them go.
    pub fn keys(&self, symbols: &[u32]) {
        let codes: Vec<u8> = symbols.iter().map(|symbol| self.code(*symbol)).collect();
        codes.iter().for_each(|code| self.input(KEY_PRESS, *code, (0, 0)));
        codes.iter().rev().for_each(|code| self.input(KEY_PRESS + 1, *code, (0, 0)));
    }

    /// Holds a key down.
    pub fn hold(&self, symbol: u32, time: Duration) {
        let code = self.code(symbol);
        self.input(KEY_PRESS, code, (0, 0));
        thread::sleep(time);
        self.input(KEY_PRESS + 1, code, (0, 0));
    }

    /// Drags with the left button and a key held, step by step.
    pub fn carry(&self, symbol: u32, from: (i16, i16), to: (i16, i16)) {
        const STEPS: i16 = 10;
        let code = self.code(symbol);
        self.point(from);
        thread::sleep(LOOK);
        self.input(KEY_PRESS, code, (0, 0));
        thread::sleep(LOOK);
        self.input(BUTTON_PRESS, 1, (0, 0));
        for step in 1..=STEPS {
            let part = |a: i16, b: i16| a + (b - a) / STEPS * step;
            thread::sleep(LOOK);
            self.point((part(from.0, to.0), part(from.1, to.1)));
        }
        thread::sleep(LOOK);
        self.input(BUTTON_PRESS + 1, 1, (0, 0));
        self.input(KEY_PRESS + 1, code, (0, 0));
    }

    /// Types what no key needs Shift for.
    pub fn write(&self, text: &str) {
        text.chars().for_each(|letter| self.key(letter as u32));
    }

    fn code(&self, symbol: u32) -> u8 {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let mapping = self.connection.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let per_code = usize::from(mapping.keysyms_per_keycode);
        let at = mapping.keysyms.chunks(per_code).position(|symbols| symbols[0] == symbol);
        first + at.unwrap_or_else(|| panic!("no key has the symbol {symbol:#x}")) as u8
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        for child in self.manager.iter_mut().chain([&mut self.server]) {
            let _ended = child.kill().and_then(|()| child.wait());
        }
    }
}

/// A running window.
pub struct Window<'a> {
    pub display: &'a Display,
    pub program: Option<Running>,
    pub id: WindowId,
    controls: PathBuf,
    pub folder: TempDir,
}

impl<'a> Window<'a> {
    /// Opens a window under validation with synchronization validation, and waits until it has a picture.
    pub fn open(display: &'a Display, arguments: &str) -> Self {
        Self::open_with(display, arguments, |program| program.arg("--device").arg(device()))
    }

    /// As [`Window::open`], of a program that is changed.
    pub fn open_with(
        display: &'a Display,
        arguments: &str,
        change: impl FnOnce(crate::cli::program::Program) -> crate::cli::program::Program,
    ) -> Self {
        let program = fumarole(&format!("view {arguments} --validate"));
        Self::start(display, change(program))
    }

    /// As [`Window::open`], of the program as it is given.
    pub fn start(display: &'a Display, program: crate::cli::program::Program) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let state = folder.path().to_owned();
        Self::start_in(display, program, folder, &state)
    }

    /// As [`Window::open`], with what an earlier window left in the folder of the user's state.
    pub fn open_again(display: &'a Display, arguments: &str, state: &Path) -> Self {
        let program = fumarole(&format!("view {arguments} --validate")).arg("--device").arg(device());
        Self::start_in(display, program, tempfile::tempdir().unwrap(), state)
    }

    fn start_in(display: &'a Display, program: crate::cli::program::Program, folder: TempDir, state: &Path) -> Self {
        let controls = folder.path().join("controls.json");
        let program = program.arg("--controls").arg(&controls);
        let program = program.env("DISPLAY", &display.name).without("WAYLAND_DISPLAY").without("WAYLAND_SOCKET");
        let program = program.env("XDG_STATE_HOME", state).inside(folder.path()).start();
        let mut window = Window { display, program: Some(program), id: 0, controls, folder };
        window.id =
            window.wait("the window", |window| display.find(display.root, "fumarole").filter(|_| window.has("paper")));
        window.focus();
        window
    }

    /// Gives it the keyboard, which a window that is not yet seen does not take.
    pub fn focus(&mut self) {
        let (display, id) = (self.display, self.id);
        self.wait("the keyboard", |_| {
            let focus = display.connection.set_input_focus(InputFocus::PARENT, id, x11rb::CURRENT_TIME);
            focus.unwrap().check().ok()
        });
    }

    /// Waits for something to be seen; the window goes on meanwhile.
    pub fn wait<T>(&mut self, what: &str, mut look: impl FnMut(&Self) -> Option<T>) -> T {
        wait(what, || {
            if self.program.as_mut().is_none_or(Running::has_ended) {
                let ended = self.program.take().map(Running::end).unwrap();
                panic!("{what}: the window has ended, {}: {}", ended.status, ended.stderr);
            }
            look(self)
        })
    }

    /// The controls that it shows now.
    pub fn controls(&self) -> Vec<Value> {
        controls(&self.controls)
    }

    fn find(&self, label: &str) -> Option<Value> {
        self.controls().into_iter().find(|control| control["label"] == label)
    }

    /// True when there is a control of that label.
    pub fn has(&self, label: &str) -> bool {
        self.find(label).is_some()
    }

    /// True when a control's words hold the text.
    pub fn says(&self, text: &str) -> bool {
        let holds = |value: &Value| value.as_str().is_some_and(|words| words.contains(text));
        self.controls().iter().any(|control| holds(&control["label"]) || holds(&control["value"]))
    }

    /// Middle of a control on the screen.
    pub fn middle(&mut self, label: &str) -> (i16, i16) {
        let [left, top, right, bottom] = self.rectangle(label);
        ((left + right) / 2, (top + bottom) / 2)
    }

    /// Left, top, right and bottom of a control on the screen.
    pub fn rectangle(&mut self, label: &str) -> [i16; 4] {
        self.wait(label, |window| window.try_rectangle(label))
    }

    /// As [`Window::rectangle`], where it is there now.
    pub fn try_rectangle(&self, label: &str) -> Option<[i16; 4]> {
        self.place(&self.find(label)?)
    }

    /// Place on the screen of the image of that name.
    pub fn try_image(&self, name: &str) -> Option<[i16; 4]> {
        let images = |control: &Value| control["role"] == "Image" && control["label"] == name;
        self.place(&self.controls().into_iter().find(images)?)
    }

    fn place(&self, control: &Value) -> Option<[i16; 4]> {
        let origin = self.display.connection.translate_coordinates(self.id, self.display.root, 0, 0).unwrap();
        let origin = origin.reply().unwrap();
        let side = |index: usize| control["rectangle_px"][index].as_f64().unwrap() as i16;
        Some([side(0) + origin.dst_x, side(1) + origin.dst_y, side(2) + origin.dst_x, side(3) + origin.dst_y])
    }

    pub fn click(&mut self, label: &str) {
        let middle = self.middle(label);
        self.display.point(middle);
        self.display.button(1);
    }

    /// Does something with the mouse while it draws nothing, and waits until it has drawn what came of it. A frame that is drawn
    /// between what is done and the first look would else be waited for in vain; where nothing comes of it none is drawn.
    fn see(&self, done: impl FnOnce(&Display)) {
        // The file is made anew with each frame.
        let drawn = || fs::metadata(&self.controls).map(|file| (file.ino(), file.mtime(), file.mtime_nsec())).ok();
        let before = wait("a window at rest", || {
            let before = drawn();
            thread::sleep(QUIET);
            (drawn() == before).then_some(before)
        });
        done(self.display);
        let deadline = Instant::now() + ANSWER;
        while drawn() == before && Instant::now() < deadline {
            thread::sleep(LOOK);
        }
    }

    /// Drags with a button held, step by step as a hand does.
    pub fn drag(&mut self, button: u8, from: (i16, i16), to: (i16, i16)) {
        self.see(|display| display.point(from));
        self.see(|display| display.input(BUTTON_PRESS, button, (0, 0)));
        for step in 1..=4 {
            let part = |a: i16, b: i16| a + (b - a) * step / 4;
            self.see(|display| display.point((part(from.0, to.0), part(from.1, to.1))));
        }
        self.see(|display| display.input(BUTTON_PRESS + 1, button, (0, 0)));
    }

    /// True when the middle of the window shows the picture or the target of that name.
    pub fn shows(&self, name: &str) -> bool {
        self.controls().iter().any(|control| control["role"] == "Image" && control["label"] == name)
    }

    /// Clicks a field, and waits until it has the keyboard.
    pub fn enter(&mut self, label: &str) {
        self.click(label);
        self.wait(label, |window| window.find(label).filter(|field| field["is_focused"] == true));
    }

    /// Waits until the frame is drawn and shown.
    pub fn wait_for_frame(&mut self, number: u32) {
        let words = format!("frame {number} in ");
        self.wait(&words, |window| window.says(&words).then_some(()));
    }

    pub fn resize(&self, width: u32, height: u32) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.display.connection.configure_window(self.id, &size).unwrap().check().unwrap();
    }

    /// Asks the window manager for something of it.
    fn ask_manager(&self, what: &str, data: [u32; 5]) {
        let event = ClientMessageEvent::new(32, self.id, self.display.atom(what), data);
        let mask = EventMask::SUBSTRUCTURE_REDIRECT | EventMask::SUBSTRUCTURE_NOTIFY;
        self.display.connection.send_event(false, self.display.root, mask, event).unwrap().check().unwrap();
    }

    /// Waits until the window manager says so.
    fn wait_for_state(&mut self, state: u8) {
        let name = self.display.atom("WM_STATE");
        self.wait("the window manager", |window| {
            (window.display.property(window.id, name).first() == Some(&state)).then_some(())
        });
    }

    /// Has it taken away from the screen.
    pub fn minimise(&mut self) {
        self.ask_manager("WM_CHANGE_STATE", [ICONIC.into(), 0, 0, 0, 0]);
        self.wait_for_state(ICONIC);
    }

    /// Has it shown again.
    pub fn restore(&mut self) {
        self.ask_manager("_NET_ACTIVE_WINDOW", [2, 0, 0, 0, 0]);
        self.wait_for_state(NORMAL);
    }

    /// Closes it as a user does, and waits for its end.
    pub fn close(mut self) -> Ended {
        let protocols = self.display.atom("WM_PROTOCOLS");
        let delete = self.display.atom("WM_DELETE_WINDOW");
        let event = ClientMessageEvent::new(32, self.id, protocols, [delete, 0, 0, 0, 0]);
        self.display.connection.send_event(false, self.id, EventMask::NO_EVENT, event).unwrap().check().unwrap();
        self.program.take().unwrap().end()
    }
}

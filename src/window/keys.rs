//! The keys: everything can be done by them, and `?` lists them.

use egui::{Context, Grid, Key, KeyboardShortcut, Modifiers, Window};

use super::interface::{CommandUse, Interface, Shown, Wish, apply_theme};
use super::layout::Theme;
use super::passes_panel;
use super::protocol::{MeasureChoice, Request, TargetChoice, Verb};
use super::{camera, compare, keep_tab, top_bar};

/// Keys and what they do, as `?` lists them.
pub const LIST: [(&str, &str); 32] = [
    ("Space", "play, pause"),
    (", and .", "a frame back, a frame on"),
    ("Home", "frame 0"),
    ("G", "type a frame's number"),
    ("drag, arrows", "orbit"),
    ("right drag, Shift drag", "pan the camera"),
    ("wheel, Page up, Page down", "dolly"),
    ("W A S D Q E, with Shift", "fly, faster"),
    ("R", "the figure's camera"),
    ("Ctrl wheel, Ctrl drag", "zoom and pan the picture"),
    ("1, 0", "one pixel a texel, all of the picture"),
    ("[ and ]", "pass before, pass after"),
    ("Shift [ and ]", "stop the frame a pass earlier, later"),
    ("T", "the pass's target, the picture"),
    ("N", "the pass's next target"),
    ("M", "times of the passes"),
    ("K", "counters of the passes"),
    ("C", "compare with a second side"),
    ("B", "side by side, divider, difference"),
    ("Ctrl S", "save the picture"),
    ("Ctrl C", "copy the render command"),
    ("Ctrl Shift C", "copy the bench command"),
    ("Ctrl R", "compile the shaders of --shader-dir again"),
    ("Esc", "stop a replay or a film; leave a field"),
    ("Tab, arrows, Enter", "from control to control, change, press"),
    ("F2, F3, F4", "passes, parameters, drawer"),
    ("L", "light, dark, as the display"),
    ("Ctrl + and -, Ctrl 0", "larger and smaller text, as it was"),
    ("F11", "all of the display"),
    ("?, F1", "this list"),
    ("Ctrl Q", "quit"),
    ("file dropped", "a mesh or map for the parameter that takes it"),
];

/// Does what the keys of this frame say.
pub fn handle(context: &Context, face: &mut Interface) {
    global(context, face);
    // A field that has the focus gets the letters.
    if context.wants_keyboard_input() {
        return;
    }
    // Of a window that is drawn late, a frame has several.
    let presses = |modifiers, key| context.input_mut(|input| input.count_and_consume_key(modifiers, key)) as i32;
    let pressed = |key| presses(Modifiers::NONE, key) > 0;
    let asks_for_list =
        context.input(|input| input.events.iter().any(|event| matches!(event, egui::Event::Text(text) if text == "?")));
    if asks_for_list {
        face.has_keys = !face.has_keys;
    }
    // Space presses the control that has the focus.
    let has_focus = context.memory(|memory| memory.focused().is_some());
    clock(face, &|key| presses(Modifiers::NONE, key), has_focus);
    let by = presses(Modifiers::SHIFT, Key::CloseBracket) - presses(Modifiers::SHIFT, Key::OpenBracket);
    if by != 0 {
        stop_at(face, by);
    }
    let by = presses(Modifiers::NONE, Key::CloseBracket) - presses(Modifiers::NONE, Key::OpenBracket);
    if by != 0 {
        step_pass(face, by);
    }
    look(context, face, &pressed);
    if !has_focus {
        camera::steer_by_keys(context, face);
    }
}

/// Keys that a field with the focus does not get.
fn global(context: &Context, face: &mut Interface) {
    let pressed =
        |modifiers, key| context.input_mut(|input| input.consume_shortcut(&KeyboardShortcut::new(modifiers, key)));
    if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::C) {
        face.ask_command(Verb::Bench, CommandUse::Copy);
    }
    // Ctrl C comes as an event of its own; a field copies its selection.
    let copies = context.input(|input| input.events.contains(&egui::Event::Copy));
    if copies && !context.wants_keyboard_input() {
        face.ask_command(Verb::Render, CommandUse::Copy);
    }
    if pressed(Modifiers::COMMAND, Key::S) {
        keep_tab::save_picture(face, 0);
    }
    if pressed(Modifiers::COMMAND, Key::R) {
        face.ask(Request::Reload);
    }
    if pressed(Modifiers::COMMAND, Key::Q) {
        face.wish(Wish::Quit);
    }
    if pressed(Modifiers::NONE, Key::F1) {
        face.has_keys = !face.has_keys;
    }
    if pressed(Modifiers::NONE, Key::F2) {
        face.layout.has_passes = !face.layout.has_passes;
    }
    if pressed(Modifiers::NONE, Key::F3) {
        face.layout.has_parameters = !face.layout.has_parameters;
    }
    if pressed(Modifiers::NONE, Key::F4) {
        face.layout.has_drawer = !face.layout.has_drawer;
    }
    if pressed(Modifiers::NONE, Key::F11) {
        face.wish(Wish::Fullscreen);
    }
    if context.input(|input| input.key_pressed(Key::Escape)) {
        if face.has_keys {
            face.has_keys = false;
        } else if face.session.progress.is_some() {
            face.ask(Request::Cancel);
        }
    }
}

fn clock(face: &mut Interface, presses: &impl Fn(Key) -> i32, has_focus: bool) {
    if !has_focus && presses(Key::Space) % 2 == 1 {
        let request = if face.is_playing() { Request::Pause } else { Request::Play };
        face.ask(request);
    }
    if presses(Key::Home) > 0 {
        face.ask(Request::GoTo(0));
    }
    let by = presses(Key::Period) - presses(Key::Comma);
    if by != 0 {
        face.ask(Request::Step(by));
    }
}

fn look(context: &Context, face: &mut Interface, pressed: &impl Fn(Key) -> bool) {
    if pressed(Key::G) {
        let field = egui::Id::new("frame field");
        context.memory_mut(|memory| memory.request_focus(field));
    }
    if pressed(Key::R) {
        camera::reset(face);
    }
    let view = match face.shown {
        Shown::Picture => &mut face.picture_view,
        Shown::Target => &mut face.target_view.view,
    };
    if pressed(Key::Num1) {
        view.reset();
        view.zoom = Some(1.0);
    }
    if pressed(Key::Num0) {
        view.reset();
    }
    if pressed(Key::T) {
        match face.shown {
            Shown::Target => face.look_at(None),
            Shown::Picture => next_target(face),
        }
    }
    if pressed(Key::N) {
        next_target(face);
    }
    if pressed(Key::M) {
        let times = if face.measure.times > 0 { 0 } else { face.layout.samples };
        passes_panel::measure(face, MeasureChoice { times, ..face.measure });
    }
    if pressed(Key::K) {
        passes_panel::measure(face, MeasureChoice { counters: !face.measure.counters, ..face.measure });
    }
    if pressed(Key::C) {
        top_bar::toggle_comparison(face);
    }
    if pressed(Key::B) && face.session.side_count() > 1 {
        compare::choose(face, top_bar::next_comparison(face.layout.comparison));
    }
    if pressed(Key::L) {
        next_theme(context, face);
    }
}

/// The pass before or after the one that is looked at.
fn step_pass(face: &mut Interface, by: i32) {
    let count = face.session.side_built(0).map_or(0, |side| side.passes.len());
    if count == 0 {
        return;
    }
    let next = match face.pass {
        None if by > 0 => 0,
        None => count - 1,
        Some(pass) => pass.saturating_add_signed(by as isize).min(count - 1),
    };
    face.select_pass(Some(next));
}

/// The frame stops a pass earlier or later.
fn stop_at(face: &mut Interface, by: i32) {
    let count = face.session.side_built(0).map_or(0, |side| side.passes.len()) as i64;
    let after = face.after.map_or(count, i64::from) + i64::from(by);
    let after = after.clamp(0, count);
    face.set_after((after < count).then_some(after as u32));
}

/// The next of the targets that the pass writes, or of all where no pass is looked at.
fn next_target(face: &mut Interface) {
    let Some(built) = face.session.side_built(0) else { return };
    let name = |index: usize| built.targets.get(index).map(|target| target.name.clone());
    let written = face.pass.and_then(|pass| built.passes.get(pass)).map(|pass| &pass.written_targets);
    let names: Vec<String> = match written.filter(|written| !written.is_empty()) {
        Some(written) => written.iter().filter_map(|&index| name(index)).collect(),
        None => built.targets.iter().map(|target| target.name.clone()).collect(),
    };
    let at = face.target.as_ref().and_then(|target| names.iter().position(|name| *name == target.name));
    let next = at.map_or(0, |at| (at + 1) % names.len().max(1));
    if let Some(name) = names.get(next).cloned() {
        face.look_at(Some(TargetChoice { side: 0, name, layer: 0, first_row: 0 }));
    }
}

/// Light, dark, as the display says.
pub fn next_theme(context: &Context, face: &mut Interface) {
    face.layout.theme = match face.layout.theme {
        Theme::System => Theme::Light,
        Theme::Light => Theme::Dark,
        Theme::Dark => Theme::System,
    };
    apply_theme(context, face.layout.theme);
}

/// The list of keys.
pub fn show_list(context: &Context, face: &mut Interface) {
    let mut is_open = face.has_keys;
    Window::new("Keys").open(&mut is_open).collapsible(false).resizable(false).show(context, |ui| {
        ui.horizontal_top(|ui| {
            for (half, keys) in LIST.chunks(LIST.len().div_ceil(2)).enumerate() {
                Grid::new(("keys", half)).striped(true).show(ui, |ui| {
                    for (keys, what) in keys {
                        ui.strong(*keys);
                        ui.label(*what);
                        ui.end_row();
                    }
                });
            }
        });
    });
    face.has_keys = is_open;
}

//! Files to keep: the picture, a target at full precision, a sheet of all targets, a film.

use egui::{DragValue, TextEdit, Ui};

use super::interface::Interface;
use super::protocol::{Keep, Request};

/// Text typed here.
#[derive(Debug)]
pub struct Saving {
    /// Folder of the files.
    pub folder: String,
    film: (u32, u32),
    ending: Ending,
}

/// Form of a target's file, and of a film's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Ending {
    target: &'static str,
    film: &'static str,
}

impl Default for Saving {
    fn default() -> Self {
        Saving { folder: "fumarole-out".into(), film: (0, 30), ending: Ending { target: "exr", film: "y4m" } }
    }
}

/// The form.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal(|ui| {
        ui.label("folder");
        let field = ui.add(TextEdit::singleline(&mut face.saving.folder).desired_width(320.0));
        field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "folder"));
    });
    ui.horizontal_wrapped(|ui| {
        for side in 0..face.session.side_count() {
            let name = if side == 0 { "Save picture" } else { "Save picture B" };
            if ui.button(name).on_hover_text("As PNG (Ctrl+S)").clicked() {
                save_picture(face, side);
            }
        }
        if let Some(target) = face.target.clone() {
            if ui.button(format!("Save {}", target.name)).on_hover_text("All its layers").clicked() {
                let file = path(face, &target.name, face.saving.ending.target);
                face.ask(Request::Keep(Keep::Target { side: target.side, name: target.name, file }));
            }
            for ending in ["exr", "npy", "png"] {
                ui.selectable_value(&mut face.saving.ending.target, ending, ending);
            }
        }
        if ui.button("Contact sheet").on_hover_text("The picture and all targets, small").clicked() {
            let file = path(face, "targets", "png");
            face.ask(Request::Keep(Keep::ContactSheet { side: 0, file }));
        }
        if face.session.ready.as_ref().is_some_and(|ready| ready.can_capture)
            && ui.button("RenderDoc capture").on_hover_text("Of the next frame").clicked()
        {
            face.ask(Request::Capture);
        }
    });
    ui.horizontal_wrapped(|ui| {
        let (first, end) = &mut face.saving.film;
        ui.label("film of frames");
        ui.add(DragValue::new(first).range(0..=u32::MAX - 1));
        ui.label("up to but not including");
        ui.add(DragValue::new(end).range(1..=u32::MAX));
        *end = (*end).max(first.saturating_add(1));
        for ending in ["y4m", "png"] {
            ui.selectable_value(&mut face.saving.ending.film, ending, ending);
        }
        if ui.button("Save film").clicked() {
            let (first, end) = face.saving.film;
            let file = path(face, "film", face.saving.ending.film);
            face.ask(Request::Keep(Keep::Film { side: 0, first, end, file }));
        }
    });
    if !face.session.kept.is_empty() {
        ui.weak(format!("written last: {}", face.session.kept.join(", ")));
    }
}

/// Saves the picture of a side.
pub fn save_picture(face: &mut Interface, side: usize) {
    let what = if side == 0 { "picture" } else { "picture-b" };
    let file = path(face, what, "png");
    face.ask(Request::Keep(Keep::Picture { side, file }));
}

/// A name that says what is in the file.
fn path(face: &Interface, what: &str, ending: &str) -> String {
    let choice = face.session.side(0).map(|side| side.choice.clone()).unwrap_or_default();
    let variant = choice.variant.unwrap_or_default();
    let (paper, number) = (&face.paper, face.session.number());
    let name = format!("{paper}-{variant}-{number:04}-{what}.{ending}");
    std::path::Path::new(&face.saving.folder).join(name).display().to_string()
}

//! The bar at the top: paper, variants, preset, the clock; and the line at the bottom: the pointer, times, progress.

use std::collections::VecDeque;

use egui::{ComboBox, ProgressBar, RichText, TextEdit, Ui};

use super::compare;
use super::interface::{CommandUse, Interface};
use super::keys;
use super::layout::{Comparison, Theme};
use super::protocol::{Request, SideChoice, Verb, Work};

/// Paper, variants, preset and clock.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal_wrapped(|ui| {
        show_paper(ui, face);
        show_sides(ui, face);
        show_presets(ui, face);
        ui.separator();
        show_clock(ui, face);
        ui.separator();
        if ui.button("Copy as command").on_hover_text("The render line of what is seen (Ctrl+C)").clicked() {
            face.ask_command(Verb::Render, CommandUse::Copy);
        }
        if ui.button("as bench").on_hover_text("The bench line of what is seen").clicked() {
            face.ask_command(Verb::Bench, CommandUse::Copy);
        }
        ui.separator();
        let panels = [
            ("Passes", &mut face.layout.has_passes, "F2"),
            ("Parameters", &mut face.layout.has_parameters, "F3"),
            ("Drawer", &mut face.layout.has_drawer, "F4"),
        ];
        for (name, is_shown, key) in panels {
            ui.toggle_value(is_shown, name).on_hover_text(key);
        }
        show_theme(ui, face);
        if ui.button("?").on_hover_text("The keys").clicked() {
            face.has_keys = !face.has_keys;
        }
    });
}

fn show_paper(ui: &mut Ui, face: &mut Interface) {
    let mut chosen = None;
    let about = face.session.ready.as_ref().map(|ready| ready.about.clone()).unwrap_or_default();
    let combo = ComboBox::from_id_salt("paper").selected_text(RichText::new(&face.paper).strong()).width(80.0);
    let combo = combo.show_ui(ui, |ui| {
        for paper in face.papers.clone() {
            if ui.selectable_label(paper == face.paper, paper).clicked() {
                chosen = Some(paper);
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, "paper"));
    combo.response.on_hover_text(about);
    if let Some(paper) = chosen.filter(|paper| *paper != face.paper) {
        face.change_paper(paper);
    }
}

/// Variant and compiler of each side.
fn show_sides(ui: &mut Ui, face: &mut Interface) {
    let Some(ready) = face.session.ready.clone() else { return };
    let (variants, presets) = (&ready.variants, &ready.presets);
    let sides: Vec<SideChoice> = (0..face.session.side_count())
        .filter_map(|side| face.session.side(side).map(|side| side.choice.clone()))
        .collect();
    let mut wanted = sides.clone();
    for (index, side) in wanted.iter_mut().enumerate() {
        let letter = ["A", "B"][index.min(1)];
        let name = side.variant.clone().unwrap_or_default();
        let combo = ComboBox::from_id_salt(("variant", index)).selected_text(&name).show_ui(ui, |ui| {
            for variant in variants {
                if ui.selectable_label(*variant == name, variant).clicked() {
                    side.variant = Some(variant.clone());
                }
            }
            ui.separator();
            for compiler in ["glslang", "naga"] {
                let is_own = side.compiler.as_deref() == Some(compiler);
                if ui.selectable_label(is_own, compiler).on_hover_text("Whose shaders run").clicked() {
                    side.compiler = Some(compiler.to_owned());
                }
            }
            if sides.len() > 1 && !presets.is_empty() {
                ui.separator();
                for preset in presets {
                    let is_own = side.preset.as_ref() == Some(&preset.name);
                    if ui.selectable_label(is_own, &preset.name).on_hover_text(&preset.help).clicked() {
                        side.preset = (!is_own).then(|| preset.name.clone());
                    }
                }
            }
        });
        let label = format!("variant {letter}");
        combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &label));
    }
    let is_compared = sides.len() > 1;
    let mut compares = is_compared;
    if ui
        .toggle_value(&mut compares, "Compare")
        .on_hover_text("A second side: another variant, compiler or preset (C)")
        .clicked()
    {
        toggle_comparison(face);
        return;
    }
    if wanted != sides {
        face.ask(Request::Sides(wanted));
    }
}

/// One side becomes two, or two one.
pub fn toggle_comparison(face: &mut Interface) {
    let Some(first) = face.session.side(0).map(|side| side.choice.clone()) else { return };
    if face.session.side_count() > 1 {
        face.ask(Request::Sides(vec![first]));
        face.ask(Request::Difference(false));
        return;
    }
    let variants = face.session.ready.as_ref().map(|ready| ready.variants.clone()).unwrap_or_default();
    let other = variants.iter().find(|variant| Some(*variant) != first.variant.as_ref());
    let second = SideChoice { variant: other.cloned().or_else(|| first.variant.clone()), ..first.clone() };
    face.ask(Request::Sides(vec![first, second]));
    compare::choose(face, face.layout.comparison);
}

fn show_presets(ui: &mut Ui, face: &mut Interface) {
    let Some(ready) = face.session.ready.clone().filter(|ready| !ready.presets.is_empty()) else { return };
    let presets = &ready.presets;
    let current = face.session.setup.as_ref().and_then(|setup| setup.preset.clone());
    let mut chosen = None;
    let text = current.clone().unwrap_or_else(|| "no preset".to_owned());
    let combo = ComboBox::from_id_salt("preset").selected_text(text).show_ui(ui, |ui| {
        if ui.selectable_label(current.is_none(), "no preset").clicked() {
            chosen = Some(None);
        }
        for preset in presets {
            let is_current = current.as_ref() == Some(&preset.name);
            if ui.selectable_label(is_current, &preset.name).on_hover_text(&preset.help).clicked() {
                chosen = Some(Some(preset.name.clone()));
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, "preset"));
    if let Some(chosen) = chosen {
        face.ask(Request::Preset(chosen));
    }
}

fn show_clock(ui: &mut Ui, face: &mut Interface) {
    let (number, is_playing) = (face.session.number(), face.is_playing());
    if ui.button("|<").on_hover_text("Frame 0 (Home)").clicked() {
        face.ask(Request::GoTo(0));
    }
    if ui.button("<").on_hover_text("A frame back (,)").clicked() {
        face.ask(Request::Step(-1));
    }
    let (name, request) = if is_playing { ("Pause", Request::Pause) } else { ("Play", Request::Play) };
    if ui.button(name).on_hover_text("Space").clicked() {
        face.ask(request);
    }
    if ui.button(">").on_hover_text("A frame on (.)").clicked() {
        face.ask(Request::Step(1));
    }
    ui.label("frame");
    let mut text = face.frame_text.clone().unwrap_or_else(|| number.to_string());
    let field = ui.add(TextEdit::singleline(&mut text).desired_width(52.0).id(egui::Id::new("frame field")));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "frame"));
    if field.changed() {
        face.frame_text = Some(text.clone());
    }
    if field.lost_focus() && face.frame_text.take().is_some() {
        match text.trim().parse::<u32>() {
            Ok(number) => face.ask(Request::GoTo(number)),
            Err(_) => face.session.problem = Some(format!("frame {text:?}: give a whole number, 0 or more")),
        }
    }
    let known = face.session.frame.as_ref().map_or(1.0, |frame| frame.speed);
    let mut speed = face.sent.speed().unwrap_or(known);
    let drag = egui::DragValue::new(&mut speed).range(0.01..=1000.0).speed(0.05).prefix("speed x ").max_decimals(2);
    let drag = ui.add(drag).on_hover_text("Frames that the clock goes on by from picture to picture");
    drag.widget_info(|| egui::WidgetInfo::slider(true, speed, "speed"));
    if drag.changed() {
        face.ask(Request::Speed(speed));
    }
}

fn show_theme(ui: &mut Ui, face: &mut Interface) {
    let name = match face.layout.theme {
        Theme::System => "Auto",
        Theme::Light => "Light",
        Theme::Dark => "Dark",
    };
    if ui.button(name).on_hover_text("Colours: light, dark, as the display has them (L)").clicked() {
        keys::next_theme(ui.ctx(), face);
    }
}

/// The pointer's place, what is being done, and the times of both processes.
pub fn show_status(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal(|ui| {
        if let Some(progress) = face.session.progress.clone() {
            let what = match progress.what {
                Work::Build => "building",
                Work::Replay => "replaying",
                Work::Film => "drawing the film",
                Work::Limits => "measuring the device",
            };
            let fraction = progress.done as f32 / progress.total.max(1) as f32;
            let text = format!("{what} {} / {}", progress.done, progress.total);
            ui.add(ProgressBar::new(fraction).desired_width(220.0).text(text));
            let can_end = matches!(progress.what, Work::Replay | Work::Film);
            if can_end && ui.small_button("Stop").on_hover_text("Esc").clicked() {
                face.ask(Request::Cancel);
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if let Some(ready) = &face.session.ready {
                let name = ready.device.split(" (").next().unwrap_or_default();
                ui.weak(name).on_hover_text(&ready.device);
                if ready.validates {
                    let count = face.session.validation.len();
                    let text = RichText::new(format!("validation: {count}"));
                    let color = ui.visuals().error_fg_color;
                    ui.label(if count > 0 { text.color(color) } else { text });
                }
            }
            if let Some(frame) = &face.session.frame {
                let times: Vec<String> = frame.sides.iter().map(|side| format!("{:.1} ms", side.frame_ms)).collect();
                ui.label(format!("frame {} in {}", frame.number, times.join(" | ")));
            }
            show_own_times(ui, face);
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let line = if face.pointed.is_empty() {
                    face.note.clone().unwrap_or_default()
                } else {
                    std::mem::take(&mut face.pointed)
                };
                ui.add(egui::Label::new(line).truncate());
            });
        });
    });
}

/// Time of the window's own drawing.
fn show_own_times(ui: &mut Ui, face: &Interface) {
    let Some(last) = face.interface_ms.back() else { return };
    let of_pictures = face.pictures_ms.back().map(|last| format!(" / {last:.1}")).unwrap_or_default();
    let largest = |times: &VecDeque<f32>| times.iter().copied().fold(0.0, f32::max);
    let mut lines = vec![format!(
        "This window's own drawing, with its panels laid out: largest of the last {} {:.1} ms",
        face.interface_ms.len(),
        largest(&face.interface_ms)
    )];
    if !of_pictures.is_empty() {
        let (count, most) = (face.pictures_ms.len(), largest(&face.pictures_ms));
        lines.push(format!(
            "A new picture alone, of which several come between: largest of the last {count} {most:.1} ms"
        ));
    }
    ui.weak(format!("window {last:.1}{of_pictures} ms")).on_hover_text(lines.join("\n"));
}

/// The next way to show two sides.
pub fn next_comparison(comparison: Comparison) -> Comparison {
    match comparison {
        Comparison::Beside => Comparison::Divider,
        Comparison::Divider => Comparison::Difference,
        Comparison::Difference => Comparison::Beside,
    }
}

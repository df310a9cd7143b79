//! Every parameter from its one declaration: a slider where it has a range, a field otherwise.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use egui::{
    CollapsingHeader, ComboBox, Context, DragValue, RichText, ScrollArea, Slider, SliderClamping, TextEdit, Ui,
};

use super::camera;
use super::interface::Interface;
use super::protocol::{Cost, ParameterInfo};
use super::session::CAMERA;

/// Texts being typed.
#[derive(Debug, Default)]
pub struct Fields {
    search: String,
    /// Texts of fields that have the focus, by the parameter's name.
    texts: HashMap<String, String>,
    /// Numbers of sliders that are being dragged.
    numbers: HashMap<String, f64>,
    /// A dropped file that several parameters could take.
    dropped: Option<PathBuf>,
}

/// The parameters by their groups.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    ui.set_min_width(ui.available_width());
    ui.horizontal(|ui| {
        ui.strong("Parameters");
        let search = TextEdit::singleline(&mut face.fields.search).hint_text("search").desired_width(f32::INFINITY);
        ui.add(search).widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "search parameters"));
    });
    show_dropped(ui, face);
    camera::show_field(ui, face);
    ui.separator();
    let Some(ready) = face.session.ready.clone() else { return };
    let parameters = &ready.parameters;
    let values = face.session.side(0).map(|side| side.values.clone()).unwrap_or_default();
    let set = face.session.side(0).map(|side| side.set.clone()).unwrap_or_default();
    let search = face.fields.search.to_lowercase();
    let is_wanted = |parameter: &ParameterInfo| {
        search.is_empty()
            || [&parameter.name, &parameter.help, &parameter.section].iter().any(|t| t.to_lowercase().contains(&search))
    };
    let mut groups: Vec<&str> = Vec::new();
    for parameter in parameters {
        if !groups.contains(&parameter.group.as_str()) {
            groups.push(&parameter.group);
        }
    }
    ScrollArea::vertical().auto_shrink(false).id_salt("parameters").show(ui, |ui| {
        for group in groups {
            let rows = || {
                let pairs = parameters.iter().zip(&values);
                pairs.filter(|(parameter, _)| {
                    parameter.group == group && parameter.name != CAMERA && is_wanted(parameter)
                })
            };
            if rows().next().is_none() {
                continue;
            }
            let everyday = rows().any(|(parameter, _)| parameter.is_everyday);
            let open = (!search.is_empty()).then_some(true);
            CollapsingHeader::new(group).default_open(everyday).open(open).show(ui, |ui| {
                for (parameter, value) in rows() {
                    let asked = face.sent.parameter(&parameter.name).map(str::to_owned);
                    let value = asked.as_ref().unwrap_or(value);
                    show_parameter(ui, face, parameter, value, set.contains(&parameter.name));
                }
            });
        }
    });
}

/// Name, help and control of a parameter.
fn show_parameter(ui: &mut Ui, face: &mut Interface, parameter: &ParameterInfo, value: &str, is_set: bool) {
    let name = RichText::new(&parameter.name);
    let name = if is_set { name.strong() } else { name };
    if parameter.is_flag {
        ui.horizontal(|ui| {
            let mut is_on = value == "on" || value == "true";
            let checkbox = ui.checkbox(&mut is_on, name).on_hover_ui(|ui| explain(ui, parameter));
            if checkbox.changed() {
                face.set(&parameter.name, vec![is_on.to_string()]);
            }
            show_reset(ui, face, parameter, is_set);
        });
        return;
    }
    ui.horizontal(|ui| {
        ui.label(name).on_hover_ui(|ui| explain(ui, parameter));
        ui.weak(&parameter.unit);
        show_reset(ui, face, parameter, is_set);
    });
    let number = value.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let is_number = !parameter.is_list && !parameter.is_several && !parameter.is_file;
    if !parameter.choices.is_empty() && !parameter.is_list {
        show_choices(ui, face, parameter, value);
    } else if let Some(number) = number.filter(|_| is_number) {
        show_number(ui, face, parameter, value, number);
    } else {
        show_text(ui, face, parameter, value);
    }
}

fn show_reset(ui: &mut Ui, face: &mut Interface, parameter: &ParameterInfo, is_set: bool) {
    if is_set {
        let reset = ui.small_button("reset").on_hover_text("Back to the preset's or the default value");
        if reset.clicked() {
            face.fields.texts.remove(&parameter.name);
            face.set(&parameter.name, Vec::new());
        }
    }
}

/// All that the declaration says, under the pointer.
fn explain(ui: &mut Ui, parameter: &ParameterInfo) {
    let mut lines = vec![parameter.help.clone()];
    let bounds = [parameter.range.as_str(), parameter.unit.as_str()].join(" ").trim().to_owned();
    if !bounds.is_empty() {
        lines.push(bounds);
    }
    if !parameter.section.is_empty() {
        lines.push(format!("paper: {}", parameter.section));
    }
    if !parameter.default.is_empty() {
        lines.push(format!("default: {}", parameter.default));
    }
    lines.push(match parameter.cost {
        Cost::Constants => "shown with the next frame".to_owned(),
        Cost::Buffers => "buffers are made anew".to_owned(),
        Cost::Pipelines => "pipelines are built anew".to_owned(),
    });
    ui.set_max_width(ui.spacing().tooltip_width);
    ui.label(lines.join("\n"));
}

fn show_choices(ui: &mut Ui, face: &mut Interface, parameter: &ParameterInfo, value: &str) {
    let mut chosen = None;
    let combo = ComboBox::from_id_salt(&parameter.name).selected_text(value).show_ui(ui, |ui| {
        for choice in &parameter.choices {
            let label = ui.selectable_label(choice.name == value, &choice.name);
            let label = if choice.help.is_empty() { label } else { label.on_hover_text(&choice.help) };
            if label.clicked() {
                chosen = Some(choice.name.clone());
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &parameter.name));
    if let Some(chosen) = chosen.filter(|chosen| chosen != value) {
        face.set(&parameter.name, vec![chosen]);
    }
}

/// A change that costs constants is drawn while the slider moves, any other when it is let go.
fn show_number(ui: &mut Ui, face: &mut Interface, parameter: &ParameterInfo, value: &str, number: f64) {
    let mut moved = face.fields.numbers.get(&parameter.name).copied().unwrap_or(number);
    let low = parameter.low.unwrap_or(f64::NEG_INFINITY);
    let high = parameter.high.unwrap_or(f64::INFINITY);
    let is_narrow = low.is_finite() && high.is_finite() && high > low && high <= 1e6;
    // To look at a number, or to leave its field, does not round it.
    let text = |shown: f64, _| if shown == number { value.trim().to_owned() } else { typed(parameter, shown) };
    let response = if is_narrow {
        // The number stands beside it.
        let digits = value.trim().len().max(8);
        ui.spacing_mut().slider_width = (ui.available_width() - 22.0 - 8.0 * digits as f32).max(40.0);
        let slider = Slider::new(&mut moved, low..=high).logarithmic(high - low > 1e3).max_decimals(6);
        let slider = slider.clamping(SliderClamping::Edits).update_while_editing(false).custom_formatter(text);
        ui.add(if parameter.is_whole { slider.integer() } else { slider })
    } else {
        let speed = if parameter.is_whole { 1.0 } else { (number.abs() * 0.01).max(1e-3) };
        let field = DragValue::new(&mut moved).range(low..=high).clamp_existing_to_range(false).speed(speed);
        let field = field.max_decimals(9).update_while_editing(false).custom_formatter(text);
        ui.add(if parameter.is_whole { field.max_decimals(0) } else { field })
    };
    response.widget_info(|| egui::WidgetInfo::slider(true, moved, &parameter.name));
    if response.changed() {
        face.fields.numbers.insert(parameter.name.clone(), moved);
    }
    // Arrows move a slider that has the focus.
    let is_held = response.dragged() || response.has_focus();
    let is_kept = face.fields.numbers.contains_key(&parameter.name);
    let is_due = if parameter.cost == Cost::Constants { response.changed() } else { is_kept && !is_held };
    if is_due && moved != number {
        face.set(&parameter.name, vec![typed(parameter, moved)]);
    }
    if !is_held {
        face.fields.numbers.remove(&parameter.name);
    }
}

/// The number as one would type it.
fn typed(parameter: &ParameterInfo, number: f64) -> String {
    if parameter.is_whole { format!("{number:.0}") } else { format!("{number}") }
}

fn show_text(ui: &mut Ui, face: &mut Interface, parameter: &ParameterInfo, value: &str) {
    let mut text = face.fields.texts.get(&parameter.name).cloned().unwrap_or_else(|| value.to_owned());
    let field = ui.add(TextEdit::singleline(&mut text).hint_text(&parameter.placeholder).desired_width(f32::INFINITY));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, &parameter.name));
    if field.changed() {
        face.fields.texts.insert(parameter.name.clone(), text.clone());
    }
    if field.lost_focus() && face.fields.texts.remove(&parameter.name).is_some() && text != value {
        face.set(&parameter.name, values_of(parameter, &text));
    }
}

/// The texts of a value that was typed: a list's parted by spaces or semicolons.
fn values_of(parameter: &ParameterInfo, text: &str) -> Vec<String> {
    if parameter.is_list {
        let parts = text.split([' ', ';']).map(str::trim).filter(|part| !part.is_empty());
        return parts.map(str::to_owned).collect();
    }
    vec![text.trim().to_owned()].into_iter().filter(|text| !text.is_empty()).collect()
}

/// Takes a file that was dropped on the window: the one parameter that takes such files gets it.
pub fn take_dropped(context: &Context, face: &mut Interface) {
    let dropped = context.input(|input| input.raw.dropped_files.iter().find_map(|file| file.path.clone()));
    let Some(path) = dropped else { return };
    let takers = takers(face.session.parameters(), &path);
    match takers.as_slice() {
        [] => face.session.problem = Some(format!("{}: no parameter of {} takes a file", path.display(), face.paper)),
        [one] => {
            let name = one.clone();
            face.set(&name, vec![path.display().to_string()]);
        }
        // The panel asks.
        _ => (face.fields.dropped, face.layout.has_parameters) = (Some(path), true),
    }
}

/// Names of the parameters that may take the file: maps those with heights, others the rest.
fn takers(parameters: &[ParameterInfo], path: &Path) -> Vec<String> {
    const HEIGHTS: [&str; 10] = ["hgt", "tif", "tiff", "asc", "flt", "bil", "dem", "png", "zip", "npy"];
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let takes_files = || parameters.iter().filter(|parameter| parameter.is_file);
    let is_map = |parameter: &ParameterInfo| parameter.name.contains("map");
    let of_kind: Vec<String> = takes_files()
        .filter(|parameter| is_map(parameter) == HEIGHTS.contains(&ending.as_str()))
        .map(|parameter| parameter.name.clone())
        .collect();
    if of_kind.is_empty() { takes_files().map(|parameter| parameter.name.clone()).collect() } else { of_kind }
}

/// Asks which parameter a dropped file is for.
fn show_dropped(ui: &mut Ui, face: &mut Interface) {
    let Some(path) = face.fields.dropped.clone() else { return };
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.label(format!("{} is for", path.display()));
        ui.horizontal_wrapped(|ui| {
            for name in takers(face.session.parameters(), &path) {
                if ui.button(&name).clicked() {
                    face.fields.dropped = None;
                    face.set(&name, vec![path.display().to_string()]);
                }
            }
            if ui.button("nothing").clicked() {
                face.fields.dropped = None;
            }
        });
    });
}

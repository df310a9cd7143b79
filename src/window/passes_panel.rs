//! The passes in the paper's order: section, times, share, calls; the one that is looked at, with its targets and counters.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::interface::{Interface, Shown};
use super::protocol::{MeasureChoice, PassInfo, PassTimes, Request, TargetChoice};

/// The passes, the slider through the frame, and the pass that is looked at.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    // A panel is as wide as its user has made it, whatever it holds.
    ui.set_min_width(ui.available_width());
    show_measuring(ui, face);
    let Some(built) = face.session.side_built(0) else {
        ui.weak("The passes are known when the paper is built.");
        return;
    };
    let passes = built.passes.clone();
    show_after(ui, face, &passes);
    ui.separator();
    ScrollArea::vertical().auto_shrink(false).id_salt("passes").show(ui, |ui| {
        ScrollArea::horizontal().id_salt("pass table").show(ui, |ui| show_table(ui, face, &passes));
        show_sum(ui, face);
        if let Some((index, pass)) = face.pass.and_then(|index| Some((index, passes.get(index)?))) {
            ui.separator();
            show_pass(ui, face, index, pass);
        } else {
            ui.weak("Choose a pass to see its targets.");
        }
    });
}

/// Times and counters come from frames of their own, on request.
fn show_measuring(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal_wrapped(|ui| {
        ui.strong("Passes");
        let mut has_times = face.measure.times > 0;
        let mut has_counters = face.measure.counters;
        let times = ui.checkbox(&mut has_times, "times").on_hover_text(
            "Timestamped frames are drawn for the times, after each change and while the clock plays; they are not shown, and \
             no frame that draws this window is timed (M)",
        );
        let counters = ui.checkbox(&mut has_counters, "counters").on_hover_text("Counted frames are drawn as well");
        let mut samples = face.layout.samples;
        let count = ui
            .add_enabled(has_times, egui::DragValue::new(&mut samples).range(1..=100).prefix("median of "))
            .on_hover_text("Timestamped frames that each median is taken of: the last ones");
        face.layout.samples = samples;
        if times.changed() || counters.changed() || count.changed() {
            let times = if has_times { samples } else { 0 };
            measure(face, MeasureChoice { times, counters: has_counters });
        }
    });
}

/// Asks for times and counters.
pub fn measure(face: &mut Interface, measure: MeasureChoice) {
    face.measure = measure;
    face.ask(Request::Measure(measure));
}

/// The slider through the frame.
fn show_after(ui: &mut Ui, face: &mut Interface, passes: &[PassInfo]) {
    let count = passes.len() as u32;
    let mut after = face.after.unwrap_or(count);
    ui.horizontal(|ui| {
        ui.label("after pass");
        ui.spacing_mut().slider_width = (ui.available_width() - 60.0).max(60.0);
        let slider = ui.add(egui::Slider::new(&mut after, 0..=count));
        slider.widget_info(|| egui::WidgetInfo::slider(true, f64::from(after), "after pass"));
        if slider.changed() {
            face.set_after((after < count).then_some(after));
        }
    });
    let words = match after.checked_sub(1).and_then(|index| passes.get(index as usize)) {
        _ if after == count => "the whole frame".to_owned(),
        None => "before the first pass".to_owned(),
        Some(pass) => format!("the frame up to {}", pass.name),
    };
    ui.weak(words);
}

fn show_table(ui: &mut Ui, face: &mut Interface, passes: &[PassInfo]) {
    let times: Vec<Vec<PassTimes>> = face.session.times.iter().map(|side| side.passes.clone()).collect();
    let is_compared = face.session.side_count() > 1;
    let of_second = |name: &str| whole(times.get(1)?.iter().find(|times| times.name == name)?);
    let number = |ui: &mut Ui, value: Option<f64>| drop(ui.monospace(milliseconds(value)));
    let second = face.session.side_built(1).map(|side| side.passes.clone()).unwrap_or_default();
    let mut of_first = times.first().into_iter().flatten();
    let has_floors = of_first.clone().any(|pass| pass.floor_ms.is_some());
    let has_counters = of_first.any(|pass| pass.counters.is_some());
    let mut chosen = None;
    Grid::new("pass grid").striped(true).spacing([10.0, 2.0]).show(ui, |ui| {
        let head = |ui: &mut Ui, text: &str, help: &str| drop(ui.strong(text).on_hover_text(help));
        head(ui, "pass", "The paper's name for it");
        if is_compared {
            head(ui, "A ms", "GPU and host time of the first side");
            head(ui, "B ms", "GPU and host time of the second side's pass of the same name");
        } else {
            head(ui, "gpu ms", "Between its timestamps: median of the last timestamped frames");
            head(ui, "host ms", "Host work that the method needs");
            head(ui, "wait ms", "Waiting for what the method reads back");
        }
        head(ui, "share", "Of the sum of all passes' GPU and host times");
        if has_floors {
            head(ui, "of limit", "Least time of its counted work at the device's limits, as a share of its GPU time");
        }
        head(ui, "calls", "Draws, dispatches, copies or executions in one frame");
        if has_counters {
            head(ui, "vertices", "Vertex stages of a counted frame");
            head(ui, "samples", "Samples that passed every test");
            head(ui, "invocations", "Compute stages of a counted frame");
        }
        head(ui, "section", "Of the paper");
        ui.end_row();
        for (index, pass) in passes.iter().enumerate() {
            let own = times.first().and_then(|side| side.iter().find(|times| times.name == pass.name));
            let is_recorded = face.after.is_none_or(|after| index < after as usize);
            let name = RichText::new(&pass.name);
            let name = if is_recorded { name } else { name.weak().strikethrough() };
            if ui.selectable_label(face.pass == Some(index), name).on_hover_ui(|ui| explain(ui, pass)).clicked() {
                chosen = Some(index);
            }
            if is_compared {
                number(ui, own.and_then(whole));
                number(ui, of_second(&pass.name));
            } else {
                number(ui, own.and_then(|times| times.gpu_ms));
                number(ui, own.and_then(|times| times.host_ms));
                number(ui, own.and_then(|times| times.wait_ms));
            }
            match own.and_then(|times| times.fraction) {
                Some(fraction) => ui.add(
                    egui::ProgressBar::new(fraction as f32)
                        .desired_width(64.0)
                        .corner_radius(2.0)
                        .text(format!("{:.1} %", fraction * 100.0)),
                ),
                None => ui.label(""),
            };
            if has_floors {
                let bound = own.and_then(|times| times.bound.clone()).unwrap_or_default();
                let fraction = own.and_then(of_limit).map(|fraction| format!("{:5.1} %", fraction * 100.0));
                ui.monospace(fraction.unwrap_or_default()).on_hover_text(bound);
            }
            ui.monospace(pass.calls.to_string());
            if has_counters {
                let counters = own.and_then(|times| times.counters).unwrap_or_default();
                for count in [counters.vertices, counters.samples_passed, counters.compute_invocations] {
                    ui.monospace(count.map(|count| count.to_string()).unwrap_or_default());
                }
            }
            ui.weak(&pass.section);
            ui.end_row();
        }
        for pass in second.iter().filter(|pass| passes.iter().all(|own| own.name != pass.name)) {
            ui.label(RichText::new(&pass.name).italics()).on_hover_ui(|ui| {
                ui.label("B alone");
                explain(ui, pass);
            });
            number(ui, None);
            number(ui, of_second(&pass.name));
            (0..1 + usize::from(has_floors)).for_each(|_| drop(ui.label("")));
            ui.monospace(pass.calls.to_string());
            (0..3 * usize::from(has_counters)).for_each(|_| drop(ui.label("")));
            ui.weak(&pass.section);
            ui.end_row();
        }
    });
    if let Some(index) = chosen {
        face.select_pass((face.pass != Some(index)).then_some(index));
    }
}

/// Least time over the time that it took.
fn of_limit(times: &PassTimes) -> Option<f64> {
    Some(times.floor_ms? / times.gpu_ms.filter(|&ms| ms > 0.0)?)
}

/// GPU and host time together.
fn whole(times: &PassTimes) -> Option<f64> {
    match (times.gpu_ms, times.host_ms) {
        (None, None) => None,
        (gpu, host) => Some(gpu.unwrap_or(0.0) + host.unwrap_or(0.0)),
    }
}

/// Description of a pass and its resources, under the pointer.
fn explain(ui: &mut Ui, pass: &PassInfo) {
    let list = |names: &[String]| if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    ui.set_max_width(ui.spacing().tooltip_width);
    ui.label(format!("{}; reads {}; writes {}", pass.kind, list(&pass.reads), list(&pass.writes)));
}

/// A time, or nothing where none is known.
pub fn milliseconds(value: Option<f64>) -> String {
    match value {
        None => String::new(),
        Some(ms) if ms >= 100.0 => format!("{ms:8.1}"),
        Some(ms) => format!("{ms:8.3}"),
    }
}

/// Frame times apart from the interface's own.
fn show_sum(ui: &mut Ui, face: &mut Interface) {
    for (index, side) in face.session.times.iter().enumerate().filter(|(_, side)| side.samples > 0) {
        // From 0 on: a sum of nothing is -0.
        let sum = side.passes.iter().filter_map(|pass| pass.gpu_ms).fold(0.0, |sum, ms| sum + ms);
        let host = side.passes.iter().filter_map(|pass| pass.host_ms).fold(0.0, |sum, ms| sum + ms);
        let name = if face.session.side_count() > 1 { ["A: ", "B: "][index.min(1)] } else { "" };
        let frame = side.frame_ms.map(|ms| format!(", a frame without timestamps {ms:.2} ms")).unwrap_or_default();
        ui.label(format!("{name}GPU {sum:.2} ms, host {host:.2} ms{frame}; median of {} frames", side.samples));
    }
    if face.measure.times > 0 && face.session.times.iter().all(|side| side.samples == 0) {
        ui.weak("The first timestamped frames are being drawn.");
    }
}

/// The pass that is looked at.
fn show_pass(ui: &mut Ui, face: &mut Interface, index: usize, pass: &PassInfo) {
    ui.horizontal_wrapped(|ui| {
        ui.heading(&pass.name);
        ui.weak(format!("{} {}", pass.section, pass.kind));
    });
    let rows = [
        ("reads", pass.reads.join(", ")),
        ("writes", pass.writes.join(", ")),
        ("shaders", pass.shaders.join(", ")),
        ("compiler", pass.compiler.clone().unwrap_or_default()),
        ("blend", pass.blend.join(", ")),
        ("depth", pass.depth.clone().unwrap_or_default()),
    ];
    for (name, text) in rows.into_iter().filter(|(_, text)| !text.is_empty()) {
        ui.horizontal_wrapped(|ui| {
            ui.weak(name);
            ui.label(text);
        });
    }
    let counters = face.session.times.first().and_then(|side| side.passes.get(index)?.counters);
    if let Some(counters) = counters {
        let counts = [
            ("vertices", counters.vertices),
            ("primitives", counters.primitives),
            ("fragments", counters.fragments),
            ("compute invocations", counters.compute_invocations),
            ("samples passed", counters.samples_passed),
        ];
        ui.horizontal_wrapped(|ui| {
            for (name, count) in counts {
                if let Some(count) = count {
                    ui.label(format!("{name} {count}"));
                }
            }
        });
    }
    show_bound(ui, face, index);
    show_thumbnails(ui, face, pass);
}

/// The device's limit, where that and the pass's work were measured.
fn show_bound(ui: &mut Ui, face: &mut Interface, index: usize) {
    if face.session.limits.is_none() && ui.small_button("Measure the device's limits").clicked() {
        face.ask(Request::Limits);
    }
    let pass = face.session.times.first().and_then(|side| side.passes.get(index));
    if let Some((fraction, floor_ms, bound)) =
        pass.and_then(|pass| Some((of_limit(pass)?, pass.floor_ms?, pass.bound.as_ref()?)))
    {
        ui.label(format!("{:.1} % of the device's limit: {bound} takes {floor_ms:.3} ms at least", fraction * 100.0));
    } else if face.session.limits.is_some() && !face.measure.counters {
        ui.weak("Counters (K) give its share of them.");
    }
}

/// Targets that the pass writes, then those that it reads.
fn show_thumbnails(ui: &mut Ui, face: &mut Interface, pass: &PassInfo) {
    let Some(built) = face.session.side_built(0) else { return };
    let of = |indices: &[usize]| -> Vec<String> {
        indices.iter().filter_map(|&index| built.targets.get(index)).map(|target| target.name.clone()).collect()
    };
    let groups = [("writes", of(&pass.written_targets)), ("reads", of(&pass.read_targets))];
    let mut chosen = None;
    for (word, names) in groups.into_iter().filter(|(_, names)| !names.is_empty()) {
        ui.weak(word);
        ui.horizontal_wrapped(|ui| {
            for name in names {
                let is_shown =
                    face.shown == Shown::Target && face.target.as_ref().is_some_and(|target| target.name == name);
                ui.vertical(|ui| {
                    ui.set_max_width(120.0);
                    if let Some(texture) = face.pictures.thumbnails.get(&name) {
                        let size = texture.size_vec2();
                        let shown = size * (112.0 / size.max_elem()).min(4.0);
                        let image = egui::Image::new((texture.id(), shown));
                        let button = ui.add(egui::Button::image(image).selected(is_shown));
                        button.widget_info(|| {
                            egui::WidgetInfo::labeled(egui::WidgetType::Button, true, format!("thumbnail {name}"))
                        });
                        if button.clicked() {
                            chosen = Some(name.clone());
                        }
                    }
                    if ui.selectable_label(is_shown, &name).clicked() {
                        chosen = Some(name);
                    }
                });
            }
        });
    }
    if let Some(name) = chosen {
        face.look_at(Some(TargetChoice { side: 0, name, layer: 0, first_row: 0 }));
    }
}

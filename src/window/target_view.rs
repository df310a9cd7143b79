//! A target or buffer in the middle: as a picture in false colours with its histogram, or as a table.

use egui::{ComboBox, DragValue, Rect, Sense, TextureHandle, TextureOptions, Ui};

use super::false_colour::{Channel, Drawing, Ramp, draw, linear_depth, number, texel};
use super::interface::Interface;
use super::picture_view::{PictureView, navigate, paint, texel_at};
use super::pictures::small_size;
use super::protocol::{Statistics, TargetChoice, TargetInfo, TargetShape, TargetValues, ValueKind};
use super::reduction::reduced;
use super::table_view;

/// View of the target.
#[derive(Default)]
pub struct TargetView {
    /// Place and scale of the target in the middle of the window.
    pub view: PictureView,
    channel: Option<Channel>,
    /// Ends of the range that the user chose.
    range: Option<(f64, f64)>,
    exposure: f32,
    ramp: Option<Ramp>,
    is_linear_depth: bool,
    is_logarithmic: bool,
    texture: Option<TextureHandle>,
    /// Contents of the texture: the frame, the drawing, and its pixels on the screen where they are fewer than its own.
    drawn: Option<(u64, TargetChoice, Drawing, Option<[usize; 2]>)>,
}

impl TargetView {
    /// Another target: its own range and channel.
    pub fn reset(&mut self) {
        let view = std::mem::take(&mut self.view);
        *self = TargetView { view, is_logarithmic: self.is_logarithmic, ..TargetView::default() };
    }
}

/// The range that is drawn where the user says none: the percentiles that leave a thousandth out at each end.
fn percentile_range(statistics: Option<&Statistics>) -> (f64, f64) {
    let Some(statistics) = statistics else { return (0.0, 1.0) };
    match (statistics.percentiles.get(1), statistics.percentiles.get(5)) {
        (Some(&low), Some(&high)) if high > low => (low, high),
        (Some(&low), _) => (low - 0.5, low + 0.5),
        _ => (0.0, 1.0),
    }
}

/// The target with its controls.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    let Some(choice) = face.target.clone() else { return };
    let info = face
        .session
        .side_built(choice.side)
        .and_then(|side| side.targets.iter().find(|target| target.name == choice.name))
        .cloned();
    let Some(info) = info else { return };
    show_heading(ui, face, &choice, &info);
    let frame = face.session.frame.as_ref();
    let values = frame.and_then(|frame| Some((frame.serial, frame.target.as_ref()?)));
    let Some((serial, values)) = values.filter(|(_, values)| values.choice == choice) else {
        ui.weak("Its values come with the next frame.");
        return;
    };
    if !values.is_written {
        ui.weak("No pass so far has written it in this frame: these are the last frame's values.");
    }
    if let TargetShape::Table { .. } = info.shape {
        let first = values.choice.first_row;
        let wanted = table_view::show(ui, values, first, &info);
        if let Some(first_row) = wanted {
            let target = TargetChoice { first_row, ..choice };
            face.target = Some(target.clone());
            face.ask(super::protocol::Request::Target(Some(target)));
        }
        return;
    }
    let view = &mut face.target_view;
    let drawing = show_controls(ui, view, values, &info);
    show_histogram(ui, view, values, drawing);
    let pixels_per_point = ui.ctx().pixels_per_point();
    let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, &choice.name));
    let size = egui::vec2(values.width as f32, values.height as f32);
    navigate(&mut view.view, ui, &response, size, false);
    let rect = view.view.place(response.rect, size, pixels_per_point);
    // The mean of two labels is a third.
    let is_of_labels = drawing.ramp == Ramp::Labels && drawing.channel != Channel::Colour;
    let shown = small_size(rect.size(), pixels_per_point, size).filter(|_| !is_of_labels);
    let state = (serial, choice.clone(), drawing, shown);
    if view.drawn.as_ref() != Some(&state) {
        let options = TextureOptions::NEAREST;
        if let Some(image) = draw(values, &drawing, info.is_srgb) {
            let small = shown.and_then(|shown| {
                let pixels = reduced(bytemuck::cast_slice(&image.pixels), image.size, shown)?;
                Some(egui::ColorImage::new(shown, pixels))
            });
            let image = small.unwrap_or(image);
            match &mut view.texture {
                Some(texture) => texture.set(image, options),
                None => view.texture = Some(ui.ctx().load_texture("target", image, options)),
            }
        }
        view.drawn = Some(state);
    }
    if let Some(texture) = &view.texture {
        paint(&painter, texture, rect);
    }
    let pointed = response.hover_pos().and_then(|pointer| texel_at(rect, size, pointer));
    if let Some((x, y)) = pointed
        && let Some(numbers) = texel(values, x, y)
    {
        face.pointed = words(&choice, &info, x, y, &numbers);
    }
}

/// Place and value of a texel.
fn words(choice: &TargetChoice, info: &TargetInfo, x: u32, y: u32, numbers: &[f64]) -> String {
    let text = |number: &f64| match info.kind {
        ValueKind::F32 => format!("{number:.6}"),
        _ => format!("{number}"),
    };
    let values: Vec<String> = numbers.iter().map(text).collect();
    let linear = info.planes.zip(numbers.first()).map(|(planes, depth)| linear_depth(*depth, planes));
    let linear = linear.map(|distance| format!(" = {distance:.4} along the view")).unwrap_or_default();
    let of = [info.holds.as_str(), info.format.as_str()].into_iter().filter(|text| !text.is_empty());
    let of = of.collect::<Vec<_>>().join("; ");
    let format = if of.is_empty() { of } else { format!(" ({of})") };
    let layer = if choice.layer > 0 { format!(", layer {}", choice.layer) } else { String::new() };
    format!("{} {x}, {y}{layer}: {}{linear}{format}", choice.name, values.join(" "))
}

fn show_heading(ui: &mut Ui, face: &mut Interface, choice: &TargetChoice, info: &TargetInfo) {
    ui.horizontal_wrapped(|ui| {
        if ui.button("Picture").on_hover_text("Back to the finished picture (T)").clicked() {
            face.look_at(None);
        }
        ui.heading(&choice.name);
        let shape = match info.shape {
            TargetShape::Image { width, height, channels, layers } => {
                format!("{width} x {height}, {channels} channels, {layers} layers")
            }
            TargetShape::Table { rows, columns } => format!("{rows} rows of {columns}"),
        };
        ui.weak(format!("{shape}  {}", info.format));
        ui.label(&info.holds);
        let mut changed = choice.clone();
        if let TargetShape::Image { layers, .. } = info.shape
            && layers > 1
        {
            ui.add(egui::Slider::new(&mut changed.layer, 0..=layers - 1).text("layer"));
        }
        if face.session.side_count() > 1 {
            for (side, name) in ["A", "B"].into_iter().enumerate() {
                ui.selectable_value(&mut changed.side, side, name);
            }
        }
        if changed != *choice {
            face.target = Some(changed.clone());
            face.ask(super::protocol::Request::Target(Some(changed)));
        }
    });
}

fn show_controls(ui: &mut Ui, view: &mut TargetView, values: &TargetValues, info: &TargetInfo) -> Drawing {
    let default = if values.channels >= 3 && info.kind != ValueKind::U32 { Channel::Colour } else { Channel::One(0) };
    let mut channel = view.channel.unwrap_or(default);
    let is_whole = matches!(values.kind, ValueKind::U32 | ValueKind::I32);
    let mut ramp = view.ramp.unwrap_or(Ramp::Viridis);
    let mut drawing = None;
    ui.horizontal_wrapped(|ui| {
        let name = |channel: Channel| match channel {
            Channel::Colour => "colour".to_owned(),
            Channel::One(index) if values.channels <= 4 => ["r", "g", "b", "a"][index.min(3)].to_owned(),
            Channel::One(index) => index.to_string(),
        };
        if values.channels > 1 {
            ComboBox::from_label("channel").selected_text(name(channel)).show_ui(ui, |ui| {
                if values.channels >= 3 {
                    ui.selectable_value(&mut channel, Channel::Colour, name(Channel::Colour));
                }
                for index in 0..values.channels as usize {
                    ui.selectable_value(&mut channel, Channel::One(index), name(Channel::One(index)));
                }
            });
        }
        view.channel = Some(channel);
        let of = if let Channel::One(index) = channel { index } else { 0 };
        let statistics = values.statistics.get(of);
        let planes = info.planes.filter(|_| view.is_linear_depth && channel != Channel::Colour);
        let percentiles = match channel {
            Channel::Colour => (0.0, if info.is_srgb { 255.0 } else { 1.0 }),
            Channel::One(_) => {
                let (low, high) = percentile_range(statistics);
                planes.map_or((low, high), |planes| (linear_depth(low, planes), linear_depth(high, planes)))
            }
        };
        let mut range = view.range.unwrap_or(percentiles);
        let speed = ((range.1 - range.0).abs() * 0.005).max(if is_whole { 0.1 } else { 1e-6 });
        let low = ui.add(DragValue::new(&mut range.0).speed(speed).max_decimals(6).prefix("from "));
        let high = ui.add(DragValue::new(&mut range.1).speed(speed).max_decimals(6).prefix("to "));
        if low.changed() || high.changed() {
            view.range = Some(range);
        }
        let reset = ui.small_button("0.1 - 99.9 %");
        if reset.on_hover_text("The range between these percentiles, without what stands for none").clicked() {
            view.range = None;
        }
        if let Some(Statistics { min: Some(min), max: Some(max), .. }) = statistics
            && ui.small_button("all").on_hover_text("From the smallest to the largest value").clicked()
        {
            let end = |value: f64| planes.map_or(value, |planes| linear_depth(value, planes));
            view.range = Some((end(*min), end(*max)));
        }
        ui.add(DragValue::new(&mut view.exposure).range(-20.0..=20.0).speed(0.05).prefix("exposure ").suffix(" stops"));
        if channel != Channel::Colour {
            let combo = ComboBox::from_id_salt("ramp").selected_text(ramp.as_str()).show_ui(ui, |ui| {
                let fitting = Ramp::ALL.into_iter().filter(|ramp| *ramp != Ramp::Labels || is_whole);
                fitting.for_each(|one| drop(ui.selectable_value(&mut ramp, one, one.as_str())));
            });
            combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, "ramp"));
        }
        if let Some([near, far]) = info.planes {
            let linear = ui.checkbox(&mut view.is_linear_depth, "linear depth");
            if linear.on_hover_text(format!("Distance along the view; the planes lie at {near} and {far}")).changed() {
                view.range = None;
            }
        }
        view.ramp = Some(ramp);
        let exposure = view.exposure;
        drawing = Some(Drawing { channel, range, exposure, ramp, linear_between: planes });
    });
    let fallback = Drawing { channel, range: (0.0, 1.0), exposure: 0.0, ramp: Ramp::Grey, linear_between: None };
    drawing.unwrap_or(fallback)
}

fn show_histogram(ui: &mut Ui, view: &mut TargetView, values: &TargetValues, drawing: Drawing) {
    let of = if let Channel::One(index) = drawing.channel { index } else { 0 };
    let Some(statistics) = values.statistics.get(of) else { return };
    ui.horizontal_wrapped(|ui| {
        let (Some(min), Some(max), Some(mean)) = (statistics.min, statistics.max, statistics.mean) else {
            ui.weak("No value counts.");
            return;
        };
        let median = statistics.percentiles.get(3).copied().unwrap_or(mean);
        ui.label(format!("min {min:.5}  median {median:.5}  mean {mean:.5}  max {max:.5}"));
        if statistics.masked > 0 {
            ui.label(format!("{} stand for none", statistics.masked));
        }
        if statistics.not_finite > 0 {
            ui.colored_label(ui.visuals().error_fg_color, format!("{} are not finite", statistics.not_finite));
        }
        ui.checkbox(&mut view.is_logarithmic, "log");
    });
    let (response, painter) = ui.allocate_painter(egui::vec2(ui.available_width(), 42.0), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "histogram"));
    let rect = response.rect;
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let height = |count: u64| if view.is_logarithmic { (count as f64 + 1.0).ln() } else { count as f64 };
    let most = statistics.histogram.iter().map(|&count| height(count)).fold(0.0, f64::max);
    let bins = statistics.histogram.len();
    if most <= 0.0 || bins == 0 {
        return;
    }
    let width = rect.width() / bins as f32;
    for (bin, &count) in statistics.histogram.iter().enumerate() {
        let tall = (height(count) / most) as f32 * rect.height();
        let left = rect.left() + width * bin as f32;
        let bar = Rect::from_min_max(egui::pos2(left, rect.bottom() - tall), egui::pos2(left + width, rect.bottom()));
        painter.rect_filled(bar, 0.0, ui.visuals().weak_text_color());
    }
    if let (Some(min), Some(max)) = (statistics.min, statistics.max)
        && max > min
    {
        let place = |value: f64| rect.left() + ((value - min) / (max - min)).clamp(0.0, 1.0) as f32 * rect.width();
        // The bins are those of the values, and not of distances.
        for end in [drawing.range.0, drawing.range.1].into_iter().filter(|_| drawing.linear_between.is_none()) {
            painter.vline(place(end), rect.y_range(), egui::Stroke::new(1.0, ui.visuals().selection.bg_fill));
        }
        if let Some(pointer) = response.hover_pos() {
            let bin = (((pointer.x - rect.left()) / width) as usize).min(bins - 1);
            let low = min + (max - min) * bin as f64 / bins as f64;
            let high = min + (max - min) * (bin + 1) as f64 / bins as f64;
            response.on_hover_text(format!("{low:.5} to {high:.5}: {} values", statistics.histogram[bin]));
        }
    }
}

/// The number of a table's cell.
pub fn cell(values: &TargetValues, row: u32, column: u32) -> Option<f64> {
    number(values, row as usize * values.width as usize + column as usize)
}

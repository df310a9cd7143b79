//! Two sides: beside each other, under a divider, or their difference.

use egui::{Rect, Sense, Stroke, Ui};

use super::camera;
use super::interface::Interface;
use super::layout::Comparison;
use super::picture_view::{lay, navigate, point, say, show_nothing, texel_at};
use super::pictures::DIFFERENCE;
use super::protocol::Request;

/// In place of a difference.
const SIZES_DIFFER: &str = "The sides' pictures differ in size: they have no difference.";

/// Both sides' pictures.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    show_choice(ui, face);
    let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "pictures"));
    let area = response.rect;
    let (Some(size), Some(second)) = (face.session.picture_size(0), face.session.picture_size(1)) else {
        return show_nothing(ui, face, area);
    };
    let pixels_per_point = ui.ctx().pixels_per_point();
    match face.layout.comparison {
        Comparison::Difference => {
            if face.session.frame.as_ref().is_none_or(|frame| frame.difference.is_none()) {
                let words = if size == second { "The difference comes with the next frame." } else { SIZES_DIFFER };
                return say(ui, area, words);
            }
            navigate(&mut face.picture_view, ui, &response, size, true);
            camera::steer(ui, face, &response);
            let rect = face.picture_view.place(area, size, pixels_per_point);
            lay(&painter, face, DIFFERENCE, rect);
        }
        Comparison::Beside => {
            let middle = area.center().x.round();
            let areas = [area.with_max_x(middle - 2.0), area.with_min_x(middle + 2.0)];
            let one = response.clone().with_new_rect(areas[0]);
            navigate(&mut face.picture_view, ui, &one, size, true);
            camera::steer(ui, face, &response);
            for (side, (area, size)) in areas.into_iter().zip([size, second]).enumerate() {
                let rect = face.picture_view.place(area, size, pixels_per_point);
                lay(&painter.with_clip_rect(area), face, side, rect);
                let is_here = response.hover_pos().is_some_and(|pointer| area.contains(pointer));
                if is_here {
                    point(face, side, &response, rect, size);
                }
            }
        }
        Comparison::Divider => {
            let rect = face.picture_view.place(area, size, pixels_per_point);
            let shown = rect.intersect(area);
            let at = divide(ui, face, shown);
            if !at.is_moved {
                navigate(&mut face.picture_view, ui, &response, size, true);
                camera::steer(ui, face, &response);
            }
            lay(&painter.with_clip_rect(shown.with_max_x(at.x)), face, 0, rect);
            lay(&painter.with_clip_rect(shown.with_min_x(at.x)), face, 1, rect);
            painter.vline(at.x, shown.y_range(), Stroke::new(2.0, ui.visuals().strong_text_color()));
            let side = response.hover_pos().map_or(0, |pointer| usize::from(pointer.x >= at.x));
            point(face, side, &response, rect, if side == 0 { size } else { second });
        }
    }
    if let Some(pointer) = response.hover_pos()
        && face.layout.comparison == Comparison::Difference
    {
        let rect = face.picture_view.place(area, size, pixels_per_point);
        if let Some((x, y)) = texel_at(rect, size, pointer) {
            face.pointed = both(face, x, y).unwrap_or_default();
        }
    }
}

/// Place of the divider, and whether it is being moved.
struct Divider {
    x: f32,
    is_moved: bool,
}

fn divide(ui: &Ui, face: &mut Interface, shown: Rect) -> Divider {
    let fraction = face.picture_view.divider.unwrap_or(0.5);
    let x = shown.left() + shown.width() * fraction;
    let handle = Rect::from_x_y_ranges(x - 5.0..=x + 5.0, shown.y_range());
    let response = ui.interact(handle, ui.id().with("divider"), Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, "divider"));
    let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    // Where the pointer is, also where its last move comes with its release: steps that are added up lose that one.
    if (response.dragged() || response.drag_stopped())
        && shown.width() > 0.0
        && let Some(pointer) = response.interact_pointer_pos()
    {
        face.picture_view.divider = Some(((pointer.x - shown.left()) / shown.width()).clamp(0.0, 1.0));
    }
    let fraction = face.picture_view.divider.unwrap_or(0.5);
    Divider { x: shown.left() + shown.width() * fraction, is_moved: response.dragged() }
}

/// Values of both sides at a pixel.
fn both(face: &Interface, x: u32, y: u32) -> Option<String> {
    let frame = face.session.frame.as_ref()?;
    let of = |side: usize| {
        let picture = frame.sides.get(side)?.picture.as_ref()?;
        let at = (y as usize * picture.width as usize + x as usize) * 4;
        let pixel = picture.block.bytes.get(at..at + 3)?;
        Some(format!("{} {} {}", pixel[0], pixel[1], pixel[2]))
    };
    Some(format!("pixel {x}, {y}: {} | {} (8-bit sRGB)", of(0)?, of(1)?))
}

/// Choice between the ways to show both sides, and their distance.
fn show_choice(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal(|ui| {
        let choices = [
            (Comparison::Beside, "Side by side"),
            (Comparison::Divider, "Divider"),
            (Comparison::Difference, "Difference"),
        ];
        for (comparison, name) in choices {
            if ui.selectable_label(face.layout.comparison == comparison, name).clicked() {
                choose(face, comparison);
            }
        }
        if let Some(difference) = face.session.frame.as_ref().and_then(|frame| frame.difference.as_ref()) {
            let text = format!(
                "CIE L*u*v*: mean {:.3}, 99th percentile {:.3}, largest {:.3}",
                difference.mean, difference.p99, difference.max
            );
            ui.label(text).on_hover_text("Black where the sides agree, through red and yellow to white at the largest");
        }
    });
}

/// Shows the sides in that way.
pub fn choose(face: &mut Interface, comparison: Comparison) {
    face.layout.comparison = comparison;
    face.ask(Request::Difference(comparison == Comparison::Difference));
}

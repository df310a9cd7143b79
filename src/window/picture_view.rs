//! The picture in the middle: one texel of it on one pixel of the screen unless the user says otherwise, zoomed and panned;
//! the camera follows the pointer.

use egui::{Pos2, Rect, Response, Sense, Ui, Vec2};

use super::camera;
use super::interface::Interface;
use super::pictures::{DIFFERENCE, small_size};

/// Zoom and pan of the picture, the same for both sides.
#[derive(Debug, Clone, Default)]
pub struct PictureView {
    /// Pixels of the screen for a texel; `None` for as many as fit, and at most one.
    pub zoom: Option<f32>,
    /// From the middle of the area to the middle of the picture, pixels of the screen.
    pub pan_px: Vec2,
    /// Place of the divider between two sides, 0 to 1.
    pub divider: Option<f32>,
}

/// Least and largest zoom.
const ZOOMS: (f32, f32) = (1.0 / 16.0, 64.0);

impl PictureView {
    /// Pixels of the screen for a texel of a picture of `size` in an area.
    pub fn scale(&self, area_px: Vec2, size: Vec2) -> f32 {
        let fits = (area_px.x / size.x).min(area_px.y / size.y).clamp(ZOOMS.0, 1.0);
        self.zoom.unwrap_or(fits)
    }

    /// The picture's rectangle in `area`, in points; its corner lies on a whole pixel, and of one that is smaller than it is
    /// the sides do as well.
    pub fn place(&self, area: Rect, size: Vec2, pixels_per_point: f32) -> Rect {
        let scale = self.scale(area.size() * pixels_per_point, size);
        let shown = if scale < 1.0 { (size * scale).round().max(Vec2::splat(1.0)) } else { size * scale };
        let corner = area.center().to_vec2() * pixels_per_point + self.pan_px - shown * 0.5;
        let corner = Vec2::new(corner.x.round(), corner.y.round());
        Rect::from_min_size((corner / pixels_per_point).to_pos2(), shown / pixels_per_point)
    }

    /// Zooms by `factor` so that what lies under `at` stays there.
    pub fn zoom_at(&mut self, factor: f32, at: Pos2, area: Rect, size: Vec2, pixels_per_point: f32) {
        let old = self.scale(area.size() * pixels_per_point, size);
        let new = (old * factor).clamp(ZOOMS.0, ZOOMS.1);
        let from_middle = (at - area.center()) * pixels_per_point;
        self.pan_px = from_middle - (from_middle - self.pan_px) * (new / old);
        self.zoom = Some(new);
    }

    /// As at first.
    pub fn reset(&mut self) {
        *self = PictureView { divider: self.divider, ..PictureView::default() };
    }
}

/// The texel under the pointer.
pub fn texel_at(rect: Rect, size: Vec2, pointer: Pos2) -> Option<(u32, u32)> {
    let at = (pointer - rect.min) / rect.size() * size;
    let is_inside = at.x >= 0.0 && at.y >= 0.0 && at.x < size.x && at.y < size.y;
    is_inside.then_some((at.x as u32, at.y as u32))
}

/// Wheel and drags that move the picture: with Ctrl or the middle button, or, for what has no camera, any.
pub fn navigate(view: &mut PictureView, ui: &Ui, response: &Response, size: Vec2, has_camera: bool) {
    let (ctrl, wheel, pinch) =
        ui.input(|input| (input.modifiers.command, input.smooth_scroll_delta.y, input.zoom_delta()));
    let pixels_per_point = ui.ctx().pixels_per_point();
    let moves = response.dragged_by(egui::PointerButton::Middle)
        || response.dragged_by(egui::PointerButton::Primary) && (ctrl || !has_camera);
    if moves {
        view.pan_px += response.drag_delta() * pixels_per_point;
    }
    let Some(pointer) = response.hover_pos() else { return };
    // With Ctrl the wheel is a pinch.
    let factor = if pinch != 1.0 {
        pinch
    } else if has_camera {
        1.0
    } else {
        (wheel * 0.005).exp()
    };
    if factor != 1.0 {
        view.zoom_at(factor, pointer, response.rect, size, pixels_per_point);
    }
}

/// The one side's picture.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, "picture"));
    let area = response.rect;
    let Some(size) = face.session.picture_size(0) else {
        return show_nothing(ui, face, area);
    };
    navigate(&mut face.picture_view, ui, &response, size, true);
    camera::steer(ui, face, &response);
    let rect = face.picture_view.place(area, size, ui.ctx().pixels_per_point());
    lay(&painter, face, 0, rect);
    point(face, 0, &response, rect, size);
}

/// Draws a side's picture, or the difference, into a rectangle.
pub fn lay(painter: &egui::Painter, face: &mut Interface, index: usize, rect: Rect) {
    // A difference is as large as both sides.
    let side = if index == DIFFERENCE { 0 } else { index };
    let Some(size) = face.session.picture_size(side) else { return };
    let shown = small_size(rect.size(), painter.pixels_per_point(), size);
    if let Some(texture) = face.pictures.shown(index, shown) {
        paint(painter, texture, rect);
    }
}

/// Draws a texture into a rectangle.
pub fn paint(painter: &egui::Painter, texture: &egui::TextureHandle, rect: Rect) {
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture.id(), rect, whole, egui::Color32::WHITE);
}

/// Says what lies under the pointer in a side's picture.
pub fn point(face: &mut Interface, side: usize, response: &Response, rect: Rect, size: Vec2) {
    let Some((x, y)) = response.hover_pos().and_then(|pointer| texel_at(rect, size, pointer)) else { return };
    let picture = face.session.frame.as_ref().and_then(|frame| frame.sides.get(side)?.picture.as_ref());
    let at = (y as usize * size.x as usize + x as usize) * 4;
    let Some([red, green, blue]) = picture.and_then(|p| p.block.bytes.get(at..at + 3)?.first_chunk::<3>().copied())
    else {
        return;
    };
    face.pointed = format!("pixel {x}, {y}: {red} {green} {blue} (8-bit sRGB)");
}

/// In place of a picture that is not there yet.
pub fn show_nothing(ui: &Ui, face: &Interface, area: Rect) {
    let words = if face.session.ended.is_some() {
        ""
    } else if face.session.frame.is_some() {
        "No pass so far has written the picture."
    } else if face.session.built.is_some() {
        "The first frame is being drawn."
    } else {
        "Loading and building."
    };
    say(ui, area, words);
}

/// Words in the middle of an area.
pub fn say(ui: &Ui, area: Rect, words: &str) {
    let (font, color) = (egui::TextStyle::Heading.resolve(ui.style()), ui.visuals().weak_text_color());
    let galley = ui.painter().layout(words.to_owned(), font, color, area.width());
    ui.painter().galley(area.center() - galley.size() / 2.0, galley, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area() -> Rect {
        Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(500.0, 300.0))
    }

    #[test]
    fn a_picture_that_fits_has_one_pixel_for_a_texel_on_whole_pixels() {
        let view = PictureView::default();
        for pixels_per_point in [1.0, 1.25, 1.5, 2.0] {
            let size = Vec2::new(301.0, 201.0);
            let rect = view.place(area(), size, pixels_per_point);
            let corner = rect.min.to_vec2() * pixels_per_point;
            assert!((corner - Vec2::new(corner.x.round(), corner.y.round())).length() < 1e-3, "{corner:?}");
            assert!((rect.size() * pixels_per_point - size).length() < 1e-2, "{rect:?}");
        }
    }

    #[test]
    fn a_picture_that_is_too_large_is_made_to_fit() {
        let rect = PictureView::default().place(area(), Vec2::new(1000.0, 300.0), 1.0);
        assert_eq!(rect.size(), Vec2::new(500.0, 150.0));
    }

    #[test]
    fn zooming_keeps_what_lies_under_the_pointer() {
        let (size, pointer) = (Vec2::new(400.0, 200.0), Pos2::new(130.0, 90.0));
        let mut view = PictureView::default();
        let before = texel_at(view.place(area(), size, 1.0), size, pointer).expect("inside");
        for _ in 0..5 {
            view.zoom_at(1.3, pointer, area(), size, 1.0);
        }
        let after = texel_at(view.place(area(), size, 1.0), size, pointer).expect("inside");
        assert!(before.0.abs_diff(after.0) <= 1 && before.1.abs_diff(after.1) <= 1, "{before:?} {after:?}");
        view.zoom_at(1e9, pointer, area(), size, 1.0);
        assert_eq!(view.zoom, Some(ZOOMS.1));
    }

    #[test]
    fn texels_outside_are_none() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(10.0, 10.0));
        let size = Vec2::new(5.0, 5.0);
        assert_eq!(texel_at(rect, size, Pos2::new(9.9, 0.0)), Some((4, 0)));
        assert_eq!(texel_at(rect, size, Pos2::new(10.0, 0.0)), None);
        assert_eq!(texel_at(rect, size, Pos2::new(-0.1, 0.0)), None);
    }
}

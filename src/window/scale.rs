//! The display's scale where the window learns of it late.

use egui::{Event, RawInput, ViewportId};

/// Has the input be that of a display whose scale is `told`, while the window `known` it by another: under X11, one of
/// winit 0.30 knows of a new scale when it is moved, and no sooner.
pub fn correct(input: &mut RawInput, told: f64, known: f64) {
    let ratio = (known / told) as f32;
    if told == known || !ratio.is_normal() {
        return;
    }
    input.screen_rect = input.screen_rect.map(|rect| rect * ratio);
    input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(told as f32);
    for event in &mut input.events {
        if let Event::PointerMoved(pos) | Event::PointerButton { pos, .. } | Event::Touch { pos, .. } = event {
            *pos *= ratio;
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::{Pos2, Rect, Vec2};

    use super::*;

    #[test]
    fn a_larger_scale_makes_fewer_points() {
        let at = |x: f32, y: f32| Event::PointerMoved(Pos2::new(x, y));
        let input = || RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(1000.0, 800.0))),
            events: vec![at(500.0, 200.0), Event::Copy],
            ..RawInput::default()
        };
        let mut corrected = input();
        correct(&mut corrected, 1.25, 1.0);
        assert_eq!(corrected.screen_rect.map(|rect| rect.size()), Some(Vec2::new(800.0, 640.0)));
        assert_eq!(corrected.events, [at(400.0, 160.0), Event::Copy]);
        assert_eq!(corrected.viewports[&ViewportId::ROOT].native_pixels_per_point, Some(1.25));
        let mut left = input();
        correct(&mut left, 1.25, 1.25);
        assert_eq!((left.screen_rect, left.events), (input().screen_rect, input().events));
    }
}

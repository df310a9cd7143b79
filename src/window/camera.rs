//! The camera under the user's hand: orbit, pan, dolly, fly. A move is one value of the paper's parameter `camera`.

use egui::{Key, PointerButton, Response, Ui, Vec2};
use glam::DVec3;

use super::interface::Interface;
use super::session::CAMERA;

/// Radians for a point that the pointer is dragged.
const ORBIT_RAD: f64 = 0.008;
/// Nearest that the view comes to straight up or down, radians.
const LEAST_POLAR_RAD: f64 = 0.02;

/// Eye and target; +Y is up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Position of the camera, in the scene's unit of length.
    pub eye: DVec3,
    /// Point in the middle of the picture, in the scene's unit of length.
    pub target: DVec3,
}

/// The camera as far as it is known while it moves: the worker's own follows late.
#[derive(Debug, Clone, Default)]
pub struct Flight {
    view: Option<View>,
    /// The text of the field, while it is typed in.
    pub text: Option<String>,
}

impl View {
    fn from_numbers(numbers: [f64; 6]) -> Self {
        let [a, b, c, d, e, f] = numbers;
        View { eye: DVec3::new(a, b, c), target: DVec3::new(d, e, f) }
    }

    /// The view of a text of six numbers; `None` of any other.
    fn parse(text: &str) -> Option<Self> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers?.try_into().ok().map(Self::from_numbers)
    }

    /// As the parameter takes it.
    pub fn text(&self) -> String {
        let numbers = [self.eye, self.target].into_iter().flat_map(|place| place.to_array());
        numbers
            .map(|number| format!("{:.6}", number).trim_end_matches('0').trim_end_matches('.').to_owned())
            .collect::<Vec<_>>()
            .join(",")
    }

    fn distance(&self) -> f64 {
        (self.eye - self.target).length()
    }

    /// Around the target, `to_right` and `up` radians.
    pub fn orbit(self, to_right: f64, up: f64) -> Self {
        let from_target = self.eye - self.target;
        let distance = from_target.length();
        let azimuth = from_target.x.atan2(from_target.z) + to_right;
        let polar = (from_target.y / distance).clamp(-1.0, 1.0).acos() - up;
        let polar = polar.clamp(LEAST_POLAR_RAD, std::f64::consts::PI - LEAST_POLAR_RAD);
        let direction = DVec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos());
        View { eye: self.target + direction * distance, ..self }
    }

    fn axes(&self) -> [DVec3; 3] {
        let forward = (self.target - self.eye).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
        [right, right.cross(forward), forward]
    }

    /// Eye and target together, in shares of their distance.
    pub fn pan(self, to_right: f64, up: f64) -> Self {
        let [right, upwards, _] = self.axes();
        let by = (right * to_right + upwards * up) * self.distance();
        View { eye: self.eye + by, target: self.target + by }
    }

    /// Nearer to the target: the distance times `factor`.
    pub fn dolly(self, factor: f64) -> Self {
        View { eye: self.target + (self.eye - self.target) * factor, ..self }
    }

    /// Eye and target together, forward and to the right, in shares of their distance.
    pub fn fly(self, forward: f64, to_right: f64, up: f64) -> Self {
        let [right, _, ahead] = self.axes();
        let by = (ahead * forward + right * to_right + DVec3::Y * up) * self.distance();
        View { eye: self.eye + by, target: self.target + by }
    }
}

/// The camera as the user has it; `None` while only the worker knows, as between a reset to one that it has not told and its
/// answer.
fn view(face: &Interface) -> Option<View> {
    if face.sent.is_underway(CAMERA) {
        return face.flight.view;
    }
    face.session.side(0)?.camera.map(View::from_numbers)
}

/// Moves the camera; nothing happens for a paper without one.
pub fn change(face: &mut Interface, change: impl FnOnce(View) -> View) {
    let Some(view) = view(face) else { return };
    if face.session.parameter(CAMERA).is_none() {
        return;
    }
    let moved = change(view);
    let is_finite = moved.eye.is_finite() && moved.target.is_finite() && moved.distance() > 1e-9;
    if is_finite && moved != view {
        face.flight.view = Some(moved);
        face.set(CAMERA, vec![moved.text()]);
    }
}

/// Back to the figure's camera.
pub fn reset(face: &mut Interface) {
    // What moves it before the worker has answered moves that one, and not the one that was left.
    face.flight = Flight { view: face.session.home.map(View::from_numbers), text: None };
    if face.session.parameter(CAMERA).is_some() {
        face.set(CAMERA, Vec::new());
    }
}

/// Pointer and wheel over a picture.
pub fn steer(ui: &Ui, face: &mut Interface, response: &Response) {
    // A turn of the wheel is done at once: what is smoothed goes on for some frames, in which another camera may be there.
    let (ctrl, shift, wheel) =
        ui.input(|input| (input.modifiers.command, input.modifiers.shift, input.raw_scroll_delta));
    let drag = response.drag_delta();
    let pans = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Primary) && shift;
    if drag != Vec2::ZERO && pans {
        let height = f64::from(response.rect.height().max(1.0));
        change(face, |view| view.pan(-f64::from(drag.x) / height, f64::from(drag.y) / height));
    } else if drag != Vec2::ZERO && response.dragged_by(PointerButton::Primary) && !ctrl {
        change(face, |view| view.orbit(-f64::from(drag.x) * ORBIT_RAD, f64::from(drag.y) * ORBIT_RAD));
    }
    if response.hovered() && wheel.y != 0.0 && !ctrl {
        change(face, |view| view.dolly((-f64::from(wheel.y) * 0.004).exp()));
    }
}

/// Keys that are held: W, A, S, D, Q, E fly; arrows orbit; Page up and down dolly.
pub fn steer_by_keys(ui: &egui::Context, face: &mut Interface) {
    let (held, seconds) = ui.input(|input| {
        let is_plain = input.modifiers.is_none() || input.modifiers.shift_only();
        let axis = |more: Key, less: Key| {
            f64::from(u8::from(input.key_down(more))) - f64::from(u8::from(input.key_down(less)))
        };
        let speed = if input.modifiers.shift { 4.0 } else { 1.0 };
        let held = [
            axis(Key::W, Key::S),
            axis(Key::D, Key::A),
            axis(Key::E, Key::Q),
            axis(Key::ArrowRight, Key::ArrowLeft),
            axis(Key::ArrowUp, Key::ArrowDown),
            axis(Key::PageDown, Key::PageUp),
        ];
        (held.map(|axis| if is_plain { axis * speed } else { 0.0 }), f64::from(input.stable_dt.min(0.1)))
    });
    if held.iter().all(|axis| *axis == 0.0) {
        return;
    }
    let [forward, to_right, up, around, over, away] = held.map(|axis| axis * seconds * 0.6);
    change(face, |view| view.fly(forward, to_right, up).orbit(around * 2.0, over * 2.0).dolly((away * 2.0).exp()));
    ui.request_repaint();
}

/// The camera as fields: typed in, or set back.
pub fn show_field(ui: &mut Ui, face: &mut Interface) {
    if face.session.parameter(CAMERA).is_none() {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("Camera").on_hover_text("Eye x,y,z and target x,y,z. Drag the picture to orbit, right button to pan, wheel to dolly; W A S D Q E fly.");
        if ui.small_button("Reset").on_hover_text("The figure's own camera (R)").clicked() {
            reset(face);
        }
    });
    let told = || face.session.side(0)?.camera.map(View::from_numbers);
    let known = view(face).or_else(told).map(|view| view.text()).unwrap_or_default();
    let mut text = face.flight.text.clone().unwrap_or(known);
    let field =
        ui.add(egui::TextEdit::singleline(&mut text).desired_width(f32::INFINITY).font(egui::TextStyle::Monospace));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "camera"));
    if field.changed() {
        face.flight.text = Some(text.clone());
    }
    if field.lost_focus() && face.flight.text.take().is_some() {
        face.flight.view = View::parse(&text);
        face.set(CAMERA, vec![text.trim().to_owned()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View { eye: DVec3::new(3.0, 4.0, 5.0), target: DVec3::new(1.0, 0.5, -2.0) }
    }

    #[test]
    fn an_orbit_keeps_distance_and_target_and_comes_round() {
        let turned = view().orbit(1.0, 0.3);
        assert_eq!(turned.target, view().target);
        assert!((turned.distance() - view().distance()).abs() < 1e-12);
        let round = (0..8).fold(view(), |view, _| view.orbit(std::f64::consts::FRAC_PI_4, 0.0));
        assert!((round.eye - view().eye).length() < 1e-9);
        assert!(view().orbit(0.0, 100.0).eye.is_finite());
    }

    #[test]
    fn a_pan_is_across_the_view_and_a_dolly_along_it() {
        let along = view().target - view().eye;
        let moved = view().pan(0.3, -0.2).eye - view().eye;
        assert!(moved.dot(along).abs() < 1e-9 && moved.length() > 1.0);
        let nearer = view().dolly(0.5);
        assert!((nearer.distance() * 2.0 - view().distance()).abs() < 1e-12);
        let ahead = view().fly(0.1, 0.0, 0.0);
        assert!(((ahead.eye - view().eye) - along * 0.1).length() < 1e-9);
    }

    #[test]
    fn looking_straight_down_has_a_way_out() {
        let down = View { eye: DVec3::Y * 3.0, target: DVec3::ZERO };
        for moved in [down.orbit(0.1, -0.1), down.pan(0.1, 0.1), down.fly(0.1, 0.1, 0.1)] {
            assert!(moved.eye.is_finite() && moved != down, "{moved:?}");
        }
    }

    #[test]
    fn the_text_is_what_the_parameter_takes() {
        let view = View { eye: DVec3::new(1.0, -2.5, 0.000_000_1), target: DVec3::new(0.0, 100.0, 3.25) };
        assert_eq!(view.text(), "1,-2.5,0,0,100,3.25");
        assert_eq!(View::parse(&view.text()), Some(View { eye: DVec3::new(1.0, -2.5, 0.0), ..view }));
        assert_eq!(View::parse("1,2,3"), None);
    }
}

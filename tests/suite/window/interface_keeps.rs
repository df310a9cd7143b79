//! Files that the drawer keeps, and its plots.

use egui_kittest::kittest::Queryable;
use fumarole::window::protocol::{Keep, Request};

use super::interface::{asked, frame, harness};

#[test]
fn what_is_kept_is_named_by_what_it_is() {
    let mut harness = harness();
    harness.get_by_label("Keep").click();
    asked(&mut harness);
    let file = |what: &str| format!("fumarole-out/caustics-level-map-0007-{what}");
    harness.get_by_label("Save picture").click();
    let picture = Keep::Picture { side: 0, file: file("picture.png") };
    assert_eq!(asked(&mut harness), [Request::Keep(picture.clone())]);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    assert_eq!(asked(&mut harness), [Request::Keep(picture)]);
    harness.get_by_label("Contact sheet").click();
    assert_eq!(asked(&mut harness), [Request::Keep(Keep::ContactSheet { side: 0, file: file("targets.png") })]);
    harness.get_by_label("Save film").click();
    let film = Keep::Film { side: 0, first: 0, end: 30, file: file("film.y4m") };
    assert_eq!(asked(&mut harness), [Request::Keep(film)]);
    // A target, once one is looked at.
    assert!(harness.query_by_label("Save target-1").is_none());
    harness.get_by_label("caustics-map").click();
    asked(&mut harness);
    harness.get_by_label("npy").click();
    harness.get_by_label("Save target-1").click();
    let target = Keep::Target { side: 0, name: "target-1".into(), file: file("target-1.npy") };
    assert_eq!(asked(&mut harness), [Request::Keep(target)]);
}

/// Text of the plot's scale, the largest time that it shows.
fn shows(harness: &egui_kittest::Harness<'_, fumarole::window::interface::Interface>, text: &str) -> bool {
    fn holds(shape: &egui::Shape, text: &str) -> bool {
        match shape {
            egui::Shape::Text(words) => words.galley.text() == text,
            egui::Shape::Vec(shapes) => shapes.iter().any(|shape| holds(shape, text)),
            _ => false,
        }
    }
    harness.output().shapes.iter().any(|clipped| holds(&clipped.shape, text))
}

#[test]
fn plots_that_are_held_stay_as_they_are() {
    let mut harness = harness();
    let slow = |ms: f64| {
        let fumarole::window::protocol::Event::Frame(mut slow) = frame(8, 1) else { unreachable!() };
        slow.sides[0].frame_ms = ms;
        fumarole::window::protocol::Event::Frame(slow)
    };
    harness.state_mut().take(slow(50.0));
    // Lines move by columns of time, of which one is to pass.
    std::thread::sleep(std::time::Duration::from_millis(600));
    harness.run();
    assert!(shows(&harness, "50.00 ms"), "the plot has another scale");
    harness.get_by_label("Hold").click();
    harness.run();
    harness.state_mut().take(slow(99.0));
    std::thread::sleep(std::time::Duration::from_millis(600));
    harness.run();
    assert!(shows(&harness, "50.00 ms"), "it went on");
    harness.get_by_label("Hold").click();
    harness.run();
    assert!(shows(&harness, "99.00 ms"), "it did not go on");
}

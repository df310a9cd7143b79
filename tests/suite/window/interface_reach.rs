//! Reach of the controls by Tab, and the columns of times of two sides.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use fumarole::window::interface::Interface;
use fumarole::window::protocol::{Event, PassTimes, Request, SideTimes};

use super::interface::{asked, built, frame, harness, setup};

/// Roles of what a user presses, changes or types into.
const CONTROLS: [egui::accesskit::Role; 7] = {
    use egui::accesskit::Role;
    [Role::Button, Role::CheckBox, Role::RadioButton, Role::ComboBox, Role::Slider, Role::SpinButton, Role::TextInput]
};

#[test]
fn every_control_is_reached_by_tab_and_pressed_by_keys() {
    let mut harness = harness();
    // With the facts and the targets of a pass.
    harness.get_by_label("caustics-map").click();
    harness.run();
    let is_control = |node: &egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        CONTROLS.contains(&node.role()) && !node.is_disabled()
    };
    let controls = harness.root().children_recursive().filter(is_control);
    let mut left: Vec<_> = controls.map(|node| (node.accesskit_node().id(), format!("{node:?}"))).collect();
    let count = left.len();
    assert!(count > 40, "{count} controls are not the window's");
    let mut presses = 0;
    while !left.is_empty() && presses < 2 * count {
        harness.key_press(egui::Key::Tab);
        // A cursor that blinks draws on and on.
        harness.run_steps(2);
        presses += 1;
        let focused = harness.root().children_recursive().find(|node| node.accesskit_node().is_focused());
        let focused = focused.map(|node| node.accesskit_node().id());
        left.retain(|(id, _)| Some(*id) != focused);
    }
    assert!(left.is_empty(), "{presses} presses of Tab do not reach {left:#?}");

    harness.state_mut().wishes();
    for key in [egui::Key::Enter, egui::Key::Space] {
        harness.get_by_label(">").focus();
        harness.run_steps(2);
        harness.key_press(key);
        assert_eq!(asked(&mut harness), [Request::Step(1)], "{key:?}");
    }
}

/// Text of the labels that begin where the head of a column does, in the row of a pass.
fn cell(harness: &Harness<'_, Interface>, head: &str, pass: &str) -> Vec<String> {
    let place = |label: &str| harness.query_all_by_label(label).next().unwrap_or_else(|| panic!("no {label}")).rect();
    let (column, row) = (place(head), place(pass));
    let root = harness.root();
    let inside = root.children_recursive().filter(|node| {
        if !node.accesskit_node().has_bounds() {
            return false;
        }
        let rect = node.rect();
        (rect.left() - column.left()).abs() < 1.0 && row.y_range().contains(rect.center().y)
    });
    let text = inside.filter_map(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value()));
    let mut text: Vec<_> = text.map(|text| text.trim().to_owned()).filter(|text| !text.is_empty()).collect();
    // A label and the run of letters in it are a node each.
    text.dedup();
    text
}

#[test]
fn two_sides_have_a_column_of_times_each() {
    let mut harness = harness();
    let Event::Built(mut both) = built(2) else { unreachable!() };
    both.sides[1].passes[2].name = "accumulate".into();
    let of = |name: &str, gpu_ms: f64, host_ms: Option<f64>| PassTimes {
        name: name.into(),
        gpu_ms: Some(gpu_ms),
        host_ms,
        ..PassTimes::default()
    };
    let side = |passes: [PassTimes; 3]| SideTimes { samples: 9, frame_ms: Some(20.0), passes: passes.to_vec() };
    let a = [of("water-surface", 0.75, Some(0.5)), of("caustics-map", 2.0, None), of("combine", 3.0, None)];
    let b = [of("water-surface", 1.5, None), of("caustics-map", 2.25, Some(0.25)), of("accumulate", 4.125, None)];
    let times = Event::Times(vec![side(a), side(b)]);
    for event in [setup(&["level-map", "volumetric"]), Event::Built(both), frame(7, 2), times] {
        harness.state_mut().take(event);
    }
    harness.run();
    for (pass, a, b) in [
        ("water-surface", Some("1.250"), Some("1.500")),
        ("caustics-map", Some("2.000"), Some("2.500")),
        ("combine", Some("3.000"), None),
        ("accumulate", None, Some("4.125")),
    ] {
        for (head, text) in [("A ms", a), ("B ms", b)] {
            assert_eq!(cell(&harness, head, pass), Vec::from_iter(text), "{pass} under {head}");
        }
    }
}

//! The interface between what is asked for and what the worker answers.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use fumarole::window::interface::Interface;
use fumarole::window::layout::Layout;
use fumarole::window::protocol::{
    Assignment, Event, Frame, MeasureChoice, Progress, Request, Setup, TargetChoice, Work,
};

use super::interface::{asked, built, distance, frame, harness, is_a_notch_nearer, press, ready, setup, turn_wheel};

/// A worker that draws a long frame answers late: what was asked for is seen at once, until the worker says what is.
#[test]
fn what_is_asked_for_is_shown_before_it_is_there() {
    let mut harness = harness();
    let is_on = |harness: &Harness<'_, Interface>| {
        let floor = harness.get_by_label("floor");
        floor.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    harness.get_by_label("floor").click();
    harness.get_by_label("Play").click();
    assert_eq!(asked(&mut harness).len(), 2);
    harness.state_mut().has_sent(5);
    for heeds in [4, 5] {
        let Event::Setup(earlier) = setup(&["level-map"]) else { unreachable!() };
        harness.state_mut().take(Event::Setup(Setup { heeds, ..earlier }));
        let Event::Frame(shown) = frame(7, 1) else { unreachable!() };
        harness.state_mut().take(Event::Frame(Box::new(Frame { heeds, ..*shown })));
        harness.run();
        assert_eq!(is_on(&harness), heeds < 5, "the flag when request {heeds} was heeded");
        let button = if heeds < 5 { "Pause" } else { "Play" };
        assert!(harness.query_by_label(button).is_some(), "no {button} when request {heeds} was heeded");
    }
}

#[test]
fn what_moves_before_the_worker_answers_moves_the_camera_of_the_figure() {
    let mut harness = harness();
    let Event::Setup(mut moved) = setup(&["level-map"]) else { unreachable!() };
    (moved.sides[0].camera, moved.sides[0].set) = (Some([0.0, 0.1, 0.5, 0.0, 0.0, 0.0]), vec!["camera".into()]);
    harness.state_mut().take(Event::Setup(moved));
    press(&mut harness, egui::Key::R);
    turn_wheel(&mut harness);
    let nearer = distance(&asked(&mut harness));
    assert!(is_a_notch_nearer(nearer), "{nearer}: of the camera that was left");
}

#[test]
fn a_window_that_begins_with_a_typed_camera_waits_for_the_one_of_the_figure() {
    let typed = || {
        let Event::Setup(mut typed) = setup(&["level-map"]) else { unreachable!() };
        (typed.sides[0].camera, typed.sides[0].set) = (Some([0.0, 0.1, 0.5, 0.0, 0.0, 0.0]), vec!["camera".into()]);
        typed
    };
    let mut face = Interface::new(&egui::Context::default(), vec!["caustics"], "caustics", Layout::default());
    for event in [ready(), Event::Setup(typed()), built(1), frame(7, 1)] {
        face.take(event);
    }
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1600.0, 1000.0))
        .build_state(|context, face: &mut Interface| face.show(context), face);
    asked(&mut harness);
    let back = Request::Set(vec![Assignment { name: "camera".into(), values: vec![] }]);
    assert_eq!(press(&mut harness, egui::Key::R), std::slice::from_ref(&back));
    harness.state_mut().has_sent(9);
    turn_wheel(&mut harness);
    assert_eq!(asked(&mut harness), [], "it moves the camera that was left");
    // The worker tells it, and from then on it is known.
    let Event::Setup(figure) = setup(&["level-map"]) else { unreachable!() };
    harness.state_mut().take(Event::Setup(Setup { heeds: 9, ..figure }));
    turn_wheel(&mut harness);
    assert!(is_a_notch_nearer(distance(&asked(&mut harness))));
    harness.state_mut().has_sent(10);
    harness.state_mut().take(Event::Setup(Setup { heeds: 10, ..typed() }));
    assert_eq!(press(&mut harness, egui::Key::R), std::slice::from_ref(&back));
    turn_wheel(&mut harness);
    assert!(is_a_notch_nearer(distance(&asked(&mut harness))), "the figure's camera is forgotten");
    // Another water may have another.
    harness.state_mut().has_sent(11);
    let mut other = typed();
    (other.heeds, other.sides[0].values[2]) = (11, "storm".into());
    harness.state_mut().take(Event::Setup(other));
    assert_eq!(press(&mut harness, egui::Key::R), [back]);
    turn_wheel(&mut harness);
    assert_eq!(asked(&mut harness), [], "it moves the camera of other water");
}

#[test]
fn times_that_are_given_up_are_ticked_no_more() {
    let mut harness = harness();
    press(&mut harness, egui::Key::M);
    press(&mut harness, egui::Key::K);
    let ticked = |harness: &Harness<'_, Interface>| {
        let is_on = |label: &str| {
            harness.get_by_label(label).accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
        };
        [is_on("times"), is_on("counters")]
    };
    assert_eq!(ticked(&harness), [true, true]);
    harness.state_mut().take(Event::Measuring(MeasureChoice::default()));
    harness.run();
    assert_eq!(ticked(&harness), [false, false]);
    // And a press asks for them again.
    let times = Layout::default().samples;
    assert_eq!(press(&mut harness, egui::Key::M), [Request::Measure(MeasureChoice { times, counters: false })]);
}

#[test]
fn the_panels_wait_for_nothing_but_pictures_and_numbers_that_go_on() {
    let mut harness = harness();
    let playing = |number: u32, sides: usize| {
        let Event::Frame(shown) = frame(number, sides) else { unreachable!() };
        Event::Frame(Box::new(Frame { is_playing: true, ..*shown }))
    };
    let face = harness.state_mut();
    assert!(face.is_going_on(&playing(8, 1)));
    assert!(!face.is_going_on(&frame(8, 1)), "it stands");
    assert!(!face.is_going_on(&playing(8, 2)), "another side");
    let Event::Frame(mut large) = playing(8, 1) else { unreachable!() };
    large.sides[0].picture.iter_mut().for_each(|picture| (picture.width, picture.height) = (4, 8));
    assert!(!face.is_going_on(&Event::Frame(large)), "another size");
    let replay = |done: u64| Event::Progress(Progress { what: Work::Replay, done, total: 9 });
    assert!(!face.is_going_on(&replay(1)), "it has just begun");
    face.take(replay(1));
    assert!(face.is_going_on(&replay(2)) && !face.is_going_on(&replay(9)));
    for event in [built(1), setup(&["level-map"]), Event::Warning("a doubt".into())] {
        assert!(!face.is_going_on(&event), "{event:?}");
    }
    // A target is drawn with the panels round it.
    harness.get_by_label("caustics-map").click();
    let requests = asked(&mut harness);
    let choice = TargetChoice { side: 0, name: "target-1".into(), layer: 0, first_row: 0 };
    assert!(requests.contains(&Request::Target(Some(choice.clone()))), "{requests:?}");
    let Event::Frame(mut with_target) = playing(8, 1) else { unreachable!() };
    with_target.target = Some(fumarole::window::protocol::TargetValues {
        choice,
        kind: fumarole::window::protocol::ValueKind::F32,
        width: 0,
        height: 0,
        channels: 1,
        block: Default::default(),
        statistics: Vec::new(),
        is_written: true,
    });
    assert!(!harness.state_mut().is_going_on(&Event::Frame(with_target)));
}

//! The interface without a window or a worker: what it shows of what it was told, and what it asks for when it is used.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use fumarole::window::interface::{Interface, Wish};
use fumarole::window::layout::{Comparison, Layout};
use fumarole::window::protocol::{
    Assignment, Block, Built, ChoiceInfo, Cost, Ended, Event, Frame, MeasureChoice, ParameterInfo, PassInfo, PassTimes,
    Picture, PresetInfo, Ready, Request, Setup, SideBuilt, SideChoice, SideFrame, SideSetup, SideTimes, TargetChoice,
    TargetInfo, TargetShape, ThumbnailChoice, ValueKind, Verb,
};

fn parameter(name: &str, low: f64, high: f64) -> ParameterInfo {
    ParameterInfo {
        name: name.into(),
        group: "Water".into(),
        help: format!("Help of {name}"),
        section: "eq. 4-17".into(),
        unit: "metres".into(),
        low: Some(low),
        high: Some(high),
        range: format!("{low} to {high}"),
        placeholder: "X".into(),
        default: "1".into(),
        cost: Cost::Constants,
        is_flag: false,
        is_list: false,
        is_several: false,
        is_whole: false,
        is_file: false,
        is_everyday: true,
        choices: Vec::new(),
        excludes: Vec::new(),
        requires: None,
    }
}

fn parameters() -> Vec<ParameterInfo> {
    let choice = |name: &str| ChoiceInfo { name: name.into(), help: String::new() };
    vec![
        parameter("depth", 0.0, 10.0),
        ParameterInfo { is_flag: true, ..parameter("floor", 0.0, 1.0) },
        ParameterInfo { choices: vec![choice("calm"), choice("storm")], ..parameter("waves", 0.0, 1.0) },
        ParameterInfo { is_file: true, is_everyday: true, ..parameter("mesh", 0.0, 1.0) },
        ParameterInfo { is_several: true, ..parameter("camera", 0.0, 1.0) },
    ]
}

pub fn ready() -> Event {
    let preset = PresetInfo { name: "figure-1".into(), help: "The first figure".into(), variant: None };
    Event::Ready(Ready {
        paper: "caustics".into(),
        about: "Light under water".into(),
        device: "llvmpipe (cpu, Mesa)".into(),
        is_cpu: true,
        validates: false,
        can_capture: false,
        shader_dir: None,
        variants: vec!["level-map".into(), "volumetric".into()],
        presets: vec![preset],
        parameters: parameters(),
        warnings: Vec::new(),
    })
}

fn side_setup(variant: &str) -> SideSetup {
    let values = ["1.5", "off", "calm", "teapot", "0,1,5,0,0,0"];
    SideSetup {
        choice: SideChoice { variant: Some(variant.into()), compiler: Some("glslang".into()), preset: None },
        values: values.map(String::from).to_vec(),
        set: vec!["depth".into()],
        camera: Some([0.0, 1.0, 5.0, 0.0, 0.0, 0.0]),
        lens: None,
    }
}

pub fn setup(variants: &[&str]) -> Event {
    let sides = variants.iter().map(|variant| side_setup(variant)).collect();
    Event::Setup(Setup { heeds: 0, preset: None, sides })
}

fn pass(name: &str, writes: usize) -> PassInfo {
    PassInfo {
        name: name.into(),
        section: "4.2".into(),
        kind: "graphics".into(),
        calls: 3,
        shaders: vec![format!("{name}.frag")],
        compiler: Some("glslang".into()),
        reads: Vec::new(),
        writes: vec![format!("target-{writes}")],
        read_targets: Vec::new(),
        written_targets: vec![writes],
        blend: vec!["replace".into()],
        depth: None,
    }
}

pub fn built(sides: usize) -> Event {
    let target = |index: usize| TargetInfo {
        name: format!("target-{index}"),
        resource: format!("target-{index}"),
        kind: ValueKind::F32,
        shape: TargetShape::Image { width: 8, height: 4, channels: 1, layers: 1 },
        format: "R32_SFLOAT".into(),
        planes: None,
        is_srgb: false,
        holds: "height in metres".into(),
    };
    let side = SideBuilt {
        size: [8, 4],
        build_ms: Some(2.0),
        load_ms: Some(1.0),
        passes: vec![pass("water-surface", 0), pass("caustics-map", 1), pass("combine", 2)],
        targets: (0..3).map(target).collect(),
    };
    Event::Built(Built { heeds: 0, sides: vec![side; sides] })
}

pub fn frame(number: u32, sides: usize) -> Event {
    let bytes: Vec<u8> = (0..8 * 4 * 4).map(|byte| (byte as u8).wrapping_add(number as u8)).collect();
    let block = Block { offset: 0, len: bytes.len() as u64, bytes };
    let picture = Picture { width: 8, height: 4, block };
    let side = SideFrame { picture: Some(picture), frame_ms: 12.5, written: Vec::new() };
    Event::Frame(Box::new(Frame {
        serial: u64::from(number) + 1,
        heeds: 0,
        number,
        is_playing: false,
        speed: 1.0,
        after: None,
        sides: vec![side; sides],
        difference: None,
        target: None,
        thumbnails: Vec::new(),
    }))
}

/// The interface of a paper with one side that shows frame 7.
pub fn harness() -> Harness<'static, Interface> {
    let layout = Layout { passes_width: 480.0, ..Layout::default() };
    let mut face = Interface::new(&egui::Context::default(), vec!["lava", "caustics"], "caustics", layout);
    for event in [ready(), setup(&["level-map"]), built(1), frame(7, 1)] {
        face.take(event);
    }
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1600.0, 1000.0))
        .build_state(|context, face: &mut Interface| face.show(context), face);
    harness.run();
    harness.state_mut().wishes();
    harness
}

/// Requests of the interface since the last call.
pub fn asked(harness: &mut Harness<'_, Interface>) -> Vec<Request> {
    harness.run();
    let wishes = harness.state_mut().wishes();
    let of = |wish| if let Wish::Ask(request) = wish { Some(request) } else { None };
    wishes.into_iter().filter_map(of).collect()
}

pub fn press(harness: &mut Harness<'_, Interface>, key: egui::Key) -> Vec<Request> {
    harness.key_press(key);
    asked(harness)
}

#[test]
fn passes_and_parameters_are_those_that_were_told() {
    let harness = harness();
    for label in ["water-surface", "caustics-map", "combine", "depth", "floor", "waves", "mesh"] {
        assert!(harness.query_all_by_label(label).next().is_some(), "{label} is not shown");
    }
}

#[test]
fn buttons_and_keys_ask_for_the_same() {
    let mut harness = harness();
    harness.get_by_label("Play").click();
    assert_eq!(asked(&mut harness), [Request::Play]);
    harness.get_by_label(">").click();
    assert_eq!(asked(&mut harness), [Request::Step(1)]);
    assert_eq!(press(&mut harness, egui::Key::Space), [Request::Pause]);
    assert_eq!(press(&mut harness, egui::Key::Period), [Request::Step(1)]);
    assert_eq!(press(&mut harness, egui::Key::Comma), [Request::Step(-1)]);
    assert_eq!(press(&mut harness, egui::Key::Home), [Request::GoTo(0)]);
    // Several in one frame of a window that is drawn late.
    let input = harness.input_mut();
    for key in [egui::Key::Period, egui::Key::Space, egui::Key::Period, egui::Key::Space, egui::Key::Period] {
        let (modifiers, physical_key) = (egui::Modifiers::NONE, None);
        input.events.push(egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers });
    }
    assert_eq!(asked(&mut harness), [Request::Step(3)]);
}

#[test]
fn a_pass_that_is_clicked_brings_its_targets() {
    let mut harness = harness();
    harness.get_by_label("caustics-map").click();
    let names = vec!["target-1".to_owned()];
    let choice = ThumbnailChoice { side: 0, names, longest_px: 160 };
    let target = TargetChoice { side: 0, name: "target-1".into(), layer: 0, first_row: 0 };
    // One of them large.
    assert_eq!(asked(&mut harness), [Request::Target(Some(target)), Request::Thumbnails(Some(choice))]);
    assert!(harness.query_by_label("height in metres").is_some(), "what a texel holds is not shown");
    assert_eq!(press(&mut harness, egui::Key::T), [Request::Target(None)]);
    let target = TargetChoice { side: 0, name: "target-1".into(), layer: 0, first_row: 0 };
    // By its small picture's name.
    harness.query_all_by_label("target-1").last().unwrap().click();
    assert_eq!(asked(&mut harness), [Request::Target(Some(target))]);
    // Its name in the list, which comes before that of what is looked at.
    harness.query_all_by_label("caustics-map").next().unwrap().click();
    assert_eq!(asked(&mut harness), [Request::Target(None), Request::Thumbnails(None)], "the picture is not back");
}

#[test]
fn the_frame_stops_after_a_pass() {
    let mut harness = harness();
    harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::OpenBracket);
    assert_eq!(asked(&mut harness), [Request::After(Some(2))]);
    harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::CloseBracket);
    assert_eq!(asked(&mut harness), [Request::After(None)]);
}

#[test]
fn times_are_asked_for_and_shown_with_their_share() {
    let mut harness = harness();
    let times = Layout::default().samples;
    assert_eq!(press(&mut harness, egui::Key::M), [Request::Measure(MeasureChoice { times, counters: false })]);
    let of = |name: &str, ms: f64, fraction: f64| PassTimes {
        name: name.into(),
        gpu_ms: Some(ms),
        fraction: Some(fraction),
        floor_ms: Some(ms / 2.0),
        bound: Some("fill".into()),
        ..PassTimes::default()
    };
    let passes = vec![of("water-surface", 1.25, 0.25), of("caustics-map", 3.75, 0.75)];
    harness.state_mut().take(Event::Times(vec![SideTimes { samples: 9, frame_ms: Some(4.0), passes }]));
    harness.run();
    for text in ["   1.250", "   3.750", " 50.0 %"] {
        assert!(harness.query_all_by_label(text).next().is_some(), "{text} is not shown");
    }
}

#[test]
fn a_flag_and_a_choice_set_what_a_user_would_type() {
    let mut harness = harness();
    let set =
        |name: &str, value: &str| Request::Set(vec![Assignment { name: name.into(), values: vec![value.into()] }]);
    harness.get_by_label("floor").click();
    assert_eq!(asked(&mut harness), [set("floor", "true")]);
    // What was set by hand can be taken back.
    harness.get_by_label("reset").click();
    assert_eq!(asked(&mut harness), [Request::Set(vec![Assignment { name: "depth".into(), values: vec![] }])]);
}

#[test]
fn a_number_that_is_only_looked_at_stays_as_it_is() {
    let mut harness = harness();
    let Event::Setup(mut third) = setup(&["level-map"]) else { unreachable!() };
    third.sides[0].values[0] = "0.3333333333333333".into();
    harness.state_mut().take(Event::Setup(third));
    assert_eq!(asked(&mut harness), []);
    let number = || harness.query_all_by_role(egui::accesskit::Role::SpinButton).last().unwrap();
    number().focus();
    harness.run();
    assert_eq!(press(&mut harness, egui::Key::Tab), []);
}

#[test]
fn the_camera_turns_by_keys_and_goes_back() {
    let mut harness = harness();
    harness.key_down(egui::Key::ArrowRight);
    harness.step();
    harness.step();
    harness.key_up(egui::Key::ArrowRight);
    let requests = asked(&mut harness);
    let Some(Request::Set(set)) = requests.first() else { panic!("no move: {requests:?}") };
    assert_eq!(set[0].name, "camera");
    let numbers: Vec<f64> = set[0].values[0].split(',').map(|number| number.parse().unwrap()).collect();
    assert_eq!(numbers.len(), 6);
    assert!(numbers[0].abs() > 1e-6 && (numbers[1] - 1.0).abs() < 1e-5, "it turned about the upright: {numbers:?}");
    let camera = Assignment { name: "camera".into(), values: vec![] };
    assert_eq!(press(&mut harness, egui::Key::R), [Request::Set(vec![camera])]);
}

/// Distance of eye and target of the one camera that was asked for.
pub fn distance(requests: &[Request]) -> f64 {
    let [Request::Set(set)] = requests else { panic!("not one camera: {requests:?}") };
    let numbers: Vec<f64> = set[0].values[0].split(',').map(|number| number.parse().unwrap()).collect();
    (0..3).map(|axis| (numbers[axis] - numbers[axis + 3]).powi(2)).sum::<f64>().sqrt()
}

/// Turns the wheel over the picture by a notch, and waits until nothing of it is left.
pub fn turn_wheel(harness: &mut Harness<'_, Interface>) {
    harness.get_by_label("picture").hover();
    let (unit, delta, modifiers) = (egui::MouseWheelUnit::Line, egui::vec2(0.0, 1.0), egui::Modifiers::NONE);
    harness.event(egui::Event::MouseWheel { unit, delta, modifiers });
    harness.run_steps(10);
}

/// True when the distance is that of the camera of [`side_setup`] after a notch.
pub fn is_a_notch_nearer(distance: f64) -> bool {
    (distance / 26.0_f64.sqrt() - (-0.16_f64).exp()).abs() < 1e-4
}

#[test]
fn a_turn_of_the_wheel_is_done_at_once_and_leaves_the_next_camera_alone() {
    let mut harness = harness();
    turn_wheel(&mut harness);
    let nearer = distance(&asked(&mut harness));
    assert!(is_a_notch_nearer(nearer), "{nearer}");
    // The pointer stays over the picture.
    let (unit, delta, modifiers) = (egui::MouseWheelUnit::Line, egui::vec2(0.0, 1.0), egui::Modifiers::NONE);
    harness.event(egui::Event::MouseWheel { unit, delta, modifiers });
    harness.key_press(egui::Key::R);
    harness.run_steps(10);
    let back = Request::Set(vec![Assignment { name: "camera".into(), values: vec![] }]);
    let requests = asked(&mut harness);
    assert_eq!(requests.last(), Some(&back), "the wheel goes on: {requests:?}");
}

#[test]
fn every_worker_is_asked_for_what_is_looked_at() {
    let layout = Layout { comparison: Comparison::Difference, ..Layout::default() };
    let mut face = Interface::new(&egui::Context::default(), vec!["lava", "caustics"], "caustics", layout);
    face.take(ready());
    let wishes = face.wishes();
    assert!(wishes.contains(&Wish::Ask(Request::Difference(true))), "remembered, and never asked for: {wishes:?}");

    let mut harness = harness();
    harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::OpenBracket);
    harness.get_by_label("caustics-map").click();
    asked(&mut harness);
    let ended = Ended { code: Some(1), signal: None, stderr: vec!["error: the device is lost".into()] };
    harness.state_mut().take(Event::Ended(ended));
    harness.run();
    assert!(harness.query_by_label("error: the device is lost").is_some());
    harness.get_by_label("Start it again").click();
    harness.run();
    assert_eq!(harness.state_mut().wishes(), [Wish::Restart("caustics".into())]);
    harness.state_mut().take(ready());
    let requests = asked(&mut harness);
    let target = TargetChoice { side: 0, name: "target-1".into(), layer: 0, first_row: 0 };
    for wanted in [Request::After(Some(2)), Request::Target(Some(target))] {
        assert!(requests.contains(&wanted), "{wanted:?} is not among {requests:?}");
    }
}

#[test]
fn two_sides_are_compared_in_three_ways() {
    let mut harness = harness();
    let requests = press(&mut harness, egui::Key::C);
    let Some(Request::Sides(sides)) = requests.first() else { panic!("no second side: {requests:?}") };
    assert_eq!(
        sides.iter().map(|side| side.variant.as_deref()).collect::<Vec<_>>(),
        [Some("level-map"), Some("volumetric")]
    );
    let Event::Built(mut both) = built(2) else { unreachable!() };
    both.sides[1].passes[2].name = "accumulate".into();
    harness.state_mut().take(setup(&["level-map", "volumetric"]));
    harness.run();
    assert!(harness.query_by_label("Side by side").is_none(), "there is one picture so far, which stays");
    for event in [Event::Built(both), frame(7, 2)] {
        harness.state_mut().take(event);
    }
    asked(&mut harness);
    assert!(harness.query_by_label("accumulate").is_some(), "the pass that B alone has");
    assert_eq!(press(&mut harness, egui::Key::B), [Request::Difference(false)]);
    assert!(harness.query_by_label("divider").is_some(), "no divider");
    assert_eq!(press(&mut harness, egui::Key::B), [Request::Difference(true)]);
    let one = press(&mut harness, egui::Key::C);
    assert!(matches!(&one[0], Request::Sides(sides) if sides.len() == 1), "{one:?}");
}

#[test]
fn a_problem_stands_over_the_picture_until_it_is_read_or_mended() {
    let mut harness = harness();
    let problem = "shaders/caustics/combine.frag:12: 'colour' : undeclared identifier";
    harness.state_mut().take(Event::Failed { id: 0, problem: problem.into() });
    harness.run();
    assert!(harness.query_by_label(problem).is_some(), "the problem is not shown");
    harness.state_mut().take(built(1));
    harness.run();
    assert!(harness.query_by_label(problem).is_none(), "the problem was mended");
}

#[test]
fn commands_are_copied_and_papers_changed() {
    let mut harness = harness();
    harness.get_by_label("Copy as command").click();
    assert_eq!(asked(&mut harness), [Request::Command(Verb::Render)]);
    let words = ["caustics", "render", "--mesh", "my pot.obj"].map(String::from).to_vec();
    harness.state_mut().take(Event::Command(words));
    harness.step();
    let commands = harness.output().platform_output.commands.clone();
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert_eq!(copied.as_deref(), Some("fumarole caustics render --mesh 'my pot.obj'"));
    harness.run();
}

#[test]
fn a_question_mark_lists_the_keys() {
    let mut harness = harness();
    harness.event(egui::Event::Text("?".into()));
    harness.run();
    assert!(harness.query_by_label("play, pause").is_some(), "no list");
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert!(harness.query_by_label("play, pause").is_none(), "the list stayed");
}

#[test]
fn messages_of_the_validation_are_counted_and_read_as_they_come() {
    let mut harness = harness();
    assert!(harness.query_by_label("Messages").is_some(), "none so far");
    for (number, id) in ["VUID-first", "VUID-second"].into_iter().enumerate() {
        harness.state_mut().take(Event::Validation(vec![format!("error: {id}: of a pass")]));
        harness.run();
        let tab = format!("Messages ({})", number + 1);
        harness.get_by_label(&tab).click();
        harness.run();
        assert!(harness.query_by_label_contains(id).is_some(), "{id} is not shown");
    }
}

#[test]
fn a_key_makes_it_light_dark_and_as_the_display_is() {
    let mut harness = harness();
    harness.input_mut().system_theme = Some(egui::Theme::Light);
    let mut themes = Vec::new();
    for _ in 0..3 {
        press(&mut harness, egui::Key::L);
        themes.push((harness.ctx.theme(), harness.ctx.style().visuals.panel_fill.intensity()));
    }
    let [light, dark, system] = themes[..] else { panic!("{themes:?}") };
    assert_eq!([light.0, dark.0, system.0], [egui::Theme::Light, egui::Theme::Dark, egui::Theme::Light], "{themes:?}");
    assert!(light.1 > 0.8 && dark.1 < 0.2 && system.1 == light.1, "{themes:?}");
}

#[test]
fn a_dropped_file_goes_to_the_parameter_that_takes_it() {
    let mut harness = harness();
    let file = egui::DroppedFile { path: Some("/tmp/bunny.obj".into()), ..Default::default() };
    harness.input_mut().dropped_files.push(file);
    let requests = asked(&mut harness);
    let mesh = Assignment { name: "mesh".into(), values: vec!["/tmp/bunny.obj".into()] };
    assert_eq!(requests, [Request::Set(vec![mesh])]);
}

#[test]
fn nothing_is_drawn_again_while_nothing_changes() {
    let mut harness = harness();
    harness.run();
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > std::time::Duration::from_secs(3600), "the interface asks for a frame in {delay:?}");
}

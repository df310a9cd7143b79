//! The worker of every paper: its pictures are those of `render`, whatever is changed on the way.

use fumarole::measure::parameter::Cost;
use fumarole::measure::study::Study;
use fumarole::papers::{burning, caustics, gas, lava, terrain};
use fumarole::window::protocol::{Event, MeasureChoice, Request, TargetChoice};

use super::scene::{PAPERS, Worker, picture, pixels, rendered, set, small, unset, variant};
use crate::common::beside_others;

/// A camera for each paper that shows the scene from elsewhere.
fn elsewhere(paper: &str) -> &'static str {
    match paper {
        "lava" => "-0.5,2.5,2.6,1.8,0.1,0.5",
        "gas" => "-1,3,9,0,0.5,0",
        "caustics" => "0.5,4,3,0,-2,0",
        "burning" => "1.5,1,1.5,0,0.1,0",
        _ => "-5000,6000,9000,0,500,0",
    }
}

fn builds(worker: &Worker) -> usize {
    worker.events.iter().filter(|e| matches!(e, Event::Built(built) if built.sides[0].build_ms.is_some())).count()
}

fn every_paper(test: impl Fn(&str, &str) + Sync) {
    beside_others(|| PAPERS.iter().for_each(|(paper, options)| test(paper, options)));
}

#[test]
fn a_picture_is_that_of_render_and_a_camera_moves_without_building() {
    every_paper(|paper, options| {
        let mut worker = Worker::small(paper);
        let first = worker.frame_after(0);
        let shown = picture(&first, 0);
        assert!(shown == rendered(paper, options), "{paper}: the first picture");
        assert_eq!((first.number, first.is_playing, first.sides.len()), (0, false, 1));

        let camera = elsewhere(paper);
        let moved = picture(&worker.frame_of(set("camera", camera)), 0);
        assert!(moved == rendered(paper, &format!("{options} --camera={camera}")), "{paper}: moved");
        assert!(moved != shown, "{paper}: the camera shows the same");
        let numbers: Vec<f64> = camera.split(',').map(|number| number.parse::<f32>().unwrap().into()).collect();
        assert_eq!(worker.setup().sides[0].camera.map(|camera| camera.to_vec()), Some(numbers), "{paper}");
        assert_eq!(builds(&worker), 1, "{paper}: the camera is no reason to build");

        assert!(picture(&worker.frame_of(unset("camera")), 0) == shown, "{paper}: back");
        assert!(!worker.setup().sides[0].set.contains(&"camera".to_owned()));
        worker.quit();
    });
}

/// The parameters whose change the window says is shown with the next frame.
fn constants<S: Study>() -> Vec<&'static str> {
    let mut names: Vec<_> = S::parameters().iter().filter(|p| p.cost == Cost::Constants).map(|p| p.name).collect();
    names.sort_unstable();
    names
}

#[test]
fn what_is_declared_as_constants_is_what_a_paper_takes_over() {
    assert_eq!(constants::<lava::setup::Setup>(), lava::DRAWN);
    assert_eq!(constants::<gas::setup::Setup>(), gas::WRITTEN);
    assert_eq!(constants::<caustics::setup::Setup>(), caustics::DRAWN);
    assert_eq!(constants::<burning::setup::Setup>(), burning::setup::DRAWN);
    assert_eq!(constants::<terrain::setup::Setup>(), terrain::WRITTEN);
}

#[test]
fn constants_that_a_paper_takes_over_are_seen_without_building() {
    beside_others(|| {
        let water: &[(&str, &str)] = &[("absorption", "0.7"), ("fresnel", "true")];
        type Changes = [(&'static str, &'static str)];
        let cases: [(&str, &str, &Changes); 7] = [
            (
                "lava",
                "",
                &[
                    ("color", "0.1,0.3,0.9"),
                    ("epsilon", "0.3"),
                    ("exposure", "0.5"),
                    ("rock-tile", "0.4"),
                    ("splat-radius", "0.1"),
                    ("tone", "clip"),
                    ("camera", "fig-8.3"),
                ],
            ),
            (
                "gas",
                "",
                &[
                    ("ambient", "0.4,0.2,0.1"),
                    ("early-end", "0.5"),
                    ("first-frame", "20"),
                    ("frame-step", "3"),
                    ("pixel-size", "0.4"),
                    ("shadow-threshold", "0.3"),
                ],
            ),
            ("caustics", "", &[water[0], water[1], ("samples", "2"), ("time-step", "0.3")]),
            ("caustics", "--variant culled", water),
            ("caustics", "--variant stencil", water),
            (
                "burning",
                "",
                &[("exposure", "0.5"), ("fire-light", "9"), ("tone", "clip"), ("camera", elsewhere("burning"))],
            ),
            ("terrain", "", &[("haze", "0.2"), ("normals", "nodes"), ("sun", "120,20"), ("camera", "top")]),
        ];
        for (paper, more, changes) in cases {
            let scene = format!("{} {more}", small(paper));
            let mut worker = Worker::start(paper, &scene);
            let first = picture(&worker.frame_of(Request::GoTo(2)), 0);
            let mut last = first.clone();
            let mut options = format!("{scene} --frame 2");
            for (name, value) in changes {
                let is_flag = *value == "true";
                options += &if is_flag { format!(" --{name}") } else { format!(" --{name}={value}") };
                let shown = picture(&worker.frame_of(set(name, value)), 0);
                assert!(shown == rendered(paper, &options), "{paper} {more}: {name} {value}");
                last = shown;
            }
            assert!(last != first, "{paper} {more}: nothing has changed");
            assert_eq!(builds(&worker), 1, "{paper} {more}");
            worker.quit();
        }
    });
}

#[test]
fn going_to_a_frame_shows_that_frame_forwards_and_back() {
    every_paper(|paper, options| {
        let mut worker = Worker::small(paper);
        worker.frame_after(0);
        let of = |number: u32| rendered(paper, &format!("{options} --frame {number}"));
        let frame = worker.frame_of(Request::GoTo(3));
        assert!(picture(&frame, 0) == of(3), "{paper}: frame 3");
        let frame = worker.frame_of(Request::Step(-2));
        assert_eq!(frame.number, 1);
        assert!(picture(&frame, 0) == of(1), "{paper}: two back");
        let frame = worker.frame_of(Request::Step(1));
        assert!(picture(&frame, 0) == of(2), "{paper}: one on");
        // The state stays where it is.
        let camera = elsewhere(paper);
        let moved = rendered(paper, &format!("{options} --frame 2 --camera={camera}"));
        assert!(picture(&worker.frame_of(set("camera", camera)), 0) == moved, "{paper}: seen from elsewhere");
        let frame = worker.frame_of(Request::Step(1));
        assert!(
            picture(&frame, 0) == rendered(paper, &format!("{options} --frame 3 --camera={camera}")),
            "{paper}: and on"
        );
        worker.quit();
    });
}

#[test]
fn a_late_frame_of_a_state_is_replayed_with_progress() {
    beside_others(|| {
        for paper in ["lava", "burning"] {
            let mut worker = Worker::small(paper);
            worker.frame_after(0);
            let frame = worker.frame_of(Request::GoTo(300));
            assert!(picture(&frame, 0) == rendered(paper, &format!("{} --frame 300", small(paper))), "{paper}");
            let progress = worker.events.iter().filter(|event| matches!(event, Event::Progress(p) if p.total > 100));
            assert!(progress.count() >= 2, "{paper}: {:?}", worker.events.len());
            worker.quit();
        }
    });
}

#[test]
fn a_replay_is_stopped_and_what_is_shown_stays() {
    beside_others(|| {
        let mut worker = Worker::small("lava");
        let first = worker.frame_after(0);
        worker.client.send(Request::GoTo(2_000_000));
        worker.wait_for(|event| matches!(event, Event::Progress(progress) if progress.total > 1000).then_some(()));
        let problem = worker.refusal_of(Request::Cancel);
        assert!(problem.contains("frame 2000000") && problem.contains("frame 0"), "{problem}");
        let again = worker.frame_of(Request::After(None));
        assert!(again.number == 0 && picture(&again, 0) == picture(&first, 0));
        // It is there for what comes next.
        let next = worker.frame_of(Request::Step(1));
        assert!(picture(&next, 0) == rendered("lava", &format!("{} --frame 1", small("lava"))));
        worker.quit();
    });
}

#[test]
fn what_is_asked_for_during_a_replay_that_is_stopped_comes_with_the_frame_that_stays() {
    beside_others(|| {
        let mut worker = Worker::small("lava");
        let first = worker.frame_after(0);
        worker.client.send(Request::Measure(MeasureChoice { times: 9, counters: true }));
        worker.client.send(Request::GoTo(2_000_000));
        worker.wait_for(|event| matches!(event, Event::Progress(progress) if progress.total > 1000).then_some(()));
        let choice = TargetChoice { side: 0, name: "density".into(), layer: 0, first_row: 0 };
        let asked = worker.client.send(Request::Target(Some(choice.clone())));
        let problem = worker.refusal_of(Request::Cancel);
        assert!(problem.contains("frame 0 stays"), "{problem}");
        // The times would have the state on its way again.
        let given_up =
            |event: &Event| matches!(event, Event::Measuring(measure) if *measure == MeasureChoice::default());
        assert!(worker.events.iter().any(given_up), "no word of the times");
        let frame = worker.frame_after(asked);
        assert_eq!((frame.number, frame.target.as_ref().map(|target| &target.choice)), (0, Some(&choice)));
        assert!(frame.sides[0].picture.as_ref().map(pixels) == first.sides[0].picture.as_ref().map(pixels));
        worker.quit();
    });
}

#[test]
fn passes_are_listed_and_a_frame_ends_after_each_of_them() {
    every_paper(|paper, _| {
        let mut worker = Worker::small(paper);
        let whole = worker.frame_after(0);
        let built = worker.events.iter().find_map(|event| match event {
            Event::Built(built) => Some(built.sides[0].clone()),
            _ => None,
        });
        let built = built.expect("what is built is told before the frame");
        let count = built.passes.len() as u32;
        assert!(count >= 2, "{paper}: {:?}", built.passes);
        assert!(built.passes.iter().all(|pass| pass.calls > 0));
        let unsaid = built.targets.iter().find(|target| target.holds.is_empty());
        assert!(unsaid.is_none(), "{paper}: what {unsaid:?} holds, and its unit");
        let written_by = |name: &str| {
            let is_one = |index: &usize| built.targets[*index].name == name;
            built.passes.iter().position(|pass| pass.written_targets.iter().any(is_one))
        };
        assert!(written_by("picture").is_some(), "{paper}: {:?}", built.passes);

        for passes in 0..=count {
            let frame = worker.frame_of(Request::After(Some(passes)));
            assert_eq!(frame.after, Some(passes));
            let written = &frame.sides[0].written;
            for target in &built.targets {
                let Some(first) = written_by(&target.name) else { continue };
                let is_written = written.contains(&target.name);
                assert_eq!(is_written, (first as u32) < passes, "{paper}: {} after {passes}", target.name);
            }
        }
        let last = worker.frame_of(Request::After(Some(count)));
        assert!(picture(&last, 0) == picture(&whole, 0), "{paper}: after the last pass");
        let again = worker.frame_of(Request::After(None));
        assert!(picture(&again, 0) == picture(&whole, 0), "{paper}: whole again");
        worker.quit();
    });
}

#[test]
fn buffers_pipelines_variants_and_presets_are_built_anew() {
    beside_others(|| {
        let mut worker = Worker::small("caustics");
        worker.frame_after(0);
        let options = small("caustics");
        let of = |more: &str| rendered("caustics", &format!("{options} {more}"));
        assert!(picture(&worker.frame_of(set("planes", "7")), 0) == of("--planes 7"), "buffers");
        assert!(picture(&worker.frame_of(set("size", "50x40")), 0) == of("--planes 7 --size 50x40"), "size");
        let frame = worker.frame_of(Request::Sides(vec![variant("volumetric")]));
        assert!(picture(&frame, 0) == of("--planes 7 --size 50x40 --variant volumetric"), "variant");
        assert_eq!(worker.setup().sides[0].choice.variant.as_deref(), Some("volumetric"));
        assert_eq!(worker.setup().sides[0].choice.compiler.as_deref(), Some("glslang"));
        assert!(builds(&worker) == 4);
        // A flag, and what turns it off again.
        let frame = worker.frame_of(set("shadows", "true"));
        assert!(picture(&frame, 0) == of("--planes 7 --size 50x40 --variant volumetric --shadows"), "a flag");
        worker.quit();

        let mut worker = Worker::start("lava", &format!("{} --color 0.1,0.2,0.9", small("lava")));
        worker.frame_after(0);
        // A preset forgets what was set, but for the size.
        let frame = worker.frame_of(Request::Preset(Some("results".into())));
        assert_eq!(worker.setup().preset.as_deref(), Some("results"));
        assert!(picture(&frame, 0) == rendered("lava", "--preset results --size 64x48"), "preset");
        worker.quit();
    });
}

//! The state depends on the simulated time alone.

use fumarole::gpu::{Mode, Recorder, Track};
use fumarole::measure::Paper;
use fumarole::papers::burning::{Parameters, Variant};
use fumarole::scene::MeshSource;

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

const TICKS: u32 = 72;

#[test]
fn equal_time_gives_equal_bits_for_any_time_step() {
    gpu_test(|device| {
        let mut reference = Fire::shell(device, &ball());
        reference.ticks(TICKS);
        let expected = reference.state();
        assert!(expected.counts.removed_triangles > 0, "the case is too tame");
        // Ticks a frame, frames.
        for (ticks, frames) in [(1.0, TICKS), (3.0, TICKS / 3), (0.5, 2 * TICKS), (TICKS.into(), 1)] {
            let parameters = Parameters { time_step_s: ticks / 60.0, ..quick() };
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
            (0..frames).for_each(|number| fire.frame(number));
            let mut state = fire.state();
            // Triangles are counted as drawn by what makes pictures.
            state.counts.drawn_triangles = 0;
            assert!(state == expected, "{ticks} ticks a frame");
        }
    });
}

#[test]
fn a_divided_tick_has_the_same_result() {
    gpu_test(|device| {
        let mut reference = Fire::shell(device, &ball());
        reference.ticks(TICKS);
        let expected = reference.state();
        for time_division in [2, 5] {
            let parameters = Parameters { time_division, ..quick() };
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &ball());
            (0..TICKS * time_division).for_each(|number| fire.frame(number));
            let mut state = fire.state();
            state.counts.drawn_triangles = 0;
            assert!(state == expected, "{time_division}");
        }
    });
}

#[test]
fn what_never_changes_may_be_loaded_in_every_frame() {
    gpu_test(|device| {
        let mut reference = Fire::shell(device, &ball());
        let mut fire = Fire::new(device, Variant::Shell, &Parameters { preload: false, ..quick() }, &ball());
        (0..TICKS).for_each(|number| {
            reference.frame(number);
            fire.frame(number);
        });
        assert!(fire.state() == reference.state());
    });
}

#[test]
fn left_out_frames_are_caught_up_and_a_restart_replays() {
    gpu_test(|device| {
        let mut steps = Fire::shell(device, &ball());
        (0..=80).for_each(|number| steps.frame(number));
        let mut jump = Fire::shell(device, &ball());
        jump.frame(80);
        assert!(jump.state() == steps.state());
        jump.paper.restart().unwrap();
        jump.frame(80);
        assert!(jump.state() == steps.state());
        // Frame 0 of a fire that begins at frame 60.
        let mut late = Fire::new(device, Variant::Shell, &Parameters { first_frame: 60, ..quick() }, &ball());
        late.frame(20);
        assert!(late.state() == steps.state());
        late.paper.restart().unwrap();
        late.frame(20);
        assert!(late.state() == steps.state());
    });
}

/// Back to a start in the midst of a tick, whatever the ticks after it have visited.
#[test]
fn a_restart_within_a_divided_tick_replays() {
    gpu_test(|device| {
        let mesh = MeshSource::Sphere.divided(20_000).load().unwrap();
        let parameters = Parameters { time_division: 4, first_frame: 4 * TICKS + 2, fire: 0, smoke: 0, ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &mesh);
        fire.frame(0);
        let expected = fire.state();
        (1..40).for_each(|number| fire.frame(number));
        assert!(fire.state() != expected, "the case is too tame");
        fire.paper.restart().unwrap();
        fire.frame(0);
        assert!(fire.state() == expected);
    });
}

#[test]
fn a_frame_before_the_last_is_refused() {
    gpu_test(|device| {
        let mut fire = Fire::shell(device, &ball());
        fire.frame(3);
        let mut recorder = Recorder::new(device).unwrap();
        let error = recorder.run(Mode::Plain, |frame| fire.paper.record(frame, 2)).unwrap_err();
        assert!(error.to_string().contains("restart the paper first"), "{error}");
    });
}

/// So that a late picture of a large mesh can be given up, and no submission lasts longer than a device may take.
#[test]
fn ticks_of_a_large_mesh_are_several_submissions() {
    gpu_test(|device| {
        let caught_up = |triangles: u64| {
            let mesh = MeshSource::Sphere.divided(triangles).load().unwrap();
            let mut fire = Fire::new(device, Variant::Shell, &Parameters { fire: 0, smoke: 0, ..quick() }, &mesh);
            let mut recorder = Recorder::new(device).unwrap();
            let sample = recorder.run(Mode::Plain, |frame| fire.paper.advance(frame, 100, 100).map(drop)).unwrap();
            sample.spans.iter().filter(|span| span.track == Track::Wait).count()
        };
        assert_eq!(caught_up(0), 1);
        let parts = caught_up(40_000);
        assert!((2..=4).contains(&parts), "{parts}");
    });
}

//! Frames that end after their first passes.

use ash::vk;
use fumarole::gpu::{Blend, Error, Frame, Mode, PassInfo, Recorder};

use super::fixtures::{BLACK, color_target, paint, paint_pass, shaders, texels};
use crate::common::gpu_test;

#[test]
fn what_lies_behind_the_end_is_left_out_and_the_next_frame_is_whole() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let targets = ["a", "b", "c"].map(|name| color_target(device, name, vk::Format::R32_SFLOAT, 4, 4));
        let passes = [("first", 0), ("second", 1), ("third", 2)]
            .map(|(name, at)| paint_pass(&shaders, name, &targets[at], BLACK, Blend::Replace));
        let host = PassInfo::host("count", "", &[], &[]);
        let mut recorder = Recorder::new(device).unwrap();
        let record = |frame: &mut Frame<'_>, value: f32| {
            paint(frame, &passes[0], value)?;
            paint(frame, &passes[1], value)?;
            // Host work gives what it gives, wherever the frame ends.
            assert_eq!(frame.host(&host, || 7), 7);
            // A pass of several calls, some behind another pass.
            paint(frame, &passes[0], value + 10.0)?;
            paint(frame, &passes[2], value)
        };
        let names = |passes: &[fumarole::gpu::PassSample]| -> Vec<(&str, u32)> {
            passes.iter().map(|pass| (pass.info.name, pass.calls)).collect()
        };
        let sample = recorder.run(Mode::Plain, |frame| record(frame, 1.0)).unwrap();
        assert_eq!(names(&sample.passes), [("first", 2), ("second", 1), ("count", 1), ("third", 1)]);
        let expected = [
            (0, &[][..], [11.0, 1.0, 1.0]),
            (1, &[("first", 1)], [3.0, 1.0, 1.0]),
            (2, &[("first", 1), ("second", 1)], [4.0, 4.0, 1.0]),
            (3, &[("first", 2), ("second", 1), ("count", 1)], [15.0, 5.0, 1.0]),
            (4, &[("first", 2), ("second", 1), ("count", 1), ("third", 1)], [16.0, 6.0, 6.0]),
            (9, &[("first", 2), ("second", 1), ("count", 1), ("third", 1)], [17.0, 7.0, 7.0]),
        ];
        for ((count, listed, values), value) in expected.into_iter().zip(2..) {
            for mode in [Mode::Plain, Mode::Timestamped, Mode::Bracketed, Mode::Counted] {
                let value = value as f32;
                let sample = recorder.run_first(mode, count, |frame| record(frame, value)).unwrap();
                assert_eq!(names(&sample.passes), listed, "{count} {mode:?}");
            }
            let found: Vec<f32> = targets.iter().map(|target| texels::<f32>(device, target)[5]).collect();
            assert_eq!(found, values, "after {count}");
        }
        let sample = recorder.run(Mode::Plain, |frame| record(frame, 1.0)).unwrap();
        assert_eq!(sample.passes.len(), 4);
        let told = recorder.run_first(Mode::Plain, 2, |frame| {
            // Told once, a frame takes nothing more.
            let told = record(frame, 1.0);
            assert!(matches!(&told, Err(Error::BeyondEnd { pass }) if pass == "first"), "{told:?}");
            assert!(matches!(paint(frame, &passes[1], 1.0), Err(Error::BeyondEnd { .. })));
            told
        });
        assert_eq!(told.unwrap().passes.len(), 2);
    });
}

#[test]
fn errors_before_the_end_are_errors() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let target = color_target(device, "a", vk::Format::R32_SFLOAT, 4, 4);
        let pass = paint_pass(&shaders, "first", &target, BLACK, Blend::Replace);
        let mut recorder = Recorder::new(device).unwrap();
        let mut run = |count| {
            let record = |frame: &mut Frame<'_>| frame.graphics(&pass, |draw| draw.vertices(3));
            recorder.run_first(Mode::Plain, count, record).map(drop)
        };
        // It lacks its constants.
        assert!(matches!(run(1), Err(Error::Pass { .. })));
        assert!(run(0).is_ok());
        let wait = recorder.run_first(Mode::Plain, 0, |frame| frame.wait_for(&pass)).map(drop);
        assert!(wait.is_ok(), "{wait:?}");
    });
}

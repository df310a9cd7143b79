//! Papers whose state advances: the measured loop replays them from frame 0.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ash::vk;
use fumarole::gpu::{Blend, Device, Error, Frame, ImageView, Load, Pass, Recorder};
use fumarole::measure::measure::{Schedule, Watch, measure};
use fumarole::measure::{Paper, Target};

use super::fixtures::{color_target, shaders};
use crate::common::gpu_test;

/// Fills its picture, and notes every frame that is asked of it.
struct Diary {
    picture: Arc<ImageView>,
    fill: Pass,
    /// The number of each frame; `None` for a restart.
    entries: Vec<Option<u32>>,
}

impl Diary {
    fn new(device: &Arc<Device>) -> Self {
        let picture = color_target(device, "picture", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let fill = Pass::graphics("fill", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&picture, Load::Discard, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        Diary { picture, fill, entries: Vec::new() }
    }
}

impl Paper for Diary {
    fn restart(&mut self) -> Result<(), Error> {
        self.entries.push(None);
        Ok(())
    }

    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.entries.push(Some(number));
        frame.graphics(&self.fill, |draw| draw.vertices(3))
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.picture
    }

    fn targets(&self) -> Vec<Target> {
        Vec::new()
    }
}

#[test]
fn every_repetition_replays_the_same_frames_after_a_restart() {
    gpu_test(|device| {
        let mut diary = Diary::new(device);
        let mut recorder = Recorder::new(device).unwrap();
        let schedule = Schedule { warmup: 2, frames: 3, repeat: 2, min_time_s: 0.0 };
        let mut watch = Watch { interrupted: &AtomicBool::new(false), progress: &mut |_, _| {} };
        let measured = measure(&mut recorder, &mut [&mut diary], schedule, &mut watch).unwrap();
        assert_eq!(measured[0].frame_ms.len(), 6);
        let replayed = [None, Some(0), Some(1), Some(2)];
        // Two repetitions, each plain, timestamped and bracketed; the counted frame comes last.
        let expected = [vec![None, Some(0), Some(1)], replayed.repeat(6), vec![None, Some(0)]].concat();
        assert_eq!(diary.entries, expected);
    });
}

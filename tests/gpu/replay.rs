//! Papers whose state advances: the measured loop and the pictures replay them from frame 0.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ash::vk;
use fumarole::experiment::machine::{Machine, MachineOptions};
use fumarole::experiment::measure::{Schedule, Watch, measure};
use fumarole::experiment::picture;
use fumarole::gpu::{Blend, Device, Error, Frame, ImageView, Load, Pass, Recorder};
use fumarole::papers::{Paper, Target};

use crate::common::gpu_test;
use crate::fixtures::{color_target, shaders};

/// Fills its picture, and notes every frame that is asked of it.
struct Diary {
    picture: Arc<ImageView>,
    fill: Pass,
    /// The number of each frame; `None` for a restart.
    entries: Vec<Option<u32>>,
    has_state: bool,
}

impl Diary {
    fn new(device: &Arc<Device>, has_state: bool) -> Self {
        let picture = color_target(device, "picture", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let fill = Pass::graphics("fill", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&picture, Load::Discard, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        Diary { picture, fill, entries: Vec::new(), has_state }
    }
}

impl Paper for Diary {
    fn has_state(&self) -> bool {
        self.has_state
    }

    fn restart(&mut self) -> Result<(), Error> {
        self.entries.push(None);
        Ok(())
    }

    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.entries.push(Some(number));
        frame.graphics(&self.fill, |draw| {
            draw.vertices(3);
        })
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
        let mut diary = Diary::new(device, true);
        let mut recorder = Recorder::new(device).unwrap();
        let schedule = Schedule { warmup: 2, frames: 3, repeat: 2, min_time_s: 0.0 };
        let mut watch = Watch { interrupted: &AtomicBool::new(false), progress: &mut |_, _| {} };
        let measured = measure(&mut recorder, &mut [&mut diary], schedule, &mut watch).unwrap();
        assert_eq!(measured[0].frame_ms.len(), 6);
        let replayed = [None, Some(0), Some(1), Some(2)];
        // Two repetitions, each plain, stamped and bracketed; the counted frame comes last.
        let expected = [vec![None, Some(0), Some(1)], replayed.repeat(6), vec![None, Some(0)]].concat();
        assert_eq!(diary.entries, expected);
    });
}

#[test]
fn a_picture_comes_after_the_frames_before_it() {
    gpu_test(|device| {
        let uuid = device.physical().uuid_text();
        let options = MachineOptions { device: Some(uuid), validate: true, ..MachineOptions::default() };
        let mut machine = Machine::open(&options, &[]).unwrap();
        for (has_state, expected) in [(true, vec![None, Some(0), Some(1), Some(2)]), (false, vec![None, Some(2)])] {
            let mut diary = Diary::new(&machine.device.clone(), has_state);
            picture::render(&mut machine, &mut diary, 2).unwrap();
            assert_eq!(diary.entries, expected);
        }
        machine.check_validation().unwrap();
    });
}

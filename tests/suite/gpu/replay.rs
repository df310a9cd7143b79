//! Papers whose state advances: the measured loop replays them from frame 0, in changing order, and again where their buffers
//! did not suffice.

use std::cell::RefCell;
use std::mem;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use ash::vk;
use fumarole::gpu::{Blend, Device, Error, Frame, ImageView, Load, Pass, Recorder, ShaderLibrary};
use fumarole::measure::bench::measure_settled;
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
    /// Its own number among several.
    number: usize,
    /// Numbers of those whose frames were recorded, common to all.
    order: Rc<RefCell<Vec<usize>>>,
    /// Time by which its first frame is longer than others.
    first_use: Duration,
    /// Times that its frames have to be recorded again.
    unsettled: u32,
}

impl Diary {
    fn new(device: &Arc<Device>) -> Self {
        let picture = color_target(device, "picture", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let fill = Pass::graphics("fill", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&picture, Load::Discard, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        Diary {
            picture,
            fill,
            entries: Vec::new(),
            number: 0,
            order: Rc::default(),
            first_use: Duration::ZERO,
            unsettled: 0,
        }
    }
}

impl Paper for Diary {
    fn restart(&mut self) -> Result<(), Error> {
        self.entries.push(None);
        Ok(())
    }

    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.entries.push(Some(number));
        self.order.borrow_mut().push(self.number);
        thread::sleep(mem::take(&mut self.first_use));
        frame.graphics(&self.fill, |draw| draw.vertices(3))
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    fn settle(&mut self, _shaders: &ShaderLibrary) -> Result<bool, Error> {
        let is_settled = self.unsettled == 0;
        self.unsettled = self.unsettled.saturating_sub(1);
        Ok(is_settled)
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

#[test]
fn of_three_papers_the_order_changes_from_round_to_round() {
    gpu_test(|device| {
        let order = Rc::default();
        let mut diaries = [0, 1, 2].map(|number| Diary { number, order: Rc::clone(&order), ..Diary::new(device) });
        let mut papers = diaries.each_mut().map(|diary| diary as &mut dyn Paper);
        let mut recorder = Recorder::new(device).unwrap();
        let schedule = Schedule { warmup: 1, frames: 2, repeat: 2, min_time_s: 0.0 };
        let mut watch = Watch { interrupted: &AtomicBool::new(false), progress: &mut |_, _| {} };
        let measured = measure(&mut recorder, &mut papers, schedule, &mut watch).unwrap();
        assert_eq!(measured.iter().map(|one| one.frame_ms.len()).collect::<Vec<_>>(), [4; 3]);
        // Every other round runs backwards, and a repetition goes on where the one before ended; every mode has the same order.
        let (first, second) = ([0, 1, 2, 0, 2, 1], [2, 0, 1, 2, 1, 0]);
        let expected = [vec![0, 1, 2], first.repeat(3), second.repeat(3), vec![0, 1, 2]].concat();
        assert_eq!(*order.borrow(), expected);
    });
}

#[test]
fn what_first_use_costs_is_kept_where_frames_are_recorded_again() {
    gpu_test(|device| {
        let mut diary = Diary { first_use: Duration::from_millis(200), unsettled: 1, ..Diary::new(device) };
        let library = shaders(device);
        let mut recorder = Recorder::new(device).unwrap();
        let schedule = Schedule { warmup: 1, frames: 1, repeat: 1, min_time_s: 0.0 };
        let mut watch = Watch { interrupted: &AtomicBool::new(false), progress: &mut |_, _| {} };
        let mut papers: [(&mut dyn Paper, &ShaderLibrary); 1] = [(&mut diary, &library)];
        let measured = measure_settled(device, &mut recorder, &mut papers, schedule, &mut watch).unwrap();
        assert!(measured[0].first_frame_ms > 100.0, "{} ms", measured[0].first_frame_ms);
        assert_eq!(measured[0].frame_ms.len(), 1);
        let once = [None, Some(0)].repeat(5);
        assert_eq!(diary.entries, once.repeat(2), "warm-up, three modes, counters, and all once more");
    });
}

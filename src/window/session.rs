//! State of the worker as far as it has told.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use super::protocol::{
    Built, DeviceLimits, Ended, Event, Frame, Memory, ParameterInfo, Progress, Ready, Setup, SideBuilt, SideSetup,
    SideTimes,
};

/// Name of the parameter that is the camera.
pub const CAMERA: &str = "camera";

/// Points of the plots that are kept: the minutes that they show, at the pace of a display.
const HISTORY: usize = 3 * 60 * 60;
/// Lines of warnings and messages that are kept.
const LINES: usize = 500;

/// A point of the plots.
#[derive(Debug, Clone)]
pub struct Point {
    /// When it came.
    pub at: Instant,
    /// Milliseconds of the frame of each side, or of each pass of the first side.
    pub values_ms: Vec<f64>,
}

/// The worker as the window knows it.
#[derive(Default)]
pub struct Session {
    /// Device, paper and parameters of the worker; `None` until it has said them.
    pub ready: Option<Arc<Ready>>,
    /// Values of all parameters; `None` until the first set-up holds.
    pub setup: Option<Setup>,
    /// Eye and target of the camera where none is set by hand, as it was last told.
    pub home: Option<[f64; 6]>,
    /// Passes and targets of the sides; `None` until they are made.
    pub built: Option<Built>,
    /// The last frame; `None` before the first.
    pub frame: Option<Frame>,
    /// Times of each side's frame and passes, as they came last.
    pub times: Vec<SideTimes>,
    /// Milliseconds of frames, each side's.
    pub frames: VecDeque<Point>,
    /// Milliseconds of passes of the first side, as medians came.
    pub passes: VecDeque<Point>,
    /// Work that takes long and is under way.
    pub progress: Option<Progress>,
    /// Message of the last request that failed.
    pub problem: Option<String>,
    /// Latest warnings, the newest last.
    pub warnings: Vec<String>,
    /// The device's own limits; `None` until they are measured.
    pub limits: Option<DeviceLimits>,
    /// Memory of device and process, as it was last asked for.
    pub memory: Option<Memory>,
    /// Files that were written, one line each.
    pub kept: Vec<String>,
    /// Latest messages of the validation layer, the newest last.
    pub validation: Vec<String>,
    /// End of the worker's process; `None` while it runs.
    pub ended: Option<Ended>,
    /// Last request that something was heard of.
    pub heeds: u64,
}

impl Session {
    /// Takes an event over; gives back what is not a state: an answer.
    pub fn take(&mut self, event: Event) -> Option<Event> {
        match event {
            Event::Ready(ready) => {
                self.warnings.clone_from(&ready.warnings);
                self.ready = Some(Arc::new(ready));
            }
            Event::Setup(setup) => {
                self.heeds = self.heeds.max(setup.heeds);
                self.home = self.home_of(&setup);
                self.setup = Some(setup);
            }
            Event::Built(built) => {
                self.heeds = self.heeds.max(built.heeds);
                // A shader that was mended, a value that can be drawn again.
                self.problem = None;
                self.built = Some(built);
                self.times.clear();
                self.passes.clear();
            }
            Event::Frame(frame) => {
                self.heeds = self.heeds.max(frame.heeds);
                let values_ms = frame.sides.iter().map(|side| side.frame_ms).collect();
                push(&mut self.frames, values_ms);
                self.frame = Some(*frame);
            }
            Event::Times(times) => {
                // The first frames are plain ones: passes without a time are no points at 0.
                if let Some(first) = times.first().filter(|first| first.samples > 0) {
                    let of_pass =
                        |pass: &super::protocol::PassTimes| pass.gpu_ms.unwrap_or(0.0) + pass.host_ms.unwrap_or(0.0);
                    push(&mut self.passes, first.passes.iter().map(of_pass).collect());
                }
                self.times = times;
            }
            Event::Progress(progress) => {
                self.progress = Some(progress).filter(|progress| progress.done < progress.total);
            }
            Event::Failed { id, problem } => {
                self.heeds = self.heeds.max(id);
                self.progress = None;
                self.problem = Some(problem);
            }
            Event::Warning(warning) => add(&mut self.warnings, [warning]),
            Event::Limits(limits) => self.limits = Some(limits),
            Event::Memory(memory) => self.memory = Some(memory),
            Event::Kept(files) => {
                self.kept.clone_from(&files);
                return Some(Event::Kept(files));
            }
            Event::Validation(messages) => add(&mut self.validation, messages),
            Event::Ended(ended) => {
                self.progress = None;
                self.ended = Some(ended);
            }
            answer @ (Event::Command(_) | Event::Measuring(_)) => return Some(answer),
        }
        None
    }

    /// The camera that a reset goes back to, where a set-up tells it, or nothing that it may depend on has changed.
    fn home_of(&self, setup: &Setup) -> Option<[f64; 6]> {
        let side = setup.sides.first()?;
        if side.set.iter().all(|name| name != CAMERA) {
            return side.camera;
        }
        let camera = self.parameter(CAMERA);
        let others = |side: &SideSetup| {
            let values = side.values.iter().enumerate().filter(|(index, _)| Some(*index) != camera);
            (side.choice.clone(), values.map(|(_, value)| value.clone()).collect::<Vec<_>>())
        };
        let is_alike = self.side(0).is_some_and(|last| others(last) == others(side));
        self.home.filter(|_| is_alike)
    }

    /// The declared parameters.
    pub fn parameters(&self) -> &[ParameterInfo] {
        self.ready.as_ref().map_or(&[], |ready| &ready.parameters)
    }

    /// Index of a parameter.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters().iter().position(|parameter| parameter.name == name)
    }

    /// Everything that is set on a side.
    pub fn side(&self, side: usize) -> Option<&SideSetup> {
        self.setup.as_ref()?.sides.get(side)
    }

    /// A side as it is built.
    pub fn side_built(&self, side: usize) -> Option<&SideBuilt> {
        self.built.as_ref()?.sides.get(side)
    }

    /// Number of the sides.
    pub fn side_count(&self) -> usize {
        self.setup.as_ref().map_or(1, |setup| setup.sides.len().max(1))
    }

    /// Two sides are set, and the last frame is of both: before the first one, the picture that was there stays.
    pub fn shows_both(&self) -> bool {
        self.side_count() > 1 && self.frame.as_ref().is_some_and(|frame| frame.sides.len() > 1)
    }

    /// Width and height of a side's picture in pixels.
    pub fn picture_size(&self, side: usize) -> Option<egui::Vec2> {
        let picture = self.frame.as_ref()?.sides.get(side)?.picture.as_ref()?;
        Some(egui::vec2(picture.width as f32, picture.height as f32))
    }

    /// Number of the frame that is shown.
    pub fn number(&self) -> u32 {
        self.frame.as_ref().map_or(0, |frame| frame.number)
    }

    /// The clock plays.
    pub fn is_playing(&self) -> bool {
        self.frame.as_ref().is_some_and(|frame| frame.is_playing)
    }
}

fn push(points: &mut VecDeque<Point>, values_ms: Vec<f64>) {
    points.push_back(Point { at: Instant::now(), values_ms });
    if points.len() > HISTORY {
        points.pop_front();
    }
}

fn add(lines: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    lines.extend(more);
    lines.drain(..lines.len().saturating_sub(LINES));
}

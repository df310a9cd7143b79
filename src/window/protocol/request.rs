//! Requests of the window to the worker.

use serde::{Deserialize, Serialize};

/// A request with its number, which rises: [`Frame::heeds`](super::Frame::heeds) and [`Event::Failed`](super::Event::Failed) name it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Numbered {
    /// From 1.
    pub id: u64,
    /// The request.
    pub request: Request,
}

/// A request of the window to the worker. Of requests that wait, a later one of the same kind takes an earlier one's place
/// where only the last matters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Sets parameters, on all sides.
    Set(Vec<Assignment>),
    /// Takes the numbers of a preset (`None`: the defaults) and forgets what was set, but for the size.
    Preset(Option<String>),
    /// Sides to be drawn: one, or two beside each other.
    Sides(Vec<SideChoice>),
    /// Frames one after the other.
    Play,
    /// Stays at the frame that is shown.
    Pause,
    /// So many frames on, or back.
    Step(i32),
    /// Frames that the clock goes on by from picture to picture while it plays, above 0 and at most 1000; below 1, a frame
    /// is drawn several times.
    Speed(f64),
    /// To frame N; a paper whose state advances replays from its start where it must.
    GoTo(u32),
    /// Records the frame only up to its first so many passes (`None`: all of them).
    After(Option<u32>),
    /// The target whose values come with every frame from now on.
    Target(Option<TargetChoice>),
    /// Small pictures of the targets of that side come with every frame from now on.
    Thumbnails(Option<ThumbnailChoice>),
    /// The difference of the two sides comes with every frame from now on.
    Difference(bool),
    /// Times and counters of the passes come from now on, from frames recorded for them.
    Measure(MeasureChoice),
    /// Measures the device's own limits, once: answered by [`Event::Limits`](super::Event::Limits).
    Limits,
    /// Memory now: answered by [`Event::Memory`](super::Event::Memory).
    Memory,
    /// The command line of what is seen: answered by [`Event::Command`](super::Event::Command).
    Command(Verb),
    /// Writes a file: answered by [`Event::Kept`](super::Event::Kept).
    Keep(Keep),
    /// The next frame is captured by RenderDoc, where its library is loaded: answered by [`Event::Kept`](super::Event::Kept).
    Capture,
    /// Compiles the shaders of `--shader-dir` again; saving one does the same.
    Reload,
    /// Ends what takes long: a replay, a film.
    Cancel,
    /// The window has taken an event that needs it: sent by the client itself.
    Taken(u64),
    /// Ends the worker.
    Quit,
}

/// A parameter's name and its value, as one would type it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Assignment {
    /// Name of the parameter.
    pub name: String,
    /// One text, of a list any number, of a flag `true` or `false`; none takes back what was set.
    pub values: Vec<String>,
}

/// One side of what is drawn; `None` leaves it as the command line or the preset has it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SideChoice {
    /// Name of the variant.
    pub variant: Option<String>,
    /// `glslang` or `naga`.
    pub compiler: Option<String>,
    /// Name of a preset, for a side that differs from the other in it; the worker's own otherwise.
    pub preset: Option<String>,
}

/// A target whose values are wanted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TargetChoice {
    /// Index of the side.
    pub side: usize,
    /// Name of the target.
    pub name: String,
    /// Layer of an image, from 0.
    pub layer: u32,
    /// First row of a table: at most [`TABLE_VALUES`] values come at once.
    pub first_row: u64,
}

/// Values of a table that come at once.
pub const TABLE_VALUES: u64 = 1 << 20;

/// Small pictures that are wanted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ThumbnailChoice {
    /// Index of the side.
    pub side: usize,
    /// Names of the targets.
    pub names: Vec<String>,
    /// Longest side in pixels, 1 to 1024.
    pub longest_px: u32,
}

/// Frames recorded for times and counters, after each change and while the clock plays; they are not shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeasureChoice {
    /// Samples of each time that the medians are taken of, 0 (no times) to 100: the last ones.
    pub times: u32,
    /// Counters as well.
    pub counters: bool,
}

/// The verb of a command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verb {
    /// Times what is seen, all sides of one set-up as variants.
    Bench,
    /// Draws the frame that is seen.
    Render,
}

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// The picture of a side.
    Picture {
        /// Index of the side.
        side: usize,
        /// Ends in .png.
        file: String,
    },
    /// A target of a side, all its layers, at full precision.
    Target {
        /// Index of the side.
        side: usize,
        /// Name of the target.
        name: String,
        /// Ends in .exr, .npy or .png.
        file: String,
    },
    /// All targets of a side as small pictures with the picture itself first.
    ContactSheet {
        /// Index of the side.
        side: usize,
        /// Ends in .png.
        file: String,
    },
    /// Frames from `first` up to but not including `end`, of a side.
    Film {
        /// Index of the side.
        side: usize,
        /// First frame.
        first: u32,
        /// One more than the last.
        end: u32,
        /// One .y4m, or .png, of which each gets its frame's number before the ending.
        file: String,
    },
}

//! What the window and its worker say to each other.
//!
//! One JSON document a line: [`Numbered`] requests on the worker's standard input, [`Event`]s on its standard output.
//! Pictures and values lie in a file that both have open, in memory where the system offers such a folder: an event names
//! the [`Block`], and [`Client`](super::client::Client) has read it before the window sees the event. The worker draws
//! at most one frame ahead of what the window has taken, so neither side's queue grows.

use serde::{Deserialize, Serialize};

/// A request with its number, which rises: [`Frame::heeds`] and [`Event::Failed`] name it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Numbered {
    /// From 1.
    pub id: u64,
    /// The request.
    pub request: Request,
}

/// What the window asks of the worker. Of requests that wait, a later one of the same kind takes an earlier one's place
/// where only the last matters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Sets parameters, on all sides.
    Set(Vec<Assignment>),
    /// Takes the numbers of a preset (`None`: the defaults) and forgets what was set, but for the size.
    Preset(Option<String>),
    /// What is drawn: one side, or two beside each other.
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
    /// Measures the device's own limits, once: answered by [`Event::Limits`].
    Limits,
    /// Memory now: answered by [`Event::Memory`].
    Memory,
    /// The command line of what is seen: answered by [`Event::Command`].
    Command(Verb),
    /// Writes a file: answered by [`Event::Kept`].
    Keep(Keep),
    /// The next frame is captured by RenderDoc, where its library is loaded: answered by [`Event::Kept`].
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

/// What is to be written.
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

/// What the worker tells the window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// First of all, and once.
    Ready(Ready),
    /// A change of the set-up is taken: what is set now. Follows [`Event::Ready`], and every change.
    Setup(Setup),
    /// The sides were made, or made anew, or changed their constants.
    Built(Built),
    /// A frame to show.
    Frame(Box<Frame>),
    /// Times and counters, as of the last frames recorded for them.
    Times(Vec<SideTimes>),
    /// How far something long has come.
    Progress(Progress),
    /// A request could not be done; what was shown last stays.
    Failed {
        /// The request's number; 0 for what no request asked for, as a shader that was saved.
        id: u64,
        /// One line.
        problem: String,
    },
    /// A doubt about what is shown, one line.
    Warning(String),
    /// The device's own limits.
    Limits(DeviceLimits),
    /// Memory by resource.
    Memory(Memory),
    /// Arguments behind the program's name: the paper's name, the verb, and the options that differ from the defaults.
    Command(Vec<String>),
    /// Files that were written.
    Kept(Vec<String>),
    /// New messages of the validation layer.
    Validation(Vec<String>),
    /// The worker is gone: told by the client itself, and the last event.
    Ended(Ended),
}

/// The paper and the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ready {
    /// Name of the paper.
    pub paper: String,
    /// One line on it.
    pub about: String,
    /// Name, kind and driver of the device.
    pub device: String,
    /// The device is a processor.
    pub is_cpu: bool,
    /// The validation layer is on.
    pub validates: bool,
    /// RenderDoc is there to capture.
    pub can_capture: bool,
    /// Folder whose shaders are compiled when saved.
    pub shader_dir: Option<String>,
    /// Every variant, in the paper's order.
    pub variants: Vec<String>,
    /// Every preset.
    pub presets: Vec<PresetInfo>,
    /// Every parameter, in the order of its declaration.
    pub parameters: Vec<ParameterInfo>,
    /// Doubts about times on this machine, one line each.
    pub warnings: Vec<String>,
}

/// A preset.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PresetInfo {
    /// Name.
    pub name: String,
    /// One line.
    pub help: String,
    /// The variant that it is made for.
    pub variant: Option<String>,
}

/// Cost of a change of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// Shown with the next frame.
    Constants,
    /// Buffers and images are made anew.
    Buffers,
    /// Pipelines as well.
    Pipelines,
}

/// A parameter, from its one declaration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterInfo {
    /// The paper's own term.
    pub name: String,
    /// Heading that it stands under.
    pub group: String,
    /// One line.
    pub help: String,
    /// Section or equation of the paper; may be empty.
    pub section: String,
    /// In words: `metres`; may be empty.
    pub unit: String,
    /// Smallest number, if there is one.
    pub low: Option<f64>,
    /// Largest number, if there is one.
    pub high: Option<f64>,
    /// Range in words with what ends are left out: `above 0 and at most 1`; empty for any.
    pub range: String,
    /// Form of the value: `N`, `X,Y,Z`, `FILE`.
    pub placeholder: String,
    /// Default as help shows it.
    pub default: String,
    /// Cost of a change.
    pub cost: Cost,
    /// `true` or `false`.
    pub is_flag: bool,
    /// Any number of values.
    pub is_list: bool,
    /// Several numbers in one text.
    pub is_several: bool,
    /// Whole numbers.
    pub is_whole: bool,
    /// It may name a file.
    pub is_file: bool,
    /// Among those that the short help lists.
    pub is_everyday: bool,
    /// Names of the values, where they are few.
    pub choices: Vec<ChoiceInfo>,
    /// Names that it must not be given with.
    pub excludes: Vec<String>,
    /// Name that it must be given with.
    pub requires: Option<String>,
}

/// One of a few values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChoiceInfo {
    /// As it is typed.
    pub name: String,
    /// One line; may be empty.
    pub help: String,
}

/// What is set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The last request that it heeds.
    pub heeds: u64,
    /// Preset of the whole.
    pub preset: Option<String>,
    /// The sides.
    pub sides: Vec<SideSetup>,
}

/// What is set on a side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideSetup {
    /// Variant, compiler and preset, none of them left open but a preset that there is none of.
    pub choice: SideChoice,
    /// Text of each parameter, in the order of [`Ready::parameters`]; of a flag `on` or `off`.
    pub values: Vec<String>,
    /// Names of those that were set by hand.
    pub set: Vec<String>,
    /// Variants that cannot draw it, with the reason.
    pub refused: Vec<(String, String)>,
    /// Eye and target of the camera, metres or the paper's unit of length.
    pub camera: Option<[f64; 6]>,
    /// The rest of that camera.
    pub lens: Option<Lens>,
}

/// A camera without its place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// The direction that points up in the picture.
    pub up: [f64; 3],
    /// Opening angle from the bottom to the top edge of the picture.
    pub vertical_fov_rad: f64,
    /// Distance of the near plane, in the unit of length of the eye; depth 0 lies there.
    pub near: f64,
    /// Distance of the far plane; depth 1 lies there.
    pub far: f64,
}

/// The sides as they are built.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Built {
    /// The last request that it heeds.
    pub heeds: u64,
    /// The sides.
    pub sides: Vec<SideBuilt>,
}

/// A side as it is built. Passes and targets are those of the first frame, and come anew when a frame shows others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideBuilt {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Milliseconds of making it; `None` where constants alone changed.
    pub build_ms: Option<f64>,
    /// Milliseconds of loading its input; `None` as above.
    pub load_ms: Option<f64>,
    /// In the paper's order.
    pub passes: Vec<PassInfo>,
    /// Those that can be looked at.
    pub targets: Vec<TargetInfo>,
}

/// A pass.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PassInfo {
    /// The paper's name for it.
    pub name: String,
    /// Section of the paper; may be empty.
    pub section: String,
    /// `graphics`, `compute`, `transfer` or `host`.
    pub kind: String,
    /// Draws, dispatches or executions in a frame.
    pub calls: u32,
    /// Paths under `shaders/`.
    pub shaders: Vec<String>,
    /// Compiler of its binaries.
    pub compiler: Option<String>,
    /// Names of the resources that it reads, in the order of their bindings.
    pub reads: Vec<String>,
    /// Names of the resources that it writes.
    pub writes: Vec<String>,
    /// Indices of the targets that it reads.
    pub read_targets: Vec<usize>,
    /// Indices of the targets that it writes.
    pub written_targets: Vec<usize>,
    /// Blend state of each colour target.
    pub blend: Vec<String>,
    /// State of the depth and stencil test.
    pub depth: Option<String>,
}

/// Type of a target's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ValueKind {
    /// 32-bit float, little-endian.
    F32,
    /// Unsigned, 32 bits, little-endian.
    U32,
    /// Signed, 32 bits, little-endian.
    I32,
    /// Unsigned byte.
    U8,
}

/// Layout of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TargetShape {
    /// Layers of rows of pixels of channels.
    Image {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// 1 to 4.
        channels: u32,
        /// From 1.
        layers: u32,
    },
    /// Rows of columns.
    Table {
        /// Elements.
        rows: u64,
        /// Values of each.
        columns: u64,
    },
}

/// A target or buffer that can be looked at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TargetInfo {
    /// Name, as `--dump` knows it.
    pub name: String,
    /// Name of the resource, as the passes have it.
    pub resource: String,
    /// Values.
    pub kind: ValueKind,
    /// Layout.
    pub shape: TargetShape,
    /// Vulkan's name of the format; empty of a buffer.
    pub format: String,
    /// It holds depths.
    pub is_depth: bool,
    /// 8-bit sRGB, as a picture is.
    pub is_srgb: bool,
}

/// Bytes in the file that both sides have open.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// First byte.
    pub offset: u64,
    /// Number of bytes.
    pub len: u64,
    /// What they are, read by the client.
    #[serde(skip)]
    pub bytes: Vec<u8>,
}

/// An 8-bit sRGB picture with alpha, top row first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Four bytes a pixel.
    pub block: Block,
}

/// A frame to show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Rises from frame to frame.
    pub serial: u64,
    /// The last request that it heeds.
    pub heeds: u64,
    /// Number of the frame.
    pub number: u32,
    /// The clock plays.
    pub is_playing: bool,
    /// Frames that the clock goes on by.
    pub speed: f64,
    /// First passes that it was recorded up to; `None`: all of them.
    pub after: Option<u32>,
    /// The sides.
    pub sides: Vec<SideFrame>,
    /// The sides' difference, where it is wanted and their sizes agree.
    pub difference: Option<Difference>,
    /// The target that is wanted.
    pub target: Option<TargetValues>,
    /// The small pictures that are wanted.
    pub thumbnails: Vec<Thumbnail>,
}

/// A side's part of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideFrame {
    /// `None` where no pass so far has written it.
    pub picture: Option<Picture>,
    /// Milliseconds from the start of recording to the last fence, without stamps.
    pub frame_ms: f64,
    /// Names of the targets that passes of this frame have written.
    pub written: Vec<String>,
}

/// Difference of two pictures in CIE L*u*v*.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Black where they agree, through red and yellow to white at `max`.
    pub picture: Picture,
    /// Mean distance.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest distance.
    pub max: f64,
}

/// A layer of a target, or rows of a table, at full precision.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TargetValues {
    /// What it answers.
    pub choice: TargetChoice,
    /// Values.
    pub kind: ValueKind,
    /// Values in a row: pixels of an image, columns of a table.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Channels of a pixel; 1 of a table.
    pub channels: u32,
    /// Rows of values, top row first; halves are widened to 32 bits.
    pub block: Block,
    /// Of each channel.
    pub statistics: Vec<Statistics>,
    /// False where no pass of this frame has written it so far: the values are the last frame's.
    pub is_written: bool,
}

/// Statistics of one channel. Values that are not finite, and sentinels, count apart.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Values that count.
    pub count: u64,
    /// Values that are not finite.
    pub not_finite: u64,
    /// Values far off all others that stand for none.
    pub masked: u64,
    /// The values that stand for none.
    pub sentinels: Vec<f64>,
    /// Smallest value; this and all below `None` where none counts.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Arithmetic mean.
    pub mean: Option<f64>,
    /// At [`PERCENTILES`], nearest rank.
    pub percentiles: Vec<f64>,
    /// Counts in [`BINS`] bins of equal width from `min` to `max`; the last takes its end in.
    pub histogram: Vec<u64>,
}

/// Percentiles of [`Statistics`]. The second and the last but one are the ramp of `--dump TARGET=FILE.png`.
pub const PERCENTILES: [f64; 7] = [0.0, 0.1, 1.0, 50.0, 99.0, 99.9, 100.0];

/// Bins of a histogram.
pub const BINS: usize = 128;

/// A small picture of a target's first layer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thumbnail {
    /// Name of the target.
    pub name: String,
    /// Drawn as `--dump TARGET=FILE.png` draws it, every so-many-th pixel; `None` where nothing has written it.
    pub picture: Option<Picture>,
}

/// Times of a side, medians of the last samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideTimes {
    /// Samples that stamps gave.
    pub samples: u32,
    /// Milliseconds of a frame without stamps, on the host's clock.
    pub frame_ms: Option<f64>,
    /// Of each pass, in the order of [`SideBuilt::passes`].
    pub passes: Vec<PassTimes>,
}

/// Times and counters of a pass in one frame, summed over its calls; `None` where there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PassTimes {
    /// The pass.
    pub name: String,
    /// Milliseconds between its stamps.
    pub gpu_ms: Option<f64>,
    /// Milliseconds of host work without waiting.
    pub host_ms: Option<f64>,
    /// Milliseconds of waiting.
    pub wait_ms: Option<f64>,
    /// Its part of the sum of all passes' times, 0 to 1.
    pub share: Option<f64>,
    /// Counters of a counted frame.
    pub counters: Option<Counters>,
}

/// Counters of a pass; `None` where the device cannot count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Vertex-stage invocations.
    pub vertices: Option<u64>,
    /// Primitives assembled.
    pub primitives: Option<u64>,
    /// Fragment-stage invocations; some devices count whole blocks.
    pub fragments: Option<u64>,
    /// Compute-stage invocations.
    pub compute_invocations: Option<u64>,
    /// Samples that passed every test.
    pub samples_passed: Option<u64>,
}

/// Something long.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// What it is.
    pub what: Work,
    /// Steps or frames done.
    pub done: u64,
    /// Steps or frames of the whole; `done` equals it at the end.
    pub total: u64,
}

/// Long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Work {
    /// Loading the input and making the sides.
    Build,
    /// Bringing a state to the frame that is wanted.
    Replay,
    /// Drawing frames of a film.
    Film,
    /// Measuring the device's limits.
    Limits,
}

/// The device's own limits, medians; `None` where they could not be measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DeviceLimits {
    /// Copies, 10^9 bytes read a second.
    pub copy_gb_s: Option<f64>,
    /// Fused multiply-adds, 10^9 operations a second.
    pub fma_gflops: Option<f64>,
    /// Fill, 10^9 pixels a second.
    pub fill_gpix_s: Option<f64>,
    /// Blending, 10^9 pixels a second.
    pub blend_gpix_s: Option<f64>,
}

/// Memory.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    /// Live resources, in order of first use.
    pub resources: Vec<ResourceMemory>,
    /// Sum of the resources.
    pub total_bytes: u64,
    /// Largest sum so far.
    pub peak_bytes: u64,
    /// Size of the device's largest heap.
    pub heap_bytes: u64,
    /// What the worker's process holds in memory, the driver's part included; `None` where the system does not tell.
    pub process_bytes: Option<u64>,
}

/// Memory of the resources of one name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResourceMemory {
    /// Debug name.
    pub name: String,
    /// Bytes, alignment included.
    pub bytes: u64,
    /// The host maps it.
    pub is_host_visible: bool,
}

/// The end of a worker.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ended {
    /// Exit code; `None` where a signal ended it.
    pub code: Option<i32>,
    /// Signal that ended it.
    pub signal: Option<i32>,
    /// The last lines that it wrote to standard error.
    pub stderr: Vec<String>,
}

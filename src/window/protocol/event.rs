//! Events from the worker: what there is to draw, and what became of requests.

use serde::{Deserialize, Serialize};

use super::{DeviceLimits, Ended, Frame, MeasureChoice, Memory, Progress, SideChoice, SideTimes};

/// An event from the worker.
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
    /// Measurement from now on, where that is not what was asked for: what was too long, or failed, is given up.
    Measuring(MeasureChoice),
    /// Progress of something long.
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

/// Everything that is set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The last request that it heeds.
    pub heeds: u64,
    /// Preset of the whole.
    pub preset: Option<String>,
    /// The sides.
    pub sides: Vec<SideSetup>,
}

/// Everything that is set on a side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideSetup {
    /// Variant, compiler and preset, none of them left open but a preset that there is none of.
    pub choice: SideChoice,
    /// Text of each parameter, in the order of [`Ready::parameters`]; of a flag `on` or `off`.
    pub values: Vec<String>,
    /// Names of those that were set by hand.
    pub set: Vec<String>,
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
    /// Milliseconds of making it, less pipelines that were there; `None` where constants alone changed.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Near and far plane of the perspective whose depths it holds, in the unit of length of the eye.
    pub planes: Option<[f64; 2]>,
    /// 8-bit sRGB, as a picture is.
    pub is_srgb: bool,
    /// Contents of a texel or row, with units; empty where the name says it all.
    pub holds: String,
}

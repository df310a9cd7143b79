//! Parts of a frame's event: pictures, values, times, memory.

use serde::{Deserialize, Serialize};

use super::{TargetChoice, ValueKind};

/// Bytes in the file that both sides have open.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// First byte.
    pub offset: u64,
    /// Number of bytes.
    pub len: u64,
    /// Their values, read by the client.
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
    /// Milliseconds from the start of recording to the last fence, without timestamps; on a GPU with what lies between its
    /// passes, which are submitted one by one, unless times or counters are wanted.
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
    /// The choice that it answers.
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
    /// Samples that timestamps gave.
    pub samples: u32,
    /// Milliseconds of a frame without timestamps, on the host's clock.
    pub frame_ms: Option<f64>,
    /// Of each pass, in the order of [`SideBuilt::passes`](super::SideBuilt::passes).
    pub passes: Vec<PassTimes>,
}

/// Times and counters of a pass in one frame, summed over its calls; `None` where there are none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PassTimes {
    /// The pass.
    pub name: String,
    /// Milliseconds between its timestamps.
    pub gpu_ms: Option<f64>,
    /// Milliseconds of host work without waiting.
    pub host_ms: Option<f64>,
    /// Milliseconds of waiting.
    pub wait_ms: Option<f64>,
    /// Its part of the sum of all passes' times, 0 to 1.
    pub fraction: Option<f64>,
    /// Counters of a counted frame.
    pub counters: Option<Counters>,
    /// Least time of the counted work at the device's limits, as a record has it; where both were measured.
    pub floor_ms: Option<f64>,
    /// The kind of work that takes most of that.
    pub bound: Option<String>,
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
    /// Kind of work.
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
    /// Memory of the worker's process, the driver's part included; `None` where the system does not tell.
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

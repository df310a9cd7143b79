//! Measurements of a frame and of its passes.

use std::sync::Arc;

use super::pass_info::PassInfo;
use super::work::Work;

/// The measurement that a frame is recorded with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// None: the host's clock alone.
    Plain,
    /// One pair of timestamps round each submission: the GPU's time with its overlap between passes.
    Bracketed,
    /// A timestamp between full barriers after every pass: each pass's own time, without overlap.
    Timestamped,
    /// Counters round every pass.
    Counted,
}

/// Counters of one pass in one frame, summed over its calls; `None` where the device cannot count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Vertex-stage invocations.
    pub vertices: Option<u64>,
    /// Primitives assembled.
    pub primitives: Option<u64>,
    /// Primitives that the clipper lets through, which are set up; what is cut may count as several.
    pub clipped_primitives: Option<u64>,
    /// Fragment-stage invocations; some devices count whole blocks.
    pub fragments: Option<u64>,
    /// Compute-stage invocations, of whole workgroups.
    pub compute_invocations: Option<u64>,
    /// Samples that passed every test, discards included.
    pub samples_passed: Option<u64>,
}

impl Counts {
    pub(super) fn add(&mut self, other: &Counts) {
        let add = |sum: &mut Option<u64>, one: Option<u64>| *sum = sum.iter().copied().chain(one).reduce(|a, b| a + b);
        add(&mut self.vertices, other.vertices);
        add(&mut self.primitives, other.primitives);
        add(&mut self.clipped_primitives, other.clipped_primitives);
        add(&mut self.fragments, other.fragments);
        add(&mut self.compute_invocations, other.compute_invocations);
        add(&mut self.samples_passed, other.samples_passed);
    }
}

/// Measurements of one pass in one frame, summed over its calls.
#[derive(Debug, Clone)]
pub struct PassSample {
    /// The pass.
    pub info: Arc<PassInfo>,
    /// Draws or dispatches; for host work, executions.
    pub calls: u32,
    /// Times that it was recorded, each with any number of calls; 0 of host work.
    pub recordings: u32,
    /// The submission of the frame that it was first part of.
    pub submission: u32,
    /// GPU time in milliseconds, in a timestamped frame.
    pub gpu_ms: Option<f64>,
    /// Host time in milliseconds, of host work.
    pub host_ms: Option<f64>,
    /// Time in milliseconds that the host waited for the pass's results.
    pub wait_ms: Option<f64>,
    /// Counters, in a counted frame.
    pub counts: Option<Counts>,
    /// Bytes, samples and triangles by its declaration, in a counted frame.
    pub work: Option<Work>,
    /// It has more calls in the frame than there are queries, or ran longer than timestamps count: neither time nor counters.
    pub is_overrun: bool,
}

/// The time span of one call of a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Index into [`FrameSample::passes`]; `None` for the frame's own recording and last wait.
    pub pass: Option<usize>,
    /// Start, in milliseconds from the start of recording.
    pub start_ms: f64,
    /// Duration in milliseconds.
    pub duration_ms: f64,
    /// The clock and whose time it is.
    pub track: Track,
}

/// Whose time a span is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Track {
    /// The host works.
    Host,
    /// The host waits for the device.
    Wait,
    /// The device works. Its clock is calibrated against the host's; where it cannot be, the first timestamp of a
    /// submission falls on the host's moment of submitting.
    Gpu,
}

/// Measurements of a frame.
#[derive(Debug, Clone, Default)]
pub struct FrameSample {
    /// The host's clock from the start of recording to the last fence, in milliseconds.
    pub frame_ms: f64,
    /// GPU time between the outer timestamps, summed over the submissions, in a bracketed frame.
    pub bracket_ms: Option<f64>,
    /// In the order of first recording.
    pub passes: Vec<PassSample>,
    /// The time span of each call: host work and waits always, GPU work in a timestamped frame.
    pub spans: Vec<Span>,
}

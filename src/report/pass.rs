//! Passes in the record.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Number;

use super::record::Summary;
use crate::named;

/// One pass of the paper; a loop of draws is one pass with its number of calls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Name of the pass, unique within the variant.
    pub name: String,
    /// Section of the paper, e.g. `"3.2"`.
    pub section: Option<String>,
    /// Kind of the work.
    pub kind: PassKind,
    /// Calls in one frame.
    pub calls: u32,
    /// Index of the queue submission within the frame, from 0; absent for host work.
    pub submission: Option<u32>,
    /// Whose SPIR-V ran; absent where no shader ran.
    pub shader_compiler: Option<String>,
    /// The binaries that ran.
    #[serde(default)]
    pub shaders: Vec<ShaderBinary>,
    /// Sum of the pass's calls in a timestamped frame.
    pub gpu_ms: Option<Summary>,
    /// Host work that the paper's method needs, without waiting.
    pub host_ms: Option<Summary>,
    /// Waiting of the host for the GPU.
    pub wait_ms: Option<Summary>,
    /// Absent where no pipeline statistics were taken.
    pub statistics: Option<Statistics>,
    /// Bytes of the pass's declared accesses; absent for host work, and where no frame was counted.
    pub bytes: Option<Bytes>,
    /// Median GPU time of the frame whose work was counted, the first of every repetition; absent where none was, and in what
    /// older programs wrote.
    #[serde(default)]
    pub counted_ms: Option<f64>,
    /// Least time of its counted work at the device's limits, in milliseconds; absent where none of it is known.
    #[serde(default)]
    pub floor_ms: Option<f64>,
    /// Kind of work that takes most of the floor, one of the names in `floors`.
    #[serde(default)]
    pub bound: Option<String>,
    /// Milliseconds of each kind of work at the device's limit.
    #[serde(default)]
    pub floors: BTreeMap<String, f64>,
}

impl Pass {
    /// The floor as a fraction of the GPU time of the frame that it was counted in: how near the pass comes to the device's
    /// limits. Of older records as a fraction of the median GPU time.
    pub fn fraction_of_limit(&self) -> Option<f64> {
        let ms = self.counted_ms.or_else(|| Some(self.gpu_ms.as_ref()?.median))?;
        Some(self.floor_ms? / Some(ms).filter(|ms| *ms > 0.0)?)
    }

    /// Its time on the device and of host work, in milliseconds; absent where neither was measured.
    pub fn busy_ms(&self) -> Option<f64> {
        let times = [&self.gpu_ms, &self.host_ms].map(|time| time.as_ref().map(|time| time.median));
        times.into_iter().flatten().reduce(|sum, ms| sum + ms)
    }
}

/// The SPIR-V of one stage.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShaderBinary {
    /// Name of the shader.
    pub name: String,
    /// Lower-case hexadecimal SHA-256 of its words.
    pub sha256: String,
    /// Size of the binary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// Number of its SPIR-V instructions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instructions: Option<u64>,
}

named! {
    /// Kind of a pass's work.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum PassKind {
        Graphics = "graphics",
        Compute = "compute",
        Transfer = "transfer",
        Host = "host",
    }
}

/// Pipeline statistics of one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Vertex-stage invocations.
    pub vertices: Option<u64>,
    /// Primitives assembled.
    pub primitives: Option<u64>,
    /// Primitives that the clipper lets through; absent from older records.
    #[serde(default)]
    pub clipped_primitives: Option<u64>,
    /// Fragment-stage invocations; some devices count whole blocks.
    pub fragments: Option<u64>,
    /// Compute-stage invocations, of whole workgroups.
    pub compute_invocations: Option<u64>,
    /// Samples that passed every test, discards included.
    pub samples_passed: Option<u64>,
}

/// Bytes that a pass moves in one frame, by its declared accesses.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bytes {
    /// Bytes that it certainly reads: of attachments by samples kept, of copies, fetches and accesses declared whole.
    pub read: u64,
    /// Bytes that it certainly writes.
    pub written: u64,
    /// The same with all that is merely bound; absent where samples of an attachment are not known.
    #[serde(default)]
    pub at_most: Option<BytesAtMost>,
    /// Names of the resources of which no more is known than that they are bound.
    #[serde(default, deserialize_with = "super::bounded::texts")]
    pub uncertain: Vec<String>,
}

/// Bytes of a pass if it touches all that is bound once a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BytesAtMost {
    /// Bytes read.
    pub read: u64,
    /// Bytes written.
    pub written: u64,
}

/// A pass as both shader compilers make it, measured in turn in one process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Name of the pass.
    pub pass: String,
    /// Times and code of each compiler's binaries.
    #[serde(deserialize_with = "super::bounded::list")]
    pub compilers: Vec<CompiledPass>,
    /// Names of the device's own counters (`VK_KHR_performance_query`); absent where it has none.
    #[serde(default, deserialize_with = "super::bounded::texts_if_any")]
    pub performance_counters: Option<Vec<String>>,
    /// Reason why none of them were read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counters_unread: Option<String>,
}

/// A pass with one compiler's binaries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompiledPass {
    /// The compiler that was asked for.
    pub compiler: String,
    /// Reason why another's binaries ran in some stage; absent where none did.
    pub fallback: Option<String>,
    /// Time of the pass on the device; absent without timestamps.
    pub gpu_ms: Option<Summary>,
    /// The binaries that ran.
    pub binaries: Vec<ShaderBinary>,
    /// Its stages as the driver's compiler made them; absent where the device does not tell.
    pub stages: Option<Vec<CompiledStage>>,
    /// The device's own counters of the pass in frame 0; absent where it has none.
    #[serde(default)]
    pub counters: Option<CounterReadings>,
}

/// Counters of a device (`VK_KHR_performance_query`) of one pass in one frame, which was replayed for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CounterReadings {
    /// Times that the frame was replayed: the device does not count everything at once.
    pub replays: u32,
    /// Times that the frame records the pass.
    pub recordings: u32,
    /// In the device's order.
    pub counters: Vec<CounterReading>,
    /// Names of those that would have taken more replays.
    #[serde(deserialize_with = "super::bounded::texts")]
    pub left_out: Vec<String>,
}

/// One counter of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CounterReading {
    /// The driver's name for it.
    pub name: String,
    /// The driver's group of counters.
    pub category: String,
    /// The driver's words on it.
    pub description: String,
    /// Unit of the value; `"1"` of plain numbers.
    pub unit: String,
    /// Smallest thing that it can be told to count: command buffer, render pass or command.
    pub scope: String,
    /// True where the value is the mean over the pass's recordings, not their sum.
    pub is_mean: bool,
    /// Absent where the device gave no number.
    pub value: Option<Number>,
}

/// One stage as the driver compiled it (`VK_KHR_pipeline_executable_properties`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompiledStage {
    /// The driver's name for it.
    pub name: String,
    /// The driver's words on it.
    pub description: String,
    /// Threads that run in step.
    pub subgroup_size: u32,
    /// Registers, spills, occupancy and the like.
    pub statistics: Vec<StageStatistic>,
    /// Instructions of the device and what came before them, as texts under the driver's names.
    pub texts: BTreeMap<String, String>,
}

/// A value that the driver states of a stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageStatistic {
    /// The driver's name for it.
    pub name: String,
    /// The value as text: its type is the driver's.
    pub value: String,
}

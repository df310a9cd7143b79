//! The record of `stress`, schema [`SCHEMA`]: plain data, in the order in which it is written. The JSON Schema is
//! `schema/fumarole.stress-1.json`. Whatever reads a bench's record reads the runs of this one too.

use std::collections::BTreeMap;

use csv::Terminator;
use serde::{Deserialize, Serialize};

use super::csv::lines;
use super::record::{Environment, InputFile, Record, Run};
use crate::named;

/// The value of [`StressRecord::schema`] that this program writes and reads.
pub const SCHEMA: &str = "fumarole.stress/1";

/// One document: where it was measured, along which axis, and every series of steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressRecord {
    /// [`SCHEMA`].
    pub schema: String,
    /// Device, host and build of all steps.
    pub environment: Environment,
    /// The command line of the latest call, program name first.
    #[serde(deserialize_with = "super::bounded::texts")]
    pub command: Vec<String>,
    /// Name of the paper's command.
    pub paper: String,
    /// Axis that grows from step to step.
    pub axis: AxisName,
    /// Axis that grows from series to series; absent without a matrix.
    pub across: Option<AxisName>,
    /// Factor between two steps.
    pub factor: f64,
    /// Everything that fixes the work of a step beside its values.
    pub settings: Settings,
    /// SHA-256 of settings, environment and axes: steps of one identity are parts of one record.
    pub identity: String,
    /// Number, from 0, and count of the processes that share the series, of which these are one's; absent of the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<[u32; 2]>,
    /// Of every variant, and of every value of the second axis.
    #[serde(deserialize_with = "super::bounded::list")]
    pub series: Vec<Series>,
}

/// An axis as its paper declares it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AxisName {
    /// Name after `--axis`.
    pub name: String,
    /// One line on what it makes larger.
    pub help: String,
    /// Unit of the values.
    pub unit: String,
    /// Unit of the amounts of steps.
    pub amount_unit: String,
}

/// Everything that fixes the work of a step beside its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Every parameter as it is typed; the axis's own before it is set.
    pub parameters: BTreeMap<String, String>,
    /// Name of the preset; absent without one.
    pub preset: Option<String>,
    /// Files that the parameters name.
    pub inputs: Vec<InputFile>,
    /// Frames before anything counts.
    pub warmup: u32,
    /// Frames in one repetition.
    pub frames: u32,
    /// Repetitions of those frames.
    pub repeat: u32,
    /// Whose SPIR-V runs.
    pub shader_compiler: String,
    /// SHA-256 of the shaders that stand in for the built-in ones; absent without any.
    pub shaders: Option<String>,
    /// The validation layer is on.
    pub validation: bool,
}

/// Steps along the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Name of the variant.
    pub variant: String,
    /// Value of the second axis; absent without a matrix.
    pub across: Option<u64>,
    /// By ascending value.
    #[serde(deserialize_with = "super::bounded::list")]
    pub steps: Vec<Step>,
    /// Why there is no further step; absent while it goes on.
    pub stop: Option<Stop>,
    /// Exponents of the frame, of every pass, and of what the steps took, in their amounts.
    #[serde(deserialize_with = "super::bounded::list")]
    pub costs: Vec<Cost>,
}

/// One finished step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Of the axis.
    pub value: u64,
    /// Amount of work that the step really had, in the axis's `amount_unit`.
    pub amount: f64,
    /// Amount over the median frame.
    pub throughput_per_s: Option<f64>,
    /// Seconds that its process took from start to end.
    pub wall_s: f64,
    /// Most memory of its process, with what a software driver allocates for the device; absent where the system does
    /// not tell.
    pub peak_bytes: Option<u64>,
    /// Numbers of each target that are not finite; targets without any are left out.
    pub not_finite: BTreeMap<String, u64>,
    /// As a bench measures it.
    pub run: Run,
}

named! {
    /// Kind of the limit that ended a series.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum StopKind {
        /// The budget.
        Time = "time",
        /// Memory of the device or of the host.
        Memory = "memory",
        /// A limit or the loss of the device.
        Device = "device",
        /// The picture or the results are wrong.
        Correctness = "correctness",
        /// The axis has no greater value.
        End = "end",
        /// The step's process crashed.
        Crash = "crash",
        /// Ctrl-C.
        Interruption = "interruption",
    }
}

impl StopKind {
    /// True for what a second call meets again.
    pub fn is_final(self) -> bool {
        matches!(self, Self::Memory | Self::Device | Self::Correctness)
    }
}

/// End of a series.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stop {
    /// Kind of the limit.
    pub kind: StopKind,
    /// Value of the step that was not finished or not begun; of a wrong one, the step's.
    pub value: u64,
    /// One line.
    pub reason: String,
}

/// Growth of one cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// A pass, or `frame`, `load`, `pipelines`, `device memory`, `process memory`.
    pub name: String,
    /// `gpu` or `host` of a pass; absent of others.
    pub clock: Option<String>,
    /// Absent for fewer than two different amounts.
    pub scaling: Option<Scaling>,
}

/// A cost as a power of the amount, or as two around a knee.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Points that it was fitted to.
    pub points: usize,
    /// One, or two that meet at the knee.
    pub segments: Vec<Segment>,
    /// Amount at which the exponent changes; absent where one exponent explains the points as well.
    pub knee: Option<f64>,
}

/// A range of amounts with one exponent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Least amount of the range.
    pub from: f64,
    /// Greatest amount of the range.
    pub to: f64,
    /// Power of the amount with which the cost grows in the range.
    pub exponent: f64,
    /// 95 %; absent without a point too many.
    pub interval: Option<[f64; 2]>,
}

impl StressRecord {
    /// Every step's run as a bench's record.
    pub fn into_record(self) -> Record {
        let runs = self.series.into_iter().flat_map(|series| series.steps).map(|step| step.run).collect();
        Record::new(self.environment, self.command, runs)
    }

    /// One row for each step and pass.
    pub fn csv(&self) -> String {
        let header = [
            "device",
            "paper",
            "axis",
            "variant",
            "across",
            "value",
            "amount",
            "unit",
            "throughput_per_s",
            "frame_median_ms",
            "load_ms",
            "pipeline_ms",
            "device_bytes",
            "host_bytes",
            "process_peak_bytes",
            "wall_s",
            "pass",
            "section",
            "kind",
            "gpu_median_ms",
            "host_median_ms",
            "wait_median_ms",
        ];
        let text = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let whole = |value: Option<u64>| value.map_or_else(String::new, |value| value.to_string());
        let mut rows = vec![header.map(str::to_owned).to_vec()];
        for (series, step) in self.series.iter().flat_map(|series| series.steps.iter().map(move |step| (series, step)))
        {
            let run = &step.run;
            let of_step = [
                self.environment.device.name.clone(),
                self.paper.clone(),
                self.axis.name.clone(),
                series.variant.clone(),
                whole(series.across),
                step.value.to_string(),
                step.amount.to_string(),
                self.axis.amount_unit.clone(),
                text(step.throughput_per_s),
                text(run.median_frame_ms()),
                text(run.load_ms),
                text(run.pipeline_ms),
                whole(run.memory.device_bytes),
                whole(run.memory.host_bytes),
                whole(step.peak_bytes),
                step.wall_s.to_string(),
            ];
            rows.extend(run.passes.iter().map(|pass| {
                let median = |time: &Option<super::record::Summary>| text(time.as_ref().map(|time| time.median));
                let of_pass = [
                    pass.name.clone(),
                    pass.section.clone().unwrap_or_default(),
                    pass.kind.as_str().to_owned(),
                    median(&pass.gpu_ms),
                    median(&pass.host_ms),
                    median(&pass.wait_ms),
                ];
                of_step.iter().cloned().chain(of_pass).collect()
            }));
        }
        lines(Terminator::CRLF, rows)
    }
}

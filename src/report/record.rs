//! The result record, schema [`SCHEMA`]: plain data, in the order in which it is written.
//!
//! Absent is `None` and is written as `null`, never as 0. Times are milliseconds, sizes bytes. Unknown fields are
//! tolerated when a record is read, so that a newer program's additions do not break an older reader. The JSON Schema
//! is `schema/fumarole.bench-1.json`.

use std::collections::BTreeMap;

use crate::named;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use super::limits::Limits;
pub use super::pass::{
    Bytes, BytesAtMost, CompiledPass, CompiledStage, CounterReading, CounterReadings, Pass, PassKind, Profile,
    ShaderBinary, StageStatistic, Statistics,
};

/// The value of [`Record::schema`] that this program writes and reads.
pub const SCHEMA: &str = "fumarole.bench/1";

/// One document: where it was measured, by which command, and every run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// [`SCHEMA`].
    pub schema: String,
    /// Device, host and build of all runs.
    pub environment: Environment,
    /// The command line, program name first.
    #[serde(deserialize_with = "super::bounded::texts")]
    pub command: Vec<String>,
    /// The measurement by several processes or machines that the runs are of; absent where one process did it all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<Share>,
    /// In the order of measurement.
    #[serde(deserialize_with = "super::bounded::list")]
    pub runs: Vec<Run>,
}

/// A measurement that several processes or machines share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// SHA-256 of everything that fixes the work of all.
    pub identity: String,
    /// Number, from 0, and count of the processes, of which the runs are one's; absent of all together.
    pub shard: Option<[u32; 2]>,
    /// Of each run, the number of what was shared out: a point of a sweep, or a block of `ab`.
    pub items: Vec<u32>,
}

impl Record {
    /// A record of the current [`SCHEMA`].
    pub fn new(environment: Environment, command: Vec<String>, runs: Vec<Run>) -> Self {
        Self { schema: SCHEMA.to_owned(), environment, command, share: None, runs }
    }
}

/// Environment of a measurement: all that it depends on besides the program's input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Environment {
    /// Start of the measurement, RFC 3339 in UTC.
    pub date: String,
    /// The Vulkan device that measured.
    pub device: Device,
    /// The computer and its operating system.
    pub host: Host,
    /// Version of the Vulkan loader.
    pub loader: Option<String>,
    /// Every active layer, those from outside the program included.
    #[serde(deserialize_with = "super::bounded::texts")]
    pub layers: Vec<String>,
    /// The build of the program.
    pub build: Build,
}

/// A Vulkan device and its driver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Device {
    /// `deviceName` of the driver.
    pub name: String,
    /// `deviceType` of the driver.
    #[serde(rename = "type")]
    pub kind: DeviceKind,
    /// Device UUID, hyphenated; absent where the driver tells none.
    pub uuid: Option<String>,
    /// `driverName`: name of the driver.
    pub driver: Option<String>,
    /// `driverInfo`: its version as the driver writes it.
    pub driver_version: Option<String>,
    /// Highest Vulkan version of the device: `1.3.255`.
    pub api_version: String,
    /// Nanoseconds per timestamp tick; absent where the queue has no timestamps.
    pub timestamp_period: Option<f64>,
    /// Valid bits of a timestamp; absent where the queue has no timestamps.
    pub timestamp_bits: Option<u32>,
}

named! {
    /// `VkPhysicalDeviceType`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum DeviceKind {
        Discrete = "discrete",
        Integrated = "integrated",
        Virtual = "virtual",
        Cpu = "cpu",
        Other = "other",
    }
}

/// A computer and its operating system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Host {
    /// Name and release of the operating system, as `Debian GNU/Linux 12 (bookworm)`.
    pub os: String,
    /// Release of the kernel; absent where the system does not tell.
    pub kernel: Option<String>,
    /// Model name of the processor; absent where the system does not tell.
    pub cpu: Option<String>,
    /// Cores this process may run on, at least 1; absent where the system does not tell.
    pub logical_cores: Option<u32>,
    /// The thread count that `LP_NUM_THREADS` pins; absent when it is unset or no number.
    pub lp_num_threads: Option<u32>,
    /// Frequency governor of the first core; absent where the system does not tell.
    #[serde(default)]
    pub cpu_governor: Option<String>,
    /// Environment variables that the Vulkan loader, its layers and Mesa's drivers read, as they were set.
    #[serde(default)]
    pub variables: BTreeMap<String, String>,
}

/// The build of this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Build {
    /// Version of the package.
    pub version: String,
    /// Full hash of the commit.
    pub git_commit: Option<String>,
    /// True when the working tree differed from `git_commit`.
    pub dirty: Option<bool>,
    /// Version of the compiler, as `rustc --version` prints it.
    pub rustc: Option<String>,
    /// Cargo's profile: `release`.
    pub profile: Option<String>,
    /// Lower-case hexadecimal SHA-256 of the program's file.
    #[serde(default)]
    pub executable_sha256: Option<String>,
}

/// One configuration of one variant, measured in one process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the paper's command: `gas`.
    pub paper: String,
    /// Name of the variant, as `--variant` takes it.
    pub variant: String,
    /// Name of the preset that the setup began with; absent without one.
    pub preset: Option<String>,
    /// Every parameter under its option's name, defaults included.
    #[serde(deserialize_with = "super::bounded::object")]
    pub config: Map<String, Value>,
    /// Files that the configuration names.
    #[serde(default)]
    pub inputs: Vec<InputFile>,
    /// Pixels of the picture, at least 1.
    pub width: u32,
    /// Pixels of the picture, at least 1.
    pub height: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Frames before anything counts.
    pub warmup: u32,
    /// Frames in one repetition.
    pub frames: u32,
    /// Repetitions of those frames from a restored state, at least 1.
    pub repeat: u32,
    /// Number of this process among the fresh ones of `--processes`, from 0.
    pub process: u32,
    /// Start of the measurement in this process, RFC 3339 in UTC.
    #[serde(default)]
    pub started: Option<String>,
    /// Host clock from the start of recording to the last fence, without timestamps or queries: one sample per frame,
    /// repetition after repetition.
    pub frame_ms: Option<Summary>,
    /// The passes in the paper's order.
    #[serde(deserialize_with = "super::bounded::list")]
    pub passes: Vec<Pass>,
    /// Median over the frames of the passes' GPU times less the GPU time of the same frame as a whole: what the exclusive
    /// timing forbids to overlap.
    pub overlap_ms: Option<f64>,
    /// Median over the frames of the time that neither GPU nor host work of a pass accounts for.
    pub unaccounted_ms: Option<f64>,
    /// GPU time of an empty pass.
    pub stamp_floor_ms: Option<f64>,
    /// Loading of the input.
    pub load_ms: Option<f64>,
    /// Times of the steps of loading mesh files; absent where none was loaded.
    #[serde(default)]
    pub loading: Option<Loading>,
    /// Making of the resources and pipelines, and the first frame less the median of the plain ones of its number.
    pub pipeline_ms: Option<f64>,
    /// Bytes that the variant's resources take.
    pub memory: Memory,
    /// The device's own limits; absent where they were not measured.
    pub limits: Option<Limits>,
    /// The paper's own figures.
    #[serde(deserialize_with = "super::bounded::object")]
    pub results: Map<String, Value>,
    /// Row of the experiment; absent outside experiments.
    pub experiment: Option<ExperimentRow>,
    /// One pass under both compilers; absent without `--profile`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// State of the validation layer during the run.
    pub validation: Validation,
    /// Doubts about the run, one line each.
    #[serde(deserialize_with = "super::bounded::texts")]
    pub warnings: Vec<String>,
    /// Picture written with the run; absent without one.
    pub image: Option<ImageFile>,
}

/// Parts of loading mesh files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loading {
    /// Bytes of the files that were read.
    pub bytes: u64,
    /// Reading and parsing.
    pub read_ms: f64,
    /// Joining vertices and cutting polygons.
    pub weld_ms: f64,
    /// Computing normals that files lack.
    pub normals_ms: f64,
    /// Ordering triangles and vertices for the device's vertex cache.
    pub optimise_ms: f64,
    /// Finding meshes in the cache, or keeping them there.
    pub cache_ms: f64,
    /// Meshes that were found in the cache.
    pub from_cache: u32,
}

impl Run {
    /// Times of the plain frames in milliseconds; none where nothing was measured.
    pub fn frame_samples(&self) -> &[f64] {
        self.frame_ms.as_ref().map_or(&[], |frame| &frame.samples)
    }

    /// Median of the plain frames; absent where nothing was measured.
    pub fn median_frame_ms(&self) -> Option<f64> {
        self.frame_ms.as_ref().map(|frame| frame.median)
    }
}

/// A file that a run read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path, as `config` has it.
    pub path: String,
    /// Lower-case hexadecimal SHA-256 of its content, with that of the files that it names.
    pub sha256: String,
}

/// Raw samples and what they come to. A summary has at least one sample; no samples are an absent summary.
///
/// Made by `measure::statistics::summarize`, which defines the percentiles and the MAD.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// In the order of measurement.
    pub samples: Vec<f64>,
    /// Smallest sample.
    pub min: f64,
    /// Mean of the middle two for an even number of samples.
    pub median: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Absent for fewer than 20 samples.
    pub p95: Option<f64>,
    /// Absent for fewer than 100 samples.
    pub p99: Option<f64>,
    /// Largest sample.
    pub max: f64,
    /// Median absolute deviation from the median, unscaled; absent for fewer than 2 samples.
    pub mad: Option<f64>,
}

/// Bytes allocated for a variant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Sum of device-local resources.
    pub device_bytes: Option<u64>,
    /// Sum of host-visible resources.
    pub host_bytes: Option<u64>,
    /// Greatest sum while the resources were made.
    pub peak_bytes: Option<u64>,
    /// Every resource of the variant.
    pub by_resource: Vec<ResourceMemory>,
}

/// Bytes allocated for the resources of one name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResourceMemory {
    /// Name of the resource, without its variant's prefix.
    pub name: String,
    /// Bytes allocated.
    pub bytes: u64,
}

/// The row of a paper's table or figure that a run reproduces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExperimentRow {
    /// Label of the row.
    pub row: String,
    /// The paper's number; absent where the paper prints none.
    pub paper: Option<f64>,
    /// The number measured; absent where the variant was left out.
    pub ours: Option<f64>,
    /// `ours / paper`.
    pub ratio: Option<f64>,
    /// Ends of the 95 % interval of `ours`; absent where it is no ratio of methods measured in turn.
    #[serde(default)]
    pub interval: Option<[f64; 2]>,
}

impl ExperimentRow {
    /// The row with the ratio of our number and the paper's.
    pub fn new(row: String, paper: impl Into<Option<f64>>, ours: Option<f64>, interval: Option<[f64; 2]>) -> Self {
        let paper = paper.into();
        ExperimentRow { row, paper, ours, ratio: ours.zip(paper).map(|(ours, paper)| ours / paper), interval }
    }
}

named! {
    /// State of the validation layer.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Validation {
        /// The validation layer ran and had nothing to say.
        Clean = "clean",
        Off = "off",
    }
}

/// A picture written with a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageFile {
    /// Path of the PNG file.
    pub path: String,
    /// Lower-case hexadecimal SHA-256 of the file.
    pub sha256: String,
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::report::example;
    use crate::report::record::Record;

    fn validator() -> jsonschema::Validator {
        let schema = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.bench-1.json"));
        let schema: Value = serde_json::from_str(schema).unwrap();
        jsonschema::meta::validate(&schema).unwrap();
        jsonschema::validator_for(&schema).unwrap()
    }

    fn document(record: &Record) -> Value {
        serde_json::to_value(record).unwrap()
    }

    #[test]
    fn full_and_minimal_records_meet_the_schema() {
        let validator = validator();
        for record in [example::full(), example::minimal()] {
            let errors: Vec<String> = validator
                .iter_errors(&document(&record))
                .map(|error| format!("{}: {error}", error.instance_path()))
                .collect();
            assert!(errors.is_empty(), "{errors:#?}");
        }
    }

    #[test]
    fn wrong_types_and_missing_fields_do_not() {
        let validator = validator();
        let wrong = [
            ("/schema", json!("fumarole.bench/2")),
            ("/environment/device/type", json!("gpu")),
            ("/runs/0/frame_ms/samples", json!([])),
            ("/runs/0/frame_ms/median", Value::Null),
            ("/runs/0/width", json!("800")),
            ("/runs/0/passes/1/gpu_ms", json!(0)),
            ("/runs/0/passes/0/kind", json!("cpu")),
            ("/runs/0/image/sha256", json!("none")),
        ];
        for (pointer, value) in wrong {
            let mut document = document(&example::full());
            *document.pointer_mut(pointer).unwrap() = value;
            assert!(!validator.is_valid(&document), "{pointer}");
        }
        let full = document(&example::full());
        for (pointer, fields) in [
            ("", &full),
            ("/environment", &full["environment"]),
            ("/runs/0", &full["runs"][0]),
            ("/runs/0/passes/1", &full["runs"][0]["passes"][1]),
        ] {
            // What later programs of the schema added, older records lack.
            let added =
                ["inputs", "loading", "started", "shaders", "samples", "counted_ms", "floor_ms", "bound", "floors"];
            for field in fields.as_object().unwrap().keys().filter(|field| !added.contains(&field.as_str())) {
                let mut document = full.clone();
                let object = document.pointer_mut(pointer).unwrap();
                object.as_object_mut().unwrap().remove(field);
                assert!(!validator.is_valid(&document), "{pointer}/{field}");
            }
        }
    }
}

//! A measurement turned into a run of the record.

use serde_json::{Map, Value};

use super::config::entries;
use super::floor::floor;
use super::measure::{COUNTED, FrameSpan, MeasuredPass, Measurement, Schedule};
use super::statistics::{median, repetition_noise, summarize};
use super::study::Identity;
use crate::gpu::live::MemoryUse;
use crate::gpu::{self, Mode, PassKind, Work};
use crate::report::console::SCATTERS_BY;
use crate::report::record::{
    self, InputFile, Limits, Loading, Memory, Pass, ResourceMemory, Run, ShaderBinary, Statistics, Validation,
};
use crate::report::trace::{TraceEvent, TraceRun, Track};

/// Repetitions that scatter more than this are called noisy.
const NOISY: f64 = 0.05;

/// Metadata of a run: all that its record holds beside the measurement.
pub struct RunMetadata {
    /// [`Study::PAPER`](super::study::Study::PAPER).
    pub paper: &'static str,
    /// Name of the variant.
    pub variant: String,
    /// Preset, size and seed.
    pub identity: Identity,
    /// Number of the fresh process that measured it, from 0.
    pub process: u32,
    /// Every parameter under its option's name, defaults included.
    pub config: Map<String, Value>,
    /// Files that the configuration names.
    pub inputs: Vec<InputFile>,
    /// Start of the measurement, RFC 3339.
    pub started: String,
    /// Milliseconds of loading the input.
    pub load_ms: f64,
    /// Times of the steps of loading its mesh files.
    pub loading: Option<Loading>,
    /// Milliseconds of making the variant's resources and pipelines.
    pub build_ms: f64,
    /// Every live resource of the variant.
    pub memory: Vec<MemoryUse>,
    /// Greatest number of bytes that the variant had allocated while it was made.
    pub peak_bytes: u64,
    /// The paper's own figures.
    pub results: Map<String, Value>,
    /// The device's own limits, where they were measured.
    pub limits: Option<Limits>,
    /// GPU time of an empty pass in milliseconds; `None` without timestamps.
    pub stamp_floor_ms: Option<f64>,
    /// Set where the device is a CPU.
    pub is_cpu: bool,
    /// State of the validation layer.
    pub validation: Validation,
    /// Doubts about the run, one line each.
    pub warnings: Vec<String>,
}

/// Assembles the run.
pub fn assemble(metadata: RunMetadata, measurement: &Measurement, schedule: Schedule) -> Run {
    let passes: Vec<Pass> =
        measurement.passes.iter().map(|p| pass(p, metadata.limits.as_ref(), metadata.is_cpu)).collect();
    let frame_ms = summarize(&measurement.frame_ms);
    let is_untimed = |p: &&MeasuredPass| p.gpu_ms.iter().any(|ms| ms.is_nan());
    let untimed: Vec<&str> = measurement.passes.iter().filter(is_untimed).map(|p| p.info.name).collect();
    let uncounted: Vec<&str> = measurement.passes.iter().filter(|p| p.is_uncounted).map(|p| p.info.name).collect();
    let is_timestamped = untimed.is_empty() && passes.iter().any(|p| p.gpu_ms.is_some());
    let mut warnings = metadata.warnings;
    if !untimed.is_empty() {
        let names = untimed.join(", ");
        warnings.push(format!(
            "GPU times of {names} are absent: a frame has more calls than there are timestamps, or runs longer than they count"
        ));
    }
    if !uncounted.is_empty() {
        let names = uncounted.join(", ");
        warnings.push(format!("statistics of {names} are absent: a frame has more calls than there are counters"));
    }
    if let Some(noise) = repetition_noise(&measurement.frame_ms, schedule.frames as usize).filter(|&n| n > NOISY) {
        warnings.push(format!("{SCATTERS_BY}{:.0} %", noise * 100.0));
    }
    if measurement.repeat < schedule.repeat {
        warnings.push(format!("interrupted after {} of {} repetitions", measurement.repeat, schedule.repeat));
    }
    let measured_s = measurement.frame_ms.iter().sum::<f64>() * 1e-3;
    if measured_s < schedule.min_time_s {
        let wanted_s = schedule.min_time_s;
        warnings.push(format!("plain frames took {measured_s:.1} s of the {wanted_s} s that `min-time` asks for"));
    }
    let sum =
        |host: bool| Some(metadata.memory.iter().filter(|m| m.host_visible == host).map(|m| m.bytes).sum::<u64>());
    Run {
        paper: metadata.paper.to_owned(),
        variant: metadata.variant,
        preset: metadata.identity.preset,
        config: metadata.config,
        inputs: metadata.inputs,
        started: Some(metadata.started),
        width: metadata.identity.width,
        height: metadata.identity.height,
        seed: metadata.identity.seed,
        warmup: schedule.warmup.max(1),
        frames: schedule.frames,
        repeat: measurement.repeat.max(1),
        process: metadata.process,
        overlap_ms: measurement.overlap_ms().filter(|_| is_timestamped),
        unaccounted_ms: measurement.unaccounted_ms().filter(|_| is_timestamped),
        stamp_floor_ms: metadata.stamp_floor_ms,
        load_ms: Some(metadata.load_ms),
        loading: metadata.loading,
        pipeline_ms: Some(metadata.build_ms + measurement.first_frame_ms),
        memory: Memory {
            device_bytes: sum(false),
            host_bytes: sum(true),
            peak_bytes: Some(metadata.peak_bytes),
            by_resource: metadata
                .memory
                .iter()
                .map(|m| ResourceMemory { name: m.name.clone(), bytes: m.bytes })
                .collect(),
        },
        limits: metadata.limits,
        results: metadata.results,
        experiment: None,
        profile: None,
        validation: metadata.validation,
        warnings,
        image: None,
        frame_ms,
        passes,
    }
}

fn pass(measured: &MeasuredPass, limits: Option<&Limits>, is_cpu: bool) -> Pass {
    let info = &measured.info;
    let floor = limits.and_then(|limits| {
        floor(measured.work.as_ref()?, &measured.counts.unwrap_or_default(), info.kind, limits, is_cpu)
    });
    let is_host = info.kind == PassKind::Host;
    Pass {
        name: info.name.to_owned(),
        section: (!info.section.is_empty()).then(|| info.section.to_owned()),
        kind: match info.kind {
            PassKind::Graphics => record::PassKind::Graphics,
            PassKind::Compute => record::PassKind::Compute,
            PassKind::Transfer => record::PassKind::Transfer,
            PassKind::Host => record::PassKind::Host,
        },
        calls: measured.calls,
        submission: (!is_host).then_some(measured.submission),
        shader_compiler: info.compiler.map(|c| c.to_string()),
        shaders: info.binaries.iter().map(shader_binary).collect(),
        gpu_ms: summarize(&measured.gpu_ms),
        host_ms: summarize(&measured.host_ms),
        wait_ms: summarize(&measured.wait_ms),
        statistics: measured.counts.map(|c| Statistics {
            vertices: c.vertices,
            primitives: c.primitives,
            clipped_primitives: c.clipped_primitives,
            fragments: c.fragments,
            compute_invocations: c.compute_invocations,
            samples_passed: c.samples_passed,
        }),
        bytes: measured.work.as_ref().map(bytes),
        counted_ms: median(&measured.counted_ms).filter(|ms| measured.work.is_some() && ms.is_finite()),
        floor_ms: floor.as_ref().map(|floor| floor.ms),
        bound: floor.as_ref().map(|floor| floor.bound.to_owned()),
        floors: floor.iter().flat_map(|f| &f.terms).map(|(name, ms)| ((*name).to_owned(), *ms)).collect(),
    }
}

/// A stage's binary as the record has it.
pub fn shader_binary(binary: &gpu::Binary) -> ShaderBinary {
    ShaderBinary {
        name: binary.name.clone(),
        sha256: binary.sha256.clone(),
        bytes: Some(binary.bytes),
        instructions: Some(binary.instructions),
    }
}

fn bytes(work: &Work) -> record::Bytes {
    record::Bytes {
        read: work.bytes.read,
        written: work.bytes.written,
        at_most: work.bytes_at_most.map(|bytes| record::BytesAtMost { read: bytes.read, written: bytes.written }),
        uncertain: work.uncertain.clone(),
    }
}

/// The measured frames as a trace: of plain ones what the host did and waited for, of bracketed ones each submission as well, of
/// timestamped ones each pass.
pub fn trace(name: String, measurement: &Measurement) -> TraceRun {
    let event = |FrameSpan { mode, repetition, frame, frame_start_ms, span }: &FrameSpan| {
        let measured = match mode {
            Mode::Plain => "plain",
            Mode::Bracketed => "bracketed",
            Mode::Timestamped => "timestamped",
            Mode::Counted => "counted",
        };
        let mut args =
            entries([("mode", measured.into()), ("repetition", (*repetition).into()), ("frame", (*frame).into())]);
        let pass = match span.pass {
            None => None,
            Some(index) => Some(measurement.passes.get(index)?),
        };
        args.extend(pass.into_iter().flat_map(arguments));
        let name = match (pass, span.track) {
            (Some(pass), _) => pass.info.name,
            (None, gpu::Track::Wait) => "wait for the device",
            (None, gpu::Track::Gpu) => "submission",
            (None, gpu::Track::Host) => "record",
        };
        Some(TraceEvent {
            name: name.to_owned(),
            track: match span.track {
                gpu::Track::Host => Track::Host,
                gpu::Track::Wait => Track::Wait,
                gpu::Track::Gpu => Track::Gpu,
            },
            start_us: (frame_start_ms + span.start_ms) * 1e3,
            duration_us: span.duration_ms * 1e3,
            args,
        })
    };
    let events = measurement.spans.iter().filter_map(event).collect();
    TraceRun { name, events, frames_left_out: measurement.frames_without_spans }
}

/// Section of a pass, its calls, and bytes and counters of the one frame that is counted, with its number; what is not known
/// is left out.
fn arguments(pass: &MeasuredPass) -> Map<String, Value> {
    let counts = pass.counts.unwrap_or_default();
    let work = pass.work.as_ref();
    let known = [
        ("calls", Some(u64::from(pass.calls))),
        ("counted_frame", work.map(|_| u64::from(COUNTED))),
        ("bytes_read", work.map(|work| work.bytes.read)),
        ("bytes_written", work.map(|work| work.bytes.written)),
        ("bytes_read_at_most", work.and_then(|work| Some(work.bytes_at_most?.read))),
        ("bytes_written_at_most", work.and_then(|work| Some(work.bytes_at_most?.written))),
        ("vertices", counts.vertices),
        ("primitives", counts.primitives),
        ("clipped_primitives", counts.clipped_primitives),
        ("fragments", counts.fragments),
        ("compute_invocations", counts.compute_invocations),
        ("samples_passed", counts.samples_passed),
    ];
    let known = known.into_iter().filter_map(|(name, value)| Some((name.to_owned(), Value::from(value?))));
    entries([("section", pass.info.section.into())]).into_iter().chain(known).collect()
}

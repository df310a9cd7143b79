//! One pass under both shader compilers, measured in turn in one process: what its binaries are, what the driver made of
//! them, and how long they take.

use serde_json::Number;

use crate::gpu::{self, Binary, Compiler, CounterValue, Counting, Mode, PassInfo, PerformanceReadings, ShaderLibrary};
use crate::measure::Paper;
use crate::measure::Variant;
use crate::measure::assembly::shader_binary;
use crate::measure::bench::{Loaded, measure_settled};
use crate::measure::error::Error;
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::measure::{Schedule, Watch};
use crate::measure::statistics::summarize;
use crate::measure::study::Study;
use crate::report::record::{CompiledPass, CompiledStage, CounterReading, CounterReadings, Profile, StageStatistic};
use crate::shader_build::NAGA_EXCEPTIONS;

/// Names of the passes of a variant that run on the device, as one frame has them.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn passes<S: Study>(
    machine: &mut Machine,
    study: &S,
    loaded: &Loaded<S>,
    variant: S::Variant,
) -> Result<Vec<&'static str>, Error> {
    let mut built = super::bench::build(machine, study, &loaded.scene, variant)?;
    let sample = machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0))?;
    let on_device = sample.passes.iter().filter(|pass| !pass.info.binaries.is_empty());
    Ok(on_device.map(|pass| pass.info.name).collect())
}

/// Measures the pass of that name of a variant with the binaries of each compiler, in turn. `None` where the variant has no
/// such pass.
///
/// # Errors
/// Any error of the Vulkan layer or of the shaders; [`Error::Interrupted`].
pub fn profile<S: Study>(
    machine: &mut Machine,
    options: &MachineOptions,
    (study, loaded): (&S, &Loaded<S>),
    (variant, pass): (S::Variant, &str),
    schedule: Schedule,
    watch: &mut Watch<'_>,
) -> Result<Option<Profile>, Error> {
    let mut made = Vec::new();
    for compiler in [Compiler::Glslang, Compiler::Naga] {
        let shaders = ShaderLibrary::new(&machine.device, compiler, options.shader_dir.as_deref())?;
        let label = format!("{} {compiler}", variant.as_str());
        let paper = study.make(&shaders, &label, &loaded.scene, variant);
        made.push((compiler, paper.map_err(|error| shaders.blamed(error))?, shaders));
    }
    let mut papers: Vec<(&mut dyn Paper, _)> =
        made.iter_mut().map(|(_, paper, shaders)| (paper as &mut dyn Paper, &*shaders)).collect();
    let measurements = measure_settled(&machine.device, &mut machine.recorder, &mut papers, schedule, watch)?;
    let mut compilers = Vec::new();
    let mut counters_unread = None;
    for ((compiler, paper, _), measurement) in made.iter_mut().zip(&measurements) {
        let Some(measured) = measurement.passes.iter().find(|measured| measured.info.name == pass) else {
            return Ok(None);
        };
        let counters = match count(machine, paper, pass)? {
            Counted::All(readings) => Some(recorded(readings)),
            Counted::None => None,
            Counted::Refused(reason) => {
                counters_unread = Some(reason);
                None
            }
        };
        compilers.push(CompiledPass {
            compiler: compiler.to_string(),
            fallback: fallback(*compiler, &measured.info),
            gpu_ms: summarize(&measured.gpu_ms),
            binaries: measured.info.binaries.iter().map(shader_binary).collect(),
            stages: stages(&measured.info),
            counters,
        });
    }
    machine.check_validation()?;
    let names = |all: &[gpu::PerformanceCounter]| all.iter().map(|counter| counter.name.clone()).collect();
    let performance_counters = machine.device.physical().performance_counters().map(names);
    Ok(Some(Profile { pass: pass.to_owned(), compilers, performance_counters, counters_unread }))
}

/// The device's own counters, or the reason why there are none.
enum Counted {
    All(PerformanceReadings),
    /// The device has none.
    None,
    /// It has, and they are not to be had, for this reason.
    Refused(String),
}

/// Reads the device's own counters of a pass in frame 0, which is replayed from the state before it as often as the device
/// needs. Nothing of this is timed.
fn count(machine: &mut Machine, paper: &mut impl Paper, pass: &str) -> Result<Counted, Error> {
    if machine.device.physical().performance_counters().is_none_or(<[_]>::is_empty) {
        return Ok(Counted::None);
    }
    paper.restart()?;
    let sample = machine.recorder.run(Mode::Plain, |frame| paper.record(frame, 0))?;
    let recordings = sample.passes.iter().find(|sample| sample.info.name == pass).map_or(0, |sample| sample.recordings);
    let counting = match Counting::begin(&mut machine.recorder, pass, recordings) {
        // The lock, or queries of this kind, may be refused to a process that can do all else.
        Err(error @ (gpu::Error::Unsupported { .. } | gpu::Error::Vulkan { .. })) => {
            return Ok(Counted::Refused(error.to_string()));
        }
        other => other?,
    };
    let Some(mut counting) = counting else {
        return Ok(Counted::Refused("each of them alone takes too many replays of the frame".to_owned()));
    };
    for _ in 0..counting.replays() {
        paper.restart()?;
        counting.replay(|frame| paper.record(frame, 0))?;
    }
    Ok(Counted::All(counting.finish()?))
}

fn recorded(readings: PerformanceReadings) -> CounterReadings {
    let number = |value: CounterValue| match value {
        CounterValue::Integer(value) => u64::try_from(value)
            .map(Number::from)
            .or_else(|_| i64::try_from(value).map(Number::from))
            .ok()
            .or_else(|| Number::from_f64(value as f64)),
        CounterValue::Float(value) => Number::from_f64(value),
    };
    let counters = readings.values.into_iter().map(|(counter, value)| CounterReading {
        unit: counter.unit().to_owned(),
        scope: counter.scope().to_owned(),
        is_mean: readings.recordings > 1 && !counter.is_amount(),
        value: value.and_then(number),
        name: counter.name,
        category: counter.category,
        description: counter.description,
    });
    CounterReadings {
        replays: readings.replays,
        recordings: readings.recordings,
        counters: counters.collect(),
        left_out: readings.left_out,
    }
}

/// Why other binaries than the compiler's ran.
fn fallback(compiler: Compiler, info: &PassInfo) -> Option<String> {
    let others: Vec<String> = info
        .binaries
        .iter()
        .filter(|binary| binary.compiler != compiler)
        .map(|Binary { name, .. }| {
            let reason = NAGA_EXCEPTIONS.iter().find(|(shader, _)| shader == name).map(|(_, reason)| *reason);
            let reason = reason.unwrap_or("a geometry stage is in the pass, which naga does not have");
            format!("{name}: {reason}")
        })
        .collect();
    (!others.is_empty()).then(|| others.join("; "))
}

fn stages(info: &PassInfo) -> Option<Vec<CompiledStage>> {
    let stages = info.executables.as_ref()?.iter().map(|one| CompiledStage {
        name: one.name.clone(),
        description: one.description.clone(),
        subgroup_size: one.subgroup_size,
        statistics: one
            .statistics
            .iter()
            .map(|one| StageStatistic { name: one.name.clone(), value: one.value.clone() })
            .collect(),
        texts: one.texts.iter().cloned().collect(),
    });
    Some(stages.collect())
}

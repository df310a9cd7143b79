//! One step, in the process that it has to itself.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Axis, host_memory};
use crate::gpu;
use crate::image::{Raster, Samples};
use crate::measure::bench::{Bench, load_for};
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::measure::{Schedule, Watch};
use crate::measure::picture::read_target;
use crate::measure::study::Study;
use crate::measure::{Error, Paper};
use crate::report::record::{Environment, Run};
use crate::report::stress::StopKind;

/// Report of a step's process.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Report {
    /// Machine that it would be measured on.
    Machine(Box<Environment>),
    /// The finished step.
    Measured(Box<Measured>),
    /// The limit that it met.
    Stopped { kind: StopKind, reason: String },
    /// Why no step can be taken: an input that is wrong.
    Refused(String),
}

/// A finished step, but for what only its parent knows.
#[derive(Debug, Serialize, Deserialize)]
pub struct Measured {
    /// The run as a bench records it.
    pub run: Run,
    /// Amount of work that the step really had, in the axis's `amount_unit`.
    pub amount: f64,
    /// Numbers of each target that are not finite, where there are any.
    pub not_finite: BTreeMap<String, u64>,
    /// Most memory of the process so far.
    pub peak_bytes: Option<u64>,
}

/// Measures a set-up whose axes are set, in one variant.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Input`] and the like of the paper; [`Error::Interrupted`] also where only a part was measured.
pub fn measure<S: Study>(
    study: &S,
    (axis, value): (&Axis<S>, u64),
    variant: S::Variant,
    options: &MachineOptions,
    schedule: Schedule,
    watch: &mut Watch<'_>,
) -> Result<Measured, Error> {
    let (loaded, mut machine) = load_for(study, &[variant], || Machine::open(options, S::NEEDS))?;
    let bench = Bench { study, loaded: &loaded, variants: &[variant], schedule, limits: None };
    let mut not_finite = BTreeMap::new();
    let mut runs = bench.measure_and(&mut machine, watch, |machine, paper| {
        for target in paper.targets() {
            let count = match read_target(&machine.device, &target) {
                Ok(raster) => doubtful(&raster),
                // Of the picture alone, which no measured frame draws.
                Err(Error::Gpu(gpu::Error::ReadBeforeWrite { .. })) => 0,
                Err(error) => return Err(error),
            };
            if count > 0 {
                not_finite.insert(target.name, count);
            }
        }
        Ok(())
    })?;
    let Some(run) = runs.pop().map(|measured| measured.run).filter(|run| run.repeat >= schedule.repeat) else {
        return Err(Error::Interrupted);
    };
    let amount = axis.amount_of(study, value, &run);
    Ok(Measured { run, amount, not_finite, peak_bytes: host_memory::peak_bytes() })
}

/// Numbers that are not finite.
fn doubtful(raster: &Raster) -> u64 {
    match raster.samples() {
        Samples::F32(values) => values.iter().filter(|value| !value.is_finite()).count() as u64,
        _ => 0,
    }
}

/// Kind of the limit that an error tells of; none of an input that is wrong.
pub fn stop_kind(error: &Error) -> Option<StopKind> {
    use gpu::Error as E;
    match error {
        Error::Gpu(error) => match error {
            E::OutOfMemory { .. } | E::Allocation { .. } => Some(StopKind::Memory),
            E::Limit { what, .. } if what.contains("all buffers") => Some(StopKind::Memory),
            E::Limit { .. } | E::Unsupported { .. } | E::Vulkan { .. } => Some(StopKind::Device),
            E::Pass { .. } | E::Validation { .. } | E::ReadBeforeWrite { .. } => Some(StopKind::Correctness),
            E::NoLoader { .. }
            | E::NoInstance { .. }
            | E::NoDevice { .. }
            | E::NoValidationLayer
            | E::UnknownDevice { .. }
            | E::AmbiguousDevice { .. }
            | E::MissingFeature { .. }
            | E::Shader { .. }
            | E::Capture { .. }
            | E::Filling { .. } => None,
            E::Interrupted => Some(StopKind::Interruption),
            E::InUse { .. } | E::Foreign { .. } | E::HostAccess { .. } | E::BeyondEnd { .. } => Some(StopKind::Crash),
        },
        Error::Parameter(_) => Some(StopKind::End),
        Error::Interrupted => Some(StopKind::Interruption),
        Error::Scene(_) | Error::Image(_) | Error::Output(_) | Error::Plot(_) | Error::Input(_) => None,
        // Of an experiment alone.
        Error::Law(_) | Error::Shared => None,
    }
}

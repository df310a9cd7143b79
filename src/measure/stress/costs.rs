//! Costs that grow with the amounts of a series, and their exponents.

use super::fit::scaling;
use crate::report::record::{Pass, Run};
use crate::report::stress::{Cost, Series, Step};

/// Exponents of the frame, of every pass on its clock, of loading and making, and of memory. A time of a pass that is no
/// longer than an empty one's is left out.
pub fn costs(series: &Series) -> Vec<Cost> {
    let fitted = |name: &str, clock: Option<&str>, of: &dyn Fn(&Step) -> Option<f64>| {
        let points: Vec<(f64, f64)> = series.steps.iter().filter_map(|step| Some((step.amount, of(step)?))).collect();
        Cost { name: name.to_owned(), clock: clock.map(str::to_owned), scaling: scaling(&points) }
    };
    let mut costs = vec![fitted("frame", None, &|step| step.run.median_frame_ms())];
    for (name, clock) in passes(series) {
        costs.push(fitted(name, Some(clock), &|step| pass_ms(&step.run, name, clock)));
    }
    costs.extend([
        fitted("load", None, &|step| step.run.load_ms),
        fitted("pipelines", None, &|step| step.run.pipeline_ms),
        fitted("device memory", None, &|step| device_bytes(&step.run)),
        fitted("process memory", None, &|step| step.peak_bytes.map(|bytes| bytes as f64)),
    ]);
    costs
}

/// Bytes of all resources, wherever they lie.
pub fn device_bytes(run: &Run) -> Option<f64> {
    Some((run.memory.device_bytes? + run.memory.host_bytes.unwrap_or(0)) as f64)
}

/// Every pass of a series with the clock that times it, in the order of the largest step.
pub fn passes(series: &Series) -> Vec<(&str, &'static str)> {
    let last = series.steps.last().map_or(&[][..], |step| &step.run.passes);
    last.iter().filter_map(|pass| Some((pass.name.as_str(), clock(pass)?))).collect()
}

fn clock(pass: &Pass) -> Option<&'static str> {
    match (&pass.gpu_ms, &pass.host_ms) {
        (Some(_), _) => Some("gpu"),
        (None, Some(_)) => Some("host"),
        (None, None) => None,
    }
}

/// Median of a pass in a run; none of one that is no longer than an empty one's.
pub fn pass_ms(run: &Run, name: &str, clock: &str) -> Option<f64> {
    let pass = run.passes.iter().find(|pass| pass.name == name)?;
    if clock == "host" {
        return Some(pass.host_ms.as_ref()?.median);
    }
    Some(pass.gpu_ms.as_ref()?.median).filter(|time| *time > run.stamp_floor_ms.unwrap_or(0.0))
}

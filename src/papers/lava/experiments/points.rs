//! Cost of the passes that draw points or splats without their fragments: the same points with an empty fragment stage.

use serde_json::{Map, Value, json};

use crate::gpu::Mode;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::statistics::median;
use crate::papers::lava::{FLOORS, Lava};
use crate::report::record::{Pass, Run};

/// Name among the results of a run.
const NAME: &str = "points_ms";

/// Milliseconds of each pass's points alone, by the passes' names, under the name that the results have them. Null without
/// timestamps.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn measure(machine: &mut Machine, paper: &Lava) -> Result<(&'static str, Value), Error> {
    const SAMPLES: usize = 3;
    let mut times: [Vec<f64>; FLOORS.len()] = Default::default();
    // The first round compiles the pipelines.
    for round in 0..=SAMPLES {
        let sample = machine.recorder.run(Mode::Timestamped, |frame| paper.record_floors(frame))?;
        for ((_, floor), times) in FLOORS.iter().zip(&mut times).filter(|_| round > 0) {
            times.extend(sample.passes.iter().find(|p| p.info.name == *floor).and_then(|p| p.gpu_ms));
        }
    }
    let of_passes: Map<String, Value> =
        FLOORS.iter().zip(&times).map(|((pass, _), times)| ((*pass).to_owned(), json!(median(times)))).collect();
    Ok((NAME, json!(of_passes)))
}

/// Milliseconds of a pass's points alone; absent for one that draws none.
pub fn points_ms(run: &Run, pass: &Pass) -> Option<f64> {
    run.results.get(NAME)?.get(&pass.name)?.as_f64()
}

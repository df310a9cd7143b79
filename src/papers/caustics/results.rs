//! The paper's own figures of measured runs: what was drawn for the caustics maps, and how fast.

use serde_json::{Map, Value as Json, json};

use super::Caustics;
use super::parameters::Variant;
use super::setup::Setup;
use crate::gpu::Mode;
use crate::measure::Error;
use crate::measure::Paper as _;
use crate::measure::bench::Built;
use crate::measure::config::entries;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::statistics::median;
use crate::measure::study::Metrics;

/// Those of each run, and its warnings.
///
/// # Errors
/// [`Error::Gpu`].
pub fn of_runs(machine: &mut Machine, measured: &[(Built<Setup>, Measurement)]) -> Result<Vec<Metrics>, Error> {
    let floors = floors_ms(machine, measured)?;
    let metrics = measured.iter().zip(floors).map(|((built, measurement), floor_ms)| {
        let results = results(machine, &built.paper, measurement, floor_ms)?;
        Ok(Metrics { results, warnings: built.paper.warnings() })
    });
    metrics.collect()
}

/// Median time of each variant's caustics maps with an empty fragment stage, interleaved; `None` without timestamps.
fn floors_ms(machine: &mut Machine, measured: &[(Built<Setup>, Measurement)]) -> Result<Vec<Option<f64>>, Error> {
    const SAMPLES: usize = 5;
    let mut times = vec![Vec::with_capacity(SAMPLES); measured.len()];
    // The first round compiles the pipelines.
    for round in 0..=SAMPLES {
        for ((built, _), times) in measured.iter().zip(&mut times) {
            let sample = machine.recorder.run(Mode::Timestamped, |frame| built.paper.record_floor(frame))?;
            if round > 0 {
                times.extend(sample.passes.iter().find_map(|p| p.gpu_ms));
            }
        }
    }
    Ok(times.iter().map(|times| median(times)).collect())
}

/// The intersection triangles of a frame and how fast they are drawn; of `hit` the triangles of the refined water, once for each
/// receiver under each light, wherever they land.
fn results(
    machine: &Machine,
    paper: &Caustics,
    measurement: &Measurement,
    floor_ms: Option<f64>,
) -> Result<Map<String, Json>, Error> {
    let water = u64::from(paper.grid().triangle_count());
    match paper.variant {
        Variant::Stencil => return Ok(Map::new()),
        Variant::Hit => {
            return Ok(entries([("refined_triangles", json!(paper.lit_receivers.len() as u64 * water))]));
        }
        Variant::LevelMap | Variant::LevelMapSmart | Variant::Culled | Variant::Volumetric => {}
    }
    // A run that was interrupted before its first frame has placed and drawn nothing.
    let Some(caustics_map) = measurement.passes.iter().find(|p| p.info.name == "caustics-map") else {
        return Ok(Map::new());
    };
    let planes = paper.planes_drawn(&machine.device)?;
    // Of the culled pairs the device alone knows how many are left.
    let triangles = match paper.variant {
        Variant::Culled => caustics_map.counts.and_then(|counts| counts.primitives),
        _ => Some(planes * water),
    };
    let time_ms = median(&caustics_map.gpu_ms).filter(|&ms| ms > 0.0);
    let rate = triangles.zip(time_ms).map(|(triangles, ms)| triangles as f64 / ms * 1e3);
    Ok(entries([
        ("planes_drawn", json!(planes)),
        ("caustics_map_floor_ms", json!(floor_ms)),
        ("caustics_map_over_floor", json!(time_ms.zip(floor_ms).map(|(time, floor)| time / floor))),
        ("intersection_triangles", json!(triangles)),
        ("intersection_triangles_per_s", json!(rate)),
    ]))
}

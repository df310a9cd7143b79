//! Least cost of each pass: the work that was counted, at the rates that the device was measured at.
//!
//! A pass that draws points or splats has the same points with an empty fragment stage, and the samples that pass at
//! the rate at which the device adds to a float target (to a byte target where it writes depths). A full-screen pass
//! has its pixels at the fill rate or its bytes at the copy bandwidth, whichever takes longer; copies and host work
//! have their bytes. What a pass takes beyond is the arithmetic and the reads of its shaders, fragments that are
//! discarded included.

use serde_json::{Map, Value, json};

use crate::gpu::Mode;
use crate::measure::Error;
use crate::measure::limits;
use crate::measure::machine::Machine;
use crate::measure::statistics::median;
use crate::papers::lava::{FLOORS, Lava};
use crate::report::record::{Pass, PassKind, Run};

/// Measures what [`floor_ms`] wants beyond the record: `points_ms`, the times of the passes' points alone, and
/// `float_blend_gpix_s`. Absent without time stamps.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn measure(machine: &mut Machine, paper: &Lava) -> Result<[(&'static str, Value); 2], Error> {
    const SAMPLES: usize = 3;
    let mut times: [Vec<f64>; FLOORS.len()] = Default::default();
    // The first round compiles the pipelines.
    for round in 0..=SAMPLES {
        let sample = machine.recorder.run(Mode::Timestamped, |frame| paper.record_floors(frame))?;
        for ((_, floor), times) in FLOORS.iter().zip(&mut times).filter(|_| round > 0) {
            times.extend(sample.passes.iter().find(|p| p.info.name == *floor).and_then(|p| p.gpu_ms));
        }
    }
    let points_ms: Map<String, Value> =
        FLOORS.iter().zip(&times).map(|((pass, _), times)| ((*pass).to_owned(), json!(median(times)))).collect();
    let float_blend_gpix_s = limits::float_blend_gpix_s(machine)?;
    Ok([("points_ms", json!(points_ms)), ("float_blend_gpix_s", json!(float_blend_gpix_s))])
}

/// The least time of a pass in milliseconds; absent where the run measured no limits or the device cannot count.
pub fn floor_ms(run: &Run, pass: &Pass) -> Option<f64> {
    let limits = run.limits.as_ref()?;
    let bytes_ms = |bytes: f64| Some(bytes / limits.copy_gb_s? * 1e-6);
    let samples_ms = |gpix_s: f64| Some(pass.statistics.as_ref()?.samples_passed? as f64 / gpix_s * 1e-6);
    let points_ms = |pass: &str| run.results.get("points_ms")?.get(pass)?.as_f64();
    let stamp_ms = run.stamp_floor_ms.unwrap_or(0.0) * f64::from(pass.calls);
    match pass.name.as_str() {
        "visibility" => Some(points_ms("visibility")? + samples_ms(limits.fill_gpix_s?)?),
        name if FLOORS.iter().any(|(drawn, _)| *drawn == name) => {
            Some(points_ms(name)? + samples_ms(run.results.get("float_blend_gpix_s")?.as_f64()?)?)
        }
        _ if pass.kind == PassKind::Host => bytes_ms(bytes(run, pass)?),
        _ if pass.kind == PassKind::Transfer => Some(stamp_ms + bytes_ms(bytes(run, pass)?)?),
        _ => Some(stamp_ms + samples_ms(limits.fill_gpix_s?)?.max(bytes_ms(bytes(run, pass)?)?)),
    }
}

/// Bytes that a pass has to read and write: texels of 16 bytes, points of 12, pixels of 4.
fn bytes(run: &Run, pass: &Pass) -> Option<f64> {
    let particles = run.config.get("particles")?.as_f64()?;
    let density: Vec<f64> = run.config.get("density")?.as_array()?.iter().filter_map(Value::as_f64).collect();
    let &[x, y, z] = &density[..] else { return None };
    let texels = x * z * (y / 4.0).ceil();
    match pass.name.as_str() {
        // Positions and velocities.
        "animate" => Some(4.0 * 16.0 * particles),
        "read-positions" => Some(2.0 * 16.0 * particles),
        "cluster" => {
            let density = run.passes.iter().find(|p| p.name == "density")?;
            Some(16.0 * particles + 12.0 * density.statistics.as_ref()?.vertices? as f64)
        }
        "read-density" => Some(2.0 * 16.0 * texels),
        "extract" => Some(16.0 * texels + 12.0 * run.results.get("accepted_grid_points")?.as_f64()?),
        "normal-height" => Some(2.0 * 16.0 * x * z),
        "normalisation" => Some((16.0 + 4.0) * f64::from(run.width) * f64::from(run.height)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;
    use crate::report::record::{Limits, Statistics};

    fn pass(name: &str, kind: PassKind, vertices: u64, samples: u64) -> Pass {
        let counts = Statistics { vertices: Some(vertices), samples_passed: Some(samples), ..Statistics::default() };
        Pass { statistics: Some(counts), calls: 2, ..example::pass(name, kind) }
    }

    #[test]
    fn a_floor_is_counted_work_at_measured_rates() {
        use PassKind::{Graphics, Host, Transfer};
        let passes = [
            (pass("density", Graphics, 1000, 4_000_000), 3.0 + 4_000_000.0 / 0.5e9 * 1e3),
            (pass("visibility", Graphics, 90, 1_000_000), 7.0 + 1_000_000.0 / 2e9 * 1e3),
            // Filling takes longer than moving the bytes, and the other way round.
            (pass("animate", Graphics, 3, 1_000_000), 0.02 + 1_000_000.0 / 2e9 * 1e3),
            (pass("normalisation", Graphics, 3, 100), 0.02 + 20.0 * 80.0 * 60.0 / 4e9 * 1e3),
            (pass("cluster", Host, 0, 0), (16.0 * 500.0 + 12.0 * 1000.0) / 4e9 * 1e3),
            // Ten planes are three clusters.
            (pass("read-density", Transfer, 0, 0), 0.02 + 2.0 * 16.0 * 30.0 * 17.0 * 3.0 / 4e9 * 1e3),
        ];
        let limits = Limits { copy_gb_s: Some(4.0), fill_gpix_s: Some(2.0), ..Limits::default() };
        let mut run = Run {
            limits: Some(limits),
            stamp_floor_ms: Some(0.01),
            width: 80,
            height: 60,
            passes: passes.iter().map(|(pass, _)| pass.clone()).collect(),
            ..example::run()
        };
        run.config.insert("particles".into(), json!(500));
        run.config.insert("density".into(), json!([30, 10, 17]));
        run.results.insert("points_ms".into(), json!({"density": 3.0, "visibility": 7.0}));
        run.results.insert("float_blend_gpix_s".into(), json!(0.5));
        for (pass, expected) in &passes {
            let found = floor_ms(&run, pass).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{}: {found} {expected}", pass.name);
        }
        run.limits = None;
        assert_eq!(floor_ms(&run, &passes[0].0), None);
    }
}

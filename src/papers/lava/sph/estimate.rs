//! Numbers of the fluid's work before any of it is begun.

use super::super::estimate::TEXEL;
use super::super::gpu_driven::sort;
use super::super::parameters::Parameters;
use super::work::Work;
use super::{Scale, neighbours};
use crate::measure::estimate::Estimate;

/// Device memory, passes and the work of a frame.
pub fn estimate(parameters: &Parameters) -> Estimate {
    let scale = Scale::of(parameters);
    let particles = f64::from(parameters.particles);
    let cells = scale.cells(parameters, parameters.particles);
    let work = Work::of(parameters, &scale, &cells);
    let steps = f64::from(scale.substeps);
    let [columns, _, rows] = parameters.density.map(f64::from);
    let detail = f64::from(parameters.flow.crust.detail(parameters).unwrap_or(0));
    let crust = detail * detail * columns * rows;
    let walks = if parameters.flow.vent.toe_m3 > 0.0 { 4.0 } else { 2.0 };
    Estimate {
        bytes: vec![
            ("particles", 140.0 * particles + neighbours::bytes(parameters.particles) + sort::bytes(&cells)),
            ("density", TEXEL * (2.0 * columns * rows + 5.0 * crust)),
        ],
        buffers: vec![("particles", 16.0 * particles)],
        passes: Some(("corrections", (steps * work.passes()) as u64)),
        invocations: vec![
            ("particles", steps * work.step(parameters.particles)),
            ("density", walks * crust * work.walked),
        ],
        ..Estimate::default()
    }
}

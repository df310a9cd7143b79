//! Numbers of the fluid's work before any of it is begun.

use glam::DVec3;

use super::super::estimate::TEXEL;
use super::super::gpu_driven::sort;
use super::super::parameters::Parameters;
use super::{Scale, chebyshev, neighbours};
use crate::measure::estimate::Estimate;

/// Device memory, passes and the work of a step. A particle looks at those of 27 cells, of its own volume each as long as they
/// are at rest.
pub fn estimate(parameters: &Parameters) -> Estimate {
    let scale = Scale::of(parameters);
    let particles = f64::from(parameters.particles);
    let cells = scale.cells(parameters, parameters.particles);
    let sides = parameters.space_m.as_dvec3() / DVec3::from(cells.counts.map(f64::from));
    let looked_at = (27.0 * (sides / scale.spacing_m).element_product()).min(particles);
    let iterations =
        chebyshev::needed(scale.stiffness * scale.stiffest) + 2.0 * f64::from(parameters.flow.corrections) + 5.0;
    let looked_at_in_all =
        2.0 * particles * looked_at + iterations * neighbours::looked_at(parameters.particles, looked_at);
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
        passes: Some(("corrections", (steps * (iterations + 24.0)) as u64)),
        invocations: vec![("particles", steps * looked_at_in_all), ("density", walks * crust * looked_at)],
        ..Estimate::default()
    }
}

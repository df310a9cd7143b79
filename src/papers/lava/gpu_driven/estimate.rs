//! Sizes of stages one and two without readbacks.

use super::super::estimate::TEXEL;
use super::super::parameters::Parameters;
use super::cells::Cells;
use super::{accumulate_depths, density, sort};
use crate::measure::estimate::Estimate;

/// Device memory, passes and the work of a frame, the particles' textures included.
pub fn estimate(parameters: &Parameters) -> Estimate {
    let [columns, _, rows] = parameters.density.map(f64::from);
    let particles = f64::from(parameters.particles);
    let clusters = f64::from(parameters.clusters());
    let cells = Cells::new(parameters, parameters.particles);
    let seen = cells.seen(parameters);
    let taps = accumulate_depths::taps(parameters);
    Estimate {
        bytes: vec![
            ("particles", 6.0 * TEXEL * particles + sort::bytes(&cells)),
            ("density", TEXEL * columns * rows * (clusters + 3.0)),
        ],
        buffers: vec![("particles", 8.0 * particles)],
        passes: Some((
            "density",
            accumulate_depths::dispatches(parameters) + u64::from(density::pieces(parameters.particles)) + 64,
        )),
        invocations: vec![("radius", columns * rows * (clusters * seen + taps)), ("particles", 16.0 * particles)],
        ..Estimate::default()
    }
}

//! Sizes of stages one and two without readbacks.

use super::super::estimate::TEXEL;
use super::super::parameters::Parameters;
use super::cells::Cells;
use super::{columns, density, sort};
use crate::measure::estimate::Estimate;

/// Device memory, passes and the work of a frame, the particles' textures included.
pub fn estimate(parameters: &Parameters) -> Estimate {
    let [columns, _, rows] = parameters.density.map(f64::from);
    let particles = f64::from(parameters.particles);
    let clusters = f64::from(parameters.clusters());
    let cells = Cells::new(parameters, parameters.particles);
    // A column of four planes looks at three by three columns of cells, over its own height and a radius.
    let [across, _, along] = cells.counts.map(|count| (3.0 / f64::from(count)).min(1.0));
    let height_m = f64::from(parameters.space_m.y);
    let seen_m = 4.0 * height_m / f64::from(parameters.density[1]) + 4.0 * f64::from(parameters.radius_m);
    let seen = particles * across * along * (seen_m / height_m).min(1.0);
    let taps = columns::taps(parameters);
    Estimate {
        bytes: vec![
            ("particles", 6.0 * TEXEL * particles + sort::bytes(&cells)),
            ("density", TEXEL * columns * rows * (clusters + 3.0)),
        ],
        buffers: vec![("particles", 8.0 * particles)],
        passes: Some((
            "density",
            columns::dispatches(parameters) + u64::from(density::pieces(parameters.particles)) + 64,
        )),
        invocations: vec![("radius", columns * rows * (clusters * seen + taps)), ("particles", 16.0 * particles)],
        ..Estimate::default()
    }
}

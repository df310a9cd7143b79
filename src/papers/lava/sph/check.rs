//! Ranges of the fluid's numbers that depend on one another.

use super::super::parameters::Parameters;
use super::MOST_ITERATIONS;
use super::Scale;
use super::chebyshev;
use super::parameters::{Sides, Simulation};
use crate::measure::ParameterError;

/// Checks what ranges of single numbers do not.
///
/// # Errors
/// The first parameter that does not fit the others.
pub fn check(parameters: &Parameters) -> Result<(), ParameterError> {
    let flow = &parameters.flow;
    if parameters.simulation == Simulation::Free {
        return match flow.first_set() {
            None => Ok(()),
            Some((name, value)) => ParameterError::check(false, name, value, "moves nothing without `simulation` sph"),
        };
    }
    let fits = flow.block_m.cmple(parameters.space_m).all();
    ParameterError::check(fits, "block", flow.block_text(), "must be no longer than the space along any side")?;
    let default_speed = Parameters::default().speed_m_s;
    ParameterError::check(
        parameters.speed_m_s == default_speed,
        "speed",
        parameters.speed_m_s,
        "is that of free particles; a fluid starts at rest",
    )?;
    let scale = Scale::of(parameters);
    let step_s = f64::from(parameters.time_step_s);
    let fallen_m = step_s * step_s * f64::from(flow.gravity_m_s2);
    ParameterError::check(
        parameters.time_step_s > 0.0 && fallen_m <= scale.support_m,
        "time-step",
        parameters.time_step_s,
        "must be above 0, and so short that gravity alone moves lava by no more than 2.4 distances of its particles",
    )?;
    let needed = chebyshev::needed(scale.stiffness);
    ParameterError::check(
        needed <= f64::from(MOST_ITERATIONS),
        "viscosity",
        flow.viscosity_pa_s,
        &format!(
            "would need {needed:.0} iterations a step of {MOST_ITERATIONS} at most: take a shorter `time-step` or fewer \
             `particles`"
        ),
    )?;
    let [columns, _, rows] = scale.cells(parameters, parameters.particles).counts;
    ParameterError::check(
        flow.sides == Sides::Walls || (columns >= 3 && rows >= 3),
        "sides",
        "periodic",
        "needs a space along x and z of three radii of the kernel at least, 7.2 distances of its particles",
    )
}

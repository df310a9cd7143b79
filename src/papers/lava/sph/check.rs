//! Ranges of the fluid's numbers that depend on one another.

use super::super::parameters::Parameters;
use super::MOST_ITERATIONS;
use super::Scale;
use super::chebyshev;
use super::heat::{Heat, LEAST_INTERVAL_K, MOST_LATENT_K, MOST_STIFFER, Rheology};
use super::neighbours::MOST_IN_COLUMN;
use super::parameters::{Flow, Sides, Simulation};
use super::substeps;
use crate::measure::ParameterError;
use crate::measure::parameter::{Extents, Value as _};

/// Checks what ranges of single numbers do not.
///
/// # Errors
/// The first parameter that does not fit the others.
pub fn check(parameters: &Parameters) -> Result<(), ParameterError> {
    let flow = &parameters.flow;
    if parameters.simulation == Simulation::Free {
        let problem = "is of a fluid's skin; choose `simulation` sph";
        ParameterError::check(parameters.gloss == 0.0, "gloss", parameters.gloss, problem)?;
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
    let least_m = 2.0 * scale.margin_m;
    ParameterError::check(
        f64::from(parameters.space_m.min_element()) >= least_m,
        "space",
        Extents(parameters.space_m.to_array()).text(),
        &format!(
            "must be {least_m:.4} metres along every side at least, half a distance of the particles: make it wider, or take more \
             `particles`"
        ),
    )?;
    let crowd = scale.in_column(parameters, parameters.particles);
    ParameterError::check(
        crowd <= f64::from(MOST_IN_COLUMN),
        "space",
        Extents(parameters.space_m.to_array()).text(),
        &format!(
            "is so large beside the `block` that its cells are {:.3} metres long, and three of them above each other may hold \
             {crowd:.0} particles, of {MOST_IN_COLUMN} at most: make it smaller, or take fewer `particles`",
            scale.cell_m(parameters, parameters.particles).max_element()
        ),
    )?;
    ParameterError::check(
        parameters.time_step_s > 0.0,
        "time-step",
        parameters.time_step_s,
        "must be above 0 for a fluid",
    )?;
    let steps = substeps::needed(parameters, scale.support_m);
    ParameterError::check(
        flow.substeps.is_some() || steps <= f64::from(substeps::MOST),
        "time-step",
        parameters.time_step_s,
        &format!(
            "would need {steps:.0} steps of the lava in a frame, of {} at most: take a shorter one, fewer `particles` or more \
             `corrections`",
            substeps::MOST
        ),
    )?;
    let fallen_m = scale.step_s * scale.step_s * f64::from(flow.gravity_m_s2);
    if let Some(substeps) = flow.substeps {
        let problem = "are so few that gravity alone moves lava by more than 2.4 distances of its particles in one: take more \
                       or a shorter `time-step`";
        ParameterError::check(fallen_m <= scale.support_m, "substeps", substeps, problem)?;
    }
    check_heat(flow, &scale)?;
    // Toes without a vent have no seams, which the crust would look at.
    flow.vent.check(parameters)?;
    flow.crust.check(parameters)?;
    let needed = chebyshev::needed(scale.stiffness * scale.stiffest);
    let (name, viscosity_pa_s) = match flow.heat.rheology {
        Rheology::Constant => ("viscosity", flow.viscosity_pa_s),
        Rheology::Basalt => ("crust-viscosity", flow.heat.crust_pa_s),
    };
    ParameterError::check(
        needed <= f64::from(MOST_ITERATIONS),
        name,
        viscosity_pa_s,
        &format!(
            "would need {needed:.0} iterations a step of {MOST_ITERATIONS} at most: take a shorter `time-step`, more \
             `substeps` or fewer `particles`"
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

/// All neighbours' weights of a particle that is three times as dense as at rest, where `heat_stiffness` is 1: what it gives away
/// in a step is no more than what it has.
const MOST_CONDUCTED: f64 = 3.0 * 28.0;

fn check_heat(flow: &Flow, scale: &Scale) -> Result<(), ParameterError> {
    let heat = &flow.heat;
    ParameterError::check(
        heat.ambient_k <= heat.melt_k,
        "ambient",
        heat.ambient_k,
        "must be no hotter than the lava at the start, `melt-temperature`",
    )?;
    ParameterError::check(
        MOST_CONDUCTED * scale.heat_stiffness <= 1.0,
        "conductivity",
        heat.conductivity_w_mk,
        "would carry heat farther in a step than from particle to particle: take a shorter `time-step`, more `substeps`, \
         fewer `particles` or a larger `heat-capacity`",
    )?;
    let default = Heat::default();
    let (is_basalt, is_latent) = (heat.rheology == Rheology::Basalt, heat.latent_j_kg > 0.0);
    ParameterError::check(
        is_latent || heat.liquidus_k == default.liquidus_k,
        "liquidus",
        heat.liquidus_k,
        "changes nothing without `latent-heat`",
    )?;
    ParameterError::check(
        !is_latent || heat.liquidus_k - heat.solidus_k >= LEAST_INTERVAL_K,
        "liquidus",
        heat.liquidus_k,
        "must be at least one kelvin above the `solidus`",
    )?;
    let [latent_k, _] = heat.crystallising_k();
    ParameterError::check(
        latent_k <= MOST_LATENT_K,
        "latent-heat",
        heat.latent_j_kg,
        &format!("must be no more than would heat the lava by {MOST_LATENT_K} kelvin: take a larger `heat-capacity`"),
    )?;
    ParameterError::check(
        is_basalt || is_latent || heat.solidus_k == default.solidus_k,
        "solidus",
        heat.solidus_k,
        "changes nothing without `rheology` basalt or `latent-heat`",
    )?;
    if !is_basalt {
        let problem = "changes nothing without `rheology` basalt";
        return ParameterError::check(
            heat.crust_pa_s == default.crust_pa_s,
            "crust-viscosity",
            heat.crust_pa_s,
            problem,
        );
    }
    ParameterError::check(flow.viscosity_pa_s > 0.0, "viscosity", flow.viscosity_pa_s, "must be above 0 for basalt")?;
    ParameterError::check(
        heat.stiffest(flow.viscosity_pa_s) <= MOST_STIFFER,
        "viscosity",
        flow.viscosity_pa_s,
        &format!(
            "must be no less than a part in {MOST_STIFFER:e} of the `crust-viscosity`, {} pascal seconds: take more, or a softer crust",
            heat.crust_pa_s
        ),
    )?;
    ParameterError::check(
        heat.crust_pa_s >= flow.viscosity_pa_s,
        "crust-viscosity",
        heat.crust_pa_s,
        "must be at least the melt's, `viscosity`",
    )
}

#[cfg(test)]
mod tests {
    use super::super::vent::Vent;
    use super::*;

    /// On columns that are too long for seams.
    #[test]
    fn toes_without_a_vent_are_named_before_their_seams() {
        let flow = Flow { vent: Vent { toe_m3: 1.0, ..Vent::default() }, ..Flow::default() };
        let parameters = Parameters { simulation: Simulation::Sph, density: [2, 24, 2], flow, ..Parameters::default() };
        let error = check(&parameters).unwrap_err();
        assert!(error.name == "toe-volume" && error.range.contains("`effusion-rate`"), "{error}");
    }
}

//! Pass `sph-inflow` (section 9): the particles that leave the vent with a step, from where the start has them.

use std::sync::Arc;

use super::InflowConstants;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};
use crate::papers::lava::animate::State;

/// Makes the pass from the start into a state, whose rock is carried by `carried`; they have done nothing that is `lasting`.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_inflow(
    shaders: &ShaderLibrary,
    start: &State,
    state: &State,
    carried: &Arc<ImageView>,
    lasting: &Arc<Buffer>,
) -> Result<Pass, Error> {
    Pass::compute("sph-inflow", "9", "lava/sph-inflow.comp")
        .constants::<InflowConstants>()
        .with("places", &start.positions)
        .with("motions", &start.velocities)
        .with("positions", &state.positions)
        .with("velocities", &state.velocities)
        .with("carried", carried)
        .with("lasting", lasting)
        .build(shaders)
}

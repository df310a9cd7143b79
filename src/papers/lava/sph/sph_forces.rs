//! Pass `sph-forces` (chapter 9): velocities after gravity alone, in the order of the cells: the right side of the viscosity's
//! equation, and its first guess.

use std::sync::Arc;

use super::{Viscous, over_cells};
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};
use crate::papers::lava::animate::State;
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass from a state and what is `lasting` of the step before; `pushed` and `velocities` take the velocities,
/// `change` is set to none, and `unmet` says that iterations have begun.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_forces(
    shaders: &ShaderLibrary,
    sort: &Sort,
    state: &State,
    velocities: &Arc<ImageView>,
    lasting: &Arc<Buffer>,
    Viscous { pushed, change, unmet, .. }: Viscous<'_>,
) -> Result<Pass, Error> {
    over_cells("sph-forces", "lava/sph-forces.comp", sort)
        .with("velocities", &state.velocities)
        .with("items", &sort.items)
        .with("pushed", pushed)
        .with("to", velocities)
        .with("change", change)
        .with("lasting", lasting)
        .with("unmet", unmet)
        .build(shaders)
}

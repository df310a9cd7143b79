//! Pass `sph-strain` (chapter 9): the rate of strain that viscosity leaves, for the viscosity of the next step.

use std::sync::Arc;

use super::over_cells;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass from the velocities that viscosity leaves; `change` takes the rates in its fourth component.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_strain(
    shaders: &ShaderLibrary,
    sort: &Sort,
    velocities: &Arc<Buffer>,
    change: &Arc<Buffer>,
) -> Result<Pass, Error> {
    over_cells("sph-strain", "lava/sph-strain.comp", sort)
        .with("from", velocities)
        .with("change", change)
        .build(shaders)
}

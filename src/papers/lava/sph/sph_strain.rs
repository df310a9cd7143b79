//! Pass `sph-strain` (chapter 9): the rate of strain that viscosity leaves, for the viscosity of the next step.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from the velocities that viscosity leaves; `change` takes the rates in its fourth component.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_strain(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    velocities: &Arc<Buffer>,
    change: &Arc<Buffer>,
) -> Result<Pass, Error> {
    ground
        .over_cells("sph-strain", "lava/sph-strain.comp")
        .with("from", velocities)
        .with("change", change)
        .build(shaders)
}

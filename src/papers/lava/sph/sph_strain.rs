//! Pass `sph-strain` (chapter 9): the rate of strain that the last step left, for the viscosity of this one.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from the velocities after gravity; `along` takes the tensor's diagonal, `across` twice what stands beside it.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_strain(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    pushed: &Arc<Buffer>,
    [along, across]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    ground
        .over_neighbours("sph-strain", "lava/sph-strain.comp")
        .with("pushed", pushed)
        .with("along", along)
        .with("across", across)
        .build(shaders)
}

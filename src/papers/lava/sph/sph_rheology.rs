//! Pass `sph-rheology` (section 9): the viscosity of each particle by its temperature and the rate of strain around it.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from rates of strain, by diagonal and what stands beside it, and temperatures; `viscosities` takes those of the
/// particles over the melt's.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_rheology(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [along, across]: [&Arc<Buffer>; 2],
    [heat, viscosities]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    ground
        .near
        .over("sph-rheology", "lava/sph-rheology.comp", ground.sort)
        .with("along", along)
        .with("across", across)
        .with("heat", heat)
        .with("viscosities", viscosities)
        .build(shaders)
}

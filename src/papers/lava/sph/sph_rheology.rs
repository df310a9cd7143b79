//! Pass `sph-rheology` (section 9): the viscosity of each particle by its temperature and the rate of strain around it.

use std::sync::Arc;

use super::over_cells;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass from rates of strain, by diagonal and what stands beside it, and temperatures; `viscosities` takes those of the
/// particles over the melt's.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_rheology(
    shaders: &ShaderLibrary,
    sort: &Sort,
    [along, across]: [&Arc<Buffer>; 2],
    [heat, viscosities]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    over_cells("sph-rheology", "lava/sph-rheology.comp", sort)
        .with("along", along)
        .with("across", across)
        .with("heat", heat)
        .with("viscosities", viscosities)
        .build(shaders)
}

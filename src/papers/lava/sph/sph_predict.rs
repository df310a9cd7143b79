//! Pass `sph-predict` (chapter 9): places at the end of the step by the velocities alone.

use std::sync::Arc;

use super::over_cells;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass from the last iterate of the velocities to places in metres.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_predict(
    shaders: &ShaderLibrary,
    sort: &Sort,
    velocities: &Arc<Buffer>,
    predicted: &Arc<Buffer>,
) -> Result<Pass, Error> {
    over_cells("sph-predict", "lava/sph-predict.comp", sort)
        .with("from", velocities)
        .with("predicted", predicted)
        .build(shaders)
}

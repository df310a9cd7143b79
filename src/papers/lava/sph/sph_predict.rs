//! Pass `sph-predict` (chapter 9): places at the end of the step by the velocities alone.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};

/// Makes the pass from the last iterate of the velocities to places in metres; `unmet` says that corrections have begun.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_predict(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [velocities, predicted]: [&Arc<ImageView>; 2],
    unmet: &Arc<Buffer>,
) -> Result<Pass, Error> {
    ground
        .over_places("sph-predict", "lava/sph-predict.comp")
        .with("from", velocities)
        .with("predicted", predicted)
        .with("unmet", unmet)
        .build(shaders)
}

//! Pass `sph-correct` (chapter 9): places after the constraints and the walls have pushed each particle (Macklin and Mueller 2013,
//! eq. 12).

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};

/// Makes the pass from places with their factors to corrected ones.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_correct(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [pushing, corrected]: [&Arc<ImageView>; 2],
    unmet: &Arc<Buffer>,
) -> Result<Pass, Error> {
    ground
        .over_neighbours("sph-correct", "lava/sph-correct.comp")
        .with("pushing", pushing)
        .with("corrected", corrected)
        .with("unmet", unmet)
        .build(shaders)
}

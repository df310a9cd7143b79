//! Pass `sph-correct` (chapter 9): places after the constraints and the walls have pushed each particle (Macklin and Mueller 2013,
//! eq. 12).

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from predicted places to corrected ones.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_correct(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [predicted, corrected]: [&Arc<Buffer>; 2],
    [factors, unmet]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    ground
        .over_neighbours("sph-correct", "lava/sph-correct.comp")
        .with("predicted", predicted)
        .with("factors", factors)
        .with("corrected", corrected)
        .with("unmet", unmet)
        .build(shaders)
}

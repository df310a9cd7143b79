//! Pass `sph-density` (chapter 9): the density at the predicted places over that at rest, walls included, and the factor of its
//! constraint (Macklin and Mueller 2013, eq. 8 to 11).

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};

/// Makes the pass; `pushing` takes the places with the factors, `factors` takes factor and density, and `unmet` tells whether any is too
/// dense.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_density(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [predicted, pushing]: [&Arc<ImageView>; 2],
    [factors, unmet]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    ground
        .over_neighbours("sph-density", "lava/sph-density.comp")
        .with("predicted", predicted)
        .with("pushing", pushing)
        .with("factors", factors)
        .with("unmet", unmet)
        .build(shaders)
}

//! Pass `sph-heat` (section 9): the temperature of each particle after conduction and the radiation of the surface.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `pushed` holds the temperatures before, `heat` takes those after and the steepness of each face. `latent` holds
/// the latent heat over the heat capacity, and what lies between solidus and liquidus, in kelvin.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_heat(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [pushed, latent]: [&Arc<Buffer>; 2],
    heat: &Arc<Buffer>,
) -> Result<Pass, Error> {
    ground
        .over_neighbours("sph-heat", "lava/sph-heat.comp")
        .with("pushed", pushed)
        .with("heat", heat)
        .with("latent", latent)
        .build(shaders)
}

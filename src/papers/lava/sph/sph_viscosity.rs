//! Pass `sph-viscosity` (chapter 9): one iteration of Chebyshev's on the implicit viscosity of Morris et al. (1997).

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from one iterate of the velocities to the next; `pushed` is the right side, `change` the last change,
/// `viscosities` those of the particles over the melt's where they are not all the same.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_viscosity(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [from, to]: [&Arc<Buffer>; 2],
    [pushed, change]: [&Arc<Buffer>; 2],
    viscosities: Option<&Arc<Buffer>>,
) -> Result<Pass, Error> {
    let shader = match viscosities {
        None => "lava/sph-viscosity-constant.comp",
        Some(_) => "lava/sph-viscosity-basalt.comp",
    };
    let pass = ground
        .over_cells("sph-viscosity", shader)
        .with("pushed", pushed)
        .with("from", from)
        .with("to", to)
        .with("change", change);
    match viscosities {
        None => pass.build(shaders),
        Some(viscosities) => pass.with("viscosities", viscosities).build(shaders),
    }
}

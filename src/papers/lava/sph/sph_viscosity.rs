//! Pass `sph-viscosity` (chapter 9): one iteration of Chebyshev's on the implicit viscosity of Morris et al. (1997).

use std::sync::Arc;

use super::{Ground, Viscous};
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};

/// Makes the pass from one iterate of the velocities to the next; `viscosities` are those of the particles over the melt's where they
/// are not all the same.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_viscosity(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    [from, to]: [&Arc<ImageView>; 2],
    viscous: Viscous<'_>,
    viscosities: Option<&Arc<Buffer>>,
) -> Result<Pass, Error> {
    let shader = match viscosities {
        None => "lava/sph-viscosity-constant.comp",
        Some(_) => "lava/sph-viscosity-basalt.comp",
    };
    let pass = ground
        .near
        .over("sph-viscosity", shader, ground.sort)
        .with("drags", &ground.near.drags)
        .with("wall_drags", viscous.wall_drags)
        .with("pushed", viscous.pushed)
        .with("from", from)
        .with("to", to)
        .with("change", viscous.change)
        .with("unmet", viscous.unmet);
    match viscosities {
        None => pass.build(shaders),
        Some(viscosities) => pass.with("viscosities", viscosities).build(shaders),
    }
}

//! Pass `sph-drag` (chapter 9): the matrix of the implicit viscosity (Morris et al. 1997), for all of its iterations.

use std::sync::Arc;

use super::Ground;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `drags` takes what each particle in a list drags by, `wall_drags` what the walls do. `viscosities` are those of
/// the particles over the melt's where they are not all the same.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_drag(
    shaders: &ShaderLibrary,
    ground: Ground<'_>,
    wall_drags: &Arc<Buffer>,
    viscosities: Option<&Arc<Buffer>>,
) -> Result<Pass, Error> {
    let shader = match viscosities {
        None => "lava/sph-drag-constant.comp",
        Some(_) => "lava/sph-drag-basalt.comp",
    };
    let pass =
        ground.over_neighbours("sph-drag", shader).with("drags", &ground.near.drags).with("wall_drags", wall_drags);
    match viscosities {
        None => pass.build(shaders),
        Some(viscosities) => pass.with("viscosities", viscosities).build(shaders),
    }
}

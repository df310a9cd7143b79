//! Pass `land` (section 6.3): each triangle of the refined water once, its flux over the texels that it covers where it
//! lands. Those whose corners do not land on one surface are listed instead.

use super::{HitPass, Landings, Sums};
use crate::gpu::{Error, Pass};

/// Makes the pass, which adds to the sums and lists the triangles that straddle.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn land(hit: HitPass<'_>, landings: &Landings, sums: &Sums) -> Result<Pass, Error> {
    let pass = hit.over_rays("land", "caustics/land");
    sums.of_triangles(pass, hit.scope.water)
        .with("landings", &landings.places)
        .with("intensities", &landings.intensities)
        .build(hit.scope.context.shaders)
}

//! Pass `intersect` (section 6.3): the place where the ray of each vertex of the refined water meets the receiver first.

use super::{HitPass, Landings};
use crate::gpu::{Error, Pass};

/// Makes the pass; the landings are its own.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn intersect(hit: HitPass<'_>, landings: &Landings) -> Result<Pass, Error> {
    hit.shadowed("intersect", "caustics/intersect")
        .with("landings", &landings.places)
        .with("intensities", &landings.intensities)
        .build(hit.scope.context.shaders)
}

//! Pass `intersect` (section 6.3): the place where the ray of each vertex of the refined water meets the receiver first.

use std::sync::Arc;

use super::{HitPass, Landings};
use crate::gpu::{Buffer, Error, Pass};

/// Makes the pass; the landings are its own, and the first word of `unfinished` takes a 1 where a ray did not end.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn intersect(hit: HitPass<'_>, landings: &Landings, unfinished: &Arc<Buffer>) -> Result<Pass, Error> {
    hit.shadowed("intersect", "caustics/intersect")
        .with("landings", &landings.places)
        .with("intensities", &landings.intensities)
        .with("unfinished", unfinished)
        .build(hit.scope.context.shaders)
}

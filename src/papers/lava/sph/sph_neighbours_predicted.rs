//! Pass `sph-neighbours-predicted` (chapter 9): lists of the particles within the kernel's radius, and a little farther, at the
//! predicted places.

use std::sync::Arc;

use super::over_places;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass, whose lists take the place of those before.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_neighbours_predicted(
    shaders: &ShaderLibrary,
    sort: &Sort,
    (lists, counts): (&Arc<ImageView>, &Arc<Buffer>),
    predicted: &Arc<ImageView>,
) -> Result<Pass, Error> {
    over_places("sph-neighbours-predicted", "lava/sph-neighbours-predicted.comp", sort)
        .with("neighbours", lists)
        .with("neighbour_counts", counts)
        .with("predicted", predicted)
        .build(shaders)
}

//! Pass `sph-neighbours` (chapter 9): lists of the particles within the kernel's radius as the step begins.

use std::sync::Arc;

use super::over_places;
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass; `crowded` takes a 1 in its first word where a loop was cut off.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_neighbours(
    shaders: &ShaderLibrary,
    sort: &Sort,
    (lists, counts): (&Arc<ImageView>, &Arc<Buffer>),
    crowded: &Arc<Buffer>,
) -> Result<Pass, Error> {
    over_places("sph-neighbours", "lava/sph-neighbours-began.comp", sort)
        .with("neighbours", lists)
        .with("neighbour_counts", counts)
        .with("crowded", crowded)
        .build(shaders)
}

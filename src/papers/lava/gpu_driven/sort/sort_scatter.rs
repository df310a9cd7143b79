//! Pass `sort-scatter` (section 5.2): every item to its place by this digit, behind all lower digits, and behind those of its
//! own digit that come before it.

use std::sync::Arc;

use super::SortConstants;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass from one list of items to the other; `counts` holds the sums before each digit of each block.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sort_scatter(
    shaders: &ShaderLibrary,
    [from, to]: [&Arc<Buffer>; 2],
    counts: &Arc<Buffer>,
) -> Result<Pass, Error> {
    Pass::compute("sort-scatter", "5.2", "lava/sort-scatter.comp")
        .constants::<SortConstants>()
        .with("from", from)
        .with("counts", counts)
        .with("to", to)
        .build(shaders)
}

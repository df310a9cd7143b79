//! Pass `cull-count` (section 6.1): the pairs before each triangle's in its block, and those of each block.

use std::sync::Arc;

use super::over_pairs;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `before` takes a word for each triangle, `blocks` one for each block.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull_count(
    shaders: &ShaderLibrary,
    kept: &Arc<Buffer>,
    [before, blocks]: [&Arc<Buffer>; 2],
) -> Result<Pass, Error> {
    over_pairs("cull-count", "caustics/cull-count.comp")
        .with("kept", kept)
        .with("before", before)
        .with("blocks", blocks)
        .build(shaders)
}

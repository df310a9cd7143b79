//! Pass `cull-compact` (section 6.1): the kept pairs as one list of indices, triangle after triangle.

use std::sync::Arc;

use super::over_pairs;
use crate::gpu::{Buffer, Error, Pass};
use crate::papers::caustics::intersections::Scope;

/// Makes the pass; `pairs` takes three indices a pair, each vertex + plane x vertices.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull_compact(
    Scope { context, water, .. }: Scope<'_>,
    kept: &Arc<Buffer>,
    [before, blocks]: [&Arc<Buffer>; 2],
    pairs: &Arc<Buffer>,
) -> Result<Pass, Error> {
    over_pairs("cull-compact", "caustics/cull-compact.comp")
        .with("indices", &water.indices)
        .with("kept", kept)
        .with("before", before)
        .with("blocks", blocks)
        .with("pairs", pairs)
        .build(context.shaders)
}

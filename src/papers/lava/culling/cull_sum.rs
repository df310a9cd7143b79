//! Pass `cull-sum` (chapter 9): the splats that stay before each cluster, and the parameters of the draw.

use std::sync::Arc;

use super::super::targets::Context;
use super::CullConstants;
use crate::gpu::{Buffer, Error, Pass};

/// Makes the pass, of one workgroup; `arguments` takes the parameters of an indirect indexed draw and the count of clusters.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull_sum(
    context: Context<'_>,
    kept: &Arc<Buffer>,
    arguments: &Arc<Buffer>,
    instanced: bool,
) -> Result<Pass, Error> {
    let shader = if instanced { "lava/cull-sum-quads.comp" } else { "lava/cull-sum-points.comp" };
    Pass::compute("cull-sum", "9", shader)
        .constants::<CullConstants>()
        .with("kept", kept)
        .with("arguments", arguments)
        .build(context.shaders)
}

//! Pass `cull` (chapter 9): clusters of splats, and of those that may be seen the splats.

use std::sync::Arc;

use super::super::scene::Scene;
use super::super::targets::Context;
use super::CullConstants;
use crate::gpu::{Buffer, Error, Pass};

/// Makes the pass; `kept` takes four words for each cluster.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull(
    context: Context<'_>,
    scene: &Scene,
    places: &Arc<Buffer>,
    kept: &Arc<Buffer>,
    is_facing: bool,
) -> Result<Pass, Error> {
    let shader = if is_facing { "lava/cull-culled.comp" } else { "lava/cull-kept.comp" };
    Pass::compute("cull", "9", shader)
        .constants::<CullConstants>()
        .with("scene", &scene.block)
        .with("normal_height", &scene.normal_height)
        .with("places", places)
        .with("kept", kept)
        .build(context.shaders)
}

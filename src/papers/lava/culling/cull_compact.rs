//! Pass `cull-compact` (chapter 9): the splats that stay as one list, in their order.

use std::sync::Arc;

use super::super::targets::Context;
use super::CullConstants;
use crate::gpu::{Buffer, Error, Pass};

/// Makes the pass; `drawn` takes the splats' numbers, or those of `places` where they are given.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull_compact(
    context: Context<'_>,
    kept: &Arc<Buffer>,
    drawn: &Arc<Buffer>,
    places: Option<&Arc<Buffer>>,
) -> Result<Pass, Error> {
    let pass = match places {
        None => Pass::compute("cull-compact", "9", "lava/cull-compact-points.comp"),
        Some(places) => Pass::compute("cull-compact", "9", "lava/cull-compact-quads.comp").with("places", places),
    };
    pass.constants::<CullConstants>().with("kept", kept).with("drawn", drawn).build(context.shaders)
}

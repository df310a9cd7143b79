//! Pass `crust-normals`: normals of the crust from differences of its heights, as section 6.4 has those of the surface. Ours.

use std::sync::Arc;

use super::super::targets::Context;
use super::SideConstants;
use crate::gpu::{Error, ImageView, Pass};

/// Makes the pass.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn crust_normals(
    context: Context<'_>,
    heights: &Arc<ImageView>,
    normal_height: &Arc<ImageView>,
) -> Result<Pass, Error> {
    Pass::compute("crust-normals", "6.4", "lava/crust-normals.comp")
        .constants::<SideConstants>()
        .with("heights", heights)
        .with("normal_height", normal_height)
        .build(context.shaders)
}

//! Pass `highest-rows`: the sheet's bilinear patches, which a ray reads many of, and the highest place of each row. Ours.

use std::sync::Arc;

use super::march::FieldConstants;
use super::scene::Scene;
use super::targets::Context;
use crate::gpu::{Buffer, Error, ImageView, Pass};

/// Makes the pass; `highest` takes a word for each row behind its first, `patches` a texel for
/// each cell, of which there is one more than columns and one more than rows.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn highest_rows(
    context: Context<'_>,
    scene: &Scene,
    highest: &Arc<Buffer>,
    patches: &Arc<ImageView>,
) -> Result<Pass, Error> {
    Pass::compute("highest-rows", "", "lava/highest-rows.comp")
        .constants::<FieldConstants>()
        .with("normal_height", &scene.normal_height)
        .with("highest", highest)
        .with("patches", patches)
        .whole(&["normal_height", "patches"])
        .build(context.shaders)
}

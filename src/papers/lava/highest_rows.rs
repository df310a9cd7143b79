//! Pass `highest-rows`: the heights by themselves, which a ray reads many of, and the highest place of each row. Ours.

use std::sync::Arc;

use super::march::FieldConstants;
use super::scene::Scene;
use super::targets::Context;
use crate::gpu::{Buffer, Error, Pass};

/// Makes the pass; `highest` takes a word for each row behind its first, `heights` one for each texel, metres.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn highest_rows(
    context: Context<'_>,
    scene: &Scene,
    highest: &Arc<Buffer>,
    heights: &Arc<Buffer>,
) -> Result<Pass, Error> {
    Pass::compute("highest-rows", "", "lava/highest-rows.comp")
        .constants::<FieldConstants>()
        .with("normal_height", &scene.normal_height)
        .with("highest", highest)
        .with("heights", heights)
        .whole(&["normal_height", "heights"])
        .build(context.shaders)
}

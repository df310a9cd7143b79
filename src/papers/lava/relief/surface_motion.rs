//! Pass `surface-motion`: speed of a fluid's surface, warmth and depth of the lava under it, on the surface's grid. Ours.

use std::sync::Arc;

use super::super::sph::{Sph, over_places};
use super::super::targets::Context;
use crate::gpu::{Error, ImageView, Pass};

/// Makes the pass of the fluid's last step, on a texture with heights in metres in alpha.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn surface_motion(
    context: Context<'_>,
    sph: &Sph,
    surface: &Arc<ImageView>,
    motion: &Arc<ImageView>,
) -> Result<Pass, Error> {
    over_places("surface-motion", "lava/surface-motion.comp", &sph.sort)
        .with("predicted", sph.arrived())
        .with("heat", &sph.heat)
        .with("normal_height", surface)
        .with("bed", &sph.bed)
        .with("motion", motion)
        .with("crowded", sph.crowded())
        .build(context.shaders)
}

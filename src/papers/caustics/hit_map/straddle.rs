//! Pass `straddle` (section 6.3): the triangles that do not land whole, by reference planes of which each texel on their
//! way has its own.

use super::{HitPass, Sums};
use crate::gpu::{Error, Pass};

/// Invocations that share the texels of a straddling triangle.
const SHARING: u32 = 8;
/// Triangles that they take one after the other, at the most.
const IN_TURN: u32 = 16;

/// Makes the pass, which adds to the sums what the triangles listed there light.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn straddle(hit: HitPass<'_>, sums: &Sums) -> Result<Pass, Error> {
    let pass = hit.shadowed("straddle", "caustics/straddle");
    sums.of_triangles(pass, hit.scope.water).build(hit.scope.context.shaders)
}

/// Invocations of the pass for so many triangles of the water, however few of them straddle.
pub fn threads(triangles: u32) -> u32 {
    triangles.div_ceil(IN_TURN) * SHARING
}

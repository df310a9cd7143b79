//! Pass `cull` (section 6.1): the pairs of water triangle and plane that may light a texel of the plane's own cell.

use std::sync::Arc;

use super::over_pairs;
use crate::gpu::{Buffer, Error, Pass};
use crate::papers::caustics::intersections::Scope;
use crate::papers::caustics::position_pyramid::PositionPyramid;
use crate::papers::caustics::smart_planes::SmartPlanes;

/// Makes the pass for uniform planes, or for those of `smart`; `kept` takes a bit for each plane, words for each triangle.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull(
    Scope { context, volumes, water, .. }: Scope<'_>,
    steps: &Arc<Buffer>,
    cells: &Arc<Buffer>,
    pyramid: &PositionPyramid,
    smart: Option<&SmartPlanes>,
    kept: &Arc<Buffer>,
) -> Result<Pass, Error> {
    let pass = match smart {
        None => over_pairs("cull", "caustics/cull-even.comp"),
        Some(smart) => over_pairs("cull", "caustics/cull-fitted.comp")
            .with("bounds", &smart.bounds)
            .with("sliced", &smart.sliced)
            .with("placed", &smart.placed),
    };
    pass.with("rays", &volumes.rays)
        .with("indices", &water.indices)
        .with("steps", steps)
        .with("pyramid", &pyramid.entries)
        .with("heights", &pyramid.heights)
        .with("cells", cells)
        .with("kept", kept)
        .build(context.shaders)
}

//! The pass `object-occlusion`: the shadows of polygon objects on each other, on what `object-shadow` leaves of the sun's light.

use super::object_depth::ObjectDepth;
use super::object_hits::ObjectHits;
use super::occlusion::occlusion;
use super::stage::{Build, PixelPass};
use crate::gpu::Error;
use crate::papers::triangle_tree::DeviceTree;

/// The pass: `occlusion` from the objects' hits.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn object_occlusion(
    build: &Build<'_>,
    tree: &DeviceTree,
    (depth, hits): (&ObjectDepth, &ObjectHits),
    shadow: &PixelPass,
) -> Result<PixelPass, Error> {
    occlusion(build, "object-occlusion", (&depth.light, tree), [&hits.target, &shadow.target])
}

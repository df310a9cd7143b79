//! The pass `object-shadow` (section 2): the maps' shadow on polygon objects.

use super::object_hits::ObjectHits;
use super::scene::DeviceScene;
use super::shadow::shadow;
use super::stage::{Build, PixelPass, Stage, Traversal};
use crate::gpu::Error;

/// The pass: `shadow` from the objects' hits.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn object_shadow(build: &Build<'_>, scene: &DeviceScene, hits: &ObjectHits) -> Result<PixelPass, Error> {
    // Rays through tiles note what they read, which fragments cannot on every device.
    let stage = if build.traversal == Traversal::Tiles { Stage::Compute } else { build.stage };
    shadow(&Build { stage, ..*build }, "object-shadow", scene, &hits.target)
}

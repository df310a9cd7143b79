//! The pass `object-shadow` (section 2): the maps' shadow on polygon objects.

use std::sync::Arc;

use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::shadow::Shadow;
use super::stage::Stage;
use crate::gpu::{Error, ImageView, ShaderLibrary};

/// The pass: `shadow` by fragment stages, from the objects' hits.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn object_shadow(
    shaders: &ShaderLibrary,
    label: &str,
    parameters: &Parameters,
    scene: &DeviceScene,
    hits: &Arc<ImageView>,
) -> Result<Shadow, Error> {
    Shadow::new(shaders, label, (Stage::Fragment, "object-shadow"), parameters, scene, hits)
}

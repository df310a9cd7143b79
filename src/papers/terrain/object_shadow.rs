//! The pass `object-shadow` (section 2): what the maps leave of the sunlight where polygon objects are seen.

use std::sync::Arc;

use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::shadow::Shadow;
use super::stage::Stage;
use crate::gpu::{Error, ImageView, ShaderLibrary};

/// The pass: `shadow` by fragment stages, from the objects' hits.
///
/// # Errors
/// What the Vulkan layer answers.
pub fn object_shadow(
    shaders: &ShaderLibrary,
    label: &str,
    parameters: &Parameters,
    scene: &DeviceScene,
    hits: &Arc<ImageView>,
) -> Result<Shadow, Error> {
    Shadow::new(shaders, label, (Stage::Fragment, "object-shadow"), parameters, scene, hits)
}

//! `tiles-empty`: no tile has a triangle.

use super::Scope;
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass, a thread a tile.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn tiles_empty(shaders: &ShaderLibrary, scope: &Scope<'_>) -> Result<Pass, Error> {
    scope.pass("tiles-empty", "gas/tiles-empty.comp").build(shaders)
}

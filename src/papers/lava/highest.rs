//! Pass `highest`: the highest place of all rows, above which no ray meets anything. Ours.

use std::sync::Arc;

use super::march::FieldConstants;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; the first word of `highest` takes the greatest of those behind it, one for each row, metres.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn highest(shaders: &ShaderLibrary, highest: &Arc<Buffer>) -> Result<Pass, Error> {
    Pass::compute("highest", "", "lava/highest.comp")
        .constants::<FieldConstants>()
        .with("highest", highest)
        .build(shaders)
}

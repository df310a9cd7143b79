//! Pass `cell-starts` (section 5.2): the first particle of each cell in the sorted list, and the end behind the last cell.

use std::sync::Arc;

use super::CellConstants;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `starts` takes a word for each cell, and one more.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cell_starts(shaders: &ShaderLibrary, sorted: &Arc<Buffer>, starts: &Arc<Buffer>) -> Result<Pass, Error> {
    Pass::compute("cell-starts", "5.2", "lava/cell-starts.comp")
        .constants::<CellConstants>()
        .with("items", sorted)
        .with("starts", starts)
        .build(shaders)
}

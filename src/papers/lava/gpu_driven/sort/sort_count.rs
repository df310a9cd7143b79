//! Pass `sort-count` (section 5.2): the number of each digit's items in every block.

use std::sync::Arc;

use super::SortConstants;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `counts` takes a word for each digit and block.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sort_count(shaders: &ShaderLibrary, items: &Arc<Buffer>, counts: &Arc<Buffer>) -> Result<Pass, Error> {
    Pass::compute("sort-count", "5.2", "lava/sort-count.comp")
        .constants::<SortConstants>()
        .with("from", items)
        .with("counts", counts)
        .build(shaders)
}

//! Pass `sub-boxes` (sections 4.7.2 and 6.1): the sub-boxes of smart slicing, runs of levels that hold the receiver.

use std::sync::Arc;

use super::over_levels;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass, of one workgroup; of `levels`, the third takes the sub-boxes, the fourth their number and their planes'.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sub_boxes(shaders: &ShaderLibrary, levels: [&Arc<Buffer>; 4]) -> Result<Pass, Error> {
    over_levels("sub-boxes", "caustics/sub-boxes.comp", levels).build(shaders)
}

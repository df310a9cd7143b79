//! Pass `cull-sum` (section 6.1): the pairs before each block, in place of those in it, and the parameters of the draw.

use std::sync::Arc;

use super::over_pairs;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass, of one workgroup; `arguments` takes the parameters of one indirect indexed draw.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cull_sum(shaders: &ShaderLibrary, blocks: &Arc<Buffer>, arguments: &Arc<Buffer>) -> Result<Pass, Error> {
    over_pairs("cull-sum", "caustics/cull-sum.comp").with("blocks", blocks).with("arguments", arguments).build(shaders)
}

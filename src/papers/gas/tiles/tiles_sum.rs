//! `tiles-sum`: the chunks before each tile's, the sum of those of the tiles before it.

use super::Scope;
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass, of one workgroup.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn tiles_sum(shaders: &ShaderLibrary, scope: &Scope<'_>) -> Result<Pass, Error> {
    scope.pass("tiles-sum", "gas/tiles-sum.comp").with("Counters", &scope.lists.counters).build(shaders)
}

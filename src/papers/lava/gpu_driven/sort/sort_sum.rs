//! Pass `sort-sum` (section 5.2): the sums before each count of a run, in place of the counts, and the sum of each run.

use std::sync::Arc;

use super::SumConstants;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};

/// Makes the pass; `counts` holds the counts, and behind them their runs' sums.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sort_sum(shaders: &ShaderLibrary, counts: &Arc<Buffer>) -> Result<Pass, Error> {
    Pass::compute("sort-sum", "5.2", "lava/sort-sum.comp")
        .constants::<SumConstants>()
        .with("counts", counts)
        .build(shaders)
}

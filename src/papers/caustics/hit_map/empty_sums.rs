//! Pass `empty-sums` (section 6.3): no light anywhere, and no triangle listed.

use std::sync::Arc;

use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    pub struct EmptyConstants {
        pairs: u32,
        threads: u32,
    }
}

/// Invocations that empty the sums, at the most: fewer workgroups than any device allows.
const EMPTYING: u32 = 1 << 18;

/// Makes the pass; `sums` has four words for each pair of texels, `straddling` begins with its count.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn empty_sums(shaders: &ShaderLibrary, sums: &Arc<Buffer>, straddling: &Arc<Buffer>) -> Result<Pass, Error> {
    Pass::compute("empty-sums", "6.3", "caustics/empty-sums.comp")
        .constants::<EmptyConstants>()
        .with("sums", sums)
        .with("straddling", straddling)
        .build(shaders)
}

/// Empties the sums of square maps of that size, one for each surface.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn record(pass: &Pass, frame: &mut Frame<'_>, map_size: u32, surfaces: u32) -> Result<(), Error> {
    // Four words together.
    let pairs = (map_size * map_size * surfaces).div_ceil(2);
    frame.compute(pass, |dispatch| {
        let threads = pairs.min(EMPTYING);
        dispatch.constants(&EmptyConstants { pairs, threads }).threads(threads, 1, 1);
    })
}

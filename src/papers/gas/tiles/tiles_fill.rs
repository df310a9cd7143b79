//! `tiles-fill`: the triangles of each tile in its chunks, in any order: what they leave in a pixel is sorted.

use super::Scope;
use crate::gpu::{Error, Pass, ShaderLibrary};
use crate::papers::gas::pieces::Piece;

/// Makes the pass, a thread a triangle.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn tiles_fill(shaders: &ShaderLibrary, scope: &Scope<'_>, piece: &Piece) -> Result<Pass, Error> {
    scope
        .pass_of_chunks("tiles-fill", "gas/tiles-fill.comp", piece)
        .with("ChunkTiles", scope.chunk_tiles)
        .with("Counters", &scope.lists.counters)
        .build(shaders)
}

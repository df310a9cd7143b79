//! `tiles-pixels`: the triangles of a chunk that touch each pixel of its tile, and those that fill it and are opaque.

use super::Scope;
use crate::gpu::{Error, Pass, ShaderLibrary};
use crate::papers::gas::pieces::Piece;

/// Makes the pass, a workgroup a chunk.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn tiles_pixels(shaders: &ShaderLibrary, scope: &Scope<'_>, piece: &Piece) -> Result<Pass, Error> {
    scope
        .pass_of_chunks("tiles-pixels", "gas/tiles-pixels.comp", piece)
        .with("ChunkTiles", scope.chunk_tiles)
        .with("TilePixels", scope.pixels)
        .with("Counters", &scope.lists.counters)
        .build(shaders)
}

//! `tiles-count`: the number of triangles that touch each tile.

use super::Scope;
use crate::gpu::{Error, Pass, ShaderLibrary};
use crate::papers::gas::pieces::Piece;

/// Makes the pass, a thread a triangle.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn tiles_count(shaders: &ShaderLibrary, scope: &Scope<'_>, piece: &Piece) -> Result<Pass, Error> {
    scope
        .pass("tiles-count", "gas/tiles-count.comp")
        .with("vertices", &piece.vertices)
        .with("triangles", &piece.triangles)
        .with("Objects", &scope.scene.objects)
        .with("Counters", &scope.lists.counters)
        .build(shaders)
}

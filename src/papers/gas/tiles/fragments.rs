//! `fragments` by tiles: what the triangles of each tile leave in its pixels.

use std::sync::Arc;

use super::Scope;
use crate::gpu::{Buffer, Error, Pass};
use crate::papers::gas::context::Context;
use crate::papers::gas::pieces::Piece;

/// Makes the pass; `losses` takes what lists of the nearest fragments alone leave out.
///
/// # Errors
/// Those of Vulkan.
pub(super) fn fragments(
    context: &Context<'_>,
    scope: &Scope<'_>,
    piece: &Piece,
    losses: Option<&Arc<Buffer>>,
) -> Result<Pass, Error> {
    let Scope { scene, lists, .. } = scope;
    let shader = match context.parameters.lists.nearest() {
        Some(_) => "gas/fragments-nearest.comp",
        None => "gas/fragments-tiles.comp",
    };
    let pass = scope
        .pass_of_chunks("fragments", shader, piece)
        .with("Volumes", &scene.volumes)
        .with("Offsets", &scene.offsets)
        .with("Heads", &lists.heads)
        .with("Links", &lists.links)
        .with("Surfaces", &lists.surfaces)
        .with("Colors", &lists.colors);
    let pass = losses.into_iter().fold(pass, |pass, losses| pass.with("Losses", losses));
    pass.with("TilePixels", scope.pixels).with("Counters", &lists.counters).build(context.shaders)
}

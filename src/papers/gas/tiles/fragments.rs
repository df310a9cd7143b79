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
    let has_gas = scene.has_surface_gas();
    let shader = match (context.parameters.lists.nearest(), has_gas) {
        (Some(_), false) => "gas/fragments-nearest-plain.comp",
        (Some(_), true) => "gas/fragments-nearest-gas.comp",
        (None, false) => "gas/fragments-tiles-plain.comp",
        (None, true) => "gas/fragments-tiles-gas.comp",
    };
    let pass = scope.pass_of_chunks("fragments", shader, piece);
    let pass = if has_gas { scene.solid_textures(pass) } else { pass };
    let pass = pass
        .with("Heads", &lists.heads)
        .with("Links", &lists.links)
        .with("Surfaces", &lists.surfaces)
        .with("Colors", &lists.colors);
    let pass = losses.into_iter().fold(pass, |pass, losses| pass.with("Losses", losses));
    pass.with("TilePixels", scope.pixels).with("Counters", &lists.counters).build(context.shaders)
}

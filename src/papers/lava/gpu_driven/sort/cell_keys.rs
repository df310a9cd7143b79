//! Pass `cell-keys` (section 5.2): the cell of every particle, beside its number, which are sorted.

use std::sync::Arc;

use super::{CellConstants, of_each};
use crate::gpu::{Buffer, Error, ImageView, Pass};
use crate::papers::lava::targets::Context;

/// Makes the pass on each texture of positions; `items` takes cell and number of each particle.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn cell_keys(context: Context<'_>, positions: &[&Arc<ImageView>], items: &Arc<Buffer>) -> Result<Vec<Pass>, Error> {
    let first = Pass::compute("cell-keys", "5.2", "lava/cell-keys.comp")
        .constants::<CellConstants>()
        .with("positions", positions[0])
        .with("items", items);
    of_each(first, positions, context)
}

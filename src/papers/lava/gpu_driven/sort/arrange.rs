//! Pass `arrange` (section 5.2): the particles' places in the order of their cells, and the pieces of `density` that are known
//! to be there, the first.

use std::sync::Arc;

use super::{CellConstants, of_each};
use crate::gpu::{Buffer, Error, ImageView, Pass};
use crate::papers::lava::targets::Context;

/// Makes the pass on each texture of positions; `places` takes the place of each sorted item, metres, `reached` a word for each
/// piece.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn arrange(
    context: Context<'_>,
    positions: &[&Arc<ImageView>],
    sorted: &Arc<Buffer>,
    places: &Arc<ImageView>,
    reached: &Arc<Buffer>,
) -> Result<Vec<Pass>, Error> {
    let first = Pass::compute("arrange", "5.2", "lava/arrange.comp")
        .constants::<CellConstants>()
        .with("positions", positions[0])
        .with("items", sorted)
        .with("places_by_cells", places)
        .with("reached", reached);
    of_each(first, positions, context)
}

//! Pass `sph-finish` (chapter 9): velocities from the places, both into the textures at the particles' numbers, and the way that the
//! rock has been carried.

use std::sync::Arc;

use super::{Lasting, Rock, over_places};
use crate::gpu::{Buffer, Error, ImageView, Pass, ShaderLibrary};
use crate::papers::lava::animate::State;
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass from the last places and temperatures into a state; the rock is carried on from one state's into
/// another's.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_finish(
    shaders: &ShaderLibrary,
    sort: &Sort,
    predicted: &Arc<ImageView>,
    [arrived, heat]: [&Arc<Buffer>; 2],
    lasting: Lasting<'_>,
    state: &State,
    (rock, [from, to]): (&Rock, [usize; 2]),
) -> Result<Pass, Error> {
    over_places("sph-finish", "lava/sph-finish.comp", sort)
        .with("predicted", predicted)
        .with("arrived", arrived)
        .with("items", &sort.items)
        .with("heat", heat)
        .with("positions", &state.positions)
        .with("velocities", &state.velocities)
        .with("carried_before", &rock.states[from])
        .with("carried_after", &rock.states[to])
        .with("carried", &rock.by_cells)
        .with("from", lasting.velocities)
        .with("pushed", lasting.pushed)
        .with("lasting", lasting.by_particles)
        .build(shaders)
}

//! `block-weights` (3.5.1): the live vertices of each block, and what has unbalanced it.

use super::buffers::Buffers;
use super::model::Model;
use super::parameters::Parameters;
use super::ping_pong::{PingPong, build, new, old};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn block_weights(
    shaders: &ShaderLibrary,
    parameters: &Parameters,
    buffers: &Buffers,
    model: &Model,
) -> Result<PingPong<2>, Error> {
    let step = |shader: &str| {
        Pass::compute("block-weights", "3.5.1", shader)
            .with("constants", &buffers.constants)
            .with("Blocks", &buffers.blocks)
    };
    let clear = step("burning/block-weights-clear.comp");
    let count = match parameters.random_rotation {
        true => step("burning/block-weights-random.comp"),
        false => step("burning/block-weights-placed.comp"),
    };
    let count = count
        .with("Flammabilities", &buffers.flammabilities)
        .with("Labels", &buffers.labels)
        .with("Cells", &buffers.cells)
        .with("Clock", &buffers.clock)
        .with("Alive", &buffers.alive);
    let states = [old("OldState", &buffers.states), new("NewState", &buffers.states)];
    Ok(PingPong::new([
        (build(shaders, clear, &[])?, model.block_count()),
        (build(shaders, count, &states)?, model.vertex_count()),
    ]))
}

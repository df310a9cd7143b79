//! `block-weights` (3.5.1): the live vertices of each block, and what has unbalanced it.

use super::buffers::Buffers;
use super::model::Model;
use super::parameters::Parameters;
use super::ping_pong::{PingPong, Work, build, new, old};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass. Where triangles are refined, vertices come to be anywhere, and it visits all.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn block_weights(
    shaders: &ShaderLibrary,
    parameters: &Parameters,
    buffers: &Buffers,
    is_refined: bool,
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
        .with("Counted", &buffers.counted)
        .with("Alive", &buffers.alive);
    let chunks = &buffers.vertex_chunks;
    let count = match is_refined {
        false => chunks.changing(count),
        true => chunks.visiting(count, &chunks.all(shaders, "vertices-all")?),
    };
    let states = [old("OldState", &buffers.states), new("NewState", &buffers.states)];
    Ok(PingPong::new([
        (build(shaders, clear, &[])?, Work::Elements(model.block_count())),
        (build(shaders, count, &states)?, Work::Indirect),
    ]))
}

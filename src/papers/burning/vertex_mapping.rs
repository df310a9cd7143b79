//! `vertex-mapping` (3.5.3): the vertices turned with their blocks, for the picture alone.

use super::buffers::Buffers;
use super::model::Model;
use super::ping_pong::{PingPong, build, new};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn vertex_mapping(shaders: &ShaderLibrary, buffers: &Buffers, model: &Model) -> Result<PingPong<1>, Error> {
    let map = Pass::compute("vertex-mapping", "3.5.3", "burning/vertex-mapping.comp")
        .with("constants", &buffers.constants)
        .with("Cells", &buffers.cells)
        .with("Mapped", &buffers.mapped);
    let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
    Ok(PingPong::new([(build(shaders, map, &newest)?, model.vertex_count())]))
}

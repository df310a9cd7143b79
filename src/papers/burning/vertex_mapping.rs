//! `vertex-mapping` (3.5.3): the vertices turned with their blocks, for the picture alone.

use super::buffers::Buffers;
use super::model::Model;
use super::parts::Parts;
use super::ping_pong::{PingPong, Work, build, new};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass; where parts fall, it moves them.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn vertex_mapping(
    shaders: &ShaderLibrary,
    buffers: &Buffers,
    parts: Option<&Parts>,
    model: &Model,
) -> Result<PingPong<1>, Error> {
    let pass = |shader: &str| Pass::compute("vertex-mapping", "3.5.3", shader);
    let map = match parts {
        None => pass("burning/vertex-mapping-whole.comp"),
        Some(parts) => parts.posing(pass("burning/vertex-mapping-parts.comp")),
    };
    let map = map.with("Flammabilities", &buffers.flammabilities);
    let map = map.with("constants", &buffers.constants).with("Cells", &buffers.cells).with("Mapped", &buffers.mapped);
    let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
    Ok(PingPong::new([(build(shaders, map, &newest)?, Work::Elements(model.vertex_count()))]))
}

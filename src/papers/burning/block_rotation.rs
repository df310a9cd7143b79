//! `block-rotation` (3.5.2): blocks lean over as they lose weight.

use super::buffers::Buffers;
use super::model::Model;
use super::parameters::Variant;
use super::ping_pong::{PingPong, Work, build, new, old};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn block_rotation(
    shaders: &ShaderLibrary,
    variant: Variant,
    buffers: &Buffers,
    model: &Model,
) -> Result<PingPong<1>, Error> {
    let object = match variant {
        Variant::Shell | Variant::LowPoly | Variant::FullySubdivided => "shell",
        Variant::Solid => "solid",
        Variant::Melting => "melting",
    };
    let rotate = Pass::compute("block-rotation", "3.5.2", &format!("burning/block-rotation-{object}.comp"))
        .with("constants", &buffers.constants)
        .with("Blocks", &buffers.blocks)
        .with("BlockConstants", &buffers.block_levels);
    let rotations = [old("OldRotations", &buffers.rotations), new("NewRotations", &buffers.rotations)];
    Ok(PingPong::new([(build(shaders, rotate, &rotations)?, Work::Elements(model.block_count()))]))
}

//! `draw-ground`: the ground below the object, with the ash that has come down on it.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::Draw;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Load, Pass, ShaderLibrary, Topology};

/// Cells of the ash along each side (`burning/ash.glsl`).
const ASH_CELLS: usize = 128;

/// Of the ash, and of its copy at the start.
pub(super) const BYTES: u32 = 2 * 4 * (ASH_CELLS * ASH_CELLS) as u32;

/// Counts of parts of triangles that have come down on each cell of the ground; none before the fire.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn ash(shaders: &ShaderLibrary, label: &str, buffers: &mut Buffers) -> Result<Arc<Buffer>, Error> {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let ash = upload(shaders.device(), &format!("{label}/ash"), usage, &[0; 4 * ASH_CELLS * ASH_CELLS])?;
    buffers.keep(shaders, &ash)?;
    Ok(ash)
}

/// The pass.
pub struct DrawGround {
    pass: Pass,
}

impl DrawGround {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        buffers: &Buffers,
        draw: &Draw,
        (ash, fire_lights): (&Arc<Buffer>, &Arc<Buffer>),
    ) -> Result<Self, Error> {
        let pass = Pass::graphics("draw-ground", "", "burning/draw-ground.vert", "burning/draw-ground.frag")
            .with("constants", &buffers.constants)
            .with("view", &draw.view)
            .with("Ash", ash)
            .with("FireLights", fire_lights)
            .topology(Topology::TriangleStrip)
            .color(&draw.target, Load::Keep, Blend::Premultiplied)
            .depth(&draw.depth, Load::Keep, DepthTest::LessWrite)
            .build(shaders)?;
        Ok(DrawGround { pass })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.vertices(4))
    }
}

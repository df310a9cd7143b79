//! `draw-puddle`: the surface of the puddle on the ground. Ours.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::draw::Draw;
use super::ping_pong::{self, new};
use super::puddle::{PUDDLE_CELLS, Puddle};
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Load, Pass, ShaderLibrary};

/// The pass, for both ping-pong indices.
pub struct DrawPuddle {
    passes: [Pass; 2],
    index_count: u32,
}

impl DrawPuddle {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        buffers: &Buffers,
        (draw, fire_lights): (&Draw, Option<&Arc<Buffer>>),
        puddle: &Puddle,
    ) -> Result<Self, Error> {
        let indices: Vec<u32> = (0..PUDDLE_CELLS * PUDDLE_CELLS).flat_map(corners_of_cell).collect();
        let usage = vk::BufferUsageFlags::INDEX_BUFFER;
        let grid = upload(shaders.device(), &format!("{label}/puddle-grid"), usage, bytemuck::cast_slice(&indices))?;
        let pass = |fragment: &str| Pass::graphics("draw-puddle", "", "burning/draw-puddle.vert", fragment);
        let pass = match fire_lights {
            None => pass("burning/draw-puddle-sun.frag"),
            Some(lights) => pass("burning/draw-puddle-flames.frag").with("FireLights", lights),
        };
        let pass = pass
            .with("constants", &buffers.constants)
            .with("view", &draw.view)
            .indices(&grid)
            .color(&draw.target, Load::Keep, Blend::Replace)
            .depth(&draw.depth, Load::Keep, DepthTest::LessWrite);
        let passes = ping_pong::build(shaders, pass, &[new("Heights", &puddle.heights)])?;
        Ok(DrawPuddle { passes, index_count: indices.len() as u32 })
    }

    /// Draws the puddle after the tick that wrote the state of index `newest`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, newest: usize) -> Result<(), Error> {
        frame.graphics(&self.passes[newest], |draw| draw.indices(self.index_count))
    }
}

/// Two triangles of a cell, by the numbers of its corners.
fn corners_of_cell(cell: u32) -> [u32; 6] {
    let row = PUDDLE_CELLS + 1;
    let first = cell / PUDDLE_CELLS * row + cell % PUDDLE_CELLS;
    [first, first + row, first + 1, first + 1, first + row, first + row + 1]
}

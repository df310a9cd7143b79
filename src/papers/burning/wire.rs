//! `draw-wire`: the edges of the drawn triangles over the mesh (figures 4.2 and 4.4).

use super::drawing::Drawing;
use super::model::Model;
use super::state::Buffers;
use crate::gpu::{Blend, DepthTest, Error, Frame, Load, Pass, ShaderLibrary, Topology};

/// The pass.
pub struct Wire {
    pass: Pass,
    /// Ends of the edges of as many triangles as can be drawn; the shader leaves out those that are not.
    vertices: u32,
}

impl Wire {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, drawing: &Drawing, model: &Model) -> Result<Self, Error> {
        let pass = Pass::graphics("draw-wire", "4.4.1", "burning/wire.vert", "burning/wire.frag")
            .with("view", &drawing.view)
            .with("Welds", &buffers.welds)
            .with("Clock", &buffers.clock)
            .with("Mapped", &buffers.mapped)
            .with("Stream", &buffers.stream)
            .topology(Topology::Lines)
            .color(&drawing.picture, Load::Keep, Blend::Replace)
            .depth(&drawing.depth, Load::Keep, DepthTest::LessReadOnly)
            .build(shaders)?;
        Ok(Wire { pass, vertices: 6 * model.triangles.len() as u32 })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            draw.vertices(self.vertices);
        })
    }
}

//! `draw-wire`: the edges of the drawn triangles over the mesh (figures 4.2 and 4.4).

use super::buffers::Buffers;
use super::draw::Draw;
use super::model::Model;
use crate::gpu::{Blend, DepthTest, Error, Frame, Load, Pass, ShaderLibrary, Topology};

/// The pass.
pub struct DrawWire {
    pass: Pass,
    /// Ends of the edges of as many triangles as can be drawn; the shader leaves out those that are not.
    vertices: u32,
}

impl DrawWire {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, draw: &Draw, model: &Model) -> Result<Self, Error> {
        let pass = Pass::graphics("draw-wire", "4.4.1", "burning/wire.vert", "burning/wire.frag")
            .with("view", &draw.view)
            .with("Welds", &buffers.welds)
            .with("Clock", &buffers.clock)
            .with("Mapped", &buffers.mapped)
            .with("Stream", &buffers.stream)
            .topology(Topology::Lines)
            .color(&draw.picture, Load::Keep, Blend::Replace)
            .depth(&draw.depth, Load::Keep, DepthTest::LessReadOnly)
            .build(shaders)?;
        Ok(DrawWire { pass, vertices: 6 * model.triangle_count() })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.vertices(self.vertices))
    }
}

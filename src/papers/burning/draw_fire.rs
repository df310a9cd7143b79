//! `draw-fire` (3.6): the particles of fire and smoke over the mesh.

use super::buffers::Buffers;
use super::draw::Draw;
use super::flames::Flames;
use crate::gpu::{Blend, Error, Frame, Load, Pass, ShaderLibrary, Topology};

/// The pass.
pub struct DrawFire {
    pass: Pass,
    particle_count: u32,
}

impl DrawFire {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, draw: &Draw, flames: &Flames) -> Result<Self, Error> {
        let pass = Pass::graphics("draw-fire", "3.6", "burning/draw-fire.vert", "burning/draw-fire.frag")
            .with("constants", &buffers.constants)
            .with("view", &draw.view)
            .with("billboards", &flames.billboards)
            .with("Particles", &flames.particles)
            .with("mesh_depth", &draw.depth)
            .color(&draw.picture, Load::Keep, Blend::Premultiplied)
            .topology(Topology::TriangleStrip)
            .build(shaders)?;
        Ok(DrawFire { pass, particle_count: flames.particle_count })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            draw.instances(4, self.particle_count);
        })
    }
}

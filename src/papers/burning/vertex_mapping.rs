//! `vertex-mapping` (3.5.3): the vertices turned with their blocks, for the picture alone.

use super::buffers::Buffers;
use super::model::Model;
use super::parts::Parts;
use super::ping_pong::{build, new};
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/shown.glsl`: the last picture, to passes that make anew what has changed since.
    pub struct Shown {
        /// Tick from which on what is touched is new; 0 where everything is.
        since: u32,
    }
}

impl Shown {
    /// No picture.
    pub const NONE: Shown = Shown { since: 0 };

    /// A picture after so many ticks.
    pub fn after(ticks: u64) -> Self {
        Shown { since: u32::try_from(ticks + 1).unwrap_or(0) }
    }
}

/// The pass, for each ping-pong index of the tick.
pub struct VertexMapping {
    passes: [Pass; 2],
    vertex_count: u32,
}

impl VertexMapping {
    /// Parts that fall are moved by it.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        buffers: &Buffers,
        parts: Option<&Parts>,
        model: &Model,
    ) -> Result<Self, Error> {
        let pass = |shader: &str| Pass::compute("vertex-mapping", "3.5.3", shader);
        let map = match parts {
            None => pass("burning/vertex-mapping-whole.comp"),
            Some(parts) => parts.posing(pass("burning/vertex-mapping-parts.comp")),
        };
        let map = map
            .constants::<Shown>()
            .with("constants", &buffers.constants)
            .with("Clock", &buffers.clock)
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("Flammabilities", &buffers.flammabilities)
            .with("Cells", &buffers.cells)
            .with("Mapped", &buffers.mapped)
            .with("Touched", &buffers.touched);
        let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
        Ok(VertexMapping { passes: build(shaders, map, &newest)?, vertex_count: model.vertex_count() })
    }

    /// Maps the state of index `tick`, and touches what has moved since the last picture.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: usize, shown: Shown) -> Result<(), Error> {
        frame.compute(&self.passes[tick], |dispatch| dispatch.constants(&shown).elements(self.vertex_count))
    }
}

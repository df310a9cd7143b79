//! `internal-deformation`: 3.4, for solids 5.3 and for what melts 6.3.

use super::buffers::Buffers;
use super::model::Model;
use super::parameters::Variant;
use super::ping_pong::{self, new, old};
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// The frame of a tick that is spread over several (3.7.2), as push constants.
    struct Slice {
        number: u32,
        division: u32,
    }
}

/// The pass for each ping-pong index of the tick.
pub struct InternalDeformation {
    /// Of what melts: moves the base points, which guide the vertices, before them.
    base_points: Option<[Pass; 2]>,
    vertices: [Pass; 2],
    block_count: u32,
    /// Frames that a tick is spread over.
    time_division: u32,
}

impl InternalDeformation {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        variant: Variant,
        time_division: u32,
        buffers: &Buffers,
        model: &Model,
    ) -> Result<Self, Error> {
        let (section, shader) = match variant {
            Variant::Shell | Variant::LowPoly | Variant::FullySubdivided => ("3.4", "internal-deformation"),
            Variant::Solid => ("5.3", "internal-deformation-solid"),
            Variant::Melting => ("6.3", "internal-deformation-melting"),
        };
        let step = |shader: &str| {
            Pass::compute("internal-deformation", section, &format!("burning/{shader}.comp"))
                .with("constants", &buffers.constants)
                .with("Labels", &buffers.labels)
        };
        let mut vertices = buffers
            .vertex_chunks
            .changing(step(shader))
            .constants::<Slice>()
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("Meltabilities", &buffers.meltabilities)
            .with("Alive", &buffers.alive);
        if variant != Variant::Melting {
            vertices = vertices
                .with("Flammabilities", &buffers.flammabilities)
                .with("RestCells", &buffers.rest_cells)
                .with("BlockConstants", &buffers.block_levels);
        }
        let mut swapped = vec![old("OldState", &buffers.states), new("NewState", &buffers.states)];
        let new_bases = new("NewBases", &buffers.base_displacements);
        if matches!(variant, Variant::Solid | Variant::Melting) {
            vertices = vertices.with("Rest", &buffers.rest);
        }
        if variant == Variant::Melting {
            vertices = vertices
                .with("BasePoints", &buffers.base_points)
                .with("Clock", &buffers.clock)
                .with("Flows", &buffers.flows);
            swapped.push(new_bases);
        }
        let mut vertices = ping_pong::build(shaders, vertices, &swapped)?;
        let mut base_points = None;
        if variant == Variant::Melting {
            let guide = step("base-points")
                .with("Rest", &buffers.rest)
                .with("BasePoints", &buffers.base_points)
                .with("Blocks", &buffers.blocks)
                .with("Clock", &buffers.clock);
            let [even, odd] =
                ping_pong::build(shaders, guide, &[old("OldBases", &buffers.base_displacements), new_bases])?;
            let [even_vertices, odd_vertices] = vertices;
            let [[even, even_vertices], [odd, odd_vertices]] =
                [[even, even_vertices], [odd, odd_vertices]].map(Pass::steps);
            (base_points, vertices) = (Some([even, odd]), [even_vertices, odd_vertices]);
        }
        Ok(InternalDeformation { base_points, vertices, block_count: model.block_count(), time_division })
    }

    /// Records slice `slice` of the tick that writes the state of index `tick`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: usize, slice: u32) -> Result<(), Error> {
        if let Some(base_points) = &self.base_points
            && slice == 0
        {
            frame.compute(&base_points[tick], |dispatch| dispatch.elements(self.block_count))?;
        }
        frame.compute(&self.vertices[tick], |dispatch| {
            dispatch.constants(&Slice { number: slice, division: self.time_division }).groups_indirect();
        })
    }
}

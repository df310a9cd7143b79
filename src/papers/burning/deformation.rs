//! `internal-deformation`: 3.4, for solids 5.3 and for what melts 6.3.

use super::model::Model;
use super::parameters::Variant;
use super::state::Buffers;
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

const NAME: &str = "internal-deformation";

host_block! {
    /// A range of vertices: a tick's share of a frame (3.7.2).
    pub struct Slice {
        pub first: u32,
        pub count: u32,
    }
}

/// The pass for either turn of the states.
pub struct Deformation {
    /// What guides the vertices of a melting object, before them.
    base_points: Option<[Pass; 2]>,
    vertices: [Pass; 2],
    vertex_count: u32,
    blocks: u32,
}

impl Deformation {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, variant: Variant, buffers: &Buffers, model: &Model) -> Result<Self, Error> {
        let [a, b] = &buffers.states;
        let (section, shader) = match variant {
            Variant::Shell | Variant::LowPoly | Variant::FullySubdivided => {
                ("3.4", "burning/internal-deformation.comp")
            }
            Variant::Solid => ("5.3", "burning/internal-deformation-solid.comp"),
            Variant::Melting => ("6.3", "burning/internal-deformation-melting.comp"),
        };
        let vertices = Pass::compute(NAME, section, shader)
            .constants::<Slice>()
            .with("constants", &buffers.constants)
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("OldState", b)
            .with("NewState", a)
            .with("Labels", &buffers.labels)
            .with("Alive", &buffers.alive);
        let (vertex_count, blocks) = (model.rest.len() as u32, model.grid.cell_count());
        if variant != Variant::Melting {
            let is_solid = variant == Variant::Solid;
            let vertices = if is_solid { vertices.with("Rest", &buffers.rest) } else { vertices };
            let to_a = vertices.build(shaders)?;
            let to_b = to_a.rebind().with("OldState", a).with("NewState", b).build(shaders)?;
            return Ok(Deformation { base_points: None, vertices: [to_a, to_b], vertex_count, blocks });
        }
        let [bases_a, bases_b] = &buffers.base_displacements;
        let to_a = vertices
            .with("Rest", &buffers.rest)
            .with("BasePoints", &buffers.base_points)
            .with("Clock", &buffers.clock)
            .with("NewBases", bases_a)
            .with("Flows", &buffers.flows)
            .build(shaders)?;
        let to_b = to_a.rebind().with("OldState", a).with("NewState", b).with("NewBases", bases_b).build(shaders)?;
        let guide_a = Pass::compute(NAME, section, "burning/base-points.comp")
            .with("constants", &buffers.constants)
            .with("Rest", &buffers.rest)
            .with("BasePoints", &buffers.base_points)
            .with("Labels", &buffers.labels)
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .with("OldBases", bases_b)
            .with("NewBases", bases_a)
            .build(shaders)?;
        let guide_b = guide_a.rebind().with("OldBases", bases_a).with("NewBases", bases_b).build(shaders)?;
        let [guide_a, to_a] = Pass::steps([guide_a, to_a]);
        let [guide_b, to_b] = Pass::steps([guide_b, to_b]);
        Ok(Deformation { base_points: Some([guide_a, guide_b]), vertices: [to_a, to_b], vertex_count, blocks })
    }

    /// Records part `part` of `parts` of the tick that leaves its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, turn: usize, part: u32, parts: u32) -> Result<(), Error> {
        if let Some(base_points) = &self.base_points
            && part == 0
        {
            frame.compute(&base_points[turn], |dispatch| {
                dispatch.threads(self.blocks, 1, 1);
            })?;
        }
        let bound = |part: u32| (u64::from(self.vertex_count) * u64::from(part) / u64::from(parts)) as u32;
        let (first, end) = (bound(part), bound(part + 1));
        frame.compute(&self.vertices[turn], |dispatch| {
            dispatch.constants(&Slice { first, count: end - first }).threads(end - first, 1, 1);
        })
    }
}

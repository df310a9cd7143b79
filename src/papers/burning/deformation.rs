//! `internal-deformation` (3.4).

use super::model::Model;
use super::state::Buffers;
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// A range of vertices: a tick's share of a frame (3.7.2).
    pub struct Slice {
        pub first: u32,
        pub count: u32,
    }
}

/// The pass for either turn of the states.
pub struct Deformation {
    turns: [Pass; 2],
    vertices: u32,
}

impl Deformation {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, model: &Model) -> Result<Self, Error> {
        let [a, b] = &buffers.states;
        let to_a = Pass::compute("internal-deformation", "3.4", "burning/internal-deformation.comp")
            .constants::<Slice>()
            .with("constants", &buffers.constants)
            .with("Triangles", &buffers.triangles)
            .with("IncidenceOffsets", &buffers.incidence_offsets)
            .with("Incidence", &buffers.incidence)
            .with("OldState", b)
            .with("NewState", a)
            .with("Labels", &buffers.labels)
            .with("Alive", &buffers.alive)
            .build(shaders)?;
        let to_b = to_a.again().with("OldState", a).with("NewState", b).build(shaders)?;
        Ok(Deformation { turns: [to_a, to_b], vertices: model.rest.len() as u32 })
    }

    /// Records part `part` of `parts` of the tick that leaves its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, turn: usize, part: u32, parts: u32) -> Result<(), Error> {
        let bound = |part: u32| (u64::from(self.vertices) * u64::from(part) / u64::from(parts)) as u32;
        let (first, end) = (bound(part), bound(part + 1));
        frame.compute(&self.turns[turn], |dispatch| {
            dispatch.constants(&Slice { first, count: end - first }).threads(end - first, 1, 1);
        })
    }
}

//! `block-weights`, `block-rotation` and `vertex-mapping` (3.5): the structural deformation.

use super::model::Model;
use super::state::Buffers;
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};

/// The passes for either turn of states and rotations.
pub struct Blocks {
    weights: [[Pass; 2]; 2],
    rotation: [Pass; 2],
    mapping: [Pass; 2],
    vertices: u32,
    blocks: u32,
}

impl Blocks {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, model: &Model) -> Result<Self, Error> {
        let pass =
            |name, section, shader: &str| Pass::compute(name, section, shader).with("constants", &buffers.constants);
        let [a, b] = &buffers.states;
        let [rotations_a, rotations_b] = &buffers.rotations;
        let clear = pass("block-weights", "3.5.1", "burning/block-weights-clear.comp")
            .with("Blocks", &buffers.blocks)
            .build(shaders)?;
        let weigh_a = pass("block-weights", "3.5.1", "burning/block-weights.comp")
            .with("OldState", b)
            .with("NewState", a)
            .with("Labels", &buffers.labels)
            .with("Cells", &buffers.cells)
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .with("Alive", &buffers.alive)
            .build(shaders)?;
        let weigh_b = weigh_a.rebind().with("OldState", a).with("NewState", b).build(shaders)?;
        let rotate_a = pass("block-rotation", "3.5.2", "burning/block-rotation.comp")
            .with("Blocks", &buffers.blocks)
            .with("OldRotations", rotations_b)
            .with("NewRotations", rotations_a)
            .build(shaders)?;
        let rotate_b =
            rotate_a.rebind().with("OldRotations", rotations_a).with("NewRotations", rotations_b).build(shaders)?;
        let map_a = pass("vertex-mapping", "3.5.3", "burning/vertex-mapping.comp")
            .with("NewState", a)
            .with("Cells", &buffers.cells)
            .with("NewRotations", rotations_a)
            .with("Mapped", &buffers.mapped)
            .build(shaders)?;
        let map_b = map_a.rebind().with("NewState", b).with("NewRotations", rotations_b).build(shaders)?;
        Ok(Blocks {
            weights: [weigh_a, weigh_b].map(|weigh| Pass::steps([clear.clone(), weigh])),
            rotation: [rotate_a, rotate_b],
            mapping: [map_a, map_b],
            vertices: model.rest.len() as u32,
            blocks: model.grid.cell_count(),
        })
    }

    /// Weighs and turns the blocks in the tick that leaves its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        let [clear, weigh] = &self.weights[turn];
        frame.compute(clear, |dispatch| {
            dispatch.threads(self.blocks, 1, 1);
        })?;
        frame.compute(weigh, |dispatch| {
            dispatch.threads(self.vertices, 1, 1);
        })?;
        frame.compute(&self.rotation[turn], |dispatch| {
            dispatch.threads(self.blocks, 1, 1);
        })
    }

    /// Turns the vertices of the state in buffer `turn` with their blocks.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn map(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        frame.compute(&self.mapping[turn], |dispatch| {
            dispatch.threads(self.vertices, 1, 1);
        })
    }
}

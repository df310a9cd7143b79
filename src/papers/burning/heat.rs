//! `heat-boundary` (3.3): the clock, and the areas of vertices and triangles.

use super::model::Model;
use super::state::Buffers;
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};

/// The pass for either turn of the states.
pub struct HeatBoundary {
    turns: [[Pass; 3]; 2],
    vertices: u32,
    triangles: u32,
}

impl HeatBoundary {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, buffers: &Buffers, model: &Model) -> Result<Self, Error> {
        let step = |shader: &str| Pass::compute("heat-boundary", "3.3", shader).with("constants", &buffers.constants);
        let clock = step("burning/heat-boundary-clock.comp").with("Clock", &buffers.clock).build(shaders)?;
        let turn = |turn: usize| -> Result<[Pass; 3], Error> {
            let old = &buffers.states[1 - turn];
            let vertices = step("burning/heat-boundary-vertices.comp")
                .with("Rest", &buffers.rest)
                .with("OldState", old)
                .with("Labels", &buffers.labels)
                .with("Clock", &buffers.clock)
                .with("Alive", &buffers.alive)
                .build(shaders)?;
            let triangles = step("burning/heat-boundary-triangles.comp")
                .with("Triangles", &buffers.triangles)
                .with("OldState", old)
                .with("Labels", &buffers.labels)
                .with("TriangleLabels", &buffers.triangle_labels)
                .with("Clock", &buffers.clock)
                .with("Alive", &buffers.alive)
                .build(shaders)?;
            Ok(Pass::steps([clock.clone(), vertices, triangles]))
        };
        let turns = [turn(0)?, turn(1)?];
        Ok(HeatBoundary { turns, vertices: model.rest.len() as u32, triangles: model.triangles.len() as u32 })
    }

    /// Begins the tick that leaves its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        let [clock, vertices, triangles] = &self.turns[turn];
        frame.compute(clock, |dispatch| {
            dispatch.threads(1, 1, 1);
        })?;
        frame.compute(vertices, |dispatch| {
            dispatch.threads(self.vertices, 1, 1);
        })?;
        frame.compute(triangles, |dispatch| {
            dispatch.threads(self.triangles, 1, 1);
        })
    }
}

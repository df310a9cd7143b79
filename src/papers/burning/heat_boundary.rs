//! `heat-boundary` (3.3): the clock, and the areas of vertices and triangles.

use super::buffers::Buffers;
use super::model::Model;
use super::ping_pong::{PingPong, build, old};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn heat_boundary(shaders: &ShaderLibrary, buffers: &Buffers, model: &Model) -> Result<PingPong<3>, Error> {
    let step = |shader: &str| {
        Pass::compute("heat-boundary", "3.3", shader)
            .with("constants", &buffers.constants)
            .with("Clock", &buffers.clock)
    };
    let of_burning = |shader: &str| step(shader).with("Flammabilities", &buffers.flammabilities);
    let old_state = [old("OldState", &buffers.states)];
    let clock = step("burning/heat-boundary-clock.comp");
    let vertices = of_burning("burning/heat-boundary-vertices.comp")
        .with("Rest", &buffers.rest)
        .with("Labels", &buffers.labels)
        .with("Alive", &buffers.alive);
    let triangles = of_burning("burning/heat-boundary-triangles.comp")
        .with("Triangles", &buffers.triangles)
        .with("Labels", &buffers.labels)
        .with("TriangleLabels", &buffers.triangle_labels)
        .with("Alive", &buffers.alive);
    Ok(PingPong::new([
        (build(shaders, clock, &[])?, 1),
        (build(shaders, vertices, &old_state)?, model.vertex_count()),
        (build(shaders, triangles, &old_state)?, model.triangle_count()),
    ]))
}

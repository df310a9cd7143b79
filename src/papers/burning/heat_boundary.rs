//! `heat-boundary` (3.3): the clock, what the tick visits, and the areas of vertices and triangles.

use super::buffers::Buffers;
use super::parameters::Variant;
use super::parts::Parts;
use super::ping_pong::{PingPong, Work, build, old};
use crate::gpu::{Error, Pass, ShaderLibrary};

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn heat_boundary(
    shaders: &ShaderLibrary,
    variant: Variant,
    buffers: &Buffers,
    parts: Option<&Parts>,
) -> Result<PingPong<5>, Error> {
    let Buffers { vertex_chunks, triangle_chunks, .. } = buffers;
    let step = |shader: &str| {
        Pass::compute("heat-boundary", "3.3", &format!("burning/{shader}.comp"))
            .with("constants", &buffers.constants)
            .with("Clock", &buffers.clock)
    };
    let clock = step("heat-boundary-clock");
    let melts = variant == Variant::Melting;
    let burning = if melts { "chunks-visited-melting" } else { "chunks-visited-burning" };
    let changing_vertices = vertex_chunks.listing(step(burning), &vertex_chunks.changed);
    let changing_vertices = changing_vertices.with("Finished", &vertex_chunks.finished);
    let changing_triangles = match parts {
        None => step(burning),
        Some(parts) => step("chunks-visited-parts").with("Searching", &parts.progress),
    };
    let changing_triangles = triangle_chunks.listing(changing_triangles, &triangle_chunks.changed);
    let changing_triangles = changing_triangles.with("Finished", &triangle_chunks.finished);
    let old_state = [old("OldState", &buffers.states)];
    let labelled = |shader: &str| {
        step(shader)
            .with("Flammabilities", &buffers.flammabilities)
            .with("Labels", &buffers.labels)
            .with("Alive", &buffers.alive)
    };
    let vertices = labelled("heat-boundary-vertices").with("Rest", &buffers.rest);
    let vertices = vertex_chunks.changing(vertices).with("Finished", &vertex_chunks.finished);
    let triangles = labelled("heat-boundary-triangles").with("Triangles", &buffers.triangles);
    let triangles = triangles.with("TriangleLabels", &buffers.triangle_labels);
    let triangles = triangle_chunks.changing(triangles).with("Finished", &triangle_chunks.finished);
    Ok(PingPong::new([
        (build(shaders, clock, &[])?, Work::Elements(1)),
        (build(shaders, changing_vertices, &[])?, vertex_chunks.lists()),
        (build(shaders, changing_triangles, &[])?, triangle_chunks.lists()),
        (build(shaders, vertices, &old_state)?, Work::Indirect),
        (build(shaders, triangles, &old_state)?, Work::Indirect),
    ]))
}

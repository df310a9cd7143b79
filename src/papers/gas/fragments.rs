//! `fragments`: what each triangle leaves in each pixel (section "Combining A-buffer and volume rendering techniques").

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::context::Context;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Error, Feature, Frame, Pass, Topology};

/// The pass `fragments`.
pub struct Fragments {
    pass: Pass,
    vertex_count: u32,
}

impl Fragments {
    /// # Errors
    /// Those of Vulkan.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, lists: &ABuffer) -> Result<Self, Error> {
        let parameters = context.parameters;
        let has_geometry_stage =
            parameters.geometry_stage && context.shaders.device().physical().has(Feature::GeometryShader);
        let (stages, vertices_a_triangle) = if has_geometry_stage {
            let pass = Pass::graphics("fragments", "A-buffer", "gas/fragments.vert", "gas/fragments.frag");
            (pass.geometry("gas/fragments.geom").topology(Topology::Points), 1)
        } else {
            (Pass::graphics("fragments", "A-buffer", "gas/fragments-pulled.vert", "gas/fragments.frag"), 6)
        };
        let pass = stages
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("Offsets", &scene.offsets)
            .with("Vertices", &scene.vertices)
            .with("Triangles", &scene.triangles)
            .with("Objects", &scene.objects)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Counters", &lists.counters)
            .constants::<BandConstants>()
            .extent(parameters.width, parameters.height)
            .build(context.shaders)?;
        Ok(Fragments { pass, vertex_count: scene.triangle_count.saturating_mul(vertices_a_triangle) })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            draw.constants(&band.constants()).vertices(self.vertex_count);
        })
    }
}

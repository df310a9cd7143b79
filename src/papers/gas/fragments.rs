//! `fragments`: what each triangle leaves in each pixel (section "Combining A-buffer and volume rendering techniques").

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::context::Context;
use super::pieces::Piece;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Error, Feature, Frame, Pass, Topology};

/// The pass `fragments`, a call for each piece of the triangles.
pub struct Fragments {
    /// Each with the triangles before it, its own, and the vertices of each.
    passes: Vec<(Pass, u32, u32, u32)>,
}

impl Fragments {
    /// # Errors
    /// Those of Vulkan.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, lists: &ABuffer) -> Result<Self, Error> {
        let parameters = context.parameters;
        let has_geometry_stage =
            parameters.geometry_stage && context.shaders.device().physical().has(Feature::GeometryShader);
        let vertices_a_triangle = if has_geometry_stage { 1 } else { 6 };
        let mut passes: Vec<(Pass, u32, u32, u32)> = Vec::with_capacity(scene.pieces.len());
        for piece in &scene.pieces {
            let pass = match passes.first() {
                None => Self::pass(context, has_geometry_stage, scene, piece, lists)?,
                Some((first, ..)) => first
                    .rebind()
                    .with("vertices", &piece.vertices)
                    .with("triangles", &piece.triangles)
                    .build(context.shaders)?,
            };
            passes.push((pass, piece.first_triangle, piece.triangle_count, vertices_a_triangle));
        }
        Ok(Fragments { passes })
    }

    fn pass(
        context: &Context<'_>,
        has_geometry_stage: bool,
        scene: &SceneBuffers,
        piece: &Piece,
        lists: &ABuffer,
    ) -> Result<Pass, Error> {
        let parameters = context.parameters;
        let has_gas = scene.has_surface_gas();
        let shader = if has_gas { "gas/fragments-gas.frag" } else { "gas/fragments-plain.frag" };
        let stages = if has_geometry_stage {
            let pass = Pass::graphics("fragments", "A-buffer", "gas/fragments.vert", shader);
            pass.geometry("gas/fragments.geom").topology(Topology::Points)
        } else {
            Pass::graphics("fragments", "A-buffer", "gas/fragments-pulled.vert", shader)
        };
        let stages = if has_gas { scene.solid_textures(stages) } else { stages };
        stages
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("vertices", &piece.vertices)
            .with("triangles", &piece.triangles)
            .with("Objects", &scene.objects)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Counters", &lists.counters)
            .constants::<BandConstants>()
            .extent(parameters.width, parameters.height)
            .build(context.shaders)
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        self.passes.iter().try_for_each(|&(ref pass, first_triangle, triangle_count, vertices_a_triangle)| {
            frame.graphics(pass, |draw| {
                draw.constants(&band.constants_of_piece(first_triangle, triangle_count))
                    .vertices(triangle_count.saturating_mul(vertices_a_triangle))
            })
        })
    }
}

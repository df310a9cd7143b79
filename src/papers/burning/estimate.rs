//! Sizes that follow from the parameters and the mesh.

use std::collections::HashSet;

use super::buffers::{BlockCounts, RestVertex, VertexState};
use super::flames::{Group, Particle};
use super::model::Division;
use super::parameters::{Parameters, Variant};
use super::{bending, chunks, connection, draw_ground, falling, fire_layer, flame_lights, parts, puddle, smoke_volume};
use crate::measure::estimate::Estimate;
use crate::scene::Mesh;

/// Bytes of a number, and of four.
const NUMBER: f64 = 4.0;
const VECTOR: f64 = 16.0;
/// Passes of a tick, and of a frame beside them.
const PASSES: u64 = 40;

/// Vertices, edges and triangles of a mesh.
#[derive(Clone, Copy)]
struct Counts {
    vertices: f64,
    edges: f64,
    triangles: f64,
}

impl Counts {
    /// Those of a list of triangles.
    fn of(vertices: usize, triangles: impl ExactSizeIterator<Item = [u32; 3]>) -> Self {
        let count = triangles.len() as f64;
        let sides = triangles.flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
        let edges: HashSet<(u32, u32)> = sides.map(|(a, b)| (a.min(b), a.max(b))).collect();
        Counts { vertices: vertices as f64, edges: edges.len() as f64, triangles: count }
    }

    /// Vertices after each triangle has become four, some times.
    fn refined(self, levels: u32) -> f64 {
        let parts = f64::from(1_u32 << levels);
        self.vertices + self.edges * (parts - 1.0) + self.triangles * (parts - 1.0) * (parts - 2.0) / 2.0
    }
}

impl Parameters {
    /// Device memory, passes and shader invocations of the first picture.
    pub(super) fn estimate(&self, variant: Variant, mesh: &Mesh) -> Estimate {
        let Division { welded, levels, .. } = Division::new(mesh, variant, self);
        let levels = levels.min(15);
        let drawn = Counts::of(welded.welds.len(), welded.triangles.iter().copied());
        let to_simulated = |t: &[u32; 3]| t.map(|corner| welded.welds[corner as usize]);
        let simulated = Counts::of(welded.vertex_count as usize, welded.triangles.iter().map(to_simulated));
        let (vertices, corners) = (simulated.refined(levels), drawn.refined(levels));
        let triangles = drawn.triangles * 4_f64.powi(levels as i32);
        let blocks = self.blocks.iter().map(|&b| f64::from(b)).product::<f64>();
        let particles = f64::from(self.fire) + f64::from(self.smoke);
        let pixels = f64::from(self.width) * f64::from(self.height);
        let texture = self.texture.as_ref().map_or(0, |t| t.levels.iter().map(|level| level.texels.len()).sum()) as f64;

        // What a restart brings back is there twice: states, labels, cells, and the like.
        let flow = if variant == Variant::Melting { 2.0 * VECTOR } else { 0.0 };
        let kept_of_vertex = 2.0 * size_of::<VertexState>() as f64 + 3.0 * NUMBER;
        let of_vertex = size_of::<RestVertex>() as f64 + 2.0 * kept_of_vertex + VECTOR + 3.0 * NUMBER + flow;
        let of_corner = 2.0 * VECTOR + 2.0 * NUMBER;
        // Four lists of three numbers and the stream; labels and marks twice; statuses of all levels' triangles twice.
        let statuses = if variant.refines() && levels > 0 { 2.0 * NUMBER * 4.0 / 3.0 } else { 0.0 };
        let of_triangle = 5.0 * 3.0 * NUMBER + 4.0 * NUMBER + statuses;
        // What a vertex counts as, twice, the tick that touched it, and the orders of the chunks.
        let of_vertex = of_vertex + NUMBER * (4.0 + chunks::WORDS);
        let of_triangle = of_triangle + NUMBER * (1.0 + chunks::WORDS);
        let is_refined = variant.refines() && levels > 0;
        let of_triangle = of_triangle + if self.orders_triangles(variant, is_refined) { NUMBER } else { 0.0 };
        let (collapses, has_puddle) = (self.collapses(variant), self.has_puddle(variant));
        let has_light = self.has_linear_light();
        let of_vertex = of_vertex + if has_puddle { size_of::<VertexState>() as f64 } else { 0.0 };
        let if_so = |condition: bool, bytes: u32| if condition { f64::from(bytes) } else { 0.0 };
        let of_vertex = of_vertex + NUMBER * if_so(collapses, parts::NUMBERS_OF_VERTEX + bending::NUMBERS_OF_VERTEX);
        let connects = self.keeps_connected(variant);
        let of_vertex = of_vertex + NUMBER * if_so(connects, connection::NUMBERS_OF_VERTEX);
        let of_triangle = of_triangle + NUMBER * if_so(connects, connection::NUMBERS_OF_TRIANGLE);
        // L of each vertex, epsilon of each edge, and the materials of the draw vertices.
        let several = self.materials.is_some();
        let of_vertex = of_vertex + if_so(several, 4);
        let of_corner = of_corner + if_so(several, 4);
        let of_triangle = of_triangle + if_so(several, 12);
        let of_look = if_so(collapses, parts::BYTES + bending::BYTES + falling::BYTES)
            + if_so(has_puddle, puddle::BYTES)
            + if_so(self.has_ash(variant), draw_ground::BYTES)
            + if_so(has_light, flame_lights::BYTES)
            + if_so(self.has_smoke_volume(), smoke_volume::BYTES);
        // Linear light, and the layer of fire and smoke.
        let of_light = if has_light { 8.0 * pixels } else { 0.0 };
        let has_layer = self.has_fire_layer() && particles > 0.0;
        let of_layer = if has_layer { fire_layer::bytes(self) } else { 0.0 };
        let of_block =
            2.0 * (size_of::<BlockCounts>() as f64 + 4.0 * VECTOR) + 2.0 * NUMBER + VECTOR + size_of::<Group>() as f64;

        let ticks_a_frame = self.slices_due(0).saturating_sub(self.slices_before()).max(1);
        let ticks = self.slices_before() as f64 + ticks_a_frame as f64;
        let of_tick = 40.0 * vertices + 20.0 * triangles + 200.0 * blocks + 10.0 * particles;
        // Of a picture that the object fills to four fifths of its height.
        let of_particle =
            std::f64::consts::PI * (0.8 * f64::from(self.particle_radius) * f64::from(self.height)).powi(2);
        let parameter = if levels > 0 { "levels" } else { "triangles" };
        Estimate {
            buffers: vec![(parameter, 3.0 * NUMBER * triangles)],
            bytes: vec![
                (parameter, of_vertex * vertices + of_corner * corners + of_triangle * triangles),
                ("blocks", of_block * blocks),
                ("look", of_look),
                ("fire", 2.0 * size_of::<Particle>() as f64 * particles),
                ("texture", NUMBER * texture),
                ("size", 2.0 * NUMBER * pixels + of_light + of_layer),
            ],
            passes: Some(("time-step", PASSES * (1 + ticks_a_frame.min(super::MOST_SLICES)))),
            draws: None,
            invocations: vec![
                (if self.first_frame > 0 { "first-frame" } else { "time-step" }, ticks * of_tick),
                ("particle-radius", particles * of_particle.min(pixels)),
                ("levels", 60.0 * vertices + 60.0 * triangles),
                ("size", 20.0 * pixels),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::parameters::Look;
    use super::super::setup::LEAST_BYTES;
    use super::*;
    use crate::scene::shapes;

    /// Of a shell by the natural look, of a solid in the text's.
    fn bytes_of_a_triangle(variant: Variant, mesh: &Mesh) -> f64 {
        let look = if variant == Variant::Solid { Look::Dissertation } else { Look::Natural };
        let estimate = Parameters { levels: Some(0), look, ..Parameters::default() }.estimate(variant, mesh);
        let of_triangles = estimate.bytes.iter().find(|(parameter, _)| *parameter == "triangles");
        of_triangles.map_or(0.0, |(_, bytes)| bytes / mesh.triangle_count() as f64)
    }

    #[test]
    fn triangles_that_share_no_vertex_take_more_than_three_times_as_much() {
        let ball = shapes::sphere(200, 200);
        let mut loose = Mesh::default();
        for (number, corners) in (0..).zip(ball.indices.chunks_exact(3)) {
            let aside = Vec3::X * (number as f32 / 1024.0);
            for &corner in corners {
                loose.indices.push(loose.positions.len() as u32);
                loose.positions.push(ball.positions[corner as usize] + aside);
                loose.normals.push(ball.normals[corner as usize]);
            }
        }
        let [solid, shell] = [Variant::Solid, Variant::Shell].map(|variant| bytes_of_a_triangle(variant, &ball));
        assert!((LEAST_BYTES..1.02 * LEAST_BYTES).contains(&solid), "{solid}");
        assert!((230.0..237.0).contains(&shell), "{shell}");
        let [solid, shell] = [Variant::Solid, Variant::Shell].map(|variant| bytes_of_a_triangle(variant, &loose));
        assert!((641.0..656.0).contains(&solid) && (967.0..977.0).contains(&shell), "{solid} {shell}");
    }
}

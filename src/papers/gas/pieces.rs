//! The triangles of all objects, in pieces that the device's buffers and images hold: one, but of the largest meshes.

use std::sync::Arc;

use ash::vk;

use super::blocks::{TriangleBlock, VertexBlock};
use super::context::Context;
use super::model::Object;
use crate::gpu::{Error, ImageView};
use crate::papers::texels;

/// Some triangles with the vertices that they use.
pub struct Piece {
    /// [`VertexBlock`]s.
    pub vertices: Arc<ImageView>,
    /// [`TriangleBlock`]s, whose vertices are those of the piece.
    pub triangles: Arc<ImageView>,
    /// Triangles of the pieces before it.
    pub first_triangle: u32,
    /// Its own triangles.
    pub triangle_count: u32,
}

/// Makes the pieces, at least one.
///
/// # Errors
/// [`Error::Limit`] for more triangles than have numbers, or an image that does not hold one; what Vulkan answers.
pub fn pieces(context: &Context<'_>, objects: &[Object]) -> Result<Vec<Piece>, Error> {
    let device = context.shaders.device();
    let limits = &device.physical().limits;
    // What a device binds of a buffer it holds of an image as well, as long as that has no more rows than its images.
    let limit_bytes = u64::from(limits.max_storage_buffer_range)
        .min(device.physical().max_buffer_bytes())
        .min(texels::bytes_of_rows(limits.max_image_dimension2_d));
    let total: usize = objects.iter().map(|object| object.mesh.triangle_count()).sum();
    // Vertices are numbered too, and there are at most three to a triangle that is drawn.
    let vertices: usize = objects.iter().map(|object| object.mesh.positions.len()).sum();
    let wanted = total.max(vertices) as u64;
    if wanted >= u64::from(u32::MAX) {
        let what = "number of triangles or vertices of all meshes";
        let limit = u64::from(u32::MAX) - 1;
        return Err(Error::Limit { object: context.name("triangles"), what, wanted, limit }.set_by("object"));
    }
    let (floats, numbers) = (vk::Format::R32G32B32A32_SFLOAT, vk::Format::R32G32B32A32_UINT);
    let mut pieces: Vec<Piece> = Vec::new();
    let mut cutting = Cutting::new(objects, limit_bytes);
    while pieces.is_empty() || !cutting.is_done() {
        let first_triangle = pieces.last().map_or(0, |piece| piece.first_triangle + piece.triangle_count);
        cutting.cut();
        let Cutting { vertices, triangles, .. } = &cutting;
        let number = if pieces.is_empty() { String::new() } else { format!("-{}", pieces.len()) };
        let name = |what: &str| context.name(&format!("{what}{number}"));
        let piece = (
            texels::upload_list(device, &name("vertices"), floats, vertices.len(), |at| cutting.vertex(vertices[at])),
            texels::upload_list(device, &name("triangles"), numbers, triangles.len(), |at| triangles[at]),
        );
        pieces.push(Piece {
            vertices: piece.0.map_err(|error| error.set_by("object"))?,
            triangles: piece.1.map_err(|error| error.set_by("object"))?,
            first_triangle,
            triangle_count: triangles.len() as u32,
        });
    }
    Ok(pieces)
}

/// Cuts the triangles of all objects in their order.
struct Cutting<'a> {
    objects: &'a [Object],
    /// The vertices before each object's.
    firsts: Vec<u32>,
    most_vertices: usize,
    most_triangles: usize,
    /// The next triangle: its object, and its number in the mesh.
    next: (usize, usize),
    /// Index of each vertex in the piece, if it is there.
    places: Vec<u32>,
    /// Of the piece: numbers of its vertices among those of all objects.
    vertices: Vec<u32>,
    triangles: Vec<TriangleBlock>,
}

impl<'a> Cutting<'a> {
    fn new(objects: &'a [Object], limit_bytes: u64) -> Self {
        let mut count = 0;
        let first = |object: &Object| {
            let next = count + object.mesh.positions.len() as u32;
            std::mem::replace(&mut count, next)
        };
        let firsts = objects.iter().map(first).collect();
        let most = |element_bytes: usize| (limit_bytes / element_bytes as u64) as usize;
        Cutting {
            objects,
            firsts,
            most_vertices: most(size_of::<VertexBlock>()),
            most_triangles: most(size_of::<TriangleBlock>()),
            next: (0, 0),
            places: vec![0; count as usize],
            vertices: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn is_done(&self) -> bool {
        self.objects.get(self.next.0..).is_none_or(|rest| rest.iter().all(|object| object.mesh.indices.is_empty()))
    }

    /// Takes the next piece; it has at least one triangle while there are any.
    fn cut(&mut self) {
        self.vertices.clear();
        self.triangles.clear();
        while let Some(object) = self.objects.get(self.next.0) {
            let Some(corners) = object.mesh.indices[3 * self.next.1..].first_chunk::<3>() else {
                self.next = (self.next.0 + 1, 0);
                continue;
            };
            let is_full = self.triangles.len() >= self.most_triangles || self.vertices.len() + 3 > self.most_vertices;
            if is_full && !self.triangles.is_empty() {
                return;
            }
            let first = self.firsts[self.next.0];
            let vertices = corners.map(|corner| self.place(first + corner));
            self.triangles.push(TriangleBlock { vertices, object: self.next.0 as u32 });
            self.next.1 += 1;
        }
    }

    /// The place of a vertex in the piece, where it may be new.
    fn place(&mut self, vertex: u32) -> u32 {
        let place = self.places[vertex as usize];
        // What a piece before has left means nothing unless the vertex is there.
        if self.vertices.get(place as usize) == Some(&vertex) {
            return place;
        }
        let place = self.vertices.len() as u32;
        self.places[vertex as usize] = place;
        self.vertices.push(vertex);
        place
    }

    fn vertex(&self, number: u32) -> VertexBlock {
        let object = self.firsts.partition_point(|&first| first <= number) - 1;
        let (mesh, at) = (&self.objects[object].mesh, (number - self.firsts[object]) as usize);
        VertexBlock::new(mesh.positions[at], mesh.normals[at])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;
    use glam::Vec3;

    #[test]
    fn pieces_hold_every_triangle_once_and_keep_to_their_size() {
        let objects = [shapes::sphere(9, 7), shapes::cuboid(), crate::scene::Mesh::default(), shapes::teapot()]
            .map(|mesh| Object::new(mesh, Vec3::ONE));
        let corner =
            |mesh: &crate::scene::Mesh, i: u32| VertexBlock::new(mesh.positions[i as usize], mesh.normals[i as usize]);
        let expected: Vec<(u32, [VertexBlock; 3])> = (0..)
            .zip(&objects)
            .flat_map(|(number, o)| {
                o.mesh.indices.chunks_exact(3).map(move |t| (number, [0, 1, 2].map(|k| corner(&o.mesh, t[k]))))
            })
            .collect();
        for limit_bytes in [1, 96, 1000, 4096, 1 << 30] {
            let mut cutting = Cutting::new(&objects, limit_bytes);
            let mut found = Vec::new();
            while !cutting.is_done() {
                cutting.cut();
                assert!(!cutting.triangles.is_empty());
                let bytes = (32 * cutting.vertices.len()).max(16 * cutting.triangles.len()) as u64;
                assert!(bytes <= limit_bytes || cutting.triangles.len() == 1, "{bytes} of {limit_bytes}");
                for triangle in &cutting.triangles {
                    let corners = triangle.vertices.map(|place| cutting.vertex(cutting.vertices[place as usize]));
                    found.push((triangle.object, corners));
                }
            }
            let words = |list: &[(u32, [VertexBlock; 3])]| {
                list.iter().map(|(o, t)| (*o, bytemuck::cast_slice::<VertexBlock, u32>(t).to_vec())).collect::<Vec<_>>()
            };
            assert!(words(&found) == words(&expected), "{limit_bytes}");
        }
    }
}

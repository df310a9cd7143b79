//! Polygon objects in the same picture, with mutually hidden surfaces: "does support traditional objects" (section 1).

use std::sync::Arc;

use ash::vk;

use super::blocks::LightBlock;
use super::parameters::Parameters;
use super::scene::{Seen, block_buffer};
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Mesh;

host_block! {
    struct ObjectVertex {
        position: [f32; 3],
        normal: [f32; 3],
    }
}

host_block! {
    struct ObjectConstants {
        to_clip: [f32; 16],
    }
}

/// The passes `object-depth` and `objects`.
pub struct Objects {
    light: Arc<Buffer>,
    depth_pass: Pass,
    passes: Vec<(Pass, u32)>,
}

impl Objects {
    /// Draws over `picture` what is nearer than `depth` says.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        meshes: &[Mesh],
        depth: &Arc<ImageView>,
        picture: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let name = format!("{label}/object-depth");
        let desc = ImageDesc::new_2d(name, vk::Format::D32_SFLOAT, parameters.width, parameters.height);
        let tested = Image::new(device, desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT))?.view()?;
        let light = block_buffer::<LightBlock>(device, &format!("{label}/object-light"))?;
        let depth_pass = Pass::graphics("object-depth", "1", "common/fullscreen.vert", "terrain/object-depth.frag")
            .with("light", &light)
            .with("depth", depth)
            .depth(&tested, Load::Clear([1.0, 0.0, 0.0, 0.0]), DepthTest::LessWrite)
            .build(shaders)?;
        let mut passes = Vec::new();
        for mesh in meshes {
            let pairs = mesh.positions.iter().zip(&mesh.normals);
            let vertices: Vec<ObjectVertex> =
                pairs.map(|(p, n)| ObjectVertex { position: p.to_array(), normal: n.to_array() }).collect();
            let buffer = |what: &str, usage, bytes: &[u8]| {
                upload(device, &format!("{label}/{}/{what}", mesh.name), usage, bytes)
            };
            let vertex_usage = vk::BufferUsageFlags::VERTEX_BUFFER;
            let vertices = buffer("vertices", vertex_usage, bytemuck::cast_slice(&vertices))?;
            let index_usage = vk::BufferUsageFlags::INDEX_BUFFER;
            let indices = buffer("indices", index_usage, bytemuck::cast_slice(&mesh.indices))?;
            let pass = Pass::graphics("objects", "1", "terrain/object.vert", "terrain/object.frag")
                .with("light", &light)
                .vertices::<ObjectVertex>(&vertices)
                .indices(&indices)
                .constants::<ObjectConstants>()
                .color(picture, Load::Keep, Blend::Replace)
                .depth(&tested, Load::Keep, DepthTest::LessWrite)
                .build(shaders)?;
            passes.push((pass, mesh.indices.len() as u32));
        }
        Ok(Objects { light, depth_pass, passes })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, seen: &Seen) -> Result<(), Error> {
        self.light.write(0, bytemuck::bytes_of(&seen.light))?;
        frame.graphics(&self.depth_pass, |draw| {
            draw.vertices(3);
        })?;
        let constants = ObjectConstants { to_clip: seen.to_clip.as_mat4().to_cols_array() };
        self.passes.iter().try_for_each(|(pass, count)| {
            frame.graphics(pass, |draw| {
                draw.constants(&constants).indices(*count);
            })
        })
    }
}

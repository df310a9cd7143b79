//! Polygon objects in the same picture, with mutually hidden surfaces: "does support traditional objects" (section 1).

use std::sync::Arc;

use ash::vk;

use super::blocks::LightBlock;
use super::hit::NO_DEPTH;
use super::parameters::Parameters;
use super::scene::{DeviceScene, Seen, block_buffer};
use super::shadows::Shadows;
use super::stage::Stage;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;
use crate::measure::Target;
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

/// The passes `object-depth` and `objects`; between them `object-hits` and `object-shadow` where the maps throw shadows.
pub struct Objects {
    light: Arc<Buffer>,
    depth_pass: Pass,
    /// Of the meshes; none without shadows.
    hit_passes: Vec<Pass>,
    hits: Option<Arc<ImageView>>,
    shadows: Shadows,
    /// Of the meshes, with their numbers of indices.
    passes: Vec<(Pass, u32)>,
}

impl Objects {
    /// Draws over the picture what is nearer than its depth says, in the shadow of the maps of `scene`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        meshes: &[Mesh],
        (depth, picture): (&Arc<ImageView>, &Arc<ImageView>),
        scene: Option<&DeviceScene>,
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
        let buffers = meshes.iter().map(|mesh| Buffers::new(shaders, label, mesh)).collect::<Result<Vec<_>, _>>()?;
        let draw = |name: &'static str, fragment: &str, buffers: &Buffers| {
            Pass::graphics(name, "1", "terrain/object.vert", fragment)
                .vertices::<ObjectVertex>(&buffers.vertices)
                .indices(&buffers.indices)
                .constants::<ObjectConstants>()
        };
        let mut hit_passes = Vec::new();
        let (shadows, hits, test) = match scene {
            None => (Shadows::none(device, &format!("{label}/objects"))?, None, DepthTest::LessWrite),
            Some(scene) => {
                let (size, format) = ((parameters.width, parameters.height), vk::Format::R32G32B32A32_SFLOAT);
                let hits = Stage::Fragment.image(device, format!("{label}/object-hits"), format, size)?;
                for (number, buffers) in buffers.iter().enumerate() {
                    let load = if number == 0 { Load::Clear([NO_DEPTH, 0.0, 0.0, 0.0]) } else { Load::Keep };
                    let pass = draw("object-hits", "terrain/object-hit.frag", buffers)
                        .color(&hits, load, Blend::Replace)
                        .depth(&tested, Load::Keep, DepthTest::LessWrite);
                    hit_passes.push(pass.build(shaders)?);
                }
                let said = (Stage::Fragment, "object-shadow");
                let shadows = Shadows::of_maps(shaders, label, said, parameters, scene, &hits)?;
                (shadows, Some(hits), DepthTest::EqualReadOnly)
            }
        };
        let pass = |buffers: &Buffers| {
            let pass = draw("objects", "terrain/object.frag", buffers)
                .with("light", &light)
                .with("shadow", &shadows.sunlit)
                .color(picture, Load::Keep, Blend::Replace)
                .depth(&tested, Load::Keep, test);
            Ok((pass.build(shaders)?, buffers.index_count))
        };
        let passes = buffers.iter().map(pass).collect::<Result<_, Error>>()?;
        Ok(Objects { light, depth_pass, hit_passes, hits, shadows, passes })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, seen: &Seen) -> Result<(), Error> {
        self.light.write(0, bytemuck::bytes_of(&seen.light))?;
        frame.graphics(&self.depth_pass, |draw| {
            draw.vertices(3);
        })?;
        let constants = ObjectConstants { to_clip: seen.to_clip.as_mat4().to_cols_array() };
        let draw = |frame: &mut Frame<'_>, pass: &Pass, count: u32| {
            frame.graphics(pass, |draw| {
                draw.constants(&constants).indices(count);
            })
        };
        for (pass, (_, count)) in self.hit_passes.iter().zip(&self.passes) {
            draw(frame, pass, *count)?;
        }
        self.shadows.record(frame)?;
        self.passes.iter().try_for_each(|(pass, count)| draw(frame, pass, *count))
    }

    /// Where objects are seen and what of the sun reaches them, with shadows.
    pub fn targets(&self) -> Vec<Target> {
        let hits = self.hits.iter().map(|hits| Target::image("object-hits", hits));
        let shadows = Some(&self.shadows).filter(|shadows| shadows.are_thrown());
        hits.chain(shadows.map(|shadows| Target::image("object-shadow", &shadows.sunlit))).collect()
    }
}

/// A mesh on the device.
struct Buffers {
    vertices: Arc<Buffer>,
    indices: Arc<Buffer>,
    index_count: u32,
}

impl Buffers {
    fn new(shaders: &ShaderLibrary, label: &str, mesh: &Mesh) -> Result<Self, Error> {
        let buffer = |what: &str, usage, bytes: &[u8]| {
            upload(shaders.device(), &format!("{label}/{}/{what}", mesh.name), usage, bytes)
        };
        let pairs = mesh.positions.iter().zip(&mesh.normals);
        let vertices: Vec<ObjectVertex> =
            pairs.map(|(p, n)| ObjectVertex { position: p.to_array(), normal: n.to_array() }).collect();
        let (vertex_usage, index_usage) = (vk::BufferUsageFlags::VERTEX_BUFFER, vk::BufferUsageFlags::INDEX_BUFFER);
        Ok(Buffers {
            vertices: buffer("vertices", vertex_usage, bytemuck::cast_slice(&vertices))?,
            indices: buffer("indices", index_usage, bytemuck::cast_slice(&mesh.indices))?,
            index_count: mesh.indices.len() as u32,
        })
    }
}

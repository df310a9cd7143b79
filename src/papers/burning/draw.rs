//! `draw`: the mesh as it burns.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::buffers::Buffers;
use super::framing;
use super::materials::Appearances;
use super::model::Model;
use super::parameters::{Material, Parameters, Shading, Variant};
use super::texture::Surface;
use crate::gpu::transfer::{update, upload};
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Camera;

host_block! {
    /// The uniform block of `burning/view.glsl`, which says what each member is.
    pub(super) struct ViewBlock {
        view_projection: Mat4,
        eye: Vec3,
        ambient: f32,
        to_light: Vec3,
        _pad: f32,
    }
}

/// Format of linear light.
pub(super) const LIGHT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

/// Direction to the light, not of unit length, and its ambient fraction.
const TO_LIGHT: Vec3 = Vec3::new(0.45, 0.75, 0.6);
const AMBIENT: f32 = 0.35;
const FAR: Load = Load::Clear([1.0, 0.0, 0.0, 0.0]);

/// The pass with its targets.
pub struct Draw {
    pass: Pass,
    /// The user's camera, or one that frames the object.
    pub camera: Camera,
    /// The uniform block of `burning/view.glsl`.
    pub view: Arc<Buffer>,
    /// D32.
    pub depth: Arc<ImageView>,
    /// 8-bit sRGB.
    pub picture: Arc<ImageView>,
    /// Linear light that `tone` makes the picture of; else the picture.
    pub target: Arc<ImageView>,
    /// Of an object that a picture covers.
    pub surface: Option<Surface>,
}

impl Draw {
    /// # Errors
    /// [`Error::Pass`] for a texture on a mesh without texture coordinates; what the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        (variant, parameters): (Variant, &Parameters),
        buffers: &Buffers,
        (appearances, fire_lights): (Option<&Appearances>, Option<&Arc<Buffer>>),
        model: &Model,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let target = |name: &str, format, usage| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, parameters.width, parameters.height);
            Image::new(device, desc.usage(usage | vk::ImageUsageFlags::SAMPLED))?.view()
        };
        let depth = target("depth", vk::Format::D32_SFLOAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)?;
        let picture = target("picture", vk::Format::R8G8B8A8_SRGB, vk::ImageUsageFlags::COLOR_ATTACHMENT)?;
        let target = match fire_lights {
            None => picture.clone(),
            Some(_) => target("radiance", LIGHT, vk::ImageUsageFlags::COLOR_ATTACHMENT)?,
        };
        let camera = framing::camera(parameters, model);
        let block = view_block(parameters, &camera);
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let view = upload(device, &format!("{label}/view"), usage, bytemuck::bytes_of(&block))?;
        let coordinates = &model.lattice.texture_coordinates;
        let surface = match &parameters.texture {
            None => None,
            Some(_) if coordinates.is_empty() => {
                let problem = "the mesh has no texture coordinates for the texture".to_owned();
                return Err(Error::Pass { pass: "draw".into(), problem });
            }
            Some(texture) => Some(Surface::new(shaders, label, texture, coordinates)?),
        };
        let (vertex, fragment) = shaders_of(variant, parameters);
        let light = match (fragment, fire_lights) {
            ("draw-normals", _) => "",
            (_, None) => "-sun",
            (_, Some(_)) => "-flames",
        };
        let fragment_shader = format!("burning/{fragment}{light}.frag");
        let mut pass = Pass::graphics("draw", "3.8", &format!("burning/{vertex}.vert"), &fragment_shader);
        if let Some(fire_lights) = fire_lights {
            pass = pass.with("FireLights", fire_lights);
        }
        pass = match parameters.shading {
            Shading::Areas => pass.with("Labels", &buffers.labels),
            Shading::Blocks => pass.with("Cells", &buffers.cells),
            _ => pass,
        };
        if let (Some(surface), "draw-textured") = (&surface, fragment) {
            pass = pass
                .with("TextureCoordinates", &surface.coordinates)
                .with("TextureLevels", &surface.levels)
                .with("texels", &surface.texels);
        }
        if let (Some(appearances), "draw-several") = (appearances, fragment) {
            pass = pass.with("Substances", &appearances.substances).with("SubstanceOf", &appearances.substance_of);
        }
        if fragment != "draw-normals" {
            pass = pass.with("constants", &buffers.constants);
        }
        let pass = pass
            .with("view", &view)
            .with("Rest", &buffers.rest)
            .with("Welds", &buffers.welds)
            .with("Mapped", &buffers.mapped)
            .with("Normals", &buffers.normals)
            .with("Colors", &buffers.colors)
            .indices(&buffers.stream)
            .indirect(&buffers.arguments)
            .color(&target, Load::Clear(parameters.background.extend(1.0).to_array()), Blend::Replace)
            .depth(&depth, FAR, DepthTest::LessWrite)
            .cull(hidden_side(parameters.removes(variant), model))
            .build(shaders)?;
        Ok(Draw { pass, camera, view, depth, picture, target, surface })
    }

    /// Sets the camera of the next frames.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn set_camera(&mut self, parameters: &Parameters, camera: Camera) -> Result<(), Error> {
        self.camera = camera;
        update(&self.view, bytemuck::bytes_of(&view_block(parameters, &camera)))
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.indices_indirect())
    }
}

/// Of an object that nothing leaves the side of its triangles that is never seen from outside.
fn hidden_side(removes: bool, model: &Model) -> vk::CullModeFlags {
    match model.hides_inside && !removes {
        true if model.outward > 0.0 => vk::CullModeFlags::BACK,
        true => vk::CullModeFlags::FRONT,
        false => vk::CullModeFlags::NONE,
    }
}

fn view_block(parameters: &Parameters, camera: &Camera) -> ViewBlock {
    ViewBlock {
        view_projection: camera.projection(parameters.aspect()) * camera.view(),
        eye: camera.eye,
        ambient: AMBIENT,
        to_light: TO_LIGHT.normalize(),
        _pad: 0.0,
    }
}

/// The pass's vertex and fragment shader: one each for what colours the surface. Devices that run both sides of a branch
/// would pay for all of them, and drivers that fold a uniform's value into a shader compile it anew.
fn shaders_of(variant: Variant, parameters: &Parameters) -> (&'static str, &'static str) {
    match (parameters.shading, parameters.material(variant)) {
        (Shading::Areas, ..) => ("draw-areas", "draw"),
        (Shading::Blocks, ..) => ("draw-blocks", "draw"),
        (Shading::Normals, ..) => ("draw-surface", "draw-normals"),
        (Shading::Lit, _) if parameters.materials.is_some() => ("draw-several", "draw-several"),
        // Edges stand out on a surface without a pattern.
        (Shading::Wire, _) | (Shading::Lit, Some(Material::Plain | Material::Wax)) => ("draw-surface", "draw"),
        (Shading::Lit, None) => ("draw-textured", "draw-textured"),
        (Shading::Lit, Some(Material::Wood)) => ("draw-surface", "draw-wood"),
    }
}

//! Caustics casting (section 4.6): the receivers under the viewer's camera, each lit by its combined map.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::maps::{self, FAR};
use super::method::{Method, Site};
use super::parameters::Parameters;
use super::receiver::{BoxBlock, LitReceiver, Vertex};
use super::water::LEVEL_M;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Camera;

host_block! {
    pub struct CameraBlock {
        view_projection: [f32; 16],
    }
}

host_block! {
    struct CastConstants {
        bounds: BoxBlock,
        albedo: [f32; 4],
        ambient: [f32; 4],
    }
}

/// What is seen where there is no receiver: light scattered back by deep water, linear RGB.
pub const DEEP_WATER: Load = Load::Clear([0.004, 0.030, 0.055, 1.0]);

/// What the view from above needs to see beyond the picture's edges, where the waves turn its rays outwards.
const WIDENING: f32 = 1.4;

/// The camera of the underwater textures. From above it stands where the refracted ray of the picture's middle comes from, so
/// that what hides what under water is, but for the waves, what the viewer sees; farther by the refraction index, as an
/// object under water seems nearer.
fn underwater_camera(parameters: &Parameters) -> Camera {
    let camera = parameters.camera;
    let forward = (camera.target - camera.eye).normalize();
    if !parameters.is_seen_from_above() || forward.y > -0.05 {
        return camera;
    }
    let level = LEVEL_M as f32;
    let n = parameters.refraction_index;
    let way = (level - camera.eye.y) / forward.y;
    let entry = camera.eye + forward * way;
    let sin2_refracted = (1.0 - forward.y * forward.y) / (n * n);
    let refracted = (forward / n + Vec3::Y * (-forward.y / n - (1.0 - sin2_refracted).sqrt())).normalize();
    Camera {
        eye: entry - refracted * (way * n),
        target: entry + refracted,
        vertical_fov_rad: 2.0 * ((camera.vertical_fov_rad / 2.0).tan() / n * WIDENING).atan(),
        far_m: camera.far_m * n,
        ..camera
    }
}

/// Colour and depth of the underwater scene as a camera sees it that stands for the viewer's without the surface.
pub struct Underwater {
    /// Linear RGB.
    pub color: Arc<ImageView>,
    pub depth: Arc<ImageView>,
    /// The depth alone, without a stencil.
    pub fetched_depth: Arc<ImageView>,
    pub view_projection: Mat4,
    pub eye: Vec3,
    pub camera: Arc<Buffer>,
}

impl Underwater {
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        depth_format: vk::Format,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let image = |name: &str, format, attachment| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, parameters.width, parameters.height);
            let image = Image::new(device, desc.usage(attachment | vk::ImageUsageFlags::SAMPLED));
            image.map_err(|error| error.set_by("--size"))
        };
        let depth = image("underwater-depth", depth_format, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)?;
        let camera = underwater_camera(parameters);
        let view_projection = camera.projection(parameters.aspect()) * camera.view();
        let block = CameraBlock { view_projection: view_projection.to_cols_array() };
        Ok(Underwater {
            color: image("underwater-color", maps::LIGHT, vk::ImageUsageFlags::COLOR_ATTACHMENT)?.view()?,
            depth: depth.view()?,
            fetched_depth: depth.depth_view()?,
            view_projection,
            eye: camera.eye,
            camera: upload(
                device,
                &format!("{label}/camera"),
                vk::BufferUsageFlags::UNIFORM_BUFFER,
                bytemuck::bytes_of(&block),
            )?,
        })
    }
}

/// One receiver's part of the cast under one light.
pub struct Cast {
    pass: Pass,
    ambient: [f32; 3],
}

/// Where a part stands among all parts of the cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Index of the light; the first lays down depth and ambient light, the others are added (eq. 4-20).
    pub light: usize,
    /// Index of the receiver.
    pub receiver: usize,
}

impl Cast {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(site: Site<'_>, underwater: &Underwater, method: &dyn Method, place: Place) -> Result<Self, Error> {
        let Site { shaders, lit, nearest, parameters, .. } = site;
        let load = |clear| if place == (Place { light: 0, receiver: 0 }) { clear } else { Load::Keep };
        let (blend, test) = if place.light == 0 {
            (Blend::Replace, DepthTest::LessWrite)
        } else {
            (Blend::Add, DepthTest::EqualReadOnly)
        };
        let pass = Pass::graphics("cast", "4.6", "caustics/cast.vert", "caustics/cast.frag")
            .vertices::<Vertex>(&lit.receiver.vertices)
            .indices(&lit.receiver.indices)
            .constants::<CastConstants>()
            .with("camera", &underwater.camera)
            .with("combined_map", method.combined_map())
            .with("position_map", method.position_map())
            .with("nearest", nearest)
            .color(&underwater.color, load(DEEP_WATER), blend)
            .depth(&underwater.depth, load(FAR), test)
            .build(shaders)?;
        let ambient = if place.light == 0 { parameters.ambient.to_array() } else { [0.0; 3] };
        Ok(Cast { pass, ambient })
    }

    /// Draws the receiver.
    pub fn draw(&self, frame: &mut Frame<'_>, lit: &LitReceiver, method: &dyn Method) -> Result<(), Error> {
        let [r, g, b] = self.ambient;
        let constants = CastConstants {
            bounds: lit.box_block(),
            albedo: lit.receiver.albedo.extend(0.0).to_array(),
            ambient: [r, g, b, method.height_slack_m(lit)],
        };
        frame.graphics(&self.pass, |draw| {
            draw.constants(&constants).indices(lit.receiver.index_count);
        })
    }
}

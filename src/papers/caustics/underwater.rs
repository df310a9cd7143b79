//! The underwater scene: what `cast` or the stencil method draws, and `view` looks at through the water's surface.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::parameters::Parameters;
use super::resources::{COLOR_MAP, Context, LIGHT};
use super::water::LEVEL_M;
use crate::gpu::transfer::update;
use crate::gpu::{Buffer, Error, ImageView};
use crate::host_block;
use crate::scene::Camera;

host_block! {
    pub struct CameraBlock {
        view_projection: [f32; 16],
    }
}

/// Widening of the picture's angle, for the view from above needs to see beyond its edges, where waves turn rays
/// outwards.
const WIDENING: f32 = 1.4;

/// The camera of the underwater textures. From above it stands where the refracted ray of the picture's middle comes
/// from, so that what hides what under water is, but for the waves, what the viewer sees; farther by the refraction
/// index, as an object under water seems nearer.
fn underwater_camera(parameters: &Parameters) -> Camera {
    let camera = parameters.camera;
    let forward = (camera.target - camera.eye).normalize();
    if !parameters.is_seen_from_above() || forward.y > -0.05 {
        return camera;
    }
    let level = LEVEL_M as f32;
    let n = parameters.refraction_index;
    let t = (level - camera.eye.y) / forward.y;
    let entry = camera.eye + forward * t;
    let sin2_refracted = (1.0 - forward.y * forward.y) / (n * n);
    let refracted = (forward / n + Vec3::Y * (-forward.y / n - (1.0 - sin2_refracted).sqrt())).normalize();
    Camera {
        eye: entry - refracted * (t * n),
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
    /// Depth, and the stencil where there is one.
    pub depth: Arc<ImageView>,
    /// The depth alone, without a stencil.
    pub fetched_depth: Arc<ImageView>,
    /// World to clip space.
    pub view_projection: Mat4,
    /// Of the camera, metres.
    pub eye: Vec3,
    /// Near and far plane of the camera.
    pub planes_m: [f32; 2],
    /// A [`CameraBlock`].
    pub camera: Arc<Buffer>,
}

impl Underwater {
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(context: Context<'_>, depth_format: vk::Format) -> Result<Self, Error> {
        let depth_usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let depth = context.image("underwater-depth", depth_format, depth_usage)?;
        let (eye, view_projection, planes_m) = seen(context.parameters);
        let block = CameraBlock { view_projection: view_projection.to_cols_array() };
        Ok(Underwater {
            color: context.image("underwater-color", LIGHT, COLOR_MAP)?.view()?,
            depth: depth.view()?,
            fetched_depth: depth.depth_view()?,
            view_projection,
            eye,
            planes_m,
            camera: context.upload("camera", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?,
        })
    }

    /// Stands for the camera of `parameters` in the next frames.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_camera(&mut self, parameters: &Parameters) -> Result<(), Error> {
        (self.eye, self.view_projection, self.planes_m) = seen(parameters);
        let block = CameraBlock { view_projection: self.view_projection.to_cols_array() };
        update(&self.camera, bytemuck::bytes_of(&block))
    }
}

/// Eye, matrix and planes of the underwater camera.
fn seen(parameters: &Parameters) -> (Vec3, Mat4, [f32; 2]) {
    let camera = underwater_camera(parameters);
    (camera.eye, camera.projection(parameters.aspect()) * camera.view(), [camera.near_m, camera.far_m])
}

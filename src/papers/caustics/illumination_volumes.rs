//! Pass `illumination-volumes` (section 4.3): a refracted ray of one light at every vertex of the water. A volume is
//! what lies between the three rays of a triangle.

use std::sync::Arc;

use ash::vk;
use glam::{DVec3, Vec3};

use super::bounding_box::Axes;
use super::resources::Context;
use super::water::LEVEL_M;
use super::water_surface::WaterSurface;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass};
use crate::host_block;
use crate::scene::Light;

host_block! {
    /// A ray as the planes' vertex stage reads it.
    pub struct Ray {
        origin: [f32; 3],
        enters: f32,
        slope: [f32; 2],
        secant: f32,
        _pad_slope: f32,
        incident: [f32; 3],
        _pad_incident: f32,
    }
}

/// Floats of a [`Ray`].
pub const RAY_FLOATS: u32 = (std::mem::size_of::<Ray>() / 4) as u32;

host_block! {
    struct LightConstants {
        source: [f32; 3],
        is_point: u32,
        reference: [f32; 3],
        eta: f32,
        u: [f32; 3],
        vertex_count: u32,
        v: [f32; 3],
        fresnel: f32,
        w: [f32; 3],
    }
}

/// The pass of one light.
pub struct IlluminationVolumes {
    /// A [`Ray`] for each vertex of the water.
    pub rays: Arc<Buffer>,
    /// Three a volume.
    pub index_count: u32,
    /// Axes of the light's boxes.
    pub axes: Axes,
    /// The point that ray origins are measured from, along the light's axes, metres.
    pub reference: DVec3,
    /// Of the light, linear RGB.
    pub intensity: Vec3,
    pass: Pass,
    constants: LightConstants,
}

impl IlluminationVolumes {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, water: &WaterSurface, light: &Light, axes: Axes) -> Result<Self, Error> {
        let vertex_count = water.grid.vertex_count();
        let size_bytes = u64::from(vertex_count) * std::mem::size_of::<Ray>() as u64;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::VERTEX_BUFFER;
        let desc = BufferDesc::new(context.name("illumination-volumes"), size_bytes).usage(usage);
        let rays = Buffer::new(context.device(), desc).map_err(|error| error.set_by("water-triangles"))?;
        let pass = Pass::compute("illumination-volumes", "4.3", "caustics/illumination-volumes.comp")
            .with("water", &water.vertices)
            .with("rays", &rays)
            .constants::<LightConstants>()
            .build(context.shaders)?;
        let middle = water.grid.center();
        let reference = axes.along(DVec3::new(middle.x, LEVEL_M, middle.y));
        let (source, is_point, intensity) = match *light {
            Light::Parallel { direction, intensity } => (direction.as_dvec3().normalize().as_vec3(), 0, intensity),
            Light::Point { position, intensity } => (position, 1, intensity),
        };
        let constants = LightConstants {
            source: source.to_array(),
            is_point,
            reference: reference.as_vec3().to_array(),
            eta: 1.0 / context.parameters.refraction_index,
            u: axes.u.as_vec3().to_array(),
            vertex_count,
            v: axes.v.as_vec3().to_array(),
            fresnel: f32::from(u8::from(context.parameters.fresnel)),
            w: axes.w.as_vec3().to_array(),
        };
        let index_count = 3 * water.grid.triangle_count();
        Ok(IlluminationVolumes { rays, index_count, axes, reference, intensity, pass, constants })
    }

    /// Sets whether the water of the next frames reflects a part of the light.
    pub fn set_fresnel(&mut self, fresnel: bool) {
        self.constants.fresnel = f32::from(u8::from(fresnel));
    }

    /// Refracts the light at every water vertex.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| dispatch.constants(&self.constants).elements(self.constants.vertex_count))
    }
}

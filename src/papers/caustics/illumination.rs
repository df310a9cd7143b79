//! Illumination volumes of one light: a refracted ray at every water vertex (section 4.3).

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::parameters::Parameters;
use super::planes::Axes;
use super::water::{LEVEL_M, Water};
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Light;

host_block! {
    /// A ray as the planes' vertex stage reads it.
    pub struct Ray {
        pub origin: [f32; 4],
        pub slope: [f32; 4],
        pub incident: [f32; 4],
    }
}

/// Floats of a [`Ray`].
pub const RAY_FLOATS: u32 = (std::mem::size_of::<Ray>() / 4) as u32;

host_block! {
    struct LightConstants {
        source: [f32; 4],
        u: [f32; 4],
        v: [f32; 4],
        w: [f32; 4],
        reference: [f32; 4],
        eta: f32,
        vertex_count: u32,
    }
}

/// The volumes of one light.
pub struct IlluminationVolumes {
    pub rays: Arc<Buffer>,
    pub index_count: u32,
    /// The point that ray origins are measured from, along the light's axes, metres.
    pub reference: DVec3,
    pass: Pass,
    constants: LightConstants,
}

impl IlluminationVolumes {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        water: &Water,
        light: &Light,
        axes: &Axes,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let vertex_count = water.grid.vertex_count();
        let size_bytes = u64::from(vertex_count) * std::mem::size_of::<Ray>() as u64;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::VERTEX_BUFFER;
        let desc = BufferDesc::new(format!("{label}/illumination-volumes"), size_bytes).usage(usage);
        let rays = Buffer::new(shaders.device(), desc).map_err(|error| error.set_by("--water-triangles"))?;
        let pass = Pass::compute("illumination-volumes", "4.3", "caustics/illumination-volumes.comp")
            .with("water", &water.vertices)
            .with("rays", &rays)
            .constants::<LightConstants>()
            .build(shaders)?;
        let middle = water.grid.center();
        let reference = axes.along(DVec3::new(middle.x, LEVEL_M, middle.y));
        let four = |v: DVec3, w: f32| v.as_vec3().extend(w).to_array();
        let constants = LightConstants {
            source: match *light {
                Light::Parallel { direction, .. } => four(direction.as_dvec3().normalize(), 0.0),
                Light::Point { position, .. } => four(position.as_dvec3(), 1.0),
            },
            u: four(axes.u, 0.0),
            v: four(axes.v, 0.0),
            w: four(axes.w, 0.0),
            reference: four(reference, 0.0),
            eta: 1.0 / parameters.refraction_index,
            vertex_count,
        };
        Ok(IlluminationVolumes { rays, index_count: 3 * water.grid.triangle_count(), reference, pass, constants })
    }

    /// Refracts the light at every water vertex.
    pub fn refract(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| {
            dispatch.constants(&self.constants).threads(self.constants.vertex_count, 1, 1);
        })
    }
}

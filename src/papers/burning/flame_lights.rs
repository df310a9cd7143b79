//! `flame-lights`: the light that the flames give, as a few lights. Ours.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::Burning;
use super::buffers::Buffers;
use super::flames::Flames;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// A light of the flames (`burning/fire-light.glsl`).
    pub struct FireLight {
        /// Mean of the particles', diagonals.
        pub position: Vec3,
        /// Of the ball that gives the light, diagonals.
        pub radius: f32,
        /// Irradiance over pi at a distance of 1 diagonal, linear RGB.
        pub intensity: Vec3,
        /// Of the lights, in each.
        pub count: f32,
    }
}

/// Cells of the box around the flames along each axis.
pub const LIGHT_CELLS: usize = 3;

const MOST_LIGHTS: usize = LIGHT_CELLS * LIGHT_CELLS * LIGHT_CELLS;

/// Of the lights.
pub(super) const BYTES: u32 = (MOST_LIGHTS * size_of::<FireLight>()) as u32;

/// [`FireLight`]s, none of them lit.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn fire_lights(shaders: &ShaderLibrary, label: &str) -> Result<Arc<Buffer>, Error> {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::UNIFORM_BUFFER;
    let dark = FireLight { position: Vec3::ZERO, radius: 1.0, intensity: Vec3::ZERO, count: 0.0 };
    upload(shaders.device(), &format!("{label}/fire-lights"), usage, bytemuck::cast_slice(&[dark; MOST_LIGHTS]))
}

/// The pass.
pub struct FlameLights {
    pass: Pass,
}

impl FlameLights {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        buffers: &Buffers,
        flames: &Flames,
        fire_lights: &Arc<Buffer>,
    ) -> Result<Self, Error> {
        let pass = Pass::compute("flame-lights", "", "burning/flame-lights.comp")
            .with("constants", &buffers.constants)
            .with("billboards", &flames.billboards)
            .with("Particles", &flames.particles)
            .with("FireLights", fire_lights)
            .build(shaders)?;
        Ok(FlameLights { pass })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| dispatch.threads(1, 1, 1))
    }
}

impl Burning {
    /// [`FireLight`]s, of a picture of linear light.
    pub fn fire_lights(&self) -> Option<&Arc<Buffer>> {
        self.fire_lights.as_ref()
    }
}

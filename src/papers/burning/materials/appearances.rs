//! Colours and patterns of materials, on the device.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::super::model::Model;
use super::super::parameters::{Material, Parameters, Variant};
use super::{Kind, Substance};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, ShaderLibrary};
use crate::host_block;

host_block! {
    /// A material to the eye (`burning/substances.glsl`).
    pub struct Appearance {
        /// Linear RGB.
        pub albedo: Vec3,
        /// 1 for what chars.
        pub charring: f32,
        /// Linear RGB of its glow.
        pub embers: Vec3,
        /// 1 for the rings of a tree.
        pub grain: f32,
    }
}

/// Of embers and of hot metal, linear RGB.
const EMBERS: Vec3 = Vec3::new(1.0, 0.35, 0.05);

impl Appearance {
    fn of(substance: &Substance) -> Self {
        let chars = substance.burns() && substance.surface != Material::Wax;
        let glows = chars || substance.kind == Some(Kind::Metal);
        Appearance {
            albedo: substance.albedo,
            charring: f32::from(u8::from(chars)),
            embers: if glows { EMBERS } else { Vec3::ZERO },
            grain: f32::from(u8::from(substance.surface == Material::Wood)),
        }
    }
}

/// The buffers of an object of several materials.
pub struct Appearances {
    /// [`Appearance`] of each material.
    pub substances: Arc<Buffer>,
    /// uint\[C\] for C draw vertices: their materials.
    pub substance_of: Arc<Buffer>,
}

impl Appearances {
    /// Uploads them; none for an object of one material.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        model: &Model,
    ) -> Result<Option<Self>, Error> {
        let Some(materials) = &parameters.materials else { return Ok(None) };
        let appearances: Vec<Appearance> = materials.all(variant, parameters).iter().map(Appearance::of).collect();
        let list = |what: &str, bytes: &[u8]| {
            upload(shaders.device(), &format!("{label}/{what}"), vk::BufferUsageFlags::STORAGE_BUFFER, bytes)
        };
        Ok(Some(Appearances {
            substances: list("substances", bytemuck::cast_slice(&appearances))?,
            substance_of: list("substance-of", bytemuck::cast_slice(&model.lattice.substances))?,
        }))
    }
}

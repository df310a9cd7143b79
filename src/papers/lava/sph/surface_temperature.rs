//! Pass `surface-temperature`: the particles' temperatures and the way that they carried the rock on the grid of the surface (chapter 9).

use std::sync::Arc;

use ash::vk;

use super::super::parameters::Parameters;
use super::super::targets::{Context, FLOATS};
use super::rock::Layings;
use super::{FlowConstants, Sph};
use crate::gpu::{Error, Frame, Image, ImageDesc, ImageView, Pass};

/// The pass.
pub struct SurfaceTemperature {
    pass: Pass,
    constants: FlowConstants,
    /// Kelvin of what glows in red; 1 in green where any particle is near the column, 0 elsewhere; in blue the share of the rock's first laying;
    /// in alpha the particles' kelvin.
    pub temperatures: Arc<ImageView>,
    /// Metres along x and z that the rock of either laying has been carried.
    pub carried: Arc<ImageView>,
}

impl SurfaceTemperature {
    /// Of the fluid's last step, on a texture with heights in metres in alpha.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, sph: &Sph, surface: &Arc<ImageView>) -> Result<Self, Error> {
        let stored = |name: &str| {
            let desc = ImageDesc::new_2d(context.name(name), FLOATS, surface.width(), surface.height());
            let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
            Image::new(context.device(), desc.usage(usage))?.view()
        };
        let (temperatures, carried) = (stored("surface-temperatures")?, stored("surface-carried")?);
        let Parameters { particles, flow, .. } = context.parameters;
        let radiance = flow.heat.crust_radiance(flow.spacing_m(*particles)) as f32;
        let face = context.upload("face", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&radiance))?;
        let pass = Pass::compute("surface-temperature", "9", "lava/surface-temperature.comp")
            .constants::<FlowConstants>()
            .with("starts", &sph.sort.starts)
            .with("predicted", sph.arrived())
            .with("heat", &sph.heat)
            .with("normal_height", surface)
            .with("temperatures", &temperatures)
            .with("carried", &sph.rock.by_cells)
            .with("surface_carried", &carried)
            .with("face", &face)
            .with("crowded", sph.crowded())
            .build(context.shaders)?;
        Ok(SurfaceTemperature { pass, constants: sph.constants, temperatures, carried })
    }

    /// After so many frames.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, sph: &Sph, frames: u32) -> Result<(), Error> {
        let Layings { share, .. } = sph.rock.layings(frames.saturating_mul(sph.substeps).saturating_sub(1));
        let constants = FlowConstants { share, ..self.constants };
        frame.compute(&self.pass, |dispatch| {
            dispatch.constants(&constants).threads(self.temperatures.width(), self.temperatures.height(), 1)
        })
    }
}

//! Pass `surface-temperature`: the particles' temperatures on the grid of the surface, for the colour of black bodies (chapter 9).

use std::sync::Arc;

use ash::vk;

use super::super::targets::{Context, FLOATS};
use super::{FlowConstants, Sph};
use crate::gpu::{Error, Frame, Image, ImageDesc, ImageView, Pass};

/// The pass.
pub struct SurfaceTemperature {
    pass: Pass,
    constants: FlowConstants,
    /// Kelvin in red; 1 in green where any particle is near the column, 0 elsewhere.
    pub temperatures: Arc<ImageView>,
}

impl SurfaceTemperature {
    /// Of the fluid's last step, on a texture with heights in metres in alpha.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, sph: &Sph, surface: &Arc<ImageView>) -> Result<Self, Error> {
        let name = context.name("surface-temperatures");
        let desc = ImageDesc::new_2d(name, FLOATS, surface.width(), surface.height());
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        let temperatures = Image::new(context.device(), desc.usage(usage))?.view()?;
        let [xs, ys, zs] = &sph.sort.places;
        let pass = Pass::compute("surface-temperature", "9", "lava/surface-temperature.comp")
            .constants::<FlowConstants>()
            .with("starts", &sph.sort.starts)
            .with("xs", xs)
            .with("ys", ys)
            .with("zs", zs)
            .with("predicted", sph.arrived())
            .with("heat", &sph.heat)
            .with("normal_height", surface)
            .with("temperatures", &temperatures)
            .build(context.shaders)?;
        Ok(SurfaceTemperature { pass, constants: sph.constants, temperatures })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| {
            dispatch.constants(&self.constants).threads(self.temperatures.width(), self.temperatures.height(), 1);
        })
    }
}

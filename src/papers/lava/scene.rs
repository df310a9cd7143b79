//! Everything that stage three draws from, by splats or by rays: the surface, the camera and the rock.

use std::sync::Arc;

use ash::vk;

use super::blackbody;
use super::parameters::Parameters;
use super::rock::Rock;
use super::sph::parameters::Simulation;
use super::splats::SplatShape;
use super::targets::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::update;
use crate::gpu::{Buffer, Error, ImageView, Sampler};
use crate::host_block;

/// Of the distance between particles; a single one on the floor stands half of it high.
const BARE_SPACINGS: f64 = 0.25;

host_block! {
    pub(super) struct SceneBlock {
        view_projection: [f32; 16],
        glow: [f32; 3],
        splat_radius_m: f32,
        space_m: [f32; 3],
        epsilon_m: f32,
        columns: [f32; 2],
        rock_texels: [f32; 2],
        depth_per_m: f32,
        rock_tile_m: f32,
        temperatures_k: [f32; 2],
        per_brightest: f32,
        is_blackbody: f32,
        bare_m: f32,
        fitted: f32,
        eye_m: [f32; 3],
        daylight: f32,
        gloss: f32,
        _padding: [f32; 3],
    }
}

/// The surface, as textures over the whole space.
#[derive(Clone, Copy)]
pub struct Sheet<'a> {
    /// Normals in RGB, heights in metres in alpha.
    pub normal_height: &'a Arc<ImageView>,
    /// `None` of free particles, whose temperature follows from the height over a level floor.
    pub fluid: Option<&'a FluidSheet>,
}

/// Temperatures, rock and ground of a fluid's surface.
#[derive(Clone)]
pub struct FluidSheet {
    /// Kelvin in red where there is 1 in green, and in blue the share of the rock's first laying.
    pub temperatures: Arc<ImageView>,
    /// Metres along x and z that the rock of either laying has been carried.
    pub carried: Arc<ImageView>,
    /// Slopes of the ground along x and z, and its height in metres.
    pub bed: Arc<ImageView>,
}

/// The scene on the device.
pub struct Scene {
    /// Normals in RGB, heights in metres in alpha, over the whole space.
    pub normal_height: Arc<ImageView>,
    /// The uniform block of the stage.
    pub block: Arc<Buffer>,
    /// The rock.
    pub rock: Arc<ImageView>,
    /// Light of black bodies by temperature.
    pub emission: Arc<Buffer>,
    /// `None` of free particles.
    pub fluid: Option<FluidSheet>,
    /// The sampler of the rock.
    pub linear: Arc<Sampler>,
}

impl Scene {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, sheet: Sheet<'_>, rock: &Rock) -> Result<Self, Error> {
        let Sheet { normal_height, fluid } = sheet;
        let block = block(context.parameters, normal_height, rock);
        Ok(Scene {
            normal_height: normal_height.clone(),
            block: context.upload("scene", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?,
            rock: rock.load(context)?,
            emission: blackbody::load(context)?,
            fluid: fluid.cloned(),
            linear: Sampler::new(context.device(), "linear", vk::Filter::LINEAR)?,
        })
    }

    /// The pass of the shader of that stem that knows where there is lava.
    pub(super) fn bounded(&self, pass: impl FnOnce(&str) -> PassBuilder, stem: &str) -> PassBuilder {
        match &self.fluid {
            None => pass(&format!("{stem}-free.frag")),
            Some(fluid) => pass(&format!("{stem}-sph.frag")).with("bed", &fluid.bed),
        }
    }

    /// The pass of the shader of that stem that colours the lava by its temperatures.
    pub(super) fn colored(&self, pass: impl FnOnce(&str) -> PassBuilder, stem: &str) -> PassBuilder {
        match &self.fluid {
            None => pass(&format!("{stem}-free.frag")),
            Some(fluid) => pass(&format!("{stem}-sph.frag"))
                .with("temperatures", &fluid.temperatures)
                .with("carried", &fluid.carried),
        }
    }

    /// The same of one that also knows where there is lava.
    pub(super) fn hot(&self, pass: impl FnOnce(&str) -> PassBuilder, stem: &str) -> PassBuilder {
        let pass = self.colored(pass, stem);
        match &self.fluid {
            None => pass,
            Some(fluid) => pass.with("bed", &fluid.bed),
        }
    }

    /// Writes the uniform block anew.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set(&self, parameters: &Parameters, rock: &Rock) -> Result<(), Error> {
        update(&self.block, bytemuck::bytes_of(&block(parameters, &self.normal_height, rock)))
    }
}

/// The eye-space depth in metres that the depth texture stores as 1.
pub fn depth_range_m(parameters: &Parameters) -> f32 {
    parameters.camera.far_m + parameters.epsilon_m
}

/// Height of places without lava, at most. The thesis's sheet lies over all of the space, at the floor where no particle is; a
/// fluid that has not come so far leaves the floor bare, and what is thinner than a part of its particles' distance is none.
fn bare_m(parameters: &Parameters) -> f32 {
    match parameters.simulation {
        Simulation::Free => f32::MIN,
        Simulation::Sph => (BARE_SPACINGS * parameters.flow.spacing_m(parameters.particles)) as f32,
    }
}

fn block(parameters: &Parameters, normal_height: &Arc<ImageView>, rock: &Rock) -> SceneBlock {
    let camera = &parameters.camera;
    let temperatures_k = parameters.temperatures_k();
    let hottest_k = parameters.hottest_k();
    let per_brightest = blackbody::per_brightest(hottest_k);
    // Objects and particles take the colour of the hottest, as the display has it.
    let hottest = || {
        let light = blackbody::light(f64::from(hottest_k)).map(|value| value as f32);
        light.map(|value| blackbody::encoded(per_brightest * value))
    };
    let glow = if parameters.is_blackbody { hottest() } else { parameters.color.to_array() };
    let view_projection = camera.projection(parameters.aspect()) * camera.view();
    SceneBlock {
        view_projection: view_projection.to_cols_array(),
        glow,
        splat_radius_m: parameters.splat_radius_m,
        space_m: parameters.space_m.to_array(),
        epsilon_m: parameters.epsilon_m,
        columns: [normal_height.width() as f32, normal_height.height() as f32],
        rock_texels: [rock.width as f32, rock.height as f32],
        depth_per_m: 1.0 / depth_range_m(parameters),
        rock_tile_m: parameters.rock_tile_m,
        temperatures_k,
        per_brightest,
        is_blackbody: f32::from(u8::from(parameters.is_blackbody)),
        bare_m: bare_m(parameters),
        fitted: f32::from(u8::from(parameters.splat_shape == SplatShape::Fitted)),
        eye_m: camera.eye.to_array(),
        daylight: parameters.daylight,
        gloss: parameters.gloss,
        _padding: [0.0; 3],
    }
}

//! Pass `view`: the finished picture, which is the cast seen through the water's surface from above (chapter 1), or
//! plainly from below. Rays find the surface that a pixel shows, the cast its light.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::receiver::ReceiverInput;
use super::resources::Context;
use super::underwater::Underwater;
use super::water::LEVEL_M;
use super::water_surface::{MapBlock, Shape, WaterSurface};
use crate::gpu::transfer::{read_image, update};
use crate::gpu::{Blend, Buffer, Device, Error, Frame, ImageView, Load, Pass};
use crate::host_block;
use crate::papers::triangle_tree::{DeviceTree, TriangleTree};

host_block! {
    pub struct ViewBlock {
        inverse_view_projection: [f32; 16],
        underwater_view_projection: [f32; 16],
        underwater_inverse: [f32; 16],
        eye: [f32; 3],
        level_m: f32,
        underwater_eye: [f32; 3],
        samples: u32,
        picture_size: [f32; 2],
        texture_size: [f32; 2],
        node_count: u32,
        most_steps: u32,
        _pad: [f32; 2],
    }
}

host_block! {
    struct WavesConstants {
        wave_count: u32,
        eta: f32,
        absorption_per_m: f32,
    }
}

host_block! {
    struct MapConstants {
        map: MapBlock,
        eta: f32,
        absorption_per_m: f32,
    }
}

/// The constants of the view from above; the plain view has none.
enum Constants {
    Below,
    AboveWaves(WavesConstants),
    AboveMap(MapConstants),
}

/// Iterations that a pixel of the pass spends at most: lavapipe ends all loops of a shader after 65,535 together.
const MOST_ITERATIONS: u32 = 60_000;

/// Steps of a ray in the receivers' tree, so that those of all samples of a pixel together stay below that. The water
/// takes five rounds of its waves, the search for light nearby 16 rings of 8 texels, as `view-above.glsl` and `view.glsl`
/// have it.
fn most_steps(parameters: &Parameters) -> u32 {
    let around_a_ray = 5 * (parameters.waves.count + 2) + 16 * (8 + 2) + 8;
    (MOST_ITERATIONS / parameters.samples.max(1)).saturating_sub(around_a_ray)
}

/// The pass, the last of a picture; no experiment times it, since the thesis's times end with the cast.
pub struct View {
    /// 8-bit sRGB.
    pub picture: Arc<ImageView>,
    pass: Pass,
    constants: Constants,
    /// A [`ViewBlock`].
    view: Arc<Buffer>,
    node_count: u32,
    most_steps: u32,
}

impl View {
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(
        context: Context<'_>,
        underwater: &Underwater,
        water: &WaterSurface,
        receivers: &[ReceiverInput],
    ) -> Result<Self, Error> {
        let Context { shaders, parameters, nearest, .. } = context;
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let picture = context.image("picture", vk::Format::R8G8B8A8_SRGB, usage)?.view()?;
        let tree = TriangleTree::over(receivers.iter().map(|receiver| &receiver.mesh));
        let tree = DeviceTree::new(context.device(), context.label, &tree)?;
        let block = block(parameters, underwater, tree.node_count);
        let view = context.upload("view", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?;
        let pass = |shader: &str| {
            let shader = format!("caustics/{}.frag", tree.variant(shader));
            let pass = Pass::graphics("view", "1", "common/fullscreen.vert", &shader);
            tree.buffers()
                .fold(pass, |pass, (name, buffer)| pass.with(name, buffer))
                .with("underwater_color", &underwater.color)
                .with("underwater_depth", &underwater.fetched_depth)
                .with("nearest", nearest)
                .with("view", &view)
                .color(&picture, Load::Discard, Blend::Replace)
        };
        if !parameters.is_seen_from_above() {
            let pass = pass("view-below").build(shaders)?;
            let constants = Constants::Below;
            let (node_count, most_steps) = (tree.node_count, block.most_steps);
            return Ok(View { picture, pass, constants, view, node_count, most_steps });
        }
        let eta = 1.0 / parameters.refraction_index;
        let absorption_per_m = parameters.absorption_per_m;
        let (pass, constants) = match &water.shape {
            Shape::Waves { list, waves } => (
                pass("view-above").with("waves", list).constants::<WavesConstants>(),
                Constants::AboveWaves(WavesConstants { wave_count: waves.len() as u32, eta, absorption_per_m }),
            ),
            Shape::Map { coefficients, place } => (
                pass("view-above-map").with("coefficients", coefficients).constants::<MapConstants>(),
                Constants::AboveMap(MapConstants { map: *place, eta, absorption_per_m }),
            ),
        };
        let (node_count, most_steps) = (tree.node_count, block.most_steps);
        Ok(View { pass: pass.build(shaders)?, picture, constants, view, node_count, most_steps })
    }

    /// Sets the camera of the next pictures, on the same side of the water as it was, and the water's absorption.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_drawn(&mut self, parameters: &Parameters, underwater: &Underwater) -> Result<(), Error> {
        match &mut self.constants {
            Constants::Below => {}
            Constants::AboveWaves(waves) => waves.absorption_per_m = parameters.absorption_per_m,
            Constants::AboveMap(map) => map.absorption_per_m = parameters.absorption_per_m,
        }
        let block = block(parameters, underwater, self.node_count);
        update(&self.view, bytemuck::bytes_of(&block))
    }

    /// Draws the picture from the cast.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            match self.constants {
                Constants::Below => draw,
                Constants::AboveWaves(waves) => draw.constants(&waves),
                Constants::AboveMap(map) => draw.constants(&map),
            }
            .vertices(3);
        })
    }

    /// Fails where a ray of the last picture did not end.
    ///
    /// # Errors
    /// [`Error::Pass`] for such a ray; what Vulkan answers.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        let texels = read_image(device, &self.picture)?;
        let uncertain = texels.chunks_exact(4).filter(|texel| texel[3] == 0).count();
        if uncertain == 0 {
            return Ok(());
        }
        let problem = format!(
            "rays of {uncertain} pixels did not end: each may take {} steps in the tree of the receivers' triangles; lower \
             `samples`, or take a `mesh` of fewer or rounder triangles",
            self.most_steps
        );
        Err(Error::Pass { pass: "view".into(), problem })
    }
}

fn block(parameters: &Parameters, underwater: &Underwater, node_count: u32) -> ViewBlock {
    let camera = &parameters.camera;
    let matrix = camera.projection(parameters.aspect()) * camera.view();
    ViewBlock {
        inverse_view_projection: matrix.inverse().to_cols_array(),
        underwater_view_projection: underwater.view_projection.to_cols_array(),
        underwater_inverse: underwater.view_projection.inverse().to_cols_array(),
        eye: camera.eye.to_array(),
        level_m: LEVEL_M as f32,
        underwater_eye: underwater.eye.to_array(),
        samples: parameters.samples,
        picture_size: [parameters.width as f32, parameters.height as f32],
        texture_size: [underwater.color.width() as f32, underwater.color.height() as f32],
        node_count,
        most_steps: most_steps(parameters),
        _pad: [0.0; 2],
    }
}

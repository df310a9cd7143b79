//! Pass `stencil-volumes` (section 3.2, Iwasaki et al.; the thesis has one sentence on it): each illumination volume is
//! held by a closed prism, counted in the stencil buffer against the depth of what is seen, then drawn where the count
//! is not zero, adding its light. It knows no occlusion: a surface in the shadow of another is lit as if nothing stood
//! before it.

use std::sync::Arc;

use ash::vk;

use super::illumination_volumes::IlluminationVolumes;
use super::parameters::Parameters;
use super::receivers::Receivers;
use super::resources::Context;
use super::underwater::Underwater;
use super::water_surface::WaterSurface;
use crate::gpu::transfer::update;
use crate::gpu::{Blend, Buffer, DepthTest, Error, Frame, Load, Pass};
use crate::host_block;

/// Vertices of a volume: a prism's eight triangles.
const VOLUME_VERTICES: u32 = 24;
/// Distance of the volumes' bottom below every receiver, as a fraction of their depth.
const BELOW: f64 = 0.1;

/// By which the sides of a prism lie beyond its volume in the picture, pixels: twice the step that devices round places to,
/// a sixteenth of a pixel at most.
const SLACK_PIXELS: f32 = 0.125;

host_block! {
    pub struct VolumesBlock {
        view_projection: [f32; 16],
        u: [f32; 3],
        reference_u: f32,
        v: [f32; 3],
        reference_v: f32,
        w: [f32; 3],
        reference_w: f32,
        intensity: [f32; 3],
        absorption_per_m: f32,
        bottom: f32,
        slack: f32,
        _pad: [f32; 2],
    }
}

/// The pass of one light.
pub struct StencilVolumes {
    pass: Pass,
    block: VolumesBlock,
    /// The block on the device.
    volumes: Arc<Buffer>,
}

impl StencilVolumes {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        water: &WaterSurface,
        volumes: &IlluminationVolumes,
        seen: &Receivers,
        underwater: &Underwater,
    ) -> Result<Self, Error> {
        let axes = volumes.axes;
        let lowest = seen.lowest_along(&axes) - volumes.reference.y;
        let block = VolumesBlock {
            view_projection: underwater.view_projection.to_cols_array(),
            u: axes.u.as_vec3().to_array(),
            reference_u: volumes.reference.x as f32,
            v: axes.v.as_vec3().to_array(),
            reference_v: volumes.reference.y as f32,
            w: axes.w.as_vec3().to_array(),
            reference_w: volumes.reference.z as f32,
            intensity: volumes.intensity.to_array(),
            absorption_per_m: context.parameters.absorption_per_m,
            bottom: (lowest - BELOW * lowest.abs()) as f32,
            slack: slack(underwater),
            _pad: [0.0; 2],
        };
        let uniform = context.upload("volumes", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?;
        let (vertex, fragment) = ("caustics/stencil-volumes.vert", "caustics/stencil-volumes.frag");
        let pass = Pass::graphics("stencil-volumes", "3.2", vertex, fragment)
            .with("rays", &volumes.rays)
            .with("indices", &water.indices)
            .with("volumes", &uniform)
            .with("surface_position", &seen.position)
            .with("surface_normal", &seen.normal)
            .with("surface_albedo", &seen.albedo)
            .with("nearest", context.nearest)
            .counting("common/empty.frag", DepthTest::CountVolume)
            .color(&underwater.color, Load::Keep, Blend::Add)
            .depth(&underwater.depth, Load::Keep, DepthTest::InsideVolume)
            .build(context.shaders)?;
        Ok(StencilVolumes { pass, block, volumes: uniform })
    }

    /// Sets camera and water of the next frames.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_drawn(&mut self, parameters: &Parameters, underwater: &Underwater) -> Result<(), Error> {
        self.block.absorption_per_m = parameters.absorption_per_m;
        self.block.view_projection = underwater.view_projection.to_cols_array();
        self.block.slack = slack(underwater);
        update(&self.volumes, bytemuck::bytes_of(&self.block))
    }

    /// The volumes one after the other: a draw that counts, a draw that lights.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, volumes: &IlluminationVolumes) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            for volume in 0..volumes.index_count / 3 {
                let first = volume * VOLUME_VERTICES;
                draw.counting(true).vertices_from(first, VOLUME_VERTICES);
                draw.counting(false).vertices_from(first, VOLUME_VERTICES);
            }
        })
    }
}

/// Of a metre's distance from the eye, metres.
fn slack(underwater: &Underwater) -> f32 {
    let pixels = underwater.color.height() as f32 / 2.0 * underwater.view_projection.row(1).truncate().length();
    SLACK_PIXELS / pixels
}

//! Pass `march`, behind `highest-rows` and `highest`: a ray for each pixel against the height field, from its highest place on,
//! in place of the splats of sections 7.1 and 7.2. Ours.

use std::sync::Arc;

use ash::vk;

use super::highest::highest;
use super::highest_rows::highest_rows;
use super::parameters::Parameters;
use super::rays::{RayConstants, rays};
use super::scene::Scene;
use super::targets::{Context, FAR, FLOATS, ZERO};
use crate::gpu::{Blend, Buffer, BufferDesc, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Pass};
use crate::host_block;

host_block! {
    pub(super) struct FieldConstants {
        columns: u32,
        rows: u32,
    }
}

/// The pass, with those before it.
pub struct March {
    highest_rows: Pass,
    highest: Pass,
    field: FieldConstants,
    march: Pass,
    rays: RayConstants,
}

impl March {
    /// Draws into `depth` and `sums`, the targets of the passes that it stands for.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        scene: &Scene,
        depth: &Arc<ImageView>,
        sums: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let (columns, rows) = (scene.normal_height.width(), scene.normal_height.height());
        let desc = BufferDesc::new(context.name("highest"), 4 * (1 + u64::from(rows)));
        let found = Buffer::new(context.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))?;
        let desc = ImageDesc::new_2d(context.name("patches"), FLOATS, columns + 1, rows + 1);
        let patches = Image::new(context.device(), desc.usage(vk::ImageUsageFlags::STORAGE))
            .map_err(|error| error.set_by("density"))?
            .view()?;
        let march = scene
            .hot(|shader| Pass::graphics("march", "", "common/fullscreen.vert", shader), "lava/march")
            .constants::<RayConstants>()
            .with("scene", &scene.block)
            .with("highest", &found)
            .with("patches", &patches)
            .with("normal_height", &scene.normal_height)
            .with("rock", &scene.rock)
            .with("linear", &scene.linear)
            .with("emission", &scene.emission)
            .color(sums, ZERO, Blend::Replace)
            .depth(depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        let field = FieldConstants { columns, rows };
        Ok(March {
            highest_rows: highest_rows(context, scene, &found, &patches)?,
            highest: highest(context.shaders, &found)?,
            field,
            march,
            rays: rays(context.parameters),
        })
    }

    /// Sets the rays to those of the parameters' camera.
    pub fn set_rays(&mut self, parameters: &Parameters) {
        self.rays = rays(parameters);
    }

    /// Draws the surface; the rock has drifted `drift_m` along x.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, drift_m: f32) -> Result<(), Error> {
        frame.compute(&self.highest_rows, |dispatch| {
            dispatch.constants(&self.field).threads(self.field.rows + 1, 1, 1)
        })?;
        frame.compute(&self.highest, |dispatch| dispatch.constants(&self.field).threads(1, 1, 1))?;
        frame.graphics(&self.march, |draw| draw.constants(&self.rays.drifted(drift_m)).vertices(3))
    }
}

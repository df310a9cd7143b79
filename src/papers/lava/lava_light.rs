//! Pass `lava-light`: the fluid's surface as lamps, which shine on objects and ground (chapter 9, "Look at other shading techniques").
//! Ours.

use std::sync::Arc;

use ash::vk;

use super::scene::{FluidSheet, Scene};
use super::targets::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass};
use crate::host_block;

/// Lamps along the longer side, at most.
const LAMPS: u32 = 32;
/// Columns along a side of a lamp's square that it looks at, at most, as in `lava/lava-light.comp`.
const MOST_SIDE: u32 = 254;
/// Bytes of a lamp.
const LAMP: u64 = 48;

host_block! {
    struct SquareConstants {
        count: [u32; 2],
        side: u32,
        step: u32,
    }
}

/// The pass.
pub struct LavaLight {
    pass: Pass,
    constants: SquareConstants,
    /// Each with place and area, direction and their number, light.
    pub lamps: Arc<Buffer>,
}

impl LavaLight {
    /// Of a fluid's surface.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, scene: &Scene, fluid: &FluidSheet) -> Result<Self, Error> {
        let (columns, rows) = (scene.normal_height.width(), scene.normal_height.height());
        let side = columns.max(rows).div_ceil(LAMPS);
        let count = [columns.div_ceil(side), rows.div_ceil(side)];
        let bytes = LAMP * u64::from(count[0]) * u64::from(count[1]);
        let desc = BufferDesc::new(context.name("lamps"), bytes).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
        let lamps = Buffer::new(context.device(), desc)?;
        let pass = Pass::compute("lava-light", "9", "lava/lava-light.comp")
            .constants::<SquareConstants>()
            .with("scene", &scene.block)
            .with("normal_height", &scene.normal_height)
            .with("bed", &fluid.bed)
            .with("temperatures", &fluid.temperatures)
            .with("emission", &scene.emission)
            .with("lamps", &lamps)
            .build(context.shaders)?;
        Ok(LavaLight { pass, constants: SquareConstants { count, side, step: side.div_ceil(MOST_SIDE) }, lamps })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let [across, down] = self.constants.count;
        frame.compute(&self.pass, |dispatch| dispatch.constants(&self.constants).threads(across, down, 1))
    }
}

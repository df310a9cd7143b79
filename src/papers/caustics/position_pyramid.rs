//! Pass `position-pyramid` (section 6.1): least and greatest height of the lit surface in squares of texels.

use std::sync::Arc;

use ash::vk;

use super::resources::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct LevelConstants {
        from: u32,
        from_size: u32,
        to: u32,
        to_size: u32,
    }
}

/// The pass of one receiver under one light.
pub struct PositionPyramid {
    levels: Vec<LevelConstants>,
    pass: Pass,
    /// Two heights an entry, metres of box space, level after level.
    pub heights: Arc<Buffer>,
    /// First entry and entries a side of each level.
    pub table: Arc<Buffer>,
}

impl PositionPyramid {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, position_map: &Arc<ImageView>) -> Result<Self, Error> {
        let levels = levels(context.parameters.map_size);
        let entries = levels.iter().map(|level| u64::from(level.to_size).pow(2)).sum::<u64>();
        let desc = BufferDesc::new(context.name("position-pyramid"), 8 * entries);
        let heights = Buffer::new(context.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
            .map_err(|error| error.set_by("map-size"))?;
        let pass = Pass::compute("position-pyramid", "6.1", "caustics/position-pyramid.comp")
            .constants::<LevelConstants>()
            .with("position_map", position_map)
            .with("nearest", context.nearest)
            .with("pyramid", &heights)
            .build(context.shaders)?;
        let places: Vec<u32> = levels.iter().flat_map(|level| [level.to, level.to_size]).collect();
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let table = context.upload("pyramid-levels", usage, bytemuck::cast_slice(&places))?;
        Ok(PositionPyramid { levels, pass, heights, table })
    }

    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        // The finest level comes with the one above it.
        let finest = self.levels.iter().take(1).map(|level| (level, level.to_size.div_ceil(2)));
        let others = self.levels.iter().skip(2).map(|level| (level, level.to_size));
        finest.chain(others).try_for_each(|(level, size)| {
            frame.compute(&self.pass, |dispatch| {
                dispatch.constants(level).threads(size, size, 1);
            })
        })
    }
}

/// The levels of the pyramid over a map, the finest first, down to one entry.
fn levels(map_size: u32) -> Vec<LevelConstants> {
    let mut levels = vec![LevelConstants { from: 0, from_size: map_size, to: 0, to_size: map_size }];
    while let Some(&LevelConstants { to, to_size, .. }) = levels.last().filter(|level| level.to_size > 1) {
        levels.push(LevelConstants {
            from: to,
            from_size: to_size,
            to: to + to_size * to_size,
            to_size: to_size.div_ceil(2),
        });
    }
    levels
}

//! Pass `position-pyramid` (section 6.1): least and greatest height of the lit surface in squares of texels from 2 x 2 on, and the
//! heights of single ones as a list.

use std::sync::Arc;

use ash::vk;

use super::resources::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct LevelConstants {
        number: u32,
        count: u32,
        map_size: u32,
    }
}

/// The pass of one receiver under one light.
pub struct PositionPyramid {
    pass: Pass,
    /// Of level 1.
    constants: LevelConstants,
    /// The position map as a list, metres of box space, row by row.
    pub heights: Arc<Buffer>,
    /// Two heights an entry, level under level.
    pub entries: Arc<Buffer>,
}

impl PositionPyramid {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, position_map: &Arc<ImageView>) -> Result<Self, Error> {
        let map_size = context.parameters.map_size;
        let buffer = |name: &str, words: u64| {
            let desc = BufferDesc::new(context.name(name), 4 * words).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by("map-size"))
        };
        let heights = buffer("position-heights", u64::from(map_size).pow(2))?;
        let entries = buffer("position-pyramid", 2 * extent(map_size).iter().product::<u64>())?;
        let pass = Pass::compute("position-pyramid", "6.1", "caustics/position-pyramid.comp")
            .constants::<LevelConstants>()
            .with("position_map", position_map)
            .with("nearest", context.nearest)
            .with("heights", &heights)
            .with("pyramid", &entries)
            .build(context.shaders)?;
        let constants = LevelConstants { number: 1, count: level_count(map_size), map_size };
        Ok(PositionPyramid { pass, constants, heights, entries })
    }

    pub fn level_count(&self) -> u32 {
        self.constants.count
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let LevelConstants { count, map_size, .. } = self.constants;
        // The finest level comes with the one above it.
        std::iter::once(1).chain(3..=count).try_for_each(|number| {
            let size = map_size.div_ceil(1 << number.max(2));
            frame.compute(&self.pass, |dispatch| {
                dispatch.constants(&LevelConstants { number, ..self.constants }).threads(size, size, 1);
            })
        })
    }
}

/// Levels over a map, down to one entry.
fn level_count(map_size: u32) -> u32 {
    (u32::BITS - map_size.saturating_sub(1).leading_zeros()).max(1)
}

/// Entries of a row, and rows of all levels: each takes half as many as the one before, of a power of two.
pub(super) fn extent(map_size: u32) -> [u64; 2] {
    [u64::from(map_size.div_ceil(2)), (1 << level_count(map_size)) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_go_down_to_one_entry_and_lie_in_the_list() {
        for map_size in (1..300).chain([511, 512, 513, 4095, 16_383, 16_384, u32::MAX]) {
            let (levels, [width, height]) = (level_count(map_size), extent(map_size));
            let size = |level: u32| u64::from(map_size).div_ceil(1 << level);
            assert!(size(levels) == 1 && (levels == 1 || size(levels - 1) > 1), "{map_size}");
            let mut rows = 0;
            for level in 1..=levels {
                let first = (1_u64 << levels) - ((1 << levels) >> (level - 1));
                assert!(first >= rows && size(level) <= width, "{map_size}");
                rows = first + size(level);
            }
            assert!(rows <= height, "{map_size}: {rows} of {height}");
        }
    }
}

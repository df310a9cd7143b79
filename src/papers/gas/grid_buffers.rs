//! The grids of the volumes on the device.

use std::sync::Arc;

use ash::vk;

use super::blocks::GridBlock;
use super::context::Context;
use super::grid::Grid;
use crate::gpu::transfer::{upload, upload_each};
use crate::gpu::{Buffer, Error};

/// The buffers of `density-grid.glsl`.
pub struct GridBuffers {
    /// [`GridBlock`]s, one a volume.
    pub grids: Arc<Buffer>,
    /// Samples of all grids, floats.
    pub samples: Arc<Buffer>,
    /// Light of their temperatures, four floats each; one that nothing reads where there are none.
    pub glow: Arc<Buffer>,
}

impl GridBuffers {
    /// # Errors
    /// [`Error::Limit`] for grids beyond what the device binds.
    pub fn new(context: &Context<'_>, grids: &[Arc<Grid>]) -> Result<Self, Error> {
        const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;
        let device = context.shaders.device();
        let mut firsts = vec![0];
        for grid in grids {
            firsts.extend(firsts.last().map(|first| first + grid.samples.len()));
        }
        // The limit on buffers keeps them below 2^32.
        let blocks: Vec<GridBlock> =
            grids.iter().zip(&firsts).map(|(grid, &first)| GridBlock::new(grid, first as u32)).collect();
        let sample = |at: usize| {
            let number = firsts.partition_point(|&first| first <= at) - 1;
            grids[number].samples[at - firsts[number]]
        };
        let count = firsts[grids.len()];
        let glow_of = |at: usize| {
            let number = firsts.partition_point(|&first| first <= at) - 1;
            let [r, g, b] = grids[number].glow.get(at - firsts[number]).copied().unwrap_or_default();
            [r, g, b, 0.0]
        };
        let glow_count = if context.parameters.glows() { count } else { 1 };
        let glow = upload_each(device, &context.name("grid-glow"), STORAGE, glow_count, glow_of);
        let samples = upload_each(device, &context.name("grid-samples"), STORAGE, count, sample);
        Ok(GridBuffers {
            grids: upload(device, &context.name("grids"), STORAGE, bytemuck::cast_slice(&blocks))?,
            samples: samples.map_err(|error| error.set_by("volume-file"))?,
            glow: glow.map_err(|error| error.set_by("volume-temperature"))?,
        })
    }
}

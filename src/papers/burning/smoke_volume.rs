//! `smoke-volume`: the smoke as a density in a grid around its particles, lit by the flames. Ours.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::Burning;
use super::buffers::Buffers;
use super::flames::Flames;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// The grid of the smoke (`burning/smoke-volume.glsl`).
    #[derive(Default)]
    pub struct SmokeGrid {
        /// Its corner, diagonals.
        pub low: Vec3,
        /// Side of a cell, diagonals; 0 where there is no smoke.
        pub cell_width: f32,
    }
}

/// Cells of the grid along each axis.
pub const SMOKE_CELLS: usize = 48;

const CELL_COUNT: u32 = (SMOKE_CELLS * SMOKE_CELLS * SMOKE_CELLS) as u32;
/// Of a cell's sum, and of its light with its extinction.
const SUM_BYTES: u32 = 4;
const CELL_BYTES: u32 = 16;

/// Of the buffers.
pub(super) const BYTES: u32 = size_of::<SmokeGrid>() as u32 + CELL_COUNT * (SUM_BYTES + CELL_BYTES);

/// The pass with its buffers.
pub struct SmokeVolume {
    /// Finds the grid, clears it, fills it, and lights it.
    steps: [Pass; 4],
    smoke_pool: u32,
    /// [`SmokeGrid`].
    pub grid: Arc<Buffer>,
    /// Of each cell, x first: light times extinction, linear RGB, and extinction, 1 over diagonals.
    pub cells: Arc<Buffer>,
}

impl SmokeVolume {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        smoke_pool: u32,
        buffers: &Buffers,
        flames: &Flames,
        fire_lights: &Arc<Buffer>,
    ) -> Result<Self, Error> {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let of_cells = |what: &str, bytes: u32| {
            let desc = BufferDesc::new(format!("{label}/{what}"), u64::from(CELL_COUNT * bytes));
            Buffer::new(shaders.device(), desc.usage(storage))
        };
        let none = SmokeGrid::default();
        let grid = upload(shaders.device(), &format!("{label}/smoke-grid"), storage, bytemuck::bytes_of(&none))?;
        let sums = of_cells("smoke-sums", SUM_BYTES)?;
        let cells = of_cells("smoke-cells", CELL_BYTES)?;
        let step = |name: &str| Pass::compute("smoke-volume", "", &format!("burning/smoke-{name}.comp"));
        let find = step("box")
            .with("constants", &buffers.constants)
            .with("billboards", &flames.billboards)
            .with("Particles", &flames.particles)
            .with("SmokeGrid", &grid);
        let clear = step("clear").with("SmokeSums", &sums);
        let fill = step("density")
            .with("constants", &buffers.constants)
            .with("Particles", &flames.particles)
            .with("SmokeGrid", &grid)
            .with("SmokeSums", &sums);
        let light = step("light")
            .with("billboards", &flames.billboards)
            .with("FireLights", fire_lights)
            .with("SmokeGrid", &grid)
            .with("SmokeSums", &sums)
            .with("SmokeCells", &cells);
        let steps = [find.build(shaders)?, clear.build(shaders)?, fill.build(shaders)?, light.build(shaders)?];
        Ok(SmokeVolume { steps: Pass::steps(steps), smoke_pool, grid, cells })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let [find, clear, fill, light] = &self.steps;
        frame.compute(find, |dispatch| dispatch.threads(1, 1, 1))?;
        for (step, threads) in [(clear, CELL_COUNT), (fill, self.smoke_pool), (light, CELL_COUNT)] {
            frame.compute(step, |dispatch| dispatch.elements(threads))?;
        }
        Ok(())
    }
}

impl Burning {
    /// The smoke's density, where it is drawn as a volume.
    pub fn smoke_volume(&self) -> Option<&SmokeVolume> {
        self.draw_fire.as_ref()?.volume.as_ref()
    }
}

//! The variant `gpu-driven`: stages one and two without a readback and without a wait. Ours.
//!
//! ```text
//! animate ─► cell-keys ─► sort-count ─► sort-sum ─► sort-scatter ─► arrange ─► cell-starts ─┐  (for section 5.2)
//!   ┌───────────────────────────────────────────────────────────────────────────────────────┘
//!   └─► density ─► extract ─► accumulate-depths ─► normal-height                               (sections 6.1 to 6.4)
//! ```
//!
//! Particles are sorted into cells no shorter than their radius. A grid point gathers its density from the cells around it,
//! where the thesis draws the particles over the grid planes; a column of grid points is summed up by itself, and eq. 6.3
//! gathers those sums, where the thesis draws a splat for each accepted point.

mod accumulate_depths;
pub mod by_cells;
mod cells;
mod density;
mod estimate;
mod extract;
pub mod sort;
mod tiles;

use std::sync::Arc;

use ash::vk;

use self::accumulate_depths::AccumulateDepths;
use self::density::GatheredDensity;
use self::extract::Extract;
use self::sort::Sort;
use super::animate::Animate;
use super::extract::Accepted;
use super::targets::{Context, FLOATS};
use crate::gpu::transfer::read_image;
use crate::gpu::{Device, Error, Frame, Image, ImageDesc, ImageView};
use crate::measure::estimate::submission_work;

pub use self::cells::Cells;
pub use self::estimate::estimate;

/// Stages one and two behind `animate`.
pub struct GpuDriven {
    /// Particles by cells.
    pub sort: Sort,
    /// Densities at the grid points.
    pub density: GatheredDensity,
    extract: Extract,
    accumulate_depths: AccumulateDepths,
    /// Number of accepted points, their heights' sum or the height that stands for them, lowest and highest density.
    columns: Arc<ImageView>,
    /// Sum of weighted heights in red, metres; sum of weights in alpha.
    pub sums: Arc<ImageView>,
    /// Turns of the loops of `density` and `accumulate-depths` in one submission. A frame of more is several.
    pub most_work: f64,
}

impl GpuDriven {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for a grid beyond the device's.
    pub fn new(context: Context<'_>, animate: &Animate, particle_count: u32) -> Result<Self, Error> {
        let cells = Cells::new(context.parameters, particle_count);
        let sort = Sort::new(context, &cells, &animate.states.each_ref().map(|state| &state.positions))?;
        let density = GatheredDensity::new(context, &cells, &sort)?;
        let columns = context.stored("columns")?;
        let sums = context.stored("accumulated-depths")?;
        let extract = Extract::new(context, &density.density, &columns, &sums)?;
        let accumulate_depths = AccumulateDepths::new(context, &columns, &sums)?;
        let most_work = submission_work(context.device());
        Ok(GpuDriven { sort, density, extract, accumulate_depths, columns, sums, most_work })
    }

    /// Sorts the first `particles` of the state with this index.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn cluster(&self, frame: &mut Frame<'_>, state: usize, particles: u32) -> Result<(), Error> {
        self.sort.record(frame, state, particles)
    }

    /// Densities, and from them the sums of eq. 6.3.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn accumulate(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.density.record(frame, self.most_work)?;
        self.extract.record(frame)?;
        self.accumulate_depths.record(frame, self.most_work)
    }

    /// Reads back what the last frame accepted.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn accepted(&self, device: &Arc<Device>) -> Result<Accepted, Error> {
        let bytes = read_image(device, &self.columns)?;
        let columns = bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes);
        Ok(columns.iter().fold(Accepted::NONE, |sum, &[count, _, lowest, highest]| Accepted {
            count: sum.count + count as usize,
            density_range: [sum.density_range[0].min(lowest), sum.density_range[1].max(highest)],
        }))
    }
}

impl Context<'_> {
    /// Description of an image of floats that kernels write, a texel for each grid point of a plane.
    fn stored_desc(&self, name: &str) -> ImageDesc {
        let [columns, _, rows] = self.parameters.density;
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        ImageDesc::new_2d(self.name(name), FLOATS, columns, rows).usage(usage)
    }

    /// Such an image.
    fn stored(&self, name: &str) -> Result<Arc<ImageView>, Error> {
        Image::new(self.device(), self.stored_desc(name))?.view()
    }
}

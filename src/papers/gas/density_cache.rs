//! `density-cache`: a table of the values of all volumes' densities, which rays read in place of the functions (section
//! "Discussion of results": "a stored table of functional values with a lower resolution").

use std::sync::Arc;

use super::context::Context;
use super::density_table::TableConstants;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, Pass};

/// The pass `density-cache`.
pub struct DensityCache {
    /// Densities of functions or files, before the solid fades them: a table a volume, x fastest, of each entry its own and those
    /// of the ones after it in x, in y, and in both.
    pub densities: Arc<Buffer>,
    /// Entries along each axis.
    pub size: u32,
    pass: Pass,
    volume_count: u32,
}

impl DensityCache {
    /// Tables of `size` entries along each axis.
    ///
    /// # Errors
    /// [`Error::Limit`] for tables beyond what the device binds.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, size: u32) -> Result<Self, Error> {
        let volume_count = context.parameters.volumes.len() as u32;
        let count = u64::from(size).pow(3) * u64::from(volume_count);
        let densities =
            context.storage::<[f32; 4]>("density-cache", count).map_err(|error| error.set_by("density-cache"))?;
        let shader = format!("gas/density-cache-{}.comp", context.parameters.density_source());
        let pass = Pass::compute("density-cache", "Discussion of results", &shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("DensityCache", &densities)
            .constants::<TableConstants>();
        let pass = scene.densities(pass).build(context.shaders)?;
        Ok(DensityCache { densities, size, pass, volume_count })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| {
            for volume in 0..self.volume_count {
                dispatch.constants(&TableConstants { volume }).threads(self.size, self.size, self.size);
            }
        })
    }
}

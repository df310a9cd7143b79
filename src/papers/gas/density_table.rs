//! `density-table`: the densities of all volumes on a grid (section "Calculation of the shadow table").

use std::sync::Arc;

use super::context::Context;
use super::densities::Densities;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, Pass};
use crate::host_block;

host_block! {
    /// Of the passes that fill tables of densities.
    pub struct TableConstants {
        /// Index of the volume.
        pub volume: u32,
    }
}

/// The pass `density-table`.
pub struct DensityTable {
    /// Densities: a table a volume, `table_size` entries along each axis, x fastest, of each its own and that of the one after it
    /// in x.
    pub densities: Arc<Buffer>,
    pass: Pass,
    size: u32,
    volume_count: u32,
}

impl DensityTable {
    /// # Errors
    /// [`Error::Limit`] for tables beyond what the device binds.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, values: &Densities) -> Result<Self, Error> {
        let volume_count = context.parameters.volumes.len() as u32;
        let densities = context.table("density-table", volume_count.into())?;
        let shader = format!("gas/density-table-{}.comp", context.parameters.density_shader());
        let pass = Pass::compute("density-table", "Shadow table", &shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("DensityTables", &densities)
            .constants::<TableConstants>();
        let pass = values.values(scene, pass).build(context.shaders)?;
        Ok(DensityTable { densities, pass, size: context.parameters.table_size, volume_count })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| {
            for volume in 0..self.volume_count {
                dispatch.constants(&TableConstants { volume }).threads(self.size, self.size, self.size);
            }
        })
    }
}

//! Pass `read-density` (section 6.2): the densities of one cluster's grid planes, read back for the isosurface.

use std::sync::Arc;

use super::targets::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, ImageView, Location, Pass};

/// The pass.
pub struct ReadDensity {
    /// One for each cluster.
    passes: Vec<Pass>,
    /// A component for each of four planes at each grid point of a plane, row by row.
    pub readback: Arc<Buffer>,
}

impl ReadDensity {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, layers: &[Arc<ImageView>]) -> Result<Self, Error> {
        let [x, _, z] = context.parameters.density;
        let bytes = 16 * u64::from(x) * u64::from(z);
        let desc = BufferDesc::new(context.name("density-readback"), bytes).location(Location::Readback);
        let readback = Buffer::new(context.device(), desc)?;
        let passes = layers.iter().map(|layer| Pass::copy("read-density", "6.2", layer, &readback)).collect();
        Ok(ReadDensity { passes, readback })
    }

    /// Waits for the densities of one cluster.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, cluster: usize) -> Result<&Buffer, Error> {
        frame.copy(&self.passes[cluster])?;
        frame.wait_for(&self.passes[cluster])?;
        Ok(&self.readback)
    }
}

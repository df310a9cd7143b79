//! Pass `read-positions` (section 5.2.3): the position map, read back for the depth profile.

use std::sync::Arc;

use super::resources::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, ImageView, Location, Pass};

/// The pass.
pub struct ReadPositions {
    pass: Pass,
    heights: Arc<Buffer>,
}

impl ReadPositions {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, position_map: &Arc<ImageView>) -> Result<Self, Error> {
        let size_bytes = 4 * u64::from(context.parameters.map_size).pow(2);
        let desc = BufferDesc::new(context.name("position-readback"), size_bytes).location(Location::Readback);
        let heights = Buffer::new(context.device(), desc)?;
        Ok(ReadPositions { pass: Pass::copy("read-positions", "5.2.3", position_map, &heights), heights })
    }

    /// Waits for the heights of the position map, metres of box space, row by row.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<&Buffer, Error> {
        frame.copy(&self.pass)?;
        frame.wait_for(&self.pass)?;
        Ok(&self.heights)
    }
}

//! Pass `read-positions` (section 5.2): the position texture, read back for the clusters.

use std::sync::Arc;

use super::animate::State;
use super::targets::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Location, Pass};

/// The pass.
pub struct ReadPositions {
    /// One for each state.
    passes: [Pass; 2],
    /// x, y, z and anything for each texel of the texture.
    pub readback: Arc<Buffer>,
}

impl ReadPositions {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, states: &[State; 2]) -> Result<Self, Error> {
        let texture = &states[0].positions;
        let bytes = 16 * u64::from(texture.width()) * u64::from(texture.height());
        let desc = BufferDesc::new(context.name("position-readback"), bytes).location(Location::Readback);
        let readback = Buffer::new(context.device(), desc)?;
        let passes = states.each_ref().map(|state| Pass::copy("read-positions", "5.2", &state.positions, &readback));
        Ok(ReadPositions { passes, readback })
    }

    /// Waits for the positions of the state with this index.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, state: usize) -> Result<&Buffer, Error> {
        frame.copy(&self.passes[state])?;
        frame.wait_for(&self.passes[state])?;
        Ok(&self.readback)
    }
}

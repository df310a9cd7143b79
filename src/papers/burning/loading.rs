//! `loading` (3.7.4): buffers that never change lie on the device from the start. Without that they are copied there in
//! every frame, which shows the gain of the optimisation.

use std::sync::Arc;

use super::buffers::Buffers;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Frame, Location, Pass};

/// The pass `loading`, of runs that do not load ahead.
pub struct Loading {
    copies: Vec<Pass>,
}

impl Loading {
    /// Keeps on the host the contents of the buffers that never change.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(device: &Arc<Device>, buffers: &Buffers) -> Result<Self, Error> {
        let copies = buffers.unchanging().into_iter().map(|buffer| copy(device, buffer)).collect::<Result<_, _>>()?;
        Ok(Loading { copies })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.copies.iter().try_for_each(|copy| frame.copy(copy))
    }
}

fn copy(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Result<Pass, Error> {
    let name = format!("{} on the host", buffer.name());
    let host = Buffer::new(device, BufferDesc::new(name, buffer.size_bytes()).location(Location::Upload))?;
    host.write(0, &read_buffer(device, buffer)?)?;
    Ok(Pass::copy("loading", "3.7.4", &host, buffer))
}

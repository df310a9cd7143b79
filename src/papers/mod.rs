//! The papers, one folder each. They know no command line, no window and no file.

pub mod caustics;

use std::sync::Arc;

use crate::gpu::bindings::Resource;
use crate::gpu::{Error, Frame, ImageView};

/// A paper's method with its resources, ready to record frames.
pub trait Paper {
    /// Records frame `number`; the simulated time is that many fixed time steps.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error>;

    /// The finished picture, 8-bit sRGB.
    fn picture(&self) -> &Arc<ImageView>;

    /// The intermediate targets and buffers that `--dump` knows, by name.
    fn targets(&self) -> Vec<(String, Resource)>;
}

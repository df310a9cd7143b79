//! The papers, one folder each. They know no command line, no window and no file.

pub mod caustics;

use std::sync::Arc;

use crate::gpu::bindings::Resource;
use crate::gpu::{Buffer, Error, Frame, ImageView};

/// A paper's method with its resources, ready to record frames.
pub trait Paper {
    /// Records frame `number`; the simulated time is that many fixed time steps.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error>;

    /// Records frame `number` with what a finished picture needs beyond the passes that the paper times.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error>;

    /// The finished picture, 8-bit sRGB.
    fn picture(&self) -> &Arc<ImageView>;

    /// The intermediate targets and buffers that `--dump` knows.
    fn targets(&self) -> Vec<Target>;
}

/// A target or buffer that can be written out.
pub struct Target {
    pub name: String,
    pub resource: Resource,
    /// Floats a row, for a buffer; images have their own shape.
    pub columns: u32,
}

impl Target {
    /// An image.
    pub fn image(name: impl Into<String>, view: &Arc<ImageView>) -> Self {
        Target { name: name.into(), resource: view.into(), columns: 0 }
    }

    /// A buffer of rows of `columns` 32-bit floats.
    pub fn table(name: impl Into<String>, buffer: &Arc<Buffer>, columns: u32) -> Self {
        Target { name: name.into(), resource: buffer.into(), columns }
    }
}

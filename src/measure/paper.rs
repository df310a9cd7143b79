//! A paper's method as the measured loop sees it: frames to record, a picture, targets to dump.

use std::ops::Range;
use std::sync::Arc;

use crate::gpu::bindings::Resource;
use crate::gpu::{Buffer, Error, Frame, ImageView, ShaderLibrary};
use crate::scene::Camera;

/// The methods that a paper compares.
pub trait Variant: Copy + Eq + std::fmt::Debug + Send + Sync + 'static {
    /// In the paper's order.
    const ALL: &'static [Self];

    /// The name that the command line and the record know it by.
    fn as_str(self) -> &'static str;
}

/// A paper's method with its resources, ready to record frames.
pub trait Paper {
    /// Returns to the state before frame 0, where there is state; no measured frame contains this.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn restart(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Records frame `number`; the simulated time is that many fixed time steps. Numbers rise after a restart. A paper
    /// whose state advances catches up with frames that were left out, so that the picture depends on the number alone.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error>;

    /// Makes the frame that was recorded last, and to its end, the next one again, without its state going on: what is drawn
    /// of the state is recorded anew, and the passes that advance it may be left out. False where the paper has to be
    /// restarted for that, which costs nothing where there is no state.
    fn repeat(&mut self) -> bool {
        false
    }

    /// Advances a state that goes step by step towards frame `number`, by at most `most` steps, and gives the number of
    /// those that are left. So a late frame is many submissions, not one.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn advance(&mut self, _frame: &mut Frame<'_>, _number: u32, _most: u32) -> Result<u32, Error> {
        Ok(0)
    }

    /// Records frame `number` with what a finished picture needs beyond the passes that the paper times.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    /// Tells which rows of the picture are looked at from now on, some of those that it has: a paper that makes each row
    /// without the others leaves the rest out, whose pixels then hold anything.
    fn keep_rows(&mut self, _rows: Range<u32>) {}

    /// True when every buffer had the capacity for all that the frames so far made. If not, their pictures have gaps:
    /// the paper has enlarged its buffers, and the frames must be recorded again.
    ///
    /// # Errors
    /// [`Error::Limit`] where this device cannot offer the capacity, [`Error::Filling`] where a parameter of the user's forbids it.
    fn settle(&mut self, _shaders: &ShaderLibrary) -> Result<bool, Error> {
        Ok(true)
    }

    /// Warnings about the input and the frames so far, one line each.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// The camera of the picture; `None` for a picture without one.
    fn camera(&self) -> Option<Camera> {
        None
    }

    /// The finished picture, 8-bit sRGB.
    fn picture(&self) -> &Arc<ImageView>;

    /// The intermediate targets and buffers that `--dump` knows.
    fn targets(&self) -> Vec<Target>;
}

/// A target or buffer that can be written out.
pub struct Target {
    /// Name for `--dump`.
    pub name: String,
    /// The image or buffer.
    pub resource: Resource,
    /// Values a row, for a buffer; images have their own shape.
    pub columns: u32,
    /// Of a buffer's values; images have their own format.
    pub kind: Kind,
    /// Contents of a texel or row, with units; empty where the name says it all.
    pub holds: &'static str,
    /// Near and far plane of the perspective whose depths it holds, 0 to 1, in the camera's unit of length.
    pub planes: Option<[f32; 2]>,
}

/// Type of a buffer's 32-bit values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    F32,
    U32,
    I32,
}

impl Target {
    /// An image.
    pub fn image(name: impl Into<String>, view: &Arc<ImageView>) -> Self {
        Target { name: name.into(), resource: view.into(), columns: 0, kind: Kind::F32, holds: "", planes: None }
    }

    /// A buffer of rows of `columns` 32-bit floats.
    pub fn table(name: impl Into<String>, buffer: &Arc<Buffer>, columns: u32) -> Self {
        Target { name: name.into(), resource: buffer.into(), columns, kind: Kind::F32, holds: "", planes: None }
    }

    /// A buffer of rows of `columns` unsigned 32-bit integers.
    pub fn words(name: impl Into<String>, buffer: &Arc<Buffer>, columns: u32) -> Self {
        Target { kind: Kind::U32, ..Self::table(name, buffer, columns) }
    }

    /// A buffer of rows of `columns` signed 32-bit integers.
    pub fn integers(name: impl Into<String>, buffer: &Arc<Buffer>, columns: u32) -> Self {
        Target { kind: Kind::I32, ..Self::table(name, buffer, columns) }
    }

    /// True where channels are colours, which a picture shows as they are; others hold numbers, which it draws by a ramp.
    pub fn is_color(&self) -> bool {
        self.holds.contains("red, green, blue")
    }

    /// With what a texel or row holds, and its unit; of a colour with the words red, green, blue.
    pub fn of(self, holds: &'static str) -> Self {
        Target { holds, ..self }
    }

    /// With the depths of a perspective, 0 at the near plane to 1 at the far one.
    pub fn between(self, near: f32, far: f32) -> Self {
        Target { planes: Some([near, far]), ..self }
    }
}

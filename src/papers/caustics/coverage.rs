//! Pass `coverage` (no part of the thesis): a caustics map that was drawn at a multiple of its size, averaged down.

use std::sync::Arc;

use super::resources::Context;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct CoverageConstants {
        multiple: u32,
    }
}

/// The pass.
pub struct Coverage {
    pass: Pass,
    multiple: u32,
}

impl Coverage {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, drawn: &Arc<ImageView>, map: &Arc<ImageView>) -> Result<Self, Error> {
        let pass = Pass::graphics("coverage", "", "common/fullscreen.vert", "caustics/coverage.frag")
            .constants::<CoverageConstants>()
            .with("drawn_map", drawn)
            .with("nearest", context.nearest)
            .color(map, Load::Discard, Blend::Replace)
            .build(context.shaders)?;
        Ok(Coverage { pass, multiple: context.parameters.coverage })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| {
            draw.constants(&CoverageConstants { multiple: self.multiple }).vertices(3);
        })
    }
}

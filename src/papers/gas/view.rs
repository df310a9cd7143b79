//! `view`: the resolved picture as it is shown.

use std::sync::Arc;

use ash::vk;

use super::context::Context;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass};

/// The pass `view`.
pub struct View {
    /// 8-bit sRGB.
    pub picture: Arc<ImageView>,
    pass: Pass,
}

impl View {
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(context: &Context<'_>, radiance: &Arc<ImageView>) -> Result<Self, Error> {
        let picture = context.image("picture", vk::Format::R8G8B8A8_SRGB, vk::ImageUsageFlags::COLOR_ATTACHMENT)?;
        let pass = Pass::graphics("view", "A-buffer", "common/fullscreen.vert", "gas/view.frag")
            .with("radiance", radiance)
            .color(&picture, Load::Discard, Blend::Replace)
            .build(context.shaders)?;
        Ok(View { picture, pass })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.vertices(3))
    }
}

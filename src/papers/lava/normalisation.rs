//! Pass `normalisation` (section 7.3): the weighted mean of the colours, which is the picture.

use std::sync::Arc;

use ash::vk;

use super::parameters::{Parameters, Shading, Tone};
use super::targets::Context;
use crate::gpu::{Blend, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct ToneConstants {
        exposure: f32,
        knee: f32,
        is_linear: f32,
    }
}

/// The pass.
pub struct Normalisation {
    pass: Pass,
    constants: ToneConstants,
    /// 8-bit sRGB, though its format does not say so.
    pub picture: Arc<ImageView>,
}

impl Normalisation {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, accumulated_colors: &Arc<ImageView>) -> Result<Self, Error> {
        let (width, height) = (context.parameters.width, context.parameters.height);
        // The values are those of the display already.
        let desc = ImageDesc::new_2d(context.name("picture"), vk::Format::R8G8B8A8_UNORM, width, height);
        let picture = Image::new(context.device(), desc.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT))?.view()?;
        let pass = Pass::graphics("normalisation", "7.3", "common/fullscreen.vert", "lava/normalisation.frag")
            .constants::<ToneConstants>()
            .with("accumulated_colors", accumulated_colors)
            .whole(&["accumulated_colors"])
            .color(&picture, Load::Discard, Blend::Replace)
            .build(context.shaders)?;
        let constants = constants(context.parameters);
        Ok(Normalisation { pass, constants, picture })
    }

    /// Sets the tone of the next frames.
    pub fn set_tone(&mut self, parameters: &Parameters) {
        self.constants = constants(parameters);
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.constants(&self.constants).vertices(3))
    }
}

/// The parts of the picture show their values as they are.
fn constants(parameters: &Parameters) -> ToneConstants {
    match parameters.shading {
        Shading::Lava | Shading::Color => ToneConstants {
            exposure: parameters.exposure,
            knee: parameters.tone.knee(),
            is_linear: f32::from(u8::from(parameters.is_blackbody)),
        },
        _ => ToneConstants { exposure: 1.0, knee: Tone::Clip.knee(), is_linear: 0.0 },
    }
}

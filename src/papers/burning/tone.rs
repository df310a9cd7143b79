//! `tone`: the display's picture of the linear light. Ours.

use super::draw::Draw;
use super::draw_fire::DrawFire;
use super::flames::Flames;
use super::parameters::Parameters;
use crate::gpu::{Blend, Error, Frame, Load, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    struct ToneConstants {
        exposure: f32,
        knee: f32,
    }
}

/// The pass.
pub struct ToneMapping {
    pass: Pass,
    constants: ToneConstants,
}

impl ToneMapping {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        parameters: &Parameters,
        draw: &Draw,
        fire: Option<(&Flames, &DrawFire)>,
    ) -> Result<Self, Error> {
        let pass = |shader: &str| Pass::graphics("tone", "", "common/fullscreen.vert", shader);
        let fire = fire.and_then(|(flames, draw_fire)| Some((flames, draw_fire.texels.as_ref()?)));
        let pass = match fire {
            None => pass("burning/tone-none.frag"),
            Some((flames, texels)) => pass("burning/tone-layer.frag")
                .with("billboards", &flames.billboards)
                .with("mesh_depth", &draw.depth)
                .with("fire_texels", texels),
        };
        let pass = pass
            .constants::<ToneConstants>()
            .with("radiance", &draw.target)
            .whole(&["radiance"])
            .color(&draw.picture, Load::Discard, Blend::Replace)
            .build(shaders)?;
        Ok(ToneMapping { pass, constants: constants(parameters) })
    }

    /// Sets the exposure and the tone of the next frames.
    pub fn set_tone(&mut self, parameters: &Parameters) {
        self.constants = constants(parameters);
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.pass, |draw| draw.constants(&self.constants).vertices(3))
    }
}

fn constants(parameters: &Parameters) -> ToneConstants {
    ToneConstants { exposure: parameters.exposure, knee: parameters.tone.knee() }
}

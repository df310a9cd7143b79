//! Pass `particles`: the particles as points in the simulation space (figure 5.2), a picture and no pass of the method.

use super::animate::Animate;
use super::normalisation::Normalisation;
use super::scene::Scene;
use super::targets::{Context, ZERO};
use crate::gpu::{Blend, Error, Frame, Pass, Topology};
use crate::host_block;

host_block! {
    struct PointsConstants {
        width: u32,
        size_px: f32,
    }
}

/// The pass.
pub struct ParticlePoints {
    /// One for each state of the animation.
    passes: [Pass; 2],
    constants: PointsConstants,
}

impl ParticlePoints {
    /// Draws over the picture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        animate: &Animate,
        scene: &Scene,
        normalisation: &Normalisation,
    ) -> Result<Self, Error> {
        let [a, b] = animate.states.each_ref().map(|state| &state.positions);
        let first = Pass::graphics("particles", "5.1", "lava/particles.vert", "lava/particles.frag")
            .topology(Topology::Points)
            .constants::<PointsConstants>()
            .with("scene", &scene.block)
            .with("positions", a)
            .color(&normalisation.picture, ZERO, Blend::Replace)
            .build(context.shaders)?;
        let second = first.rebind().with("positions", b).build(context.shaders)?;
        // A pixel in a picture of 400 rows; never none.
        let size_px = (context.parameters.height as f32 / 400.0).max(1.0);
        let constants = PointsConstants { width: a.width(), size_px };
        Ok(ParticlePoints { passes: [first, second], constants })
    }

    /// Draws the first `count` particles of the state with this index.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, state: usize, count: u32) -> Result<(), Error> {
        frame.graphics(&self.passes[state], |draw| draw.constants(&self.constants).vertices(count))
    }
}

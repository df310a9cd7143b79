//! The particles as points in the simulation space (figure 5.2): a picture, no pass of the method.

use std::sync::Arc;

use super::animation::Animation;
use super::splatting::Splatting;
use super::targets::ZERO;
use crate::gpu::{Blend, Error, Frame, Pass, ShaderLibrary, Topology};
use crate::host_block;

host_block! {
    struct PointsConstants {
        width: u32,
        size_px: f32,
    }
}

/// Draws the particles over the picture.
pub struct Points {
    /// One for each state of the animation.
    passes: [Pass; 2],
    count: u32,
    constants: PointsConstants,
}

impl Points {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, animation: &Animation, splatting: &Splatting) -> Result<Self, Error> {
        let [a, b] = animation.positions();
        let first = Pass::graphics("particles", "5.1", "lava/particles.vert", "lava/particles.frag")
            .topology(Topology::Points)
            .constants::<PointsConstants>()
            .with("scene", splatting.scene())
            .with("positions", a)
            .color(splatting.picture(), ZERO, Blend::Replace)
            .build(shaders)?;
        let second = first.rebind().with("positions", b).build(shaders)?;
        // A pixel in a picture of 400 rows; never none.
        let size_px = (splatting.picture().height() as f32 / 400.0).max(1.0);
        let constants = PointsConstants { width: a.width(), size_px };
        Ok(Points { passes: [first, second], count: animation.count(), constants })
    }

    /// Draws the particles as they are after the last step.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, animation: &Animation) -> Result<(), Error> {
        let [a, _] = animation.positions();
        let which = usize::from(!Arc::ptr_eq(a, animation.state().0));
        frame.graphics(&self.passes[which], |draw| {
            draw.constants(&self.constants).vertices(self.count);
        })
    }
}

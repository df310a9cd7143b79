//! The display's tone, of the papers whose light is linear.

use crate::choice;

choice! {
    /// Fate of what is brighter than the display.
    pub enum Tone {
        /// Bent above 0.6, so that nothing reaches the display's end.
        Shoulder = ("shoulder", "As it is up to 0.6 of the display's range, above it ever less, so that nothing clips"),
        /// Clipped at the display's end.
        Clip = ("clip", "Clipped, as by a frame buffer"),
    }
}

impl Tone {
    /// The value from which `common/tone.glsl` bends, as a fraction of the display's range.
    pub(super) fn knee(self) -> f32 {
        match self {
            Tone::Shoulder => 0.6,
            Tone::Clip => 1.0,
        }
    }
}

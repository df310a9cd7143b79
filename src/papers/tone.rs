//! The display's tone, of the papers whose light is linear.

use crate::measure::parameter::Choice;

/// Fate of what is brighter than the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Tone {
    /// Bent above 0.6, so that nothing reaches the display's end.
    Shoulder,
    /// Clipped at the display's end.
    Clip,
}

impl Choice for Tone {
    const ALL: &'static [Self] = &[Tone::Shoulder, Tone::Clip];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("shoulder", "As it is up to 0.6 of the display's range, above it ever less, so that nothing clips"),
        ("clip", "Clipped, as by a frame buffer"),
    ];
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

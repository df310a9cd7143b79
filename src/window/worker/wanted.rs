//! What the window wants to see, and of which frame.

use std::time::Instant;

use crate::window::protocol::{MeasureChoice, TargetChoice, ThumbnailChoice};

/// What the window wants to see.
#[derive(Default)]
pub struct Wanted {
    pub after: Option<u32>,
    pub target: Option<TargetChoice>,
    pub thumbnails: Option<ThumbnailChoice>,
    pub has_difference: bool,
    pub measure: MeasureChoice,
}

/// The clock.
pub struct Clock {
    /// Number of the frame, with the part of a frame by which a slow clock is past it.
    pub at: f64,
    pub speed: f64,
    pub is_playing: bool,
    /// When it last went on.
    pub moved: Option<Instant>,
}

impl Clock {
    /// Number of the frame that it shows.
    pub fn number(&self) -> u32 {
        // Saturates at both ends.
        self.at as u32
    }
}

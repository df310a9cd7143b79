//! Contents that the window wants to see, and their frame.

use std::time::Instant;

use crate::window::protocol::{MeasureChoice, TargetChoice, ThumbnailChoice};

/// Contents that the window wants to see.
#[derive(Default)]
pub struct Wanted {
    /// Passes that a frame is recorded up to; `None` for all of them.
    pub after: Option<u32>,
    /// Target whose values are wanted.
    pub target: Option<TargetChoice>,
    /// Targets that are wanted as small pictures.
    pub thumbnails: Option<ThumbnailChoice>,
    /// The difference of both sides is wanted as well.
    pub has_difference: bool,
    /// Samples and counters of the times.
    pub measure: MeasureChoice,
}

/// The clock.
pub struct Clock {
    /// Number of the frame, with the part of a frame by which a slow clock is past it.
    pub at: f64,
    /// Frames that the clock goes on by from picture to picture, above 0 and at most 1000.
    pub speed: f64,
    /// The clock goes on by itself.
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

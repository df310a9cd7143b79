//! Why a window ended otherwise than by its user.

use crate::gpu;

/// Why a window could not be opened, or did not last.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(
        "opening a window: {reason}; run it where there is a display (DISPLAY or WAYLAND_DISPLAY is set), or use `render`, which needs none"
    )]
    NoDisplay {
        /// Message of the display's library.
        reason: String,
    },
    #[error(transparent)]
    Gpu(#[from] gpu::Error),
    #[error("starting the program that draws for the window: {reason}")]
    Worker {
        /// The system's message, or the part of the connection that is missing.
        reason: String,
    },
    /// The first worker did not get as far as its first words.
    #[error("{message}")]
    Refused {
        /// Its own last line.
        message: String,
        /// Its exit code.
        code: i32,
    },
    #[error("running the window: {reason}")]
    Loop {
        /// Message of the event loop.
        reason: String,
    },
    #[error("writing {path}: {reason}")]
    Controls {
        /// File of the controls' places.
        path: String,
        /// The system's message.
        reason: String,
    },
}

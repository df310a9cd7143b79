use std::path::PathBuf;

use crate::file::OutputError;

/// Failures of pictures and rasters; every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot tell the format of {path}: name a file that ends in .exr, .npy or .png")]
    UnknownEnding {
        /// File that was to be written.
        path: PathBuf,
    },
    #[error("writing {path}: there is no value to draw; an empty buffer can be written as .npy")]
    Empty {
        /// File that was to be written.
        path: PathBuf,
    },
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error("opening picture {path}: {reason}; name a readable PNG file")]
    Open {
        /// File that was to be read.
        path: PathBuf,
        /// The system's message.
        reason: String,
    },
    #[error("reading picture {path}: {reason}; give a whole PNG file")]
    Png {
        /// File that was read.
        path: PathBuf,
        /// The decoder's message on one line.
        reason: String,
    },
    #[error(
        "reading picture {path}: {width} x {height} pixels are more than {max_side} a side or {max_pixels} in all; scale it"
    )]
    TooLarge {
        /// File that was read.
        path: PathBuf,
        /// Pixels a row, by the file's header.
        width: u32,
        /// Rows, by the file's header.
        height: u32,
        /// Most pixels of a picture.
        max_pixels: u64,
        /// Most pixels along a side.
        max_side: u32,
    },
    #[error("making {what}: {expected} values are needed and {found} were given")]
    Length {
        /// Picture or raster that was to be made, with its shape.
        what: String,
        /// Number of values that the shape has, or a rule for it.
        expected: String,
        /// Number of values that were given.
        found: usize,
    },
    #[error("making {what}: an image has 1 to 4 channels; write wider data as a table")]
    Channels {
        /// Raster that was to be made, with its shape.
        what: String,
    },
    #[error(
        "comparing pictures: {} x {} and {} x {} pixels differ in size; render both at one size", .left.0, .left.1, .right.0, .right.1
    )]
    SizeMismatch {
        /// Width and height of the first picture, pixels.
        left: (u32, u32),
        /// Width and height of the second picture, pixels.
        right: (u32, u32),
    },
    #[error("comparing pictures: a mask of {found} pixels does not fit {expected} pixels")]
    MaskLength {
        /// Pixels of the pictures.
        expected: usize,
        /// Pixels of the mask.
        found: usize,
    },
    #[error("comparing pictures: no pixel to compare; give a mask that holds at least one")]
    NoPixels,
}

/// Another library's message on one line, to be continued by ours.
pub(super) fn one_line(message: impl ToString) -> String {
    let message = message.to_string();
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    line.trim_end_matches('.').to_owned()
}

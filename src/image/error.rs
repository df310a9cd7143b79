use std::path::PathBuf;

use crate::file::OutputError;

/// Failures of pictures and rasters; every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot tell the format of {path}: name a file that ends in .exr, .npy or .png")]
    UnknownEnding { path: PathBuf },
    #[error("writing {path}: there is no value to draw; an empty buffer can be written as .npy")]
    Empty { path: PathBuf },
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error("opening picture {path}: {reason}; name a readable PNG file")]
    Open { path: PathBuf, reason: String },
    #[error("reading picture {path}: {reason}; give a whole PNG file")]
    Png { path: PathBuf, reason: String },
    #[error(
        "reading picture {path}: {width} x {height} pixels are more than {max_side} a side or {max_pixels} in all; scale it"
    )]
    TooLarge { path: PathBuf, width: u32, height: u32, max_pixels: u64, max_side: u32 },
    #[error("making {what}: {expected} values are needed and {found} were given")]
    Length { what: String, expected: String, found: usize },
    #[error("making {what}: an image has 1 to 4 channels; write wider data as a table")]
    Channels { what: String },
    #[error(
        "comparing pictures: {} x {} and {} x {} pixels differ in size; render both at one size", .left.0, .left.1, .right.0, .right.1
    )]
    SizeMismatch { left: (u32, u32), right: (u32, u32) },
    #[error("comparing pictures: a mask of {found} pixels does not fit {expected} pixels")]
    MaskLength { expected: usize, found: usize },
    #[error("comparing pictures: no pixel to compare; give a mask that holds at least one")]
    NoPixels,
}

/// Another library's message on one line, to be continued by ours.
pub(super) fn one_line(message: impl ToString) -> String {
    let message = message.to_string();
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    line.trim_end_matches('.').to_owned()
}

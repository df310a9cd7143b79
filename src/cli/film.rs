//! Films as one file.

use std::io;
use std::path::Path;

use super::failure::Failure;
use super::outcome;
use crate::file::{self, OutputError};
use crate::image::{Rgba8, y4m};

/// Checks before any work that a film can be written there.
///
/// # Errors
/// [`Failure::Input`] for another ending than `.y4m`; a file that cannot be written.
pub fn check(path: &Path) -> Result<(), Failure> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("y4m")) {
        let message = format!("--film {}: films are YUV4MPEG2; end the name in .y4m", path.display());
        return Err(Failure::Input(message));
    }
    outcome::check_file(path)
}

/// Writes a film, and gives the number of its frames; without one there is no file.
pub fn shoot(
    path: &Path,
    rate: u32,
    mut frames: impl Iterator<Item = Result<Rgba8, Failure>>,
) -> Result<usize, Failure> {
    // Before the first frame is there, nothing is written: an older film stays.
    let Some(first) = frames.next().transpose()? else { return Ok(0) };
    let (mut count, mut failure) = (0, None);
    let written = file::write_with(path, |output| {
        let mut film = y4m::Film::new(output, (first.width(), first.height()), rate)?;
        for frame in [Ok(first)].into_iter().chain(frames) {
            match frame {
                Ok(frame) => film.push(&frame)?,
                Err(error) => {
                    failure = Some(error);
                    return Err(io::Error::other("a frame could not be drawn"));
                }
            }
            count += 1;
        }
        Ok(())
    });
    failure.map_or_else(|| written.map(|()| count).map_err(|error: OutputError| error.into()), Err)
}

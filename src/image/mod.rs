//! Pictures in and out, and how far apart two of them are. CPU only.
//!
//! ```text
//! Raster (any target or buffer, full precision) --write--> .exr | .npy | .png
//! Rgba8  (a finished picture)  <--read_png / write_png-->  .png
//! Rgba8, one after the other  --y4m::Film-->  .y4m
//! Rgba8 x Rgba8 --compare--> Difference (CIE L*u*v*)  <-- golden::check
//! ```

pub mod compare;
pub mod contact_sheet;
mod error;
mod exr;
pub mod golden;
mod npy;
mod picture;
mod png;
mod preview;
mod raster;
pub mod srgb;
mod statistics;
mod view;
pub mod y4m;

pub use self::compare::{Difference, compare};
pub use self::error::Error;
pub use self::picture::Rgba8;
pub use self::png::{CheckedPng, read_png, read_png_within, write_png, write_png_hashed};
pub use self::preview::preview;
pub use self::raster::{Raster, Samples, Shape};
pub use self::statistics::Statistics;
pub use self::view::Ramp;

use std::io;
use std::path::{Path, PathBuf};

use crate::file;

/// A file format for a [`Raster`], chosen by the ending of the file's name (in any case).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR, every value unchanged: 32-bit float channels for `f32`, 32-bit unsigned ones for unsigned integers. It
    /// knows no signed ones: `i32` becomes float, exact up to 2^24. Channels are named Y, RG, RGB or RGBA; an array
    /// target becomes the EXR layers `layer0`, `layer1`, ...; a table becomes one channel, a row a line.
    Exr,
    /// NumPy: the element type and the shape kept exactly, `(layers, height, width, channels)` for an image and
    /// `(rows, columns)` for a table, in C order.
    Npy,
    /// PNG. `u8` and `u16` data are stored unchanged (8 and 16 bits; two channels as red and green). Other data becomes
    /// an 8-bit view: `f32` of two to four channels is taken as linear light, clamped to 0..=1 and sRGB-encoded,
    /// without the fourth channel; one channel of `f32`, [numbers](Raster::of_numbers) in several, and all `u32` and `i32`, are
    /// drawn by a linear [`Ramp`] common to all channels and layers, which the file's comment tells. A pixel with a value that is not finite, or
    /// that stands for none as it lies far off all others, is magenta. The layers of an array target stand below one another.
    Png,
}

impl Format {
    /// The format that the ending of `path` asks for.
    ///
    /// # Errors
    /// [`Error::UnknownEnding`] for any other ending, or none.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("exr") => Ok(Self::Exr),
            Some("npy") => Ok(Self::Npy),
            Some("png") => Ok(Self::Png),
            _ => Err(Error::UnknownEnding { path: path.into() }),
        }
    }
}

/// Writes `raster` to `path` in the [`Format`] of its ending, and gives the ramp that a PNG draws it by. The file appears whole or not at all: an older file
/// stays as it was when writing fails.
///
/// # Errors
/// [`Error::UnknownEnding`]; [`Error::Empty`] for a raster without values in a picture format; [`Error::Output`] when
/// the file cannot be written or the format cannot hold so large a raster.
pub fn write(path: &Path, raster: &Raster) -> Result<Option<Ramp>, Error> {
    let format = Format::of(path)?;
    if raster.samples().is_empty() && format != Format::Npy {
        return Err(Error::Empty { path: path.into() });
    }
    let mut shown = None;
    file::write_with(path, |file| match format {
        Format::Exr => exr::encode(file, raster),
        Format::Npy => npy::encode(file, raster),
        Format::Png => png::encode(file, raster).map(|ramp| shown = ramp),
    })?;
    Ok(shown)
}

/// The file of one of several frames: `picture.png` for frame 7 is `picture-0007.png`.
pub fn numbered(path: &Path, number: u32) -> PathBuf {
    suffixed(path, &format!("-{number:04}"))
}

/// The file with a suffix before its ending.
pub fn suffixed(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(suffix);
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

/// A failure inside a format's own encoder, as the failure of the write that it is.
fn encoder_error(error: impl std::error::Error) -> io::Error {
    io::Error::other(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_chooses_the_format_in_any_case() {
        assert_eq!(Format::of(Path::new("a.b/x.EXR")).unwrap(), Format::Exr);
        assert_eq!(Format::of(Path::new("x.npy")).unwrap(), Format::Npy);
        assert_eq!(Format::of(Path::new("x.exr.Png")).unwrap(), Format::Png);
        for path in ["x", "x.jpg", ".png", "png", ""] {
            assert!(Format::of(Path::new(path)).is_err(), "{path}");
        }
    }

    #[test]
    fn numbers_go_before_the_ending() {
        assert_eq!(numbered(Path::new("a/b.png"), 7), Path::new("a/b-0007.png"));
    }

    #[test]
    fn an_unknown_ending_or_an_empty_picture_writes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let empty = Raster::table(0, 3, Vec::<f32>::new()).unwrap();
        let some = Raster::table(1, 1, vec![1.0f32]).unwrap();
        let error = write(&folder.path().join("x.tga"), &some).unwrap_err();
        assert!(error.to_string().contains(".exr, .npy or .png"), "{error}");
        for name in ["x.exr", "x.png"] {
            let error = write(&folder.path().join(name), &empty).unwrap_err();
            assert!(matches!(error, Error::Empty { .. }), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

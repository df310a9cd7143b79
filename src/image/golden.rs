//! Golden pictures: what a rendering must look like, checked in as PNG and compared by their [`Difference`].
//!
//! A missing golden is a failure, never a pass. Run with `FUMAROLE_BLESS=1` to make or replace goldens, look at them,
//! and commit them.

use std::path::{Path, PathBuf};

use super::compare::{self, Difference};
use super::{Error, Rgba8, read_png, write_png};

const BLESS_VARIABLE: &str = "FUMAROLE_BLESS";

/// The largest L\*u\*v\* distances that pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the average over all pixels.
    pub mean: f64,
    /// Of the 99th percentile.
    pub p99: f64,
}

/// Why a picture does not pass; every message is one line that names the files to look at.
#[derive(Debug, thiserror::Error)]
pub enum GoldenError {
    #[error("golden {golden} is missing: look at {actual}, and run again with FUMAROLE_BLESS=1 to accept it")]
    Missing {
        /// File that was looked for.
        golden: PathBuf,
        /// File to which the picture was written.
        actual: PathBuf,
    },
    #[error(
        "golden {golden} is {} x {} pixels and the picture {actual} is {} x {}: render at the golden's size, or run again with FUMAROLE_BLESS=1 to accept it", .expected.0, .expected.1, .found.0, .found.1
    )]
    Size {
        /// File of the golden picture.
        golden: PathBuf,
        /// File to which the picture was written.
        actual: PathBuf,
        /// Width and height of the golden picture, pixels.
        expected: (u32, u32),
        /// Width and height of the picture, pixels.
        found: (u32, u32),
    },
    #[error(
        "picture differs from golden {golden} by {:.3} on average (at most {:.3} passes) and {:.3} at the 99th percentile (at most {:.3}): look at {actual} and {heat_map}, and run again with FUMAROLE_BLESS=1 to accept it", .difference.mean, .tolerance.mean, .difference.p99, .tolerance.p99
    )]
    Different {
        /// File of the golden picture.
        golden: PathBuf,
        /// File to which the picture was written.
        actual: PathBuf,
        /// File to which the distances of its pixels were written, as colours.
        heat_map: PathBuf,
        /// Distance of both in CIE L\*u\*v\*.
        difference: Difference,
        /// Largest distance that passes.
        tolerance: Tolerance,
    },
    #[error(transparent)]
    Image(#[from] Error),
}

/// Compares `actual` with the golden picture at `golden`, over all pixels.
///
/// On failure `<name>.actual.png`, and `<name>.difference.png` with the [heat map](compare::heat_map), are written to
/// `output_dir`, which is made if need be. With `FUMAROLE_BLESS=1` in the environment `actual` becomes the golden
/// instead, and the difference is 0.
///
/// # Errors
/// [`GoldenError`], also for a golden that cannot be read or written.
pub fn check(
    actual: &Rgba8,
    golden: &Path,
    tolerance: Tolerance,
    output_dir: &Path,
) -> Result<Difference, GoldenError> {
    if std::env::var_os(BLESS_VARIABLE).is_some_and(|value| value == "1") {
        bless(actual, golden)?;
    }
    check_strictly(actual, golden, tolerance, output_dir)
}

/// Makes `actual` the golden picture at `golden`, in a folder that is made if need be.
///
/// # Errors
/// [`Error::Empty`] and [`Error::Output`].
pub fn bless(actual: &Rgba8, golden: &Path) -> Result<(), Error> {
    write_png(golden, actual)
}

fn check_strictly(
    actual: &Rgba8,
    golden: &Path,
    tolerance: Tolerance,
    output_dir: &Path,
) -> Result<Difference, GoldenError> {
    let name = golden.file_stem().unwrap_or_default().to_string_lossy();
    let actual_path = output_dir.join(format!("{name}.actual.png"));
    if !golden.exists() {
        write_png(&actual_path, actual)?;
        return Err(GoldenError::Missing { golden: golden.into(), actual: actual_path });
    }
    let expected = read_png(golden)?;
    let distances = match compare::distances(&expected, actual) {
        Ok(distances) => distances,
        Err(Error::SizeMismatch { left, right }) => {
            write_png(&actual_path, actual)?;
            return Err(GoldenError::Size { golden: golden.into(), actual: actual_path, expected: left, found: right });
        }
        Err(error) => return Err(error.into()),
    };
    let difference = Difference::of(&distances).ok_or(Error::NoPixels)?;
    if difference.mean <= tolerance.mean && difference.p99 <= tolerance.p99 {
        return Ok(difference);
    }
    let heat_map_path = output_dir.join(format!("{name}.difference.png"));
    let heat_map = compare::heat_map(actual.width(), actual.height(), &distances)?;
    write_png(&actual_path, actual)?;
    write_png(&heat_map_path, &heat_map)?;
    Err(GoldenError::Different {
        golden: golden.into(),
        actual: actual_path,
        heat_map: heat_map_path,
        difference,
        tolerance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRICT: Tolerance = Tolerance { mean: 0.0, p99: 0.0 };

    fn grey(value: u8, width: u32) -> Rgba8 {
        let pixels = [value, value, value, 255].repeat(width as usize);
        Rgba8::new(width, 1, pixels).unwrap()
    }

    #[test]
    fn a_missing_golden_fails_shows_the_picture_and_is_not_made() {
        let folder = tempfile::tempdir().unwrap();
        let golden = folder.path().join("lava.png");
        let output_dir = folder.path().join("new/out");
        let error = check_strictly(&grey(9, 3), &golden, STRICT, &output_dir).unwrap_err();
        assert!(matches!(error, GoldenError::Missing { .. }), "{error}");
        assert!(error.to_string().contains("FUMAROLE_BLESS=1"), "{error}");
        assert!(!golden.exists());
        let actual = output_dir.join("lava.actual.png");
        assert_eq!(read_png(&actual).unwrap(), grey(9, 3));
    }

    #[test]
    fn a_blessed_picture_passes_and_writes_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let golden = folder.path().join("goldens/lava.png");
        let output_dir = folder.path().join("out");
        bless(&grey(9, 3), &golden).unwrap();
        let difference = check_strictly(&grey(9, 3), &golden, STRICT, &output_dir).unwrap();
        assert_eq!((difference.max, difference.pixels), (0.0, 3));
        assert!(!output_dir.exists());
    }

    #[test]
    fn each_bound_alone_can_fail_a_picture() {
        let folder = tempfile::tempdir().unwrap();
        let golden = folder.path().join("lava.png");
        bless(&grey(100, 3), &golden).unwrap();
        // One grey step at 100 is about 0.4.
        for (mean, p99, passes) in [(1.0, 1.0, true), (0.1, 1.0, false), (1.0, 0.1, false)] {
            let tolerance = Tolerance { mean, p99 };
            let result = check_strictly(&grey(101, 3), &golden, tolerance, folder.path());
            assert_eq!(result.is_ok(), passes, "{tolerance:?}");
        }
        let actual = read_png(&folder.path().join("lava.actual.png")).unwrap();
        assert_eq!(actual, grey(101, 3));
        let heat_map = read_png(&folder.path().join("lava.difference.png")).unwrap();
        assert_eq!(heat_map, grey(255, 3));
    }

    #[test]
    fn another_size_and_a_damaged_golden_fail() {
        let folder = tempfile::tempdir().unwrap();
        let golden = folder.path().join("lava.png");
        bless(&grey(100, 3), &golden).unwrap();
        let error = check_strictly(&grey(100, 4), &golden, STRICT, folder.path()).unwrap_err();
        assert!(matches!(error, GoldenError::Size { .. }), "{error}");
        assert!(folder.path().join("lava.actual.png").exists());
        std::fs::write(&golden, b"not a picture").unwrap();
        let error = check_strictly(&grey(100, 3), &golden, STRICT, folder.path()).unwrap_err();
        assert!(matches!(error, GoldenError::Image(Error::Png { .. })), "{error}");
    }
}

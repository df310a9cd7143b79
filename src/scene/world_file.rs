//! World files: six lines beside a picture that say where it lies.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec2;

use super::error::{Asset, Fault, Place};
use super::{Coordinates, Error, file};

/// Endings of the world file of a PNG, in the order in which they are looked for.
pub(super) const ENDINGS: [&str; 6] = ["pgw", "PGW", "pngw", "PNGW", "wld", "WLD"];

/// The world file beside a picture and the coordinates that it states, or nothing without one.
///
/// # Errors
/// [`Error::Read`]; [`Error::Malformed`] for a file that is no six numbers, and for one that turns its picture.
pub fn beside(picture: &Path) -> Result<Option<(PathBuf, Coordinates)>, Error> {
    for ending in ENDINGS {
        let Some(path) = file::beside(picture, ending)? else { continue };
        let (input, _) = file::open(&path, Asset::WorldFile)?;
        let mut bytes = Vec::new();
        input.take(MAX_BYTES).read_to_end(&mut bytes).map_err(|error| file::failed(&path, Asset::WorldFile, error))?;
        return match parse(&String::from_utf8_lossy(&bytes)) {
            Ok(coordinates) => Ok(Some((path, coordinates))),
            Err(fault) => Err(Error::Malformed { path, asset: Asset::WorldFile, fault }),
        };
    }
    Ok(None)
}

/// Six numbers are a few hundred characters.
const MAX_BYTES: u64 = 1 << 16;

/// The lines are the change of x and y from a column to the next (A, D), from a row to the next (B, E), and the place of
/// the first texel's middle (C, F).
fn parse(text: &str) -> Result<Coordinates, Fault> {
    let whole = |reason: String| Fault::new(Place::Whole, reason);
    let mut numbers = [0.0; 6];
    let mut words = text.split_whitespace();
    for (number, line) in numbers.iter_mut().zip(1..) {
        let word = words.next().ok_or_else(|| whole(format!("it has {} numbers instead of six", line - 1)))?;
        let parsed = word.parse().ok().filter(|value: &f64| value.is_finite());
        let shown: String = word.chars().take(40).collect();
        *number = parsed.ok_or_else(|| Fault::new(Place::Line(line), format!("{shown:?} is no finite number")))?;
    }
    if words.next().is_some() {
        return Err(whole("it has more than six numbers".to_owned()));
    }
    let [a, d, b, e, c, f] = numbers;
    if (b, d) != (0.0, 0.0) {
        return Err(whole("it turns the picture; write one with north up with gdalwarp".to_owned()));
    }
    if a <= 0.0 || e >= 0.0 {
        let reason = format!(
            "its steps are {a:?} east and {e:?} north; a picture with north up has {:?} and {:?}",
            a.abs(),
            -e.abs()
        );
        return Err(whole(reason));
    }
    Ok(Coordinates { north_west: DVec2::new(c, f), step: DVec2::new(a, -e) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_lines_place_a_picture() {
        let placed = parse("0.5\n0\n0.0\r\n-0.25\n139.25\n39.875\n").unwrap();
        assert_eq!(placed, Coordinates { north_west: DVec2::new(139.25, 39.875), step: DVec2::new(0.5, 0.25) });
        for (text, expected) in [
            ("", "0 numbers"),
            ("1 0 0 -1 2", "5 numbers"),
            ("1 0 0 -1 2 3 4", "more than six"),
            ("1 0 0 x 2 3", "line 4: \"x\""),
            ("1 0 0 -1 inf 3", "line 5: \"inf\""),
            ("1 0.5 0.5 -1 2 3", "gdalwarp"),
            ("1 0 0 1 2 3", "north up has 1.0 and -1.0"),
            ("0 0 0 -1 2 3", "steps are 0.0 east"),
        ] {
            let fault = parse(text).unwrap_err().to_string();
            assert!(fault.contains(expected), "{text}: {fault}");
        }
    }

    #[test]
    fn it_lies_beside_its_picture() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("land.png");
        assert_eq!(beside(&picture).unwrap(), None);
        std::fs::write(folder.path().join("land.wld"), "1 0 0 -1 2 3").unwrap();
        assert!(beside(&picture).unwrap().unwrap().0.ends_with("land.wld"));
        std::fs::write(folder.path().join("land.pgw"), "1 0").unwrap();
        let error = beside(&picture).unwrap_err().to_string();
        assert!(
            error.starts_with("cannot load world file ") && error.contains("land.pgw: it has 2 numbers"),
            "{error}"
        );
    }
}

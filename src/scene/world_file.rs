//! World files: six lines beside a picture that say where it lies.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::error::{Asset, Fault, Place};
use super::height_map::{read_text, shown};
use super::{Coordinates, Error, file};

/// Endings of the world file of a picture, in the order in which they are looked for: `pgw`, `pngw` and `wld` of a PNG, `tfw`,
/// `tifw` and `wld` of a `.tif`, each in small letters and then in large ones.
pub(super) fn endings(picture: &Path) -> Vec<String> {
    let ending = picture.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let outer = ending.chars().next().zip(ending.chars().last());
    let of_its_own = outer.map(|(first, last)| [format!("{first}{last}w"), format!("{ending}w")]);
    let small = of_its_own.into_iter().flatten().chain(["wld".to_owned()]);
    small.flat_map(|small| [small.to_uppercase(), small].into_iter().rev()).collect()
}

/// The world file beside a picture and the coordinates that it states, or nothing without one.
///
/// # Errors
/// [`Error::Read`]; [`Error::Malformed`] for a file that is no six numbers, and for one that turns its picture.
pub fn beside(picture: &Path) -> Result<Option<(PathBuf, Coordinates)>, Error> {
    for ending in endings(picture) {
        let Some(path) = file::beside(picture, &ending)? else { continue };
        let (input, _) = file::open(&path, Asset::WorldFile)?;
        return match parse(&read_text(input, &path)?) {
            Ok(coordinates) => Ok(Some((path, coordinates))),
            Err(fault) => Err(Error::Malformed { path, asset: Asset::WorldFile, fault }),
        };
    }
    Ok(None)
}

/// Least and largest texels, in degrees or in the units of a projection: the least is 1 millionth of a metre in degrees.
const STEPS: std::ops::RangeInclusive<f64> = 1e-11..=1e6;

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
        let [east, north, right_east, right_north] = [a, e, a.abs(), -e.abs()].map(shown);
        let reason = format!(
            "its steps are {east} east and {north} north; a picture with north up has {right_east} and {right_north}"
        );
        return Err(whole(reason));
    }
    for (line, step) in [(1, a), (4, e)] {
        if !STEPS.contains(&step.abs()) {
            let (least, most) = (shown(*STEPS.start()), shown(*STEPS.end()));
            let reason = format!("its step is {}, and the sides of texels are {least} to {most}", shown(step));
            return Err(Fault::new(Place::Line(line), reason));
        }
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
            ("1 0 0 1 2 3", "north up has 1 and -1"),
            ("0 0 0 -1 2 3", "steps are 0 east"),
            ("1e300 0 0 1e300 2 3", "are 1e300 east and 1e300 north"),
            ("1e-300 0 0 -45 2 3", "line 1: its step is 1e-300, and the sides of texels are 1e-11 to 1000000"),
            ("45 0 0 -1e300 2 3", "line 4: its step is -1e300, and the sides"),
        ] {
            let fault = parse(text).unwrap_err().to_string();
            assert!(fault.contains(expected) && fault.len() < 120, "{text}: {fault}");
        }
    }

    #[test]
    fn its_ending_is_of_its_picture_s() {
        let of = |name: &str| endings(Path::new(name));
        assert_eq!(of("a/land.png"), ["pgw", "PGW", "pngw", "PNGW", "wld", "WLD"]);
        assert_eq!(of("land.TIF"), ["tfw", "TFW", "tifw", "TIFW", "wld", "WLD"]);
        assert_eq!(of("land"), ["wld", "WLD"]);
    }

    #[test]
    fn it_lies_beside_its_picture() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("land.png");
        assert_eq!(beside(&picture).unwrap(), None);
        // Some editors put a mark of UTF-8 before a text.
        std::fs::write(folder.path().join("land.wld"), "\u{feff}1 0 0 -1 2 3").unwrap();
        assert!(beside(&picture).unwrap().unwrap().0.ends_with("land.wld"));
        std::fs::write(folder.path().join("land.pgw"), "1 0").unwrap();
        let error = beside(&picture).unwrap_err().to_string();
        assert!(
            error.starts_with("cannot load world file ") && error.contains("land.pgw: it has 2 numbers"),
            "{error}"
        );
    }
}

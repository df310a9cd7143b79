//! The drape that a user chooses in place of the colour ramp.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use glam::DVec2;
use serde_json::{Value as Json, json};

use super::drape::{Drape, Draping};
use crate::image::CheckedPng;
use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, parse_finite};
use crate::scene::{Coordinates, HeightMap, shown, world_file};

/// Source of a drape.
#[derive(Debug, Clone, PartialEq)]
pub enum DrapeSource {
    /// PNG over the first map.
    Picture(PathBuf),
    /// Lines of equal height, so many metres apart; without a number as many as suit the maps.
    Contours(Option<f32>),
    /// Colours by the angle of the surface.
    Slope,
    /// Colours by height.
    Hypsometric,
}

/// The most lines that maps have from their lowest place to their highest where no distance is given.
const MOST_LINES: f64 = 25.0;

impl Value for DrapeSource {
    const SHAPE: Shape = Shape::single("FILE.png|contours[:M]|slope|hypsometric");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = match texts {
            [text] => text.to_str().unwrap_or_default(),
            _ => "",
        };
        match (text, text.strip_prefix("contours:")) {
            ("contours", _) => Ok(DrapeSource::Contours(None)),
            ("slope", _) => Ok(DrapeSource::Slope),
            ("hypsometric", _) => Ok(DrapeSource::Hypsometric),
            (_, Some(metres)) => match parse_finite(metres)? {
                interval_m if (1e-3..=1e6).contains(&interval_m) => Ok(DrapeSource::Contours(Some(interval_m))),
                _ => Err("its lines must be 0.001 to 1000000 metres apart".to_owned()),
            },
            _ => PathBuf::parse(texts).map(DrapeSource::Picture),
        }
    }

    fn text(&self) -> String {
        match self {
            DrapeSource::Picture(path) => path.text(),
            DrapeSource::Contours(None) => "contours".to_owned(),
            DrapeSource::Contours(Some(interval_m)) => format!("contours:{interval_m}"),
            DrapeSource::Slope => "slope".to_owned(),
            DrapeSource::Hypsometric => "hypsometric".to_owned(),
        }
    }

    fn json(&self) -> Json {
        match self {
            DrapeSource::Contours(Some(interval_m)) => json!({"contours": interval_m}),
            _ => json!(self.text()),
        }
    }

    fn files(&self) -> Vec<PathBuf> {
        match self {
            DrapeSource::Picture(path) => vec![path.clone()],
            _ => Vec::new(),
        }
    }
}

/// A drape whose picture is read, before there are maps to lay it over.
pub(super) struct ReadDrape<'a> {
    source: &'a DrapeSource,
    picture: Option<Picture<'a>>,
}

struct Picture<'a> {
    path: &'a Path,
    png: CheckedPng,
    /// The file beside it that says where it lies.
    place: Option<(PathBuf, Coordinates)>,
}

impl DrapeSource {
    /// Reads the picture, if it is one: maps take long to make, and a file that is none is refused before.
    ///
    /// # Errors
    /// [`Error::Image`] of the picture, [`Error::Scene`] of the file beside it.
    pub(super) fn read(&self) -> Result<ReadDrape<'_>, Error> {
        let picture = if let DrapeSource::Picture(path) = self { Some(Picture::read(path)?) } else { None };
        Ok(ReadDrape { source: self, picture })
    }
}

impl ReadDrape<'_> {
    /// Over maps whose heights are `exaggeration` times the true ones, which lines and colours count. After all else that may
    /// be refused: a small file can hold a large picture.
    ///
    /// # Errors
    /// [`Error::Input`] of a picture that does not lie on the first map.
    pub(super) fn over(self, maps: &[&HeightMap], exaggeration: f32) -> Result<Drape, Error> {
        let draping = match self.source {
            DrapeSource::Picture(_) => {
                return match (self.picture, maps.first()) {
                    (Some(picture), Some(map)) => picture.over(map),
                    _ => Ok(Drape::white()),
                };
            }
            DrapeSource::Contours(Some(interval_m)) => Draping::Contours { interval_m: interval_m * exaggeration },
            DrapeSource::Contours(None) => {
                let (low_m, high_m) = maps
                    .iter()
                    .map(|map| map.range_m())
                    .fold((f32::INFINITY, f32::NEG_INFINITY), |(low_m, high_m), (lowest_m, highest_m)| {
                        (low_m.min(lowest_m), high_m.max(highest_m))
                    });
                let range_m = f64::from(high_m - low_m) / f64::from(exaggeration);
                Draping::Contours { interval_m: suiting_interval_m(range_m) * exaggeration }
            }
            DrapeSource::Slope => Draping::Slope,
            DrapeSource::Hypsometric => Draping::Hypsometric { scale: exaggeration },
        };
        Ok(Drape::of_terrain(draping))
    }
}

/// 1, 2 or 5 times a power of ten, the smallest by which [`MOST_LINES`] are not passed.
fn suiting_interval_m(range_m: f64) -> f32 {
    let least_m = (range_m / MOST_LINES).max(1e-3);
    let power_m = 10_f64.powf(least_m.log10().floor());
    // Powers of ten are no round numbers in binary.
    let fits = |factor: &f64| factor * power_m >= least_m * (1.0 - 1e-9);
    ([1.0, 2.0, 5.0].into_iter().find(fits).unwrap_or(10.0) * power_m) as f32
}

impl<'a> Picture<'a> {
    fn read(path: &'a Path) -> Result<Self, Error> {
        // The file that takes less first.
        let place = world_file::beside(path)?;
        Ok(Picture { path, png: CheckedPng::read(path)?, place })
    }

    /// The picture where its world file says, or with its corners on the map's.
    fn over(self, map: &HeightMap) -> Result<Drape, Error> {
        let Picture { path, png, place } = self;
        let (width, height) = png.size();
        let drape = || Drape::new(width, height, png.into_picture()?.into_pixels()).map_err(Error::from);
        let Some((world_file, coordinates)) = place else { return drape() };
        let Some(of_map) = map.coordinates() else {
            let message = format!(
                "{} places {}, but the first map has no coordinates; take a map that has, or move that file away to lay the \
                 picture's corners on the map's",
                world_file.display(),
                path.display()
            );
            return Err(Error::Input(message));
        };
        check_texels(&coordinates, map)
            .map_err(|reason| Error::Input(format!("{}: {reason}", world_file.display())))?;
        let (corners, map_corners) = (coordinates.corners(width, height), of_map.corners(map.width(), map.height()));
        // The same meridian may have two names.
        let apart_deg = (map_corners[0] + map_corners[1] - corners[0] - corners[1]).x / 2.0;
        let turns = if map.geographic().is_some() { (apart_deg / 360.0).round() } else { 0.0 };
        let [first, last] = corners.map(|corner| of_map.node(corner + DVec2::new(360.0 * turns, 0.0)));
        let end = DVec2::new((map.width() - 1).into(), (map.height() - 1).into());
        if last.cmple(DVec2::ZERO).any() || first.cmpge(end).any() {
            // A number too large for that has no fraction.
            let rounded = |number: f64| Some((number * 1e6).round() / 1e6).filter(|rounded| rounded.is_finite());
            let shown = |number: f64| shown(rounded(number).unwrap_or(number));
            let span = |[a, b]: [DVec2; 2]| {
                format!("{} to {} east, {} to {} north", shown(a.x), shown(b.x), shown(b.y), shown(a.y))
            };
            let message = format!(
                "{} places {} beside the first map: it lies at {}, the map at {}; both have to be in the same coordinates",
                world_file.display(),
                path.display(),
                span(corners),
                span(map_corners)
            );
            return Err(Error::Input(message));
        }
        Ok(drape()?.placed(first.as_vec2(), (last - first).as_vec2()))
    }
}

/// Passes for texels as large as the distance between samples may be: others would not be seen, or be all that is seen.
fn check_texels(coordinates: &Coordinates, map: &HeightMap) -> Result<(), String> {
    /// Metres of a degree of latitude.
    const DEGREE_M: f64 = 111_000.0;
    let (least_m, most_m) = HeightMap::SPACING_M.into_inner();
    let (unit_m, most_m) = match map.geographic() {
        Some(_) => (DEGREE_M, HeightMap::MOST_SPACING_ON_EARTH_M),
        None => (1.0, most_m),
    };
    let beyond = [(1, coordinates.step.x), (4, coordinates.step.y)];
    match beyond.into_iter().find(|(_, step)| !(least_m..=most_m).contains(&(step * unit_m))) {
        None => Ok(()),
        Some((line, step)) => Err(format!(
            "line {line}: its texels are {} m large in the first map's coordinates, and have to be {least_m} to {most_m} m",
            shown(step * unit_m)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Samples;

    #[test]
    fn texels_are_as_large_as_can_be_seen() {
        let map = HeightMap::new(2, 2, Samples::Float(vec![0.0; 4])).unwrap();
        let check =
            |x: f64, y: f64| check_texels(&Coordinates { north_west: DVec2::ZERO, step: DVec2::new(x, y) }, &map);
        assert_eq!((check(1e-6, 1e6), check(0.5, 30.0)), (Ok(()), Ok(())));
        assert!(check(1e-8, 1.0).unwrap_err().starts_with("line 1: its texels are 1e-8 m large"));
        assert!(
            check(1.0, 1e300)
                .unwrap_err()
                .ends_with("1e300 m large in the first map's coordinates, and have to be 0.000001 to 1000000 m")
        );
    }

    #[test]
    fn words_are_drapes_and_all_else_is_a_file() {
        let parse = |text: &str| DrapeSource::parse(&[OsStr::new(text)]);
        for (text, expected) in [
            ("contours", DrapeSource::Contours(None)),
            ("contours:12.5", DrapeSource::Contours(Some(12.5))),
            ("slope", DrapeSource::Slope),
            ("hypsometric", DrapeSource::Hypsometric),
            ("./slope", DrapeSource::Picture("./slope".into())),
        ] {
            assert_eq!(parse(text).as_ref(), Ok(&expected));
            assert_eq!(expected.text(), text);
            assert_eq!(expected.files().len(), usize::from(text.starts_with('.')));
        }
        for text in
            ["contours:", "contours:0", "contours:-5", "contours:nan", "contours:inf", "contours:1e7", "contours:x"]
        {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lines_are_round_numbers_of_metres_apart() {
        for (range_m, expected_m) in
            [(0.0, 1e-3), (0.7, 0.05), (25.0, 1.0), (26.0, 2.0), (1800.0, 100.0), (8849.0, 500.0), (1e5, 5000.0)]
        {
            assert_eq!(suiting_interval_m(range_m), expected_m, "{range_m} m");
        }
    }
}

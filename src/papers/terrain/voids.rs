//! The option `voids`, and what is said of voids.

use std::ffi::OsStr;

use serde_json::{Value as Json, json};

use crate::measure::parameter::{Shape, Value, one, parse_finite};
use crate::scene::{HeightMap, Suspect, Voids};

impl Value for Voids {
    const SHAPE: Shape = Shape::single("fill|level:M|hole");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match one(texts)? {
            "fill" => Ok(Voids::Fill),
            "hole" => Ok(Voids::Hole),
            text => match text.split_once(':') {
                Some(("level", metres)) => match parse_finite(metres)? {
                    level_m if f64::from(level_m).abs() <= HeightMap::MOST_HEIGHT_M => Ok(Voids::Level(level_m)),
                    _ => Err(format!("its level must be -{0} to {0} metres", HeightMap::MOST_HEIGHT_M)),
                },
                _ => Err("give fill, level:M or hole".to_owned()),
            },
        }
    }

    fn text(&self) -> String {
        match self {
            Voids::Fill => "fill".to_owned(),
            Voids::Level(level_m) => format!("level:{level_m}"),
            Voids::Hole => "hole".to_owned(),
        }
    }

    fn json(&self) -> Json {
        match self {
            Voids::Fill | Voids::Hole => json!(self.text()),
            Voids::Level(level_m) => json!({"level": level_m}),
        }
    }
}

/// Lines on the samples that maps leave void, and on heights that look like voids.
pub fn void_warnings<'a>(maps: impl ExactSizeIterator<Item = &'a HeightMap>) -> Vec<String> {
    let of = maps.len();
    let warnings = maps.zip(1..).flat_map(|(map, number): (&HeightMap, usize)| {
        let suspect = map.suspect().map(|Suspect { height_m, samples, next_m }| {
            format!(
                "{samples} samples are {height_m} m, the next is {next_m} m: they look like voids that the file does not \
                 declare; declare them, as by gdal_translate -a_nodata {height_m}"
            )
        });
        map.void_note().into_iter().chain(suspect).map(move |note| format!("`map` {number} of {of}: {note}"))
    });
    warnings.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_lie_where_the_base_may() {
        let parse = |text: &str| Voids::parse(&[OsStr::new(text)]);
        for (text, expected) in [
            ("fill", Voids::Fill),
            ("hole", Voids::Hole),
            ("level:1e6", Voids::Level(1e6)),
            ("level:-1e6", Voids::Level(-1e6)),
        ] {
            assert_eq!(parse(text), Ok(expected));
        }
        for text in ["level:1e38", "level:-1000001"] {
            assert_eq!(parse(text), Err("its level must be -1000000 to 1000000 metres".to_owned()), "{text}");
        }
    }
}

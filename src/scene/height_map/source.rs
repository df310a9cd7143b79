use super::{HeightMap, formats, volcano};
use crate::scene::Error;
use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Source of a height map: one of the built-in ones or a file.
///
/// As text: `volcano`, `maunga-whau` or `jacksboro`; anything else is a path, so that a file named `volcano` is
/// `./volcano`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum HeightMapSource {
    /// [`volcano()`] of seed 1, [`Self::VOLCANO_SIDE`] samples a side. Call the function for another size.
    Volcano,
    /// The volcano Maunga Whau in Auckland: 61 x 87 samples, 10 m apart.
    MaungaWhau,
    /// The Jacksboro fault in Tennessee: 403 x 344 samples, 3 arc-seconds apart.
    Jacksboro,
    /// An SRTM tile or a folder of them, an ESRI raster with its header, a GeoTIFF, a PNG, an Esri ASCII grid or a mosaic of such
    /// files (.vrt).
    File(PathBuf),
}

impl HeightMapSource {
    /// Samples a side of the built-in volcano.
    pub const VOLCANO_SIDE: u32 = 1_024;

    /// The file that it is read from, if it is.
    pub fn path(&self) -> Option<&Path> {
        if let Self::File(path) = self { Some(path) } else { None }
    }

    /// Builds the volcano or reads the file.
    ///
    /// # Errors
    /// For files only: one that cannot be read, is of an unknown format, or is malformed, with the field that is wrong.
    pub fn load(&self) -> Result<HeightMap, Error> {
        match self {
            Self::Volcano => volcano(Self::VOLCANO_SIDE, 1),
            Self::MaungaWhau => formats::maunga_whau(),
            Self::Jacksboro => formats::jacksboro(),
            Self::File(path) => formats::load(path, 0),
        }
    }

    /// An overview of a GeoTIFF in place of its data, 1 the finest; 0 is the data, as any source has them.
    ///
    /// # Errors
    /// As [`Self::load`]; an overview that the source does not have.
    pub fn load_overview(&self, overview: u32) -> Result<HeightMap, Error> {
        match self {
            Self::File(path) => formats::load(path, overview),
            _ if overview == 0 => self.load(),
            _ => Err(Error::HeightMap {
                reason: format!("`overview` {overview}: only a GeoTIFF has any, and {self} is none"),
            }),
        }
    }
}

impl FromStr for HeightMapSource {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "volcano" => Self::Volcano,
            "maunga-whau" => Self::MaungaWhau,
            "jacksboro" => Self::Jacksboro,
            path => Self::File(path.into()),
        })
    }
}

impl fmt::Display for HeightMapSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Volcano => formatter.write_str("volcano"),
            Self::MaungaWhau => formatter.write_str("maunga-whau"),
            Self::Jacksboro => formatter.write_str("jacksboro"),
            Self::File(path) => path.display().fmt(formatter),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::error::Asset;

    #[test]
    fn text_round_trips() {
        for (text, is_file) in
            [("volcano", false), ("maunga-whau", false), ("jacksboro", false), ("./volcano", true), ("a.hgt", true)]
        {
            let Ok(source) = text.parse::<HeightMapSource>();
            assert_eq!(source.to_string(), text);
            assert_eq!(matches!(source, HeightMapSource::File(_)), is_file);
        }
    }

    #[test]
    fn a_misspelt_name_is_told_what_there_is() {
        let names = Asset::HeightMap.built_in().unwrap();
        for name in names.split(", ") {
            let Ok(source) = name.parse::<HeightMapSource>();
            assert!(source.path().is_none(), "{name}");
        }
        let Ok(source) = "nope".parse::<HeightMapSource>();
        let message = source.load().unwrap_err().to_string();
        assert!(message.contains("height map nope") && message.contains(names), "{message}");
    }

    #[test]
    fn built_in_maps_have_their_documented_sizes_and_heights() {
        for (source, (width, height), (low_m, high_m)) in [
            (HeightMapSource::Volcano, (1_024, 1_024), (500.0, 1_710.0)),
            (HeightMapSource::MaungaWhau, (61, 87), (94.0, 195.0)),
            (HeightMapSource::Jacksboro, (403, 344), (236.0, 1_076.0)),
        ] {
            let map = source.load().unwrap();
            assert_eq!((map.width(), map.height()), (width, height), "{source}");
            let (low, high) = map.range_m();
            assert!((low - low_m).abs() < 1.0 && (high - high_m).abs() < 1.0, "{source}: {low} to {high}");
            assert_eq!(map.voids(), 0);
        }
    }
}

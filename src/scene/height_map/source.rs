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

/// Ways to read the file of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MapOptions {
    /// Number of an overview of a GeoTIFF in place of its data, 1 the finest; 0 is the data, as any source has them.
    pub overview: u32,
    /// Another spacing takes the place of the file's: one that no map may have is then no fault, and tells no place either.
    pub has_own_spacing: bool,
    /// A world file beside a picture does not count, as for the parts of a mosaic that states its place itself.
    pub is_placed: bool,
}

/// An overview, of the spacing that the file has.
impl From<u32> for MapOptions {
    fn from(overview: u32) -> Self {
        MapOptions { overview, ..MapOptions::default() }
    }
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

    /// As [`Self::load`], read by these options.
    ///
    /// # Errors
    /// As [`Self::load`]; an overview that the source does not have.
    pub fn load_with(&self, options: impl Into<MapOptions>) -> Result<HeightMap, Error> {
        match (self, options.into()) {
            (Self::File(path), options) => formats::load(path, options),
            (_, MapOptions { overview: 0, .. }) => self.load(),
            (_, MapOptions { overview, .. }) => Err(Error::HeightMap {
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
    use crate::scene::RowSource;
    use crate::scene::error::Asset;
    use glam::DVec2;
    use std::io::Cursor;
    use tiff::encoder::TiffEncoder;
    use tiff::encoder::colortype::Gray8;
    use tiff::tags::Tag;

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

    /// Of each format that states one in its own words.
    #[test]
    fn a_spacing_that_no_map_may_have_is_no_fault_where_another_is_given() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            HeightMapSource::File(path)
        };
        let mut tiff = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut tiff).unwrap();
        let mut picture = encoder.new_image::<Gray8>(2, 2).unwrap();
        picture.encoder().write_tag(Tag::ModelPixelScaleTag, &[1e300_f64, 1e300, 0.0][..]).unwrap();
        picture.write_data(&[7, 8, 9, 7]).unwrap();
        let header = |dim: &str| format!("NCOLS 2\nNROWS 2\nULXMAP 7\nULYMAP 45\nXDIM {dim}\nYDIM {dim}\n");
        write("a.hdr", header("1e-300").as_bytes());
        let sources = [
            write("a.asc", b"ncols 2\nnrows 2\ncellsize 1e7\n7 8\n9 7\n"),
            write("a.bil", &[7, 8, 9, 7]),
            write("a.tif", tiff.get_ref()),
        ];
        let given = MapOptions { has_own_spacing: true, ..MapOptions::default() };
        for source in &sources {
            let message = source.load().unwrap_err().to_string();
            assert!(message.contains(": it makes samples lie "), "{message}");
            let map = source.load_with(given).unwrap().with_spacing_m(DVec2::splat(30.0)).unwrap();
            assert_eq!((map.range_m(), map.coordinates(), map.geographic()), ((7.0, 9.0), None, None), "{source}");
        }
        let tiff = sources[2].path().unwrap();
        assert!(RowSource::geotiff(tiff, 0).is_err());
        assert_eq!(RowSource::geotiff(tiff, given).unwrap().unwrap().map().spacing_m(), DVec2::ONE);
        // A spacing that a map may have tells its place, whatever stands in for it.
        write("a.hdr", header("0.01").as_bytes());
        let [own, other] = [MapOptions::default(), given].map(|options| sources[1].load_with(options).unwrap());
        assert!(own.geographic().is_some() && own == other);
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

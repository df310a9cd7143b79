//! The `.aux.xml` file that GDAL keeps beside a raster for what its format has no place for.

use super::check_unit;
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};
use roxmltree::Document;
use std::path::{Path, PathBuf};

/// Statistics and histograms may be in it.
const MOST_BYTES: u64 = 16 << 20;

/// Passes where such a file beside a raster says nothing by which its heights would be others than they are read, and where there is
/// none.
///
/// # Errors
/// [`Error::Malformed`] for a scale, an offset, a unit other than metres, and voids of a PNG, which has no others.
pub(super) fn check(raster: &Path) -> Result<(), Error> {
    let mut name = raster.as_os_str().to_owned();
    name.push(".aux.xml");
    let path = PathBuf::from(name);
    if !path.is_file() {
        return Ok(());
    }
    let text = crate::file::read_text(&path, MOST_BYTES);
    let text = text.map_err(|source| file::failed(&path, Asset::HeightMap, source))?;
    let is_png = raster.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    check_text(&text, is_png).map_err(|fault| Error::Malformed { path, asset: Asset::HeightMap, fault })
}

fn check_text(text: &str, is_png: bool) -> Result<(), Fault> {
    let document = Document::parse(text).map_err(|error| Fault::foreign(Place::Whole, &error))?;
    let bands = document.root_element().children().filter(|node| node.has_tag_name("PAMRasterBand"));
    for node in bands.flat_map(|band| band.children()).filter(|node| node.is_element()) {
        let name = node.tag_name().name();
        let text = node.text().unwrap_or_default().trim();
        let is_number = |plain: f64| text.parse::<f64>().is_ok_and(|number| number == plain);
        let problem = match name {
            "UnitType" => check_unit(text).err(),
            "Scale" if !is_number(1.0) => Some(scaled()),
            "Offset" if !is_number(0.0) => Some(scaled()),
            "NoDataValue" if is_png => {
                Some("a PNG with voids is not read; write a GeoTIFF with gdal_translate".to_owned())
            }
            _ => None,
        };
        if let Some(problem) = problem {
            return Err(Fault::new(Place::Part(name.to_owned()), problem));
        }
    }
    Ok(())
}

fn scaled() -> String {
    "it changes heights; write plain metres with gdal_translate -unscale".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::height_map::formats::load;

    #[test]
    fn what_changes_heights_is_refused() {
        let of = |band: &str, is_png| {
            check_text(&format!("<PAMDataset><PAMRasterBand band=\"1\">{band}</PAMRasterBand></PAMDataset>"), is_png)
        };
        for plain in [
            "",
            "<Scale>1</Scale><Offset>0.0</Offset>",
            "<UnitType>metre</UnitType>",
            "<Metadata><MDI key=\"STATISTICS_MAXIMUM\">12</MDI></Metadata>",
        ] {
            assert_eq!(of(plain, true), Ok(()), "{plain}");
        }
        assert_eq!(of("<NoDataValue>0</NoDataValue>", false), Ok(()));
        for (band, name) in [
            ("<Scale>0.1</Scale>", "Scale: it changes heights"),
            ("<Offset>100</Offset>", "Offset: it changes heights"),
            ("<UnitType>ft</UnitType>", "UnitType: its heights are in \"ft\""),
            ("<NoDataValue>0</NoDataValue>", "NoDataValue: a PNG with voids"),
        ] {
            let message = of(band, true).unwrap_err().to_string();
            assert!(message.starts_with(name), "{message}");
        }
        assert!(check_text("<PAMDataset>", false).is_err());
    }

    #[test]
    fn the_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let map = folder.path().join("a.asc");
        std::fs::write(&map, "ncols 2\nnrows 2\ncellsize 10\n1 2\n3 4\n").unwrap();
        assert!(load(&map, 0).is_ok());
        let band = "<PAMDataset><PAMRasterBand band=\"1\"><UnitType>ft</UnitType></PAMRasterBand></PAMDataset>";
        std::fs::write(folder.path().join("a.asc.aux.xml"), band).unwrap();
        let message = load(&map, 0).unwrap_err().to_string();
        assert!(message.contains("a.asc.aux.xml: UnitType: its heights are in"), "{message}");
    }
}

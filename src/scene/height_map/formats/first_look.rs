//! A first look at the parts of a mosaic that may be packed far smaller than they are. Nothing of their samples is kept.

use super::geotiff::Picture;
use super::geotiff_check::check_samples;
use super::placement::by_world_file;
use super::{Format, PNG_MAGIC, ending, is_tiff, magic, malformed, png};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::height_map::{HeightMap, MapOptions, Samples};
use crate::scene::{Error, file};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Bytes of a sample of a map, and of its height.
const KEPT_BYTES: u64 = 8;

/// A packed file, open at its start.
enum Packed {
    Tiff(BufReader<File>),
    Png(BufReader<File>),
}

/// A TIFF or a PNG by its content, and its size in bytes; none of a file that has its reader by its ending.
fn open(path: &Path) -> Result<Option<(Packed, u64)>, Error> {
    if Format::of(&ending(path)) != Format::ByContent {
        return Ok(None);
    }
    let (mut file, size_bytes) = file::open(path, Asset::HeightMap)?;
    let magic = magic(&mut file, path)?;
    let packed = if is_tiff(&magic) {
        Packed::Tiff(BufReader::new(file))
    } else if magic == PNG_MAGIC {
        Packed::Png(BufReader::new(file))
    } else {
        return Ok(None);
    };
    Ok(Some((packed, size_bytes)))
}

/// Bytes of a packed file's samples.
#[derive(Default)]
pub(super) struct Unpacked {
    /// Of all of them, unpacked.
    pub(super) raw_bytes: u64,
    /// That are held at most while their map is made.
    pub(super) most_bytes: u64,
}

/// Sizes of a packed file by its head; 0 of another file, which is no smaller than its samples.
pub(super) fn unpacked(path: &Path, options: MapOptions) -> Result<Unpacked, Error> {
    let sizes = |packed: Packed, size_bytes: u64| -> Result<Unpacked, Fault> {
        let ((width, height), raw_bytes) = match packed {
            Packed::Tiff(input) => {
                let picture = Picture::open(size_bytes, input, options)?;
                ((picture.width, picture.height), picture.raw_bytes()?)
            }
            Packed::Png(input) => png::size(size_bytes, input)?,
        };
        Ok(Unpacked { raw_bytes, most_bytes: raw_bytes + KEPT_BYTES * u64::from(width) * u64::from(height) })
    };
    match open(path)? {
        Some((packed, size_bytes)) => sizes(packed, size_bytes).map_err(|fault| malformed(path, fault)),
        None => Ok(Unpacked::default()),
    }
}

/// The map of a packed file without its samples, and true where one of them is a height that is none of `voids`; none of another
/// file.
///
/// # Errors
/// [`Error::Malformed`] for samples that make no map.
pub(super) fn look_through(
    path: &Path,
    options: MapOptions,
    voids: &[f64],
) -> Result<Option<(HeightMap, bool)>, Error> {
    let Some((packed, size_bytes)) = open(path)? else { return Ok(None) };
    let fault = |fault| malformed(path, fault);
    let ((width, height), placement, has_known) = match packed {
        Packed::Tiff(input) => {
            let mut picture = Picture::open(size_bytes, input, options).map_err(fault)?.in_file(path)?;
            picture.raw_bytes().map_err(fault)?;
            let has_known = check_samples(&mut picture, voids).map_err(fault)?;
            ((picture.width, picture.height), picture.placement, has_known)
        }
        Packed::Png(input) => {
            let (size, has_known) = png::look_through(size_bytes, input, voids).map_err(fault)?;
            (size, by_world_file(path, None, size, size, options)?, has_known)
        }
    };
    let map = HeightMap::promised(width, height, Samples::Float(Vec::new())).and_then(|map| placement.place(map));
    map.map(|map| Some((map, has_known))).map_err(|error| fault(Fault::foreign(Place::Whole, &error)))
}

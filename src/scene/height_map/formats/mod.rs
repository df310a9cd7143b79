//! Files of heights. Every reader checks the size that a header claims, and that the file can hold it, before it
//! allocates; it gives a valid map or names the field that is wrong.

mod ascii_grid;
mod esri;
mod geotiff;
mod hgt;
mod hgt_folder;
mod placement;
mod png;
pub(in crate::scene) mod vrt;

use super::HeightMap;
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

const KNOWN_ENDINGS: &str = ".hgt, .hdr, .bil, .bsq, .dem, .asc, .tif, .tiff, .png, .vrt";
const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
/// TIFF and BigTIFF, little and big endian.
const TIFF_MAGIC: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];

/// Reads the height map at `path`: a folder of SRTM tiles, or a file by its ending, in either case, or by its content if that is
/// a TIFF or a PNG.
pub(super) fn load(path: &Path) -> Result<HeightMap, Error> {
    if path.is_dir() {
        return hgt_folder::load(path);
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if matches!(ending.as_str(), "hdr" | "bil" | "bsq" | "dem") {
        return esri::load(path);
    }
    if ending == "vrt" {
        return vrt::load(path);
    }
    let (mut file, size_bytes) = file::open(path, Asset::HeightMap)?;
    let parsed = match ending.as_str() {
        "hgt" => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            hgt::parse(&name, size_bytes, BufReader::new(file))
        }
        "asc" => {
            let projection = placement::beside(path)?;
            ascii_grid::parse(size_bytes, BufReader::new(file), projection)
        }
        _ => {
            let mut magic = Vec::new();
            let read = file.by_ref().take(8).read_to_end(&mut magic).and_then(|_| file.rewind());
            read.map_err(|source| Error::Read { path: path.to_owned(), source })?;
            if magic == PNG_MAGIC {
                png::parse(size_bytes, BufReader::new(file))
            } else if TIFF_MAGIC.iter().any(|known| magic.starts_with(known)) {
                geotiff::parse(size_bytes, BufReader::new(file))
            } else if matches!(ending.as_str(), "tif" | "tiff" | "png") {
                Err(Fault::new(Place::Byte(0), "its content is neither TIFF nor PNG; it is damaged or something else"))
            } else {
                let (path, known) = (path.to_owned(), KNOWN_ENDINGS.to_owned());
                return Err(Error::UnknownEnding { path, asset: Asset::HeightMap, ending, known });
            }
        }
    };
    parsed.map_err(|fault| malformed(path, fault))
}

/// The volcano that the program carries.
pub(super) fn maunga_whau() -> Result<HeightMap, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/maunga-whau.asc"));
    ascii_grid::parse(bytes.len() as u64, bytes.as_slice(), None)
        .map_err(|fault| malformed(Path::new("maunga-whau.asc"), fault))
}

/// The mountains that the program carries.
pub(super) fn jacksboro() -> Result<HeightMap, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/jacksboro.tif"));
    geotiff::parse(bytes.len() as u64, Cursor::new(bytes.as_slice()))
        .map_err(|fault| malformed(Path::new("jacksboro.tif"), fault))
}

fn malformed(path: &Path, fault: Fault) -> Error {
    Error::Malformed { path: path.to_owned(), asset: Asset::HeightMap, fault }
}

/// Passes when a compressed file can hold samples of so many bits each, so that a small file cannot ask for much
/// memory.
fn check_compressed(size_bytes: u64, (width, height): (u32, u32), bits: u32) -> Result<(), String> {
    /// Neither Deflate (1,032) nor LZW (about 1,400) packs tighter.
    const MOST_COMPRESSED: u64 = 2_000;
    let raw_bytes = u64::from(width) * u64::from(height) * u64::from(bits).div_ceil(8);
    if size_bytes.saturating_mul(MOST_COMPRESSED) >= raw_bytes {
        return Ok(());
    }
    Err(format!("its size is {size_bytes} bytes, too few for {width} x {height} samples; it is cut off"))
}

/// The text of a small file beside a map, such as its header.
fn read_text(file: File, path: &Path) -> Result<String, Error> {
    /// Headers and projections are a few lines.
    const MAX_TEXT_BYTES: u64 = 1 << 20;
    let mut bytes = Vec::new();
    file.take(MAX_TEXT_BYTES)
        .read_to_end(&mut bytes)
        .map_err(|source| Error::Read { path: path.to_owned(), source })?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests;

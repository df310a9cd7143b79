//! Files of heights. Every reader checks the size that a header claims, and that the file can hold it, before it
//! allocates; it gives a valid map or names the field that is wrong.

mod ascii_grid;
mod auxiliary;
mod distinct;
mod esri;
mod first_look;
mod geotiff;
mod geotiff_check;
mod geotiff_rows;
mod hgt;
mod hgt_folder;
mod placement;
mod png;
mod stored;
mod systems;
pub(in crate::scene) mod vrt;

pub(super) use self::geotiff_rows::GeoTiffRows;
use super::{HeightMap, MapOptions};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

const KNOWN_ENDINGS: &str = ".hgt, .hdr, .bil, .bsq, .dem, .asc, .tif, .tiff, .png, .vrt";
/// Of UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
/// TIFF and BigTIFF, little and big endian.
const TIFF_MAGIC: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];

/// Format of a file by its ending.
#[derive(PartialEq, Eq)]
enum Format {
    Esri,
    Mosaic,
    Hgt,
    AsciiGrid,
    /// A TIFF or a PNG, or something else: its content tells.
    ByContent,
}

impl Format {
    /// By an ending in small letters.
    fn of(ending: &str) -> Self {
        match ending {
            "hdr" | "bil" | "bsq" | "dem" => Self::Esri,
            "vrt" => Self::Mosaic,
            "hgt" => Self::Hgt,
            "asc" => Self::AsciiGrid,
            _ => Self::ByContent,
        }
    }
}

/// Reads the height map at `path`: a folder of SRTM tiles, or a file by its ending, in either case, or by its content if that is
/// a TIFF or a PNG.
///
/// An overview is one of a TIFF.
pub(super) fn load(path: &Path, options: impl Into<MapOptions>) -> Result<HeightMap, Error> {
    let options = options.into();
    let MapOptions { overview, has_own_spacing, .. } = options;
    auxiliary::check(path)?;
    if overview > 0 {
        return tiff_overview(path, options);
    }
    if path.is_dir() {
        return hgt_folder::load(path);
    }
    let ending = ending(path);
    let open = || file::open(path, Asset::HeightMap);
    let parsed = match Format::of(&ending) {
        Format::Esri => return esri::load(path, has_own_spacing),
        Format::Mosaic => return vrt::load(path, has_own_spacing),
        Format::Hgt => {
            let (file, size_bytes) = open()?;
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            hgt::parse(&name, size_bytes, BufReader::new(file))
        }
        Format::AsciiGrid => {
            let (file, size_bytes) = open()?;
            let projection = placement::beside(path)?;
            ascii_grid::parse(size_bytes, BufReader::new(file), projection, has_own_spacing)
        }
        Format::ByContent => {
            let (mut file, size_bytes) = open()?;
            let magic = magic(&mut file, path)?;
            if magic == PNG_MAGIC {
                return png_map(path, (file, size_bytes), options);
            } else if is_tiff(&magic) {
                geotiff::read(tiff(path, (file, size_bytes), options)?)
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

/// In small letters.
fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// An overview of a TIFF, from 1 on.
fn tiff_overview(path: &Path, options: MapOptions) -> Result<HeightMap, Error> {
    let Some((file, size_bytes)) = open_tiff(path)? else {
        let overview = options.overview;
        let reason = format!("`overview` {overview}: only a GeoTIFF has any, and {} is none", path.display());
        return Err(Error::HeightMap { reason });
    };
    geotiff::read(tiff(path, (file, size_bytes), options)?).map_err(|fault| malformed(path, fault))
}

/// The map of a PNG, whose size is given, at its place.
fn png_map(path: &Path, (file, size_bytes): (File, u64), options: MapOptions) -> Result<HeightMap, Error> {
    let map = png::parse(size_bytes, BufReader::new(file)).map_err(|fault| malformed(path, fault))?;
    let size = (map.width(), map.height());
    placement::by_world_file(path, None, size, size, options)?.place(map)
}

/// The picture of a TIFF, whose size is given, at its place.
fn tiff(
    path: &Path,
    (file, size_bytes): (File, u64),
    options: MapOptions,
) -> Result<geotiff::Picture<BufReader<File>>, Error> {
    let picture = geotiff::Picture::open(size_bytes, BufReader::new(file), options);
    picture.map_err(|fault| malformed(path, fault))?.in_file(path)
}

/// True for a TIFF or a PNG that is read by its content.
pub(in crate::scene) fn is_picture(path: &Path) -> bool {
    let content = || magic(&mut file::open(path, Asset::HeightMap).ok()?.0, path).ok();
    Format::of(&ending(path)) == Format::ByContent
        && content().is_some_and(|magic| magic == PNG_MAGIC || is_tiff(&magic))
}

/// The file and its size, if it is a TIFF by its content.
fn open_tiff(path: &Path) -> Result<Option<(File, u64)>, Error> {
    if path.is_dir() {
        return Ok(None);
    }
    let (mut file, size_bytes) = file::open(path, Asset::HeightMap)?;
    Ok(is_tiff(&magic(&mut file, path)?).then_some((file, size_bytes)))
}

fn is_tiff(magic: &[u8]) -> bool {
    TIFF_MAGIC.iter().any(|known| magic.starts_with(known))
}

/// The first bytes of a file, which is then read from its start.
fn magic(file: &mut File, path: &Path) -> Result<Vec<u8>, Error> {
    let mut magic = Vec::new();
    let read = file.by_ref().take(8).read_to_end(&mut magic).and_then(|_| file.rewind());
    read.map(|()| magic).map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// The volcano that the program carries.
pub(super) fn maunga_whau() -> Result<HeightMap, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/maunga-whau.asc"));
    ascii_grid::parse(bytes.len() as u64, bytes.as_slice(), None, false)
        .map_err(|fault| malformed(Path::new("maunga-whau.asc"), fault))
}

/// The mountains that the program carries.
pub(super) fn jacksboro() -> Result<HeightMap, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/jacksboro.tif"));
    geotiff::parse(bytes.len() as u64, Cursor::new(bytes.as_slice()), 0)
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

/// Passes for a name of the metre, and for none: heights of another unit would be read as metres in silence.
fn check_unit(name: &str) -> Result<(), String> {
    let name = name.trim();
    let lower = name.to_lowercase();
    if ["", "m"].contains(&&*lower) || ["metre", "meter", "m "].iter().any(|begin| lower.starts_with(begin)) {
        return Ok(());
    }
    let name: String = name.chars().take(40).collect();
    Err(format!(
        "its heights are in {name:?}; write metres, for instance with gdal_calc --calc=A*0.3048 where they are feet"
    ))
}

/// The text of a small file beside a map or a picture, such as its header, without the mark of UTF-8 that some editors put
/// before it.
pub(in crate::scene) fn read_text(file: File, path: &Path) -> Result<String, Error> {
    /// Headers and projections are a few lines.
    const MAX_TEXT_BYTES: u64 = 1 << 20;
    let mut bytes = Vec::new();
    file.take(MAX_TEXT_BYTES)
        .read_to_end(&mut bytes)
        .map_err(|source| Error::Read { path: path.to_owned(), source })?;
    Ok(String::from_utf8_lossy(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes)).into_owned())
}

#[cfg(test)]
mod tests;

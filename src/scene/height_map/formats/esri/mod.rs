mod header;

use super::placement::{self, MapCoordinates, Unit};
use super::{malformed, read_text};
use crate::scene::binary::{Rows, skip};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use crate::scene::{Error, HeightMap, file};
use bytemuck::Pod;
use header::{Header, Kind};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// Endings of the samples beside a header.
const DATA_ENDINGS: [&str; 6] = ["bil", "dem", "bsq", "BIL", "DEM", "BSQ"];

/// Reads an ESRI raster of one band, given its header (`.hdr`) or its samples (`.bil`, `.bsq`, `.dem`).
pub(super) fn load(path: &Path, has_own_spacing: bool) -> Result<HeightMap, Error> {
    let is_header = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hdr"));
    // The file that was named has to be there before the one beside it is looked for.
    file::open(path, Asset::HeightMap)?;
    let (header_path, data_path) = if is_header {
        (
            path.to_owned(),
            beside(path, &DATA_ENDINGS, |name| {
                format!("its samples are missing; put them beside it as {name}.bil, {name}.dem or {name}.bsq")
            })?,
        )
    } else {
        let missing = |name: &str| format!("its header is missing; put it beside it as {name}.hdr");
        (beside(path, &["hdr", "HDR"], missing)?, path.to_owned())
    };
    let (header_file, _) = file::open(&header_path, Asset::HeightMap)?;
    let header =
        Header::parse(&read_text(header_file, &header_path)?).map_err(|fault| malformed(&header_path, fault))?;
    let unit = placement::beside(path)?;
    let placement = header.placement(unit, has_own_spacing).map_err(|fault| malformed(&header_path, fault))?;
    let (data, size_bytes) = file::open(&data_path, Asset::HeightMap)?;
    parse(&header, placement, size_bytes, BufReader::new(data)).map_err(|fault| malformed(&data_path, fault))
}

/// The file of the same name with one of some endings.
fn beside(path: &Path, endings: &[&str], missing: impl Fn(&str) -> String) -> Result<PathBuf, Error> {
    file::first_beside(path, endings, |name| malformed(path, Fault::new(Place::Whole, missing(name))))
}

impl Header {
    /// The spacing and the coordinates that it states.
    fn placement(&self, unit: Option<Unit>, has_own_spacing: bool) -> Result<Placement, Fault> {
        let Header { columns: width, rows: height, north_west, .. } = *self;
        let Some(step) = self.step else { return Ok(Placement::Unknown) };
        let coordinates = MapCoordinates { north_west, step, width, height, field: "XDIM, YDIM" };
        coordinates.placed_or_spaced(unit, has_own_spacing)
    }
}

/// Reads the samples that a header describes.
fn parse(header: &Header, placement: Placement, size_bytes: u64, input: impl Read) -> Result<HeightMap, Fault> {
    match header.kind {
        Kind::Unsigned8 => samples::<u8>(header, placement, size_bytes, input, true),
        Kind::Signed8 => samples::<i8>(header, placement, size_bytes, input, true),
        Kind::Unsigned16 => samples::<u16>(header, placement, size_bytes, input, true),
        Kind::Signed16 => samples::<i16>(header, placement, size_bytes, input, true),
        Kind::Unsigned32 => samples::<u32>(header, placement, size_bytes, input, true),
        Kind::Signed32 => samples::<i32>(header, placement, size_bytes, input, true),
        Kind::Float32 => samples::<f32>(header, placement, size_bytes, input, false),
    }
}

fn samples<T: Pod + Into<f64>>(
    header: &Header,
    placement: Placement,
    size_bytes: u64,
    mut input: impl Read,
    integral: bool,
) -> Result<HeightMap, Fault> {
    let (width, height) = (header.columns, header.rows);
    check_size(width.into(), height.into())
        .map_err(|reason| Fault::new(Place::Whole, format!("by NCOLS and NROWS of its header, {reason}")))?;
    let row_bytes = u64::from(width) * size_of::<T>() as u64;
    let stride_bytes = header.stride_bytes.unwrap_or(row_bytes);
    let bits = 8 * size_of::<T>();
    if stride_bytes < row_bytes {
        let reason = format!(
            "its header contradicts itself: BANDROWBYTES is {stride_bytes}, but NCOLS {width} x NBITS {bits} needs \
             {row_bytes}"
        );
        return Err(Fault::new(Place::Whole, reason));
    }
    // The last row may lack its padding. No product overflows: the sides are small, and these fields are checked.
    let least_bytes = header.skip_bytes + stride_bytes * u64::from(height - 1) + row_bytes;
    let most_bytes = header.skip_bytes + stride_bytes * u64::from(height);
    if !(least_bytes..=most_bytes).contains(&size_bytes) {
        let reason = format!(
            "its size is {size_bytes} bytes, but its header's SKIPBYTES {} and NROWS {height} x NCOLS {width} x NBITS \
             {bits} make {least_bytes}",
            header.skip_bytes
        );
        return Err(Fault::new(Place::Whole, reason));
    }
    skip(&mut input, header.skip_bytes).map_err(|error| Fault::foreign(Place::Whole, &error))?;
    let rows = Rows { width: width as usize, height: height as usize, stride_bytes, order: header.order };
    Grid { width, height, values: rows.read::<T>(input)?, integral, no_data: header.no_data, placement }.into_map()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Reads a header and the samples that follow it after a zero byte, both in one piece for damage at random.
    pub(in super::super) fn parse_header_and_samples(bytes: &[u8]) -> Result<HeightMap, Fault> {
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        let header = Header::parse(&String::from_utf8_lossy(&bytes[..end]))?;
        let samples = bytes.get(end + 1..).unwrap_or_default();
        parse(&header, header.placement(None, false)?, samples.len() as u64, samples)
    }

    #[test]
    fn a_spacing_that_no_picture_has_is_refused_with_the_header() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.bil"), [7; 4]).unwrap();
        let read = |dim: &str| {
            let header = format!("\u{feff}NCOLS 2\r\nNROWS 2\r\nXDIM {dim}\r\nYDIM 10\r\n");
            std::fs::write(folder.path().join("a.hdr"), header).unwrap();
            load(&folder.path().join("a.bil"), false)
        };
        // Some editors put a mark of UTF-8 before a text.
        assert_eq!(read("20").unwrap().spacing_m().to_array(), [20.0, 10.0]);
        for dim in ["1e300", "1e-300", "1e7"] {
            let message = read(dim).unwrap_err().to_string();
            let said = format!(
                "a.hdr: XDIM, YDIM: it makes samples lie {} x 10 m apart; they",
                dim.replace("1e7", "10000000")
            );
            assert!(message.contains(&said), "{message}");
        }
        let message = read("-1e300").unwrap_err().to_string();
        assert!(message.contains("line 3: XDIM and YDIM are -1e300 and 10; both"), "{message}");
    }

    #[test]
    fn what_is_missing_beside_a_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        for (name, expected) in [
            ("a.hdr", "its samples are missing; put them beside it as a.bil, a.dem or a.bsq"),
            ("b.bil", "its header is missing; put it beside it as b.hdr"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, "NCOLS 2\nNROWS 2\n").unwrap();
            let message = load(&path, false).unwrap_err().to_string();
            assert!(message.ends_with(expected), "{message}");
        }
    }
}

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
pub(super) fn load(path: &Path) -> Result<HeightMap, Error> {
    let is_header = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hdr"));
    // The file that was named has to be there before the one beside it is looked for.
    file::open(path, Asset::HeightMap)?;
    let (header_path, data_path) = if is_header {
        (path.to_owned(), beside(path, &DATA_ENDINGS, "samples (.bil, .dem or .bsq)")?)
    } else {
        (beside(path, &["hdr", "HDR"], "header (.hdr)")?, path.to_owned())
    };
    let (header_file, _) = file::open(&header_path, Asset::HeightMap)?;
    let header =
        Header::parse(&read_text(header_file, &header_path)?).map_err(|fault| malformed(&header_path, fault))?;
    let unit = placement::beside(path)?;
    let (data, size_bytes) = file::open(&data_path, Asset::HeightMap)?;
    parse(&header, size_bytes, BufReader::new(data), unit).map_err(|fault| malformed(&data_path, fault))
}

/// The file of the same name with one of some endings.
fn beside(path: &Path, endings: &[&str], what: &str) -> Result<PathBuf, Error> {
    let fault = |name: &str| format!("its {what} is missing; put it beside it as {name}");
    file::first_beside(path, endings, |name| malformed(path, Fault::new(Place::Whole, fault(name))))
}

/// Reads the samples that a header describes.
fn parse(header: &Header, size_bytes: u64, input: impl Read, unit: Option<Unit>) -> Result<HeightMap, Fault> {
    match header.kind {
        Kind::Unsigned8 => samples::<u8>(header, size_bytes, input, unit, true),
        Kind::Signed8 => samples::<i8>(header, size_bytes, input, unit, true),
        Kind::Unsigned16 => samples::<u16>(header, size_bytes, input, unit, true),
        Kind::Signed16 => samples::<i16>(header, size_bytes, input, unit, true),
        Kind::Unsigned32 => samples::<u32>(header, size_bytes, input, unit, true),
        Kind::Signed32 => samples::<i32>(header, size_bytes, input, unit, true),
        Kind::Float32 => samples::<f32>(header, size_bytes, input, unit, false),
    }
}

fn samples<T: Pod + Into<f64>>(
    header: &Header,
    size_bytes: u64,
    mut input: impl Read,
    unit: Option<Unit>,
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
    let placement = header.step.map_or(Placement::Unknown, |step| {
        MapCoordinates { north_west: header.north_west, step, width, height }.placed(unit)
    });
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
        parse(&header, samples.len() as u64, samples, None)
    }
}

use super::check_compressed;
use crate::scene::HeightMap;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use ::png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};
use std::io::{BufRead, Seek};

/// 16 bits and alpha in the largest map.
const MAX_BYTES: usize = 4 << 28;

/// Reads a grey PNG of 8 or 16 bits: whole metres. Transparent samples, which is how GDAL writes no-data, are void.
pub(super) fn parse(size_bytes: u64, input: impl BufRead + Seek) -> Result<HeightMap, Fault> {
    let foreign = |error: DecodingError| Fault::foreign(Place::Whole, &error);
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: MAX_BYTES });
    let header = decoder.read_header_info().map_err(foreign)?;
    let (width, height) = header.size();
    let is_packed = (header.bit_depth as u8) < 8;
    let header_fault = |reason: String| Fault::new(Place::Part("IHDR".to_owned()), reason);
    check_size(width.into(), height.into()).map_err(header_fault)?;
    check_compressed(size_bytes, (width, height), 8).map_err(header_fault)?;
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(foreign)?;
    let (color, depth) = reader.output_color_type();
    let has_alpha = color == ColorType::GrayscaleAlpha;
    if !has_alpha && (color != ColorType::Grayscale || is_packed) {
        let reason = "it is no grey picture of 8 or 16 bits; write heights as grey, for instance with gdal_translate";
        return Err(header_fault(reason.to_owned()));
    }
    let mut bytes = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut bytes).map_err(foreign)?;
    let samples: Vec<u16> = match depth {
        BitDepth::Sixteen => bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
        _ => bytes.into_iter().map(u16::from).collect(),
    };
    if !has_alpha {
        return map(width, height, samples, None);
    }
    // A value that no 16-bit sample has.
    const VOID: i32 = -1;
    let masked = |pixel: &[u16]| if pixel[1] == 0 { VOID } else { pixel[0].into() };
    map(width, height, samples.chunks_exact(2).map(masked).collect(), Some(VOID.into()))
}

fn map<T: Copy + Into<f64>>(width: u32, height: u32, values: Vec<T>, no_data: Option<f64>) -> Result<HeightMap, Fault> {
    Grid { width, height, values, integral: true, no_data, placement: Placement::Unknown }.into_map()
}

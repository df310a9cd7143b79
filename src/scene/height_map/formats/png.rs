use super::check_compressed;
use super::distinct::firsts;
use crate::scene::HeightMap;
use crate::scene::binary::spare_bytes;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement, all_void, is_same};
use crate::scene::height_map::map::check_size;
use ::png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Reader, Transformations};
use std::io::{BufRead, Seek};

/// 16 bits and alpha in the largest map.
const MAX_BYTES: usize = 4 << 28;

/// Reads a grey PNG of 8 or 16 bits: whole metres. Transparent samples, which is how GDAL writes no-data, are void.
pub(super) fn parse(size_bytes: u64, mut input: impl BufRead + Seek) -> Result<HeightMap, Fault> {
    let ((width, height), mut reader) = open(size_bytes, &mut input)?;
    let (color, depth) = reader.output_color_type();
    let raw_bytes = reader.output_buffer_size().unwrap_or(0);
    // Nothing is kept of a file that could be far larger than it is before all of it is seen to be whole.
    if raw_bytes as u64 > spare_bytes(size_bytes) {
        check_samples(&mut reader, &[])?;
        drop(reader);
        reader = open(size_bytes, &mut input)?.1;
    }
    let mut bytes = vec![0; raw_bytes];
    reader.next_frame(&mut bytes).map_err(foreign)?;
    let samples: Vec<u16> = match depth {
        BitDepth::Sixteen => bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
        _ => bytes.into_iter().map(u16::from).collect(),
    };
    if color == ColorType::Grayscale {
        return map(width, height, samples, None);
    }
    // A value that no 16-bit sample has.
    const VOID: i32 = -1;
    let masked = |pixel: &[u16]| if pixel[1] == 0 { VOID } else { pixel[0].into() };
    map(width, height, samples.chunks_exact(2).map(masked).collect(), Some(VOID.into()))
}

/// Columns and rows, and the bytes of all samples, unpacked.
pub(super) fn size(size_bytes: u64, input: impl BufRead + Seek) -> Result<((u32, u32), u64), Fault> {
    let (size, reader) = open(size_bytes, input)?;
    Ok((size, reader.output_buffer_size().unwrap_or(0) as u64))
}

/// Columns and rows, and true where a sample is a height that is none of `voids`. All samples are looked at, and none is kept.
pub(super) fn look_through(
    size_bytes: u64,
    input: impl BufRead + Seek,
    voids: &[f64],
) -> Result<((u32, u32), bool), Fault> {
    let (size, mut reader) = open(size_bytes, input)?;
    check_samples(&mut reader, voids).map(|has_known| (size, has_known))
}

/// Decodes all rows, one by one; true where a sample is a height that is none of `voids`, which stand for none as well.
fn check_samples(reader: &mut Reader<impl BufRead + Seek>, voids: &[f64]) -> Result<bool, Fault> {
    let (color, depth) = reader.output_color_type();
    let has_alpha = color != ColorType::Grayscale;
    let mut look = Look { voids, has_height: !has_alpha, has_known: !has_alpha && voids.is_empty() };
    while let Some(row) = reader.next_interlaced_row().map_err(foreign)? {
        match (depth, has_alpha) {
            (BitDepth::Sixteen, true) => look.at::<4>(row.data(), |[high, low, a, b]| ([high, low], a | b)),
            (BitDepth::Sixteen, false) => look.at::<2>(row.data(), |value| (value, 1)),
            (_, true) => look.at::<2>(row.data(), |[value, alpha]| ([0, value], alpha)),
            (_, false) => look.at::<1>(row.data(), |[value]| ([0, value], 1)),
        }
    }
    if look.has_height { Ok(look.has_known) } else { Err(all_void()) }
}

struct Look<'a> {
    voids: &'a [f64],
    /// A sample is a height.
    has_height: bool,
    /// One is none of `voids`.
    has_known: bool,
}

impl Look<'_> {
    /// Looks at pixels of so many bytes, of which `parts` gives the sample and an opacity, until a height is known.
    fn at<const N: usize>(&mut self, bytes: &[u8], parts: impl Fn([u8; N]) -> ([u8; 2], u8)) {
        if self.has_known {
            return;
        }
        let pixels = bytes.as_chunks::<N>().0;
        let mut look = |pixel: [u8; N]| {
            let (value, opacity) = parts(pixel);
            if opacity > 0 {
                let value = f64::from(u16::from_be_bytes(value));
                self.has_height = true;
                self.has_known |= !self.voids.iter().any(|void| is_same(value, *void));
            }
        };
        match firsts(pixels) {
            Some(firsts) => firsts.into_iter().for_each(|index| look(pixels[index])),
            None => pixels.iter().for_each(|&pixel| look(pixel)),
        }
    }
}

/// The size of a grey PNG of 8 or 16 bits, and what reads its rows.
fn open<R: BufRead + Seek>(size_bytes: u64, mut input: R) -> Result<((u32, u32), Reader<R>), Fault> {
    input.rewind().map_err(|error| Fault::foreign(Place::Whole, &error))?;
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: MAX_BYTES });
    // Texts and profiles can be compressed too, and are not looked at.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(foreign)?;
    let (width, height) = header.size();
    let is_packed = (header.bit_depth as u8) < 8;
    let header_fault = |reason: String| Fault::new(Place::Part("IHDR".to_owned()), reason);
    check_size(width.into(), height.into()).map_err(header_fault)?;
    check_compressed(size_bytes, (width, height), 8).map_err(header_fault)?;
    decoder.set_transformations(Transformations::EXPAND);
    let reader = decoder.read_info().map_err(foreign)?;
    let color = reader.output_color_type().0;
    if color == ColorType::GrayscaleAlpha || (color == ColorType::Grayscale && !is_packed) {
        return Ok(((width, height), reader));
    }
    let reason = "it is no grey picture of 8 or 16 bits; write heights as grey, for instance with gdal_translate";
    Err(header_fault(reason.to_owned()))
}

fn foreign(error: DecodingError) -> Fault {
    Fault::foreign(Place::Whole, &error)
}

fn map<T: Copy + Into<f64>>(width: u32, height: u32, values: Vec<T>, no_data: Option<f64>) -> Result<HeightMap, Fault> {
    Grid { width, height, values, integral: true, no_data, placement: Placement::Unknown }.into_map()
}
